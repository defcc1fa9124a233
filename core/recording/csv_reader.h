// Streaming, strict reading of numeric CSV by libcsv: only the wanted columns are kept, nothing is guessed.
//
// Comma-separated, LF or CRLF, blanks around fields and a UTF-8 byte-order mark ignored, blank lines skipped. Every
// line must have as many fields as the first one. A problem names file, line and column.

#ifndef IDIM_CORE_RECORDING_CSV_READER_H_
#define IDIM_CORE_RECORDING_CSV_READER_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/base/status.h"

namespace idim {

struct CsvFirstLine {
  std::vector<std::string> fields;
  int line = 1;              // 1-based, after skipped blank lines
  bool any_number = false;   // some field is a number
  bool all_numbers = false;  // all are: the file has no header
};

// Refuses a file that is missing or empty.
Result<CsvFirstLine> ReadCsvFirstLine(const std::string& path);

struct CsvColumn {
  int index = 0;      // zero-based
  std::string label;  // for messages: "column 'q3'"
  double scale = 1.0;
  double offset = 0.0;
};

// scale * field + offset of the wanted columns, rows x columns.size(). Refused: text, an empty field, NaN, inf, a
// magnitude above 1e12 before or after scaling, a wrong number of fields, a truncated last line.
// `fields` is the number of fields of the first line.
Result<Eigen::MatrixXd> ReadCsvColumns(const std::string& path, bool has_header, int fields,
                                       const std::vector<CsvColumn>& columns);

// The 1-based line of zero-based data row `row`. It reads the file again: for messages only.
int LineOfCsvRow(const std::string& path, bool has_header, int row);

}  // namespace idim

#endif  // IDIM_CORE_RECORDING_CSV_READER_H_
