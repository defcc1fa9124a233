#include "apps/pages/validation_report.h"

#include <glog/logging.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "core/base/text.h"
#include "core/report/report.h"
#include "core/robot/joint_units.h"

namespace idim {
namespace {

// Tables of strings, for the console and for the page alike: the first column says which row it is.
struct PlainTable {
  std::string title;
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows;
};

PlainTable Start(const std::string& title, const std::string& first, const std::vector<Validation>& validations) {
  PlainTable table{title, {first}, {}};
  for (const Validation& v : validations) table.columns.push_back(v.name);
  return table;
}

std::vector<PlainTable> Tables(const std::vector<Validation>& validations) {
  CHECK(!validations.empty());
  std::vector<PlainTable> tables;
  PlainTable errors = Start("Relative error norm of the torque, % (Table VI)", "recording, joint", validations);
  PlainTable masses = Start("Payload mass estimated anew, kg +- standard deviation (error in %) (Tables VII, VIII)",
                            "recording, weighed", validations);
  PlainTable conditions{"Condition number of W (Table V)", {"recording", "cond(W)"}, {}};
  const std::vector<ValidationOfRecording>& recordings = validations[0].recordings;
  for (size_t r = 0; r < recordings.size(); ++r) {
    conditions.rows.push_back({recordings[r].name, Format("%.0f", recordings[r].condition_number)});
    Eigen::Index joints = 0;
    for (const Validation& v : validations) {
      if (v.recordings[r].fit) joints = v.recordings[r].fit->relative_error_percent.size();
    }
    for (Eigen::Index j = 0; j < joints + (joints > 0); ++j) {
      std::vector<std::string> row = {recordings[r].name + (j < joints ? ", joint " + std::to_string(j + 1) : ", all")};
      for (const Validation& v : validations) {
        const auto& fit = v.recordings[r].fit;
        row.push_back(!fit          ? "-"
                      : j == joints ? Format("%.2f", fit->relative_error_percent_all)
                                    : Format("%.2f", fit->relative_error_percent[j]));
      }
      errors.rows.push_back(std::move(row));
    }
    std::vector<std::string> row = {recordings[r].name};
    bool any = false;
    for (const Validation& v : validations) {
      const auto& mass = v.recordings[r].mass;
      if (mass && mass->weighed && !any) row[0] += Format(", %.4g", *mass->weighed);
      any |= mass.has_value();
      std::string cell = "-";
      if (mass) {
        cell = Format("%.3f", mass->value) + Format(" +- %.3f", mass->standard_deviation);
        if (mass->ErrorPercent()) cell += Format(" (%.2f)", *mass->ErrorPercent());
      }
      row.push_back(std::move(cell));
    }
    if (any) masses.rows.push_back(std::move(row));
  }
  for (PlainTable* table : {&errors, &conditions, &masses}) {
    if (!table->rows.empty()) tables.push_back(std::move(*table));
  }
  return tables;
}

// Table VI as bars, a figure a recording.
Section Errors(const std::vector<Validation>& validations) {
  Section section;
  section.title = "Relative error of the torque";
  FigureGrid grid;
  for (size_t r = 0; r < validations[0].recordings.size(); ++r) {
    BarFigure figure;
    figure.title = validations[0].recordings[r].name;
    figure.y_title = "relative error [%]";
    for (size_t k = 0; k < validations.size(); ++k) {
      const auto& fit = validations[k].recordings[r].fit;
      if (!fit) continue;
      figure.sets.push_back({validations[k].name, fit->relative_error_percent, ColorOfSet(k)});
    }
    if (figure.sets.empty()) continue;
    for (Eigen::Index j = 1; j <= figure.sets[0].value.size(); ++j) {
      figure.categories.push_back("joint " + std::to_string(j));
    }
    grid.figures.emplace_back(std::move(figure));
  }
  if (!grid.figures.empty()) section.blocks.emplace_back(std::move(grid));
  return section;
}

template <typename T>
nlohmann::ordered_json OrNull(const std::optional<T>& value) {
  return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json();
}

std::vector<double> ToVector(const Eigen::VectorXd& v) { return {v.data(), v.data() + v.size()}; }

}  // namespace

std::string ValidationToText(const std::vector<Validation>& validations) {
  std::string text;
  for (const PlainTable& table : Tables(validations)) {
    std::vector<std::vector<std::string>> lines = {table.columns};
    lines.insert(lines.end(), table.rows.begin(), table.rows.end());
    text += (text.empty() ? "" : "\n") + table.title + "\n" + AlignColumns(lines);
  }
  for (const Validation& v : validations) {
    if (!v.warning.empty()) text += "\n" + v.name + " is not to be trusted: " + v.warning + "\n";
  }
  return text;
}

std::string ValidationToJson(const std::string& robot, const std::vector<Validation>& validations) {
  nlohmann::ordered_json json;
  json["schema"] = "idim.validation.1";
  json["robot"] = robot;
  json["estimates"] = nlohmann::ordered_json::array();
  for (const Validation& v : validations) {
    nlohmann::ordered_json estimate;
    estimate["name"] = v.name;
    estimate["warning"] = v.warning;
    estimate["gains"] = ToVector(v.gains);
    estimate["recordings"] = nlohmann::ordered_json::array();
    for (const ValidationOfRecording& r : v.recordings) {
      nlohmann::ordered_json entry;
      entry["name"] = r.name;
      entry["payload"] = r.payload;
      entry["condition_number"] = r.condition_number;
      for (const char* key :
           {"relative_error_percent", "relative_error_percent_all", "rms_torque", "rms_torque_unfiltered", "mass",
            "mass_weighed", "mass_standard_deviation", "mass_error_percent"}) {
        entry[key] = nullptr;
      }
      if (r.fit) {
        entry["relative_error_percent"] = ToVector(r.fit->relative_error_percent);
        entry["relative_error_percent_all"] = r.fit->relative_error_percent_all;
        entry["rms_torque"] = ToVector(r.fit->rms_torque);
        entry["rms_torque_unfiltered"] = ToVector(r.fit->rms_torque_unfiltered);
      }
      if (r.mass) {
        entry["mass"] = r.mass->value;
        entry["mass_standard_deviation"] = r.mass->standard_deviation;
        entry["mass_weighed"] = OrNull(r.mass->weighed);
        entry["mass_error_percent"] = OrNull(r.mass->ErrorPercent());
      }
      estimate["recordings"].push_back(std::move(entry));
    }
    json["estimates"].push_back(std::move(estimate));
  }
  return json.dump(1) + "\n";
}

std::string RenderValidationReport(const Robot& robot, const std::vector<Validation>& validations) {
  Report report;
  report.title = robot.name;
  report.subtitle = "Estimates judged on recordings they have not seen";
  Section summary;
  summary.title = "Tables";
  for (const PlainTable& plain : Tables(validations)) {
    Table table;
    table.caption = plain.title;
    for (size_t c = 0; c < plain.columns.size(); ++c) {
      table.columns.push_back({plain.columns[c], c == 0 ? Table::Align::kLeft : Table::Align::kRight});
    }
    table.rows = plain.rows;
    summary.blocks.emplace_back(std::move(table));
  }
  for (const Validation& v : validations) {
    if (v.warning.empty()) continue;
    summary.blocks.emplace_back(Paragraph{v.name + " is not to be trusted: " + v.warning, Paragraph::Kind::kWarning});
  }
  report.sections.push_back(std::move(summary));
  if (Section errors = Errors(validations); !errors.blocks.empty()) report.sections.push_back(std::move(errors));
  for (const Validation& v : validations) {
    for (const RecordingSeries& s : v.series) {
      Section section;
      section.title = "Torque in " + s.name + " by " + v.name;
      FigureGrid grid;
      for (Eigen::Index j = 0; j < s.torque.cols(); ++j) {
        TimeFigure figure;
        figure.title = "joint " + std::to_string(j + 1);
        figure.y_title = "torque [" + UnitsOf(robot, static_cast<int>(j)).torque + "]";
        figure.t = s.decimated_t;
        figure.traces = {{"gains x signal", s.decimated_torque.col(j), SeriesColor::kMeasured},
                         {"model", s.decimated_model.col(j), SeriesColor::kModel}};
        figure.link = s.name + " " + v.name;
        grid.figures.emplace_back(std::move(figure));
      }
      section.blocks.emplace_back(std::move(grid));
      report.sections.push_back(std::move(section));
    }
  }
  return RenderReport(report);
}

}  // namespace idim
