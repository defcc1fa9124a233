// Numbers and names as text: strict parsing, short printing, the nearest known name for a message.

#ifndef IDIM_CORE_BASE_TEXT_H_
#define IDIM_CORE_BASE_TEXT_H_

#include <string>
#include <string_view>
#include <vector>

namespace idim {

// Larger magnitudes are garbage for every quantity that the library reads.
inline constexpr double kLargestInput = 1e12;

enum class NumberText { kOk, kNotANumber, kNotFinite, kTooLarge };

// The whole text must be one decimal number (an optional leading sign, no blanks, no locale), finite and at most
// kLargestInput in magnitude; `value` is set for kOk and kTooLarge.
NumberText ParseNumber(std::string_view text, double* value);

// What is wrong with `text`, e.g. "'abc' is not a number"; long or unprintable text is clipped. Not for kOk.
std::string DescribeNumberProblem(NumberText problem, std::string_view text);

// Shortest decimal text that reads back to the same double.
std::string FormatNumber(double value);

// printf into a string, of any length.
[[gnu::format(printf, 1, 2)]] std::string Format(const char* format, ...);

// At most 40 characters, control characters shown as '?'.
std::string Clip(std::string_view text);

std::string Join(const std::vector<std::string>& parts, const std::string& separator);

// Columns below each other, two blanks apart: the first to the left, the others to the right. Rows may be of different
// length; UTF-8.
std::string AlignColumns(const std::vector<std::vector<std::string>>& rows);

// The candidate with the smallest edit distance (ties: the first); "" without candidates.
std::string NearestName(const std::string& name, const std::vector<std::string>& candidates);

}  // namespace idim

#endif  // IDIM_CORE_BASE_TEXT_H_
