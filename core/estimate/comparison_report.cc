#include "core/estimate/comparison_report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <utility>

#include "core/estimate/estimate_json.h"
#include "core/report/report.h"

namespace idim {
namespace {

std::string Text(const char* format, double value) {
  char text[64];
  std::snprintf(text, sizeof(text), format, value);
  return text;
}

SeriesColor ColorOf(size_t k) {
  static constexpr SeriesColor kColors[] = {SeriesColor::kModel, SeriesColor::kMeasured, SeriesColor::kOrange,
                                            SeriesColor::kTeal,  SeriesColor::kPurple,   SeriesColor::kResidual};
  return kColors[k % std::size(kColors)];
}

const ParameterEstimate* Find(const Estimate& estimate, const std::string& name) {
  for (const ParameterEstimate& p : estimate.parameters) {
    if (p.parameter.name == name) return &p;
  }
  return nullptr;
}

// Names of all estimates in the order of the model, which each of them follows.
std::vector<Parameter> AllParameters(const std::vector<Estimate>& estimates) {
  std::vector<Parameter> all;
  for (const Estimate& e : estimates) {
    size_t at = 0;
    for (const ParameterEstimate& p : e.parameters) {
      const auto found =
          std::find_if(all.begin(), all.end(), [&](const Parameter& a) { return a.name == p.parameter.name; });
      if (found != all.end()) {
        at = static_cast<size_t>(found - all.begin()) + 1;
      } else {
        all.insert(all.begin() + static_cast<std::ptrdiff_t>(at++), p.parameter);
      }
    }
  }
  return all;
}

// The first estimate with numbers: what the others are compared with.
const Estimate* FirstUsable(const std::vector<Estimate>& estimates) {
  for (const Estimate& e : estimates) {
    if (!e.parameters.empty()) return &e;
  }
  return nullptr;
}

Section Verdicts(const std::vector<Estimate>& estimates) {
  Section section;
  section.title = "Estimators";
  Table table;
  table.columns = {{"estimator"},
                   {"relative error, %", Table::Align::kNumber},
                   {"cond(W)", Table::Align::kRight},
                   {"weighted", Table::Align::kRight},
                   {"verdict"}};
  for (const Estimate& e : estimates) {
    table.rows.push_back({EstimatorTitle(e.estimator), Text("%.2f", e.relative_error_percent),
                          Text("%.0f", e.condition_number), Text("%.0f", e.condition_number_weighted),
                          e.status.ok() ? "ok" : "not to be trusted: " + e.status.message()});
  }
  section.blocks.emplace_back(std::move(table));
  return section;
}

Table ValueTable(const std::vector<Estimate>& estimates, const std::vector<Reference>& references,
                 const std::vector<Parameter>& parameters) {
  Table table;
  table.columns = {{"parameter"}, {"unit"}};
  for (const Estimate& e : estimates) {
    table.columns.push_back({EstimatorTitle(e.estimator), Table::Align::kNumber});
    table.columns.push_back({"% σ", Table::Align::kNumber});
  }
  for (const Reference& r : references) table.columns.push_back({r.name, Table::Align::kNumber});
  for (const Parameter& parameter : parameters) {
    std::vector<std::string> row = {parameter.name, parameter.unit};
    for (const Estimate& e : estimates) {
      const ParameterEstimate* p = Find(e, parameter.name);
      row.push_back(p == nullptr ? "" : Text("%.4g", p->value));
      row.push_back(p == nullptr ? "" : Text("%.2f", p->RelativeSigmaPercent()));
    }
    for (const Reference& r : references) {
      const Reference::Entry* entry = r.Find(parameter.name);
      row.push_back(entry == nullptr ? "" : Text("%.4g", entry->value));
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

IntervalFigure Intervals(const std::vector<Estimate>& estimates, const std::vector<Reference>& references,
                         const std::vector<Parameter>& parameters) {
  IntervalFigure figure;
  const Eigen::Index count = static_cast<Eigen::Index>(parameters.size());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto blank = [&] { return Eigen::VectorXd::Constant(count, nan).eval(); };
  for (const Parameter& p : parameters) figure.parameters.push_back(p.name);
  for (const Estimate& e : estimates) {
    if (e.parameters.empty()) continue;
    IntervalFigure::Estimates set{EstimatorTitle(e.estimator), blank(), blank(), blank(), ColorOf(figure.sets.size())};
    for (Eigen::Index k = 0; k < count; ++k) {
      const ParameterEstimate* p = Find(e, figure.parameters[k]);
      if (p == nullptr) continue;
      set.value[k] = p->value;
      set.lower[k] = p->interval95[0];
      set.upper[k] = p->interval95[1];
    }
    figure.sets.push_back(std::move(set));
  }
  for (const Reference& r : references) {
    IntervalFigure::Estimates set{r.name, blank(), blank(), blank(), ColorOf(figure.sets.size())};
    for (Eigen::Index k = 0; k < count; ++k) {
      const Reference::Entry* entry = r.Find(figure.parameters[k]);
      if (entry != nullptr) set.value[k] = entry->value;
    }
    if (set.value.array().isFinite().any()) figure.sets.push_back(std::move(set));
  }
  return figure;
}

Section Gains(const std::vector<Estimate>& estimates, const std::vector<Reference>& references,
              const std::vector<Parameter>& gains) {
  Section section;
  section.title = "Drive gains";
  section.blocks.emplace_back(ValueTable(estimates, references, gains));
  FigureGrid grid;
  for (const Parameter& gain : gains) {
    IntervalFigure figure = Intervals(estimates, references, {gain});
    figure.title = gain.name + ", 95 % intervals";
    figure.value_title = gain.unit;
    grid.figures.emplace_back(std::move(figure));
  }
  section.blocks.emplace_back(std::move(grid));
  // The verdicts of the last estimator, whose weights come closest to the noise.
  const std::vector<GainDiagnosis>* diagnoses = nullptr;
  for (const Estimate& e : estimates) {
    if (!e.gain_diagnoses.empty()) diagnoses = &e.gain_diagnoses;
  }
  if (diagnoses != nullptr) {
    Table table;
    table.caption = "How well the data determine each gain";
    table.columns = {{"gain"}, {"verdict"}, {"why"}};
    for (const GainDiagnosis& g : *diagnoses) table.rows.push_back({g.name, g.strength, g.sentence});
    section.blocks.emplace_back(std::move(table));
  }
  return section;
}

Section SingularValues(const std::vector<Estimate>& estimates) {
  Section section;
  section.title = "Singular values";
  FigureGrid grid;
  for (const Estimate& e : estimates) {
    if (e.singular_values.size() == 0) continue;
    BarFigure figure;
    figure.title = EstimatorTitle(e.estimator) + ": the last should stand apart from the one before";
    figure.x_title = "index";
    figure.y_title = "log10 of the singular value";
    for (Eigen::Index k = 0; k < e.singular_values.size(); ++k) figure.categories.push_back(std::to_string(k + 1));
    const Eigen::VectorXd floored = e.singular_values.cwiseMax(1e-16 * e.singular_values[0]);
    figure.sets.push_back({EstimatorTitle(e.estimator), floored.array().log10().matrix(), ColorOf(0)});
    grid.figures.emplace_back(std::move(figure));
  }
  if (!grid.figures.empty()) section.blocks.emplace_back(std::move(grid));
  return section;
}

}  // namespace

std::string ComparisonToText(const std::vector<Estimate>& estimates, const std::vector<Reference>& references) {
  std::string text;
  for (const Estimate& e : estimates) {
    text += EstimatorTitle(e.estimator) + ": ";
    text += e.parameters.empty() ? "no estimate" : "relative error " + Text("%.2f %%", e.relative_error_percent);
    text += (e.status.ok() ? std::string() : "; not to be trusted: " + e.status.message()) + "\n";
  }
  const Estimate* first = FirstUsable(estimates);
  text += "\nvalue, relative standard deviation in %, difference to the first in %\nparameter ";
  for (const Estimate& e : estimates)
    text +=
        Text("", 0) + "  " + EstimatorTitle(e.estimator) + std::string(24 - EstimatorTitle(e.estimator).size(), ' ');
  for (const Reference& r : references) text += "  " + r.name;
  text += "\n";
  for (const Parameter& parameter : AllParameters(estimates)) {
    text += parameter.name + std::string(parameter.name.size() < 10 ? 10 - parameter.name.size() : 0, ' ');
    const ParameterEstimate* base = first == nullptr ? nullptr : Find(*first, parameter.name);
    for (const Estimate& e : estimates) {
      const ParameterEstimate* p = Find(e, parameter.name);
      if (p == nullptr) {
        text += std::string(26, ' ');
        continue;
      }
      text += Text(" %+10.3e", p->value) + Text(" %6.1f", std::min(p->RelativeSigmaPercent(), 9999.0));
      text += base == nullptr || base == p ? std::string(8, ' ')
                                           : Text(" %+7.1f", 100.0 * (p->value - base->value) / std::abs(base->value));
    }
    for (const Reference& r : references) {
      const Reference::Entry* entry = r.Find(parameter.name);
      text += entry == nullptr ? std::string(12, ' ') : Text("  %+10.3e", entry->value);
    }
    text += "\n";
  }
  return text;
}

std::string ComparisonToJson(const std::vector<Estimate>& estimates) {
  nlohmann::ordered_json json;
  json["schema"] = "idim.comparison.1";
  json["estimates"] = nlohmann::ordered_json::array();
  for (const Estimate& e : estimates) json["estimates"].push_back(EstimateJson(e));
  return json.dump(1) + "\n";
}

std::string RenderComparisonReport(const std::vector<Estimate>& estimates, const std::vector<Reference>& references) {
  Report report;
  report.title = estimates.empty() ? "" : estimates[0].robot;
  report.subtitle = "Estimators side by side on the same data";
  report.sections.push_back(Verdicts(estimates));
  std::vector<Parameter> gains, others;
  for (const Parameter& p : AllParameters(estimates)) {
    (p.kind == ParameterKind::kDriveGain ? gains : others).push_back(p);
  }
  if (!gains.empty()) report.sections.push_back(Gains(estimates, references, gains));
  Section values;
  values.title = "Parameters";
  values.blocks.emplace_back(ValueTable(estimates, references, others));
  IntervalFigure figure = Intervals(estimates, references, others);
  figure.title = "95 % intervals, divided by the first estimate";
  figure.value_title = "relative to the first";
  figure.scale = IntervalFigure::Scale::kRelativeToFirst;
  figure.limits = std::make_pair(-1.0, 3.0);
  values.blocks.emplace_back(FigureGrid{1, {std::move(figure)}});
  report.sections.push_back(std::move(values));
  Section singular = SingularValues(estimates);
  if (!singular.blocks.empty()) report.sections.push_back(std::move(singular));
  return RenderReport(report);
}

}  // namespace idim
