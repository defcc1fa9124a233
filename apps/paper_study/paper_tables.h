// The paper's tables as they are printed, from the CSV copies in datasets/paper_study/paper/.

#ifndef IDIM_APPS_PAPER_STUDY_PAPER_TABLES_H_
#define IDIM_APPS_PAPER_STUDY_PAPER_TABLES_H_

#include <string>
#include <vector>

#include "core/base/status.h"

namespace idim {

// One CSV file: a header line and rows of as many cells; lines that begin with # are left out. Cells stay text, so that
// "4.59±0.005" and "1.28e+0" read as printed.
struct PaperTable {
  std::string path;
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;

  // CHECKs that the column exists.
  int Column(const std::string& name) const;
  const std::string& Cell(int row, const std::string& column) const;
  // CHECKs that the cell is a number.
  double Number(int row, const std::string& column) const;
};

struct PaperTables {
  PaperTable table_1, table_2_4, table_3, table_5, table_6, table_7_8, relative_error;
};

// BadInput: a file that is missing, has a row of another length, lacks a column or a number that the page needs.
Result<PaperTables> ReadPaperTables(const std::string& folder);

}  // namespace idim

#endif  // IDIM_APPS_PAPER_STUDY_PAPER_TABLES_H_
