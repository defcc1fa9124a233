#include "core/recording/csv_reader.h"

#include <csv.h>
#include <glog/logging.h>

#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>
#include <string_view>

#include "core/base/file.h"
#include "core/base/text.h"

namespace idim {

namespace {

constexpr size_t kChunk = 1 << 16;
constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

using FilePointer = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

FilePointer Open(const std::string& path) { return FilePointer(std::fopen(path.c_str(), "rb"), &std::fclose); }

std::string At(const std::string& path, int line) { return path + ":" + std::to_string(line) + ": "; }

// The line of the zero-based record (header included) among lines that are not blank.
int LineOfRecord(const std::string& path, long record) {
  const Result<std::string> text = ReadFile(path);
  if (!text.ok()) return 0;
  int line = 1;
  bool blank = true;
  for (const char c : *text) {
    if (c == '\n') {
      if (!blank) --record;
      blank = true;
      ++line;
    } else if (c != ' ' && c != '\t' && c != '\r') {
      if (blank && record == 0) return line;
      blank = false;
    }
  }
  return line;
}

// A libcsv parser that feeds a sink with OnField(text) and OnRow(ended_by_newline); the sink's `done` stops it.
template <typename Sink>
class Parser {
 public:
  explicit Parser(Sink* sink) : sink_(sink) { CHECK_EQ(csv_init(&parser_, CSV_STRICT | CSV_STRICT_FINI), 0); }
  ~Parser() { csv_free(&parser_); }
  Parser(const Parser&) = delete;
  Parser& operator=(const Parser&) = delete;

  // Empty: all is well; else the reason.
  std::string Run(const std::string& path) {
    const FilePointer file = Open(path);
    if (file == nullptr) return std::strerror(errno);
    std::vector<char> buffer(kChunk);
    bool first = true;
    while (const size_t count = std::fread(buffer.data(), 1, kChunk, file.get())) {
      const std::string_view text(buffer.data(), count);
      const size_t skip = first && text.substr(0, 3) == kByteOrderMark ? 3 : 0;
      first = false;
      if (csv_parse(&parser_, text.data() + skip, count - skip, &Field, &Row, sink_) != count - skip) {
        return csv_strerror(csv_error(&parser_));
      }
      if (sink_->done) return std::string();
    }
    if (std::ferror(file.get()) != 0) return std::strerror(errno);
    if (csv_fini(&parser_, &Field, &Row, sink_) != 0) return csv_strerror(csv_error(&parser_));
    return std::string();
  }

 private:
  static void Field(void* text, size_t size, void* sink) {
    static_cast<Sink*>(sink)->OnField(std::string_view(static_cast<const char*>(text), size));
  }
  // libcsv gives the character that ended the row, -1 where the file ended instead.
  static void Row(int terminator, void* sink) { static_cast<Sink*>(sink)->OnRow(terminator != -1); }

  Sink* sink_;
  csv_parser parser_;
};

struct FirstLineSink {
  void OnField(std::string_view text) {
    if (!done) fields.emplace_back(text);
  }
  void OnRow(bool) { done = true; }

  std::vector<std::string> fields;
  bool done = false;
};

class ColumnSink {
 public:
  ColumnSink(bool has_header, int fields, const std::vector<CsvColumn>& columns)
      : fields_(fields), columns_(columns), wanted_(fields, -1), header_(has_header ? 1 : 0) {
    for (size_t i = 0; i < columns.size(); ++i) {
      CHECK(columns[i].index >= 0 && columns[i].index < fields);
      CHECK_EQ(wanted_[columns[i].index], -1) << "a column is read once";
      wanted_[columns[i].index] = static_cast<int>(i);
    }
    row_.resize(columns.size());
  }

  void OnField(std::string_view text) {
    const int field = field_++;
    if (field >= fields_ || done || record_ < header_ || problem_record_ >= 0) return;
    const int slot = wanted_[field];
    if (slot < 0) return;
    // The plain case goes straight through; whatever it does not take is looked at again for the message.
    double value = 0.0;
    const char* const end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data(), end, value);
    if (stop != end || error != std::errc() || !(std::abs(value) <= kLargestInput)) {
      const NumberText kind = ParseNumber(text, &value);
      if (kind != NumberText::kOk) {
        SetProblem(columns_[slot].label + ": " + DescribeNumberProblem(kind, text) + "; expected a finite number");
        return;
      }
    }
    value = columns_[slot].scale * value + columns_[slot].offset;
    if (!(std::abs(value) <= kLargestInput)) {
      SetProblem(columns_[slot].label + ": " + DescribeNumberProblem(NumberText::kTooLarge, text) +
                 " after scale and offset; expected a finite number");
      return;
    }
    row_[slot] = value;
  }

  void OnRow(bool ended_by_newline) {
    const int count = field_;
    field_ = 0;
    if (done) return;
    if (problem_record_ >= 0) {  // a row follows the one with the problem: that one is not the last
      done = true;
      return;
    }
    if (count != fields_) {
      wrong_count_ = count;
      problem_record_ = record_;
    } else if (!problem_.empty()) {
      problem_record_ = record_;
    } else if (record_ >= header_) {
      values_.insert(values_.end(), row_.begin(), row_.end());
    }
    unterminated_ = !ended_by_newline;
    ++record_;
  }

  long record() const { return record_; }
  // The record with the first problem, -1: none.
  long problem_record() const { return problem_record_; }

  std::string Problem() const {
    const bool last = !done;
    std::string text = problem_;
    if (wrong_count_ >= 0) {
      text = std::to_string(wrong_count_) + (wrong_count_ == 1 ? " column" : " columns") + "; expected " +
             std::to_string(fields_) + " as in the first line";
    }
    const bool truncated = last && (wrong_count_ >= 0 ? wrong_count_ < fields_ : unterminated_);
    return truncated ? "the last line is truncated: " + text : text;
  }

  Eigen::MatrixXd Values() const {
    const Eigen::Index width = static_cast<Eigen::Index>(columns_.size());
    const Eigen::Index rows = width == 0 ? record_ - header_ : static_cast<Eigen::Index>(values_.size()) / width;
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    return Eigen::Map<const RowMajor>(values_.data(), rows, width);
  }

  bool done = false;

 private:
  void SetProblem(std::string text) {
    if (problem_.empty()) problem_ = std::move(text);
  }

  const int fields_;
  const std::vector<CsvColumn>& columns_;
  std::vector<int> wanted_;  // field -> slot in row_, -1: not wanted
  const long header_;
  std::vector<double> row_;
  std::vector<double> values_;
  int field_ = 0;
  long record_ = 0;
  long problem_record_ = -1;
  int wrong_count_ = -1;
  bool unterminated_ = false;
  std::string problem_;
};

}  // namespace

Result<CsvFirstLine> ReadCsvFirstLine(const std::string& path) {
  // Opening a directory succeeds, so the plain reader's checks come first.
  if (!IsRegularFile(path)) {
    const Result<std::string> content = ReadFile(path);
    IDIM_RETURN_IF_ERROR(content);
  }
  FirstLineSink sink;
  const std::string reason = Parser<FirstLineSink>(&sink).Run(path);
  if (!sink.done && !reason.empty())
    return Status::BadInput(At(path, 1) + reason + "; expected comma-separated values");
  if (sink.fields.empty()) {
    return Status::BadInput(At(path, 1) + "the file is empty; expected a header line and samples");
  }
  CsvFirstLine first;
  first.fields = std::move(sink.fields);
  first.line = LineOfRecord(path, 0);
  int numbers = 0;
  for (const std::string& field : first.fields) {
    double value = 0.0;
    if (ParseNumber(field, &value) != NumberText::kNotANumber) ++numbers;
  }
  first.any_number = numbers > 0;
  first.all_numbers = numbers == static_cast<int>(first.fields.size());
  return first;
}

Result<Eigen::MatrixXd> ReadCsvColumns(const std::string& path, bool has_header, int fields,
                                       const std::vector<CsvColumn>& columns) {
  ColumnSink sink(has_header, fields, columns);
  const std::string reason = Parser<ColumnSink>(&sink).Run(path);
  if (sink.problem_record() >= 0) {
    return Status::BadInput(At(path, LineOfRecord(path, sink.problem_record())) + sink.Problem());
  }
  if (!reason.empty()) {
    return Status::BadInput(At(path, LineOfRecord(path, sink.record())) + "not valid CSV: " + reason +
                            "; expected comma-separated values");
  }
  return sink.Values();
}

int LineOfCsvRow(const std::string& path, bool has_header, int row) {
  return LineOfRecord(path, static_cast<long>(row) + (has_header ? 1 : 0));
}

}  // namespace idim
