#include "apps/paper_study/paper_tables.h"

#include <glog/logging.h>

#include <algorithm>
#include <sstream>
#include <utility>

#include "core/base/file.h"
#include "core/base/text.h"

namespace idim {
namespace {

std::vector<std::string> Cells(const std::string& line) {
  std::vector<std::string> cells(1);
  for (char c : line) {
    if (c == ',') {
      cells.emplace_back();
    } else if (c != '\r') {
      cells.back() += c;
    }
  }
  return cells;
}

// `numbers`: columns whose every cell must be a number; `texts`: those that must be there.
Result<PaperTable> ReadPaperTable(const std::string& path, const std::vector<std::string>& numbers,
                                  const std::vector<std::string>& texts, size_t rows) {
  Result<std::string> text = ReadFile(path);
  IDIM_RETURN_IF_ERROR(text);
  PaperTable table;
  table.path = path;
  std::istringstream stream(*text);
  std::string line;
  while (std::getline(stream, line)) {
    if (line.empty() || line[0] == '#') continue;
    std::vector<std::string> cells = Cells(line);
    if (table.header.empty()) {
      table.header = std::move(cells);
      continue;
    }
    if (cells.size() != table.header.size()) {
      return Status::BadInput(path + ": '" + Clip(line) + "' has " + std::to_string(cells.size()) +
                              " cells; expected " + std::to_string(table.header.size()));
    }
    table.rows.push_back(std::move(cells));
  }
  std::vector<std::string> wanted = numbers;
  wanted.insert(wanted.end(), texts.begin(), texts.end());
  for (const std::string& name : wanted) {
    if (std::find(table.header.begin(), table.header.end(), name) == table.header.end()) {
      return Status::BadInput(path + ": no column '" + name + "'; expected " + Join(wanted, ", "));
    }
  }
  if (rows > 0 && table.rows.size() != rows) {
    return Status::BadInput(path + ": has " + std::to_string(table.rows.size()) + " rows; expected " +
                            std::to_string(rows));
  }
  for (const std::string& name : numbers) {
    for (const auto& row : table.rows) {
      double value = 0.0;
      const std::string& cell = row[table.Column(name)];
      const NumberText problem = ParseNumber(cell, &value);
      if (problem != NumberText::kOk) {
        return Status::BadInput(path + ": column '" + name + "': " + DescribeNumberProblem(problem, cell));
      }
    }
  }
  return table;
}

}  // namespace

int PaperTable::Column(const std::string& name) const {
  const auto found = std::find(header.begin(), header.end(), name);
  CHECK(found != header.end()) << path << ": " << name;
  return static_cast<int>(found - header.begin());
}

const std::string& PaperTable::Cell(int row, const std::string& column) const { return rows[row][Column(column)]; }

double PaperTable::Number(int row, const std::string& column) const {
  double value = 0.0;
  CHECK(ParseNumber(Cell(row, column), &value) == NumberText::kOk) << path << ": " << column;
  return value;
}

Result<PaperTables> ReadPaperTables(const std::string& folder) {
  const std::vector<std::string> parameter_columns = {
      "parameter",        "ten_known_value",    "ten_known_relative_std_percent",
      "mass_known_value", "difference_percent", "mass_known_relative_std_percent"};
  std::vector<std::string> cases = {"manufacturer", "case1", "case2", "case3", "case4"};
  std::vector<std::string> masses = {"true_mass"};
  for (const std::string& name : cases) {
    masses.push_back(name);
    masses.push_back(name + "_rsd");
  }
  PaperTables tables;
  struct File {
    const char* name;
    PaperTable* table;
    std::vector<std::string> numbers, texts;
    size_t rows;
  };
  const File files[] = {{"table_1.csv", &tables.table_1, {}, parameter_columns, 0},
                        {"table_2_4.csv",
                         &tables.table_2_4,
                         {"a_priori", "wls_ten_known", "wls_ten_known_rsd", "wls_mass_known", "wls_mass_known_rsd",
                          "tls_ten_known", "tls_ten_known_rsd", "tls_mass_known", "tls_mass_known_rsd"},
                         {"joint"},
                         6},
                        {"table_3.csv", &tables.table_3, {}, parameter_columns, 0},
                        {"table_5.csv", &tables.table_5, {"condition_number"}, {"trajectory"}, 3},
                        {"table_6.csv", &tables.table_6, cases, {"trajectory", "joint"}, 18},
                        {"table_7_8.csv", &tables.table_7_8, masses, {"trajectory"}, 6},
                        {"relative_error.csv", &tables.relative_error, {"relative_error_percent"}, {"case"}, 4}};
  for (const File& file : files) {
    Result<PaperTable> table = ReadPaperTable(folder + "/" + file.name, file.numbers, file.texts, file.rows);
    IDIM_RETURN_IF_ERROR(table);
    *file.table = std::move(table).value();
  }
  return tables;
}

}  // namespace idim
