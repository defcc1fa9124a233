#include "apps/pages/comparison_report.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "apps/pages/monte_carlo_report.h"
#include "core/base/text.h"
#include "core/estimate/estimate_json.h"
#include "core/report/report.h"

namespace idim {
namespace {

// A percentage to a tenth; of a parameter near zero it says no more than that it is large.
std::string TenthsOfPercent(double value) {
  constexpr double kLargest = 9999.0;
  if (std::abs(value) < kLargest) return Format("%.1f", value);
  return value > 0.0 ? ">9999" : "<-9999";
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

// The verdicts of the last estimator that has some, whose weights come closest to the noise; nullptr without.
const std::vector<GainDiagnosis>* LastDiagnoses(const std::vector<Estimate>& estimates) {
  const std::vector<GainDiagnosis>* diagnoses = nullptr;
  for (const Estimate& e : estimates) {
    if (!e.gain_diagnoses.empty()) diagnoses = &e.gain_diagnoses;
  }
  return diagnoses;
}

// What the others are compared with: the first that can be trusted, else the first with numbers.
const Estimate* FirstUsable(const std::vector<Estimate>& estimates) {
  const Estimate* first = nullptr;
  for (const Estimate& e : estimates) {
    if (e.parameters.empty()) continue;
    if (e.status.ok()) return &e;
    if (first == nullptr) first = &e;
  }
  return first;
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
    const bool solved = !e.parameters.empty();
    table.rows.push_back({EstimatorTitle(e.estimator), solved ? Format("%.2f", e.relative_error_percent) : "",
                          solved ? Format("%.0f", e.condition_number) : "",
                          solved ? Format("%.0f", e.condition_number_weighted) : "",
                          e.status.ok() ? "ok" : "not to be trusted: " + e.status.message()});
  }
  section.blocks.emplace_back(std::move(table));
  return section;
}

Section BiasTests(const std::vector<BiasTest>& tests) {
  Section section;
  section.title = "Is least squares biased?";
  section.blocks.emplace_back(Paragraph{
      "Durbin-Wu-Hausman test by augmented regression; instruments are the same columns a few decimated samples "
      "before and after, which see the motion but not the noise of this sample."});
  Table table;
  table.columns = {{"equations"}, {"answer"}};
  for (const BiasTest& test : tests) table.rows.push_back({test.equations, BiasTestSentence(test)});
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
      const ParameterEstimate* p = e.Find(parameter.name);
      row.push_back(p == nullptr ? "" : Format("%.4g", p->value));
      row.push_back(p == nullptr ? "" : TenthsOfPercent(p->RelativeSigmaPercent()));
    }
    for (const Reference& r : references) {
      const Reference::Entry* entry = r.Find(parameter.name);
      row.push_back(entry == nullptr ? "" : Format("%.4g", entry->value));
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

// The colour of a set is that of its place in the lists, whatever a figure leaves out.
IntervalFigure Intervals(const std::vector<Estimate>& estimates, const std::vector<Reference>& references,
                         const std::vector<Parameter>& parameters) {
  IntervalFigure figure;
  const Eigen::Index count = static_cast<Eigen::Index>(parameters.size());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto blank = [&] { return Eigen::VectorXd::Constant(count, nan).eval(); };
  for (const Parameter& p : parameters) figure.parameters.push_back(p.name);
  for (size_t place = 0; place < estimates.size(); ++place) {
    const Estimate& e = estimates[place];
    if (e.parameters.empty()) continue;
    IntervalFigure::Estimates set{EstimatorTitle(e.estimator), blank(), blank(), blank(), ColorOfSet(place)};
    for (Eigen::Index k = 0; k < count; ++k) {
      const ParameterEstimate* p = e.Find(figure.parameters[k]);
      if (p == nullptr) continue;
      set.value[k] = p->value;
      set.lower[k] = p->interval95[0];
      set.upper[k] = p->interval95[1];
    }
    figure.sets.push_back(std::move(set));
  }
  for (size_t place = 0; place < references.size(); ++place) {
    const Reference& r = references[place];
    IntervalFigure::Estimates set{r.name, blank(), blank(), blank(), ColorOfSet(estimates.size() + place)};
    for (Eigen::Index k = 0; k < count; ++k) {
      const Reference::Entry* entry = r.Find(figure.parameters[k]);
      if (entry != nullptr) set.value[k] = entry->value;
    }
    if (set.value.array().isFinite().any()) figure.sets.push_back(std::move(set));
  }
  return figure;
}

// Where to look at a gain: a factor of two about the one to believe, so that an estimator that is off by a factor of a
// hundred is an arrow and does not flatten the others. Believed: the first reference, else the last estimate that can
// be trusted, else the last. None where all fits anyway.
std::optional<std::pair<double, double>> Around(const std::vector<Estimate>& estimates,
                                                const std::vector<Reference>& references, const std::string& name) {
  double centre = 0.0, lowest = 0.0, highest = 0.0;
  bool trusted = false;
  for (const Estimate& e : estimates) {
    const ParameterEstimate* p = e.Find(name);
    if (p == nullptr) continue;
    if (e.status.ok() || !trusted) centre = p->value;
    trusted |= e.status.ok();
    lowest = std::min(lowest, p->interval95[0]);
    highest = std::max(highest, p->interval95[1]);
  }
  for (size_t k = references.size(); k-- > 0;) {
    const Reference::Entry* entry = references[k].Find(name);
    if (entry != nullptr) centre = entry->value;
  }
  if (centre == 0.0) return std::nullopt;
  // From zero, which is no gain at all, to twice the centre, and a little beyond, to round numbers.
  const double step = 0.5 * std::pow(10.0, std::floor(std::log10(std::abs(centre))));
  const auto round = [&](double share) { return step * std::ceil(share * std::abs(centre) / step - 1e-9); };
  const double near = round(0.2), far = round(2.2);
  const auto limits = centre > 0.0 ? std::make_pair(-near, far) : std::make_pair(-far, near);
  if (lowest >= limits.first && highest <= limits.second) return std::nullopt;
  return limits;
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
    figure.limits = Around(estimates, references, gain.name);
    grid.figures.emplace_back(std::move(figure));
  }
  section.blocks.emplace_back(std::move(grid));
  if (const std::vector<GainDiagnosis>* diagnoses = LastDiagnoses(estimates)) {
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
  for (size_t place = 0; place < estimates.size(); ++place) {
    const Estimate& e = estimates[place];
    if (e.singular_values.size() == 0) continue;
    BarFigure figure;
    figure.title = EstimatorTitle(e.estimator) + ": the last should stand apart from the one before";
    figure.x_title = "index";
    figure.y_title = "log10 of the singular value";
    for (Eigen::Index k = 0; k < e.singular_values.size(); ++k) figure.categories.push_back(std::to_string(k + 1));
    const Eigen::VectorXd floored = e.singular_values.cwiseMax(1e-16 * e.singular_values[0]);
    figure.sets.push_back({EstimatorTitle(e.estimator), floored.array().log10().matrix(), ColorOfSet(place)});
    grid.figures.emplace_back(std::move(figure));
  }
  if (!grid.figures.empty()) section.blocks.emplace_back(std::move(grid));
  return section;
}

}  // namespace

std::string ComparisonToText(const Comparison& comparison) {
  const std::vector<Estimate>& estimates = comparison.estimates;
  const std::vector<Reference>& references = comparison.references;
  std::string text;
  for (const Estimate& e : estimates) {
    text += EstimatorTitle(e.estimator) + ": ";
    text += e.parameters.empty() ? "no estimate" : "relative error " + Format("%.2f %%", e.relative_error_percent);
    text += (e.status.ok() ? std::string() : "; not to be trusted: " + e.status.message()) + "\n";
  }
  if (comparison.sequential) {
    text += "one joint at a time:";
    for (const ParameterEstimate& p : comparison.sequential->parameters) {
      text += " " + p.parameter.name + Format(" %.4g", p.value);
    }
    text += comparison.sequential->status.ok() ? "\n" : "; " + comparison.sequential->status.message() + "\n";
  }
  for (const BiasTest& test : comparison.bias_tests) {
    text += "is LS biased (" + test.equations + ")? " + BiasTestSentence(test) + "\n";
  }
  const Estimate* first = FirstUsable(estimates);
  if (first == nullptr) return text;
  std::vector<std::vector<std::string>> rows = {{"parameter"}};
  for (const Estimate& e : estimates) {
    if (e.parameters.empty()) continue;
    rows[0].insert(rows[0].end(), {EstimatorTitle(e.estimator) + (e.status.ok() ? "" : " (!)"), "%std"});
    if (&e != first) rows[0].push_back("diff %");
  }
  for (const Reference& r : references) rows[0].push_back(r.name);
  for (const Parameter& parameter : AllParameters(estimates)) {
    std::vector<std::string> row = {parameter.name};
    const ParameterEstimate* base = first->Find(parameter.name);
    for (const Estimate& e : estimates) {
      if (e.parameters.empty()) continue;
      const ParameterEstimate* p = e.Find(parameter.name);
      row.push_back(p == nullptr ? "" : Format("%+.3e", p->value));
      row.push_back(p == nullptr ? "" : TenthsOfPercent(p->RelativeSigmaPercent()));
      if (&e == first) continue;
      const bool comparable = p != nullptr && base != nullptr && base->value != 0.0;
      row.push_back(comparable ? TenthsOfPercent(100.0 * (p->value - base->value) / std::abs(base->value)) : "");
    }
    for (const Reference& r : references) {
      const Reference::Entry* entry = r.Find(parameter.name);
      row.push_back(entry == nullptr ? "" : Format("%+.3e", entry->value));
    }
    rows.push_back(std::move(row));
  }
  text += "\nvalue, relative standard deviation in %, difference to " + EstimatorTitle(first->estimator) + " in %\n" +
          AlignColumns(rows);
  if (const std::vector<GainDiagnosis>* diagnoses = LastDiagnoses(estimates)) {
    for (const GainDiagnosis& g : *diagnoses) text += "\n" + g.sentence;
    text += "\n";
  }
  if (comparison.monte_carlo) text += "\n" + MonteCarloToText(*comparison.monte_carlo);
  return text;
}

std::string ComparisonToJson(const Comparison& comparison) {
  nlohmann::ordered_json json;
  json["schema"] = "idim.comparison.1";
  json["estimates"] = nlohmann::ordered_json::array();
  for (const Estimate& e : comparison.estimates) json["estimates"].push_back(EstimateJson(e));
  if (comparison.sequential) json["sequential"] = EstimateJson(*comparison.sequential);
  if (!comparison.bias_tests.empty()) {
    json["bias_tests"] = nlohmann::ordered_json::array();
    for (const BiasTest& t : comparison.bias_tests) {
      json["bias_tests"].push_back({{"equations", t.equations},
                                    {"status", t.status.ok() ? "ok" : "untrusted"},
                                    {"message", t.status.message()},
                                    {"biased", t.biased},
                                    {"f", t.f},
                                    {"degrees_of_freedom", {t.numerator, t.denominator}},
                                    {"p_value", t.p_value},
                                    {"sargan_p_value", t.sargan_p}});
    }
  }
  if (comparison.monte_carlo) json["monte_carlo"] = MonteCarloJson(*comparison.monte_carlo);
  return json.dump(1) + "\n";
}

std::string RenderComparisonReport(const Comparison& comparison) {
  const std::vector<Estimate>& estimates = comparison.estimates;
  const std::vector<Reference>& references = comparison.references;
  Report report;
  report.title = estimates.empty() ? "" : estimates[0].robot;
  report.subtitle = "Estimators side by side on the same data";
  report.sections.push_back(Verdicts(estimates));
  if (!comparison.bias_tests.empty()) report.sections.push_back(BiasTests(comparison.bias_tests));
  std::vector<Parameter> gains, others;
  for (const Parameter& p : AllParameters(estimates)) {
    (p.kind == ParameterKind::kDriveGain ? gains : others).push_back(p);
  }
  if (!gains.empty()) report.sections.push_back(Gains(estimates, references, gains));
  if (comparison.sequential) {
    Table table = ValueTable({*comparison.sequential}, {}, gains);
    table.caption = "Baseline: one joint at a time, from its own equation";
    report.sections.back().blocks.emplace_back(std::move(table));
  }
  Section values;
  values.title = "Parameters";
  values.blocks.emplace_back(ValueTable(estimates, references, others));
  IntervalFigure figure = Intervals(estimates, references, others);
  // Divided by the estimate that comes closest to the truth, not by the first: that is LS,
  // which may be off by a factor.
  size_t believed = 0, set = 0;
  bool trusted = false;
  for (const Estimate& e : estimates) {
    if (e.parameters.empty()) continue;
    if (e.status.ok() || !trusted) believed = set;
    trusted |= e.status.ok();
    ++set;
  }
  if (set > 0) std::rotate(figure.sets.begin(), figure.sets.begin() + believed, figure.sets.begin() + believed + 1);
  const std::string unit = set > 0 ? figure.sets[0].name : "the first";
  figure.title = "95 % intervals, divided by " + unit;
  figure.value_title = "relative to " + unit;
  figure.scale = IntervalFigure::Scale::kRelativeToFirst;
  figure.limits = std::make_pair(-1.0, 3.0);
  values.blocks.emplace_back(FigureGrid{1, {std::move(figure)}});
  report.sections.push_back(std::move(values));
  Section singular = SingularValues(estimates);
  if (!singular.blocks.empty()) report.sections.push_back(std::move(singular));
  if (comparison.monte_carlo) {
    for (Section& section : MonteCarloSections(*comparison.monte_carlo)) report.sections.push_back(std::move(section));
  }
  return RenderReport(report);
}

}  // namespace idim
