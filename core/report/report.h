// A report is one HTML file that needs no network: text and tables as plain HTML, which also prints and reads without
// scripts, and figures drawn in the reader's browser by Apache ECharts, which is embedded with its licence.
//
//   Report report;
//   report.title = "Staubli TX-40";
//   Section& fit = report.sections.emplace_back();
//   fit.title = "Measured and modelled torque";
//   fit.blocks.push_back(FigureGrid{2, {TimeFigure{...}, ...}});
//   std::string html = RenderReport(report);
//
// All strings are plain text, UTF-8; markup in them is shown, not obeyed.

#ifndef IDIM_CORE_REPORT_REPORT_H_
#define IDIM_CORE_REPORT_REPORT_H_

#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "core/report/figure.h"

namespace idim {

struct Paragraph {
  enum class Kind { kPlain, kNote, kWarning };
  std::string text;
  Kind kind = Kind::kPlain;
};

// Name and value, in the order given: cut-off frequency, condition number, samples kept.
struct KeyValues {
  std::vector<std::pair<std::string, std::string>> entries;
};

struct Table {
  enum class Align {
    kLeft,
    kRight,
    kNumber,  // decimal points below each other
  };
  struct Column {
    std::string title;
    Align align = Align::kLeft;
  };
  std::string caption;
  std::vector<Column> columns;
  std::vector<std::vector<std::string>> rows;  // each as long as columns
  std::vector<int> muted_rows = {};            // shown pale: parameters that the data do not determine
};

// Figures in rows of `columns`; one below the other on a narrow screen.
struct FigureGrid {
  int columns = 2;
  std::vector<Figure> figures;
};

using Block = std::variant<Paragraph, KeyValues, Table, FigureGrid>;

struct Section {
  std::string title;
  std::vector<Block> blocks;
};

struct Report {
  std::string title;
  std::string subtitle;
  std::vector<Section> sections;
};

// The HTML page. The same report gives the same bytes: no date, no random name. Samples are held as base64 of
// little-endian floats (time: doubles), equal vectors once.
//
// When all is drawn the page's <html> carries data-figures-expected, data-figures-drawn and data-script-errors, and
// each drawn figure data-drawn="true". Opened with the fragment #check, a figure counts as drawn only if pixels of one
// of its series' colours are found in its plotting area.
std::string RenderReport(const Report& report);

}  // namespace idim

#endif  // IDIM_CORE_REPORT_REPORT_H_
