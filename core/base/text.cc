#include "core/base/text.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <numeric>

namespace idim {

NumberText ParseNumber(std::string_view text, double* value) {
  const char* begin = text.data();
  const char* const end = begin + text.size();
  if (begin != end && *begin == '+') ++begin;  // from_chars takes '-' only
  if (begin == end || (begin != text.data() && *begin == '-')) return NumberText::kNotANumber;
  double parsed = 0.0;
  const auto [stop, error] = std::from_chars(begin, end, parsed);
  if (stop != end || error == std::errc::invalid_argument) return NumberText::kNotANumber;
  if (error == std::errc::result_out_of_range) return NumberText::kTooLarge;
  if (!std::isfinite(parsed)) return NumberText::kNotFinite;
  *value = parsed;
  return std::abs(parsed) <= kLargestInput ? NumberText::kOk : NumberText::kTooLarge;
}

std::string DescribeNumberProblem(NumberText problem, std::string_view text) {
  if (text.empty()) return "empty field";
  const std::string quoted = "'" + Clip(text) + "'";
  switch (problem) {
    case NumberText::kNotFinite:
      return quoted + " is not finite";
    case NumberText::kTooLarge:
      return quoted + " is out of range (largest magnitude " + FormatNumber(kLargestInput) + ")";
    default:
      return quoted + " is not a number";
  }
}

std::string FormatNumber(double value) {
  char buffer[32];
  const auto result = std::to_chars(buffer, buffer + sizeof(buffer), value);
  return std::string(buffer, result.ptr);
}

std::string Format(const char* format, ...) {
  va_list arguments, again;
  va_start(arguments, format);
  va_copy(again, arguments);
  const int length = std::vsnprintf(nullptr, 0, format, arguments);
  va_end(arguments);
  std::string text(static_cast<size_t>(std::max(0, length)) + 1, '\0');
  std::vsnprintf(text.data(), text.size(), format, again);
  va_end(again);
  text.pop_back();
  return text;
}

std::string Clip(std::string_view text) {
  constexpr size_t kLongest = 40;
  std::string clipped(text.substr(0, kLongest));
  for (char& c : clipped) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  }
  return text.size() > kLongest ? clipped + "..." : clipped;
}

std::string Join(const std::vector<std::string>& parts, const std::string& separator) {
  std::string joined;
  for (size_t i = 0; i < parts.size(); ++i) joined += (i == 0 ? "" : separator) + parts[i];
  return joined;
}

namespace {

// Code points: continuation bytes do not count.
size_t Width(const std::string& text) {
  return static_cast<size_t>(std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xc0) != 0x80; }));
}

// Levenshtein distance, one row of the table at a time.
size_t EditDistance(const std::string& a, const std::string& b) {
  std::vector<size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), size_t{0});
  for (size_t i = 1; i <= a.size(); ++i) {
    size_t diagonal = row[0];
    row[0] = i;
    for (size_t j = 1; j <= b.size(); ++j) {
      const size_t substituted = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substituted});
    }
  }
  return row.back();
}

}  // namespace

std::string AlignColumns(const std::vector<std::vector<std::string>>& rows) {
  std::vector<size_t> width;
  for (const auto& row : rows) {
    width.resize(std::max(width.size(), row.size()), 0);
    for (size_t c = 0; c < row.size(); ++c) width[c] = std::max(width[c], Width(row[c]));
  }
  std::string text;
  for (const auto& row : rows) {
    std::string line;
    for (size_t c = 0; c < row.size(); ++c) {
      const std::string pad(width[c] - Width(row[c]), ' ');
      line += c == 0 ? row[c] + pad : "  " + pad + row[c];
    }
    text += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
  }
  return text;
}

std::string NearestName(const std::string& name, const std::vector<std::string>& candidates) {
  const auto nearest = std::min_element(candidates.begin(), candidates.end(), [&](const auto& a, const auto& b) {
    return EditDistance(name, a) < EditDistance(name, b);
  });
  return nearest == candidates.end() ? std::string() : *nearest;
}

}  // namespace idim
