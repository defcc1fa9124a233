#include "apps/pages/monte_carlo_report.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "core/base/text.h"

namespace idim {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

bool IsGain(const ParameterStatistics& p) { return p.parameter.kind == ParameterKind::kDriveGain; }

// Of a deviation; > 0.
double PercentOfTruth(const ParameterStatistics& p, double value) {
  return p.truth == 0.0 ? std::numeric_limits<double>::quiet_NaN() : 100.0 * value / std::abs(p.truth);
}

// Negative where the estimate is too small in magnitude, also where the truth is negative.
double BiasPercent(const ParameterStatistics& p) {
  return p.truth == 0.0 ? std::numeric_limits<double>::quiet_NaN() : 100.0 * p.bias / p.truth;
}

// Significant digits enough to tell 0.3 % from 30 %; what is large is only large.
std::string Percent(double value) {
  if (!std::isfinite(value)) return "";
  if (std::abs(value) >= 9999.0) return value > 0.0 ? ">9999" : "<-9999";
  return Format(std::abs(value) < 9.995 ? "%+.2f" : std::abs(value) < 99.95 ? "%+.1f" : "%+.0f", value);
}

std::string Unsigned(double value) {
  const std::string text = Percent(value);
  return text.empty() || text[0] != '+' ? text : text.substr(1);
}

std::string Coverage(const ParameterStatistics& p) { return p.runs == 0 ? "" : Format("%.1f", 100.0 * p.coverage95); }

// Mean, and where it should lie.
std::string NeesText(const Nees& nees) {
  return nees.runs == 0 ? "" : Format("%.3g (%.2f to %.2f)", nees.mean, nees.expected95[0], nees.expected95[1]);
}

// Least, median and greatest coverage of the parameters; without any run: nothing.
std::string CoverageRange(const EstimatorStatistics& e) {
  std::vector<double> coverage;
  for (const ParameterStatistics& p : e.parameters) {
    if (p.runs > 0) coverage.push_back(100.0 * p.coverage95);
  }
  if (coverage.empty()) return "";
  std::sort(coverage.begin(), coverage.end());
  return Format("%.1f / %.1f / %.1f", coverage.front(), coverage[coverage.size() / 2], coverage.back());
}

// The parameters that pictures and short tables are about.
std::vector<Index> Shown(const MonteCarlo& monte_carlo) {
  std::vector<Index> gains, all;
  if (monte_carlo.estimators.empty()) return all;
  const auto& parameters = monte_carlo.estimators[0].parameters;
  for (size_t k = 0; k < parameters.size(); ++k) {
    all.push_back(static_cast<Index>(k));
    if (IsGain(parameters[k])) gains.push_back(static_cast<Index>(k));
  }
  return gains.empty() ? all : gains;
}

bool HasGains(const MonteCarlo& monte_carlo) {
  if (monte_carlo.estimators.empty()) return false;
  const auto& parameters = monte_carlo.estimators[0].parameters;
  return std::any_of(parameters.begin(), parameters.end(), IsGain);
}

std::string Simulated(const MonteCarlo& m) {
  return std::to_string(m.runs) + " runs, seed " + std::to_string(m.seed) + ": the study's own motion, torque by the " +
         "model with the parameters of " + EstimatorTitle(m.reference) +
         ", white noise on positions and signals as large as on the real ones, every estimator on each";
}

Table Summary(const MonteCarlo& m) {
  const bool gains = HasGains(m);
  Table table;
  table.caption =
      "Mean normalised estimation error squared (where it lies in 95 % of cases if the covariance is right; that of "
      "all parameters by the covariance of independent samples, whose inverse is not itself noise), and coverage of "
      "the 95 % intervals over the parameters: least / median / greatest, %";
  table.columns = {{"estimator"}, {"failures", Table::Align::kRight}, {"no numbers", Table::Align::kRight}};
  if (gains) table.columns.push_back({"NEES, gains", Table::Align::kRight});
  table.columns.push_back({"NEES, all", Table::Align::kRight});
  table.columns.push_back({"coverage", Table::Align::kRight});
  for (const EstimatorStatistics& e : m.estimators) {
    std::vector<std::string> row = {EstimatorTitle(e.estimator), std::to_string(e.failures),
                                    std::to_string(e.without_numbers)};
    if (gains) row.push_back(NeesText(e.nees_gains));
    row.insert(row.end(), {NeesText(e.nees), CoverageRange(e)});
    table.rows.push_back(std::move(row));
  }
  return table;
}

// Rows: estimators; columns: the gains.
using Cell = std::string (*)(const ParameterStatistics&);
Table OfGains(const MonteCarlo& m, const std::string& caption, Cell cell) {
  Table table;
  table.caption = caption;
  table.columns = {{"estimator"}};
  for (const Index k : Shown(m)) {
    table.columns.push_back({m.estimators[0].parameters[k].parameter.name, Table::Align::kNumber});
  }
  for (const EstimatorStatistics& e : m.estimators) {
    std::vector<std::string> row = {EstimatorTitle(e.estimator)};
    for (const Index k : Shown(m)) row.push_back(cell(e.parameters[k]));
    table.rows.push_back(std::move(row));
  }
  return table;
}

std::vector<Table> GainTables(const MonteCarlo& m) {
  return {OfGains(m, "Bias, % of the truth (negative: too small)",
                  [](const ParameterStatistics& p) { return Percent(BiasPercent(p)); }),
          OfGains(m, "Spread (standard deviation over the runs), % of the truth",
                  [](const ParameterStatistics& p) { return Unsigned(PercentOfTruth(p, p.standard_deviation)); }),
          OfGains(m, "Reported standard deviation (root mean square), % of the truth",
                  [](const ParameterStatistics& p) { return Unsigned(PercentOfTruth(p, p.mean_standard_deviation)); }),
          OfGains(m, "RMSE, % of the truth",
                  [](const ParameterStatistics& p) { return Unsigned(PercentOfTruth(p, p.rmse)); }),
          OfGains(m, "Coverage of 95 % intervals, %", &Coverage)};
}

// Dot: mean of the runs; bar: where 95 % of normal runs lie about it.
IntervalFigure Errors(const MonteCarlo& m) {
  IntervalFigure figure;
  figure.title = "Error: mean over the runs, and 1.96 spreads to both sides";
  figure.value_title = "error, % of the truth";
  const std::vector<Index> shown = Shown(m);
  const Index count = static_cast<Index>(shown.size());
  for (const Index k : shown) figure.parameters.push_back(m.estimators[0].parameters[k].parameter.name);
  double reach = 0.0;
  for (const EstimatorStatistics& e : m.estimators) {
    IntervalFigure::Estimates set{EstimatorTitle(e.estimator), VectorXd(count), VectorXd(count), VectorXd(count),
                                  ColorOfSet(static_cast<size_t>(&e - m.estimators.data()))};
    for (Index k = 0; k < count; ++k) {
      const ParameterStatistics& p = e.parameters[shown[k]];
      const double half = 1.96 * PercentOfTruth(p, p.standard_deviation);
      set.value[k] = BiasPercent(p);
      set.lower[k] = set.value[k] - half;
      set.upper[k] = set.value[k] + half;
      if (std::isfinite(half)) reach = std::max({reach, std::abs(set.lower[k]), std::abs(set.upper[k])});
    }
    if (set.value.array().isFinite().any()) figure.sets.push_back(std::move(set));
  }
  // Twice the truth is as wrong as it need be shown; an arrow tells of the rest.
  if (reach > 120.0) figure.limits = std::make_pair(-120.0, 120.0);
  return figure;
}

ScatterFigure BiasAgainstSpread(const MonteCarlo& m) {
  ScatterFigure figure;
  figure.title = "Bias against spread: the lower left is best";
  figure.x_title = "spread, % of the truth";
  figure.y_title = "|bias|, % of the truth";
  figure.logarithmic = true;
  figure.show_labels = HasGains(m);
  const std::vector<Index> shown = Shown(m);
  const Index count = static_cast<Index>(shown.size());
  for (const EstimatorStatistics& e : m.estimators) {
    ScatterFigure::Points set{EstimatorTitle(e.estimator), VectorXd(count), VectorXd(count),
                              ColorOfSet(static_cast<size_t>(&e - m.estimators.data()))};
    for (Index k = 0; k < count; ++k) {
      const ParameterStatistics& p = e.parameters[shown[k]];
      set.x[k] = PercentOfTruth(p, p.standard_deviation);
      set.y[k] = std::abs(BiasPercent(p));
      set.labels.push_back(p.parameter.name);
    }
    const auto drawable =
        (set.x.array() > 0.0 && set.y.array() > 0.0 && set.x.array().isFinite() && set.y.array().isFinite());
    if (drawable.any()) figure.sets.push_back(std::move(set));
  }
  figure.rays = {{"bias = spread", 1.0},
                 {"below: no bias that the runs can tell", 1.96 / std::sqrt(static_cast<double>(m.runs))}};
  return figure;
}

ReferenceBand Nominal(const MonteCarlo& m) {
  const auto [lower, upper] = CoverageBand(m.runs);
  return {"95 %", 95.0, std::min(95.0, 100.0 * lower), std::max(95.0, 100.0 * upper)};
}

// A column an estimator, a dot a parameter.
ScatterFigure CoverageFigure(const MonteCarlo& m) {
  ScatterFigure figure;
  figure.title = "How often 95 % intervals hold the truth";
  figure.y_title = "coverage, %";
  figure.show_labels = false;
  figure.band = Nominal(m);
  ScatterFigure::Points gains{"drive gains", {}, {}, SeriesColor::kMeasured};
  ScatterFigure::Points others{HasGains(m) ? "other parameters" : "parameters", {}, {}, SeriesColor::kModel};
  std::vector<double> x[2], y[2];
  for (const EstimatorStatistics& e : m.estimators) {
    const double column = static_cast<double>(figure.categories.size());
    figure.categories.push_back(EstimatorTitle(e.estimator));
    const double count = static_cast<double>(e.parameters.size());
    for (size_t k = 0; k < e.parameters.size(); ++k) {
      const ParameterStatistics& p = e.parameters[k];
      if (p.runs == 0) continue;
      const int set = IsGain(p) ? 1 : 0;
      // In the model's order across the column, so that dots do not hide each other.
      x[set].push_back(column + 0.7 * ((static_cast<double>(k) + 0.5) / count - 0.5));
      y[set].push_back(100.0 * p.coverage95);
      (set == 1 ? gains : others).labels.push_back(p.parameter.name);
    }
  }
  int set = 0;
  for (ScatterFigure::Points* points : {&others, &gains}) {  // the gains on top
    points->x = Eigen::Map<VectorXd>(x[set].data(), static_cast<Index>(x[set].size()));
    points->y = Eigen::Map<VectorXd>(y[set].data(), static_cast<Index>(y[set].size()));
    ++set;
    if (points->x.size() > 0) figure.sets.push_back(std::move(*points));
  }
  return figure;
}

// Errors over their reported standard deviations, all parameters of all runs together.
HistogramFigure Scores(const MonteCarlo& m) {
  HistogramFigure figure;
  figure.title = "Error over reported standard deviation, all parameters";
  figure.x_title = "(estimate - truth) / reported standard deviation; dashed: as it should be";
  figure.limits = std::make_pair(-6.0, 6.0);
  figure.bins = 48;
  figure.standard_normal = true;
  for (const EstimatorStatistics& e : m.estimators) {
    std::vector<double> scores;
    for (const ParameterStatistics& p : e.parameters) {
      for (const double score : p.scores) {
        if (std::isfinite(score)) scores.push_back(score);
      }
    }
    if (scores.empty()) continue;
    figure.sets.push_back({EstimatorTitle(e.estimator),
                           Eigen::Map<VectorXd>(scores.data(), static_cast<Index>(scores.size())),
                           ColorOfSet(static_cast<size_t>(&e - m.estimators.data()))});
  }
  return figure;
}

HistogramFigure Histogram(const MonteCarlo& m, Index parameter) {
  HistogramFigure figure;
  const ParameterStatistics& first = m.estimators[0].parameters[parameter];
  figure.title = first.parameter.name + ", estimates of the runs";
  figure.x_title = first.parameter.name + " [" + first.parameter.unit + "]";
  figure.mark = HistogramFigure::Mark{"truth", first.truth};
  double lower = first.truth, upper = first.truth;
  for (const EstimatorStatistics& e : m.estimators) {
    const VectorXd& values = e.parameters[parameter].values;
    if (!values.array().isFinite().any()) continue;
    figure.sets.push_back(
        {EstimatorTitle(e.estimator), values, ColorOfSet(static_cast<size_t>(&e - m.estimators.data()))});
    for (const double value : values) {
      if (!std::isfinite(value)) continue;
      lower = std::min(lower, value);
      upper = std::max(upper, value);
    }
  }
  // From zero to twice the truth at most: an estimator that is off by a factor of ten must not flatten the others.
  const double room = std::max(0.05 * (upper - lower), 1e-3 * std::abs(first.truth));
  const double ends[2] = {std::min(0.0, 2.0 * first.truth), std::max(0.0, 2.0 * first.truth)};
  lower = std::max(lower - room, ends[0]);
  upper = std::min(upper + room, ends[1]);
  if (lower < upper) figure.limits = std::make_pair(lower, upper);
  return figure;
}

// For each estimator: bias in units of the spread, spread over the reported one, coverage.
Table AllParameters(const MonteCarlo& m) {
  Table table;
  table.caption = "All parameters: bias in spreads / coverage of 95 % intervals, %";
  table.columns = {{"parameter"}, {"truth", Table::Align::kNumber}, {"unit"}};
  for (const EstimatorStatistics& e : m.estimators) {
    table.columns.push_back({EstimatorTitle(e.estimator), Table::Align::kNumber});
    table.columns.push_back({"%", Table::Align::kNumber});
  }
  for (size_t k = 0; k < m.estimators[0].parameters.size(); ++k) {
    const ParameterStatistics& first = m.estimators[0].parameters[k];
    std::vector<std::string> row = {first.parameter.name, Format("%.4g", first.truth), first.parameter.unit};
    for (const EstimatorStatistics& e : m.estimators) {
      const ParameterStatistics& p = e.parameters[k];
      row.push_back(p.standard_deviation > 0.0 ? Percent(p.bias / p.standard_deviation) : "");
      row.push_back(Coverage(p));
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace

std::string MonteCarloToText(const MonteCarlo& m) {
  std::string text = "Monte Carlo: " + Simulated(m) + "\n";
  const auto append = [&](const Table& table) {
    std::vector<std::vector<std::string>> rows(1);
    for (const Table::Column& column : table.columns) rows[0].push_back(column.title);
    rows.insert(rows.end(), table.rows.begin(), table.rows.end());
    text += "\n" + (table.caption.empty() ? std::string() : table.caption + "\n") + AlignColumns(rows);
  };
  append(Summary(m));
  for (const EstimatorStatistics& e : m.estimators) {
    if (e.failures == 0) continue;
    text += EstimatorTitle(e.estimator) + ", first failure: " + e.first_failure + "\n";
  }
  if (HasGains(m)) {
    for (const Table& table : GainTables(m)) append(table);
  }
  return text;
}

std::vector<Section> MonteCarloSections(const MonteCarlo& m) {
  if (m.estimators.empty()) return {};
  std::vector<Section> sections(1);
  Section& errors = sections[0];
  errors.title = "Monte Carlo: bias, spread and intervals";
  errors.blocks.emplace_back(Paragraph{Simulated(m) + "."});
  errors.blocks.emplace_back(Paragraph{
      "The model is true here and the noise white, so spreads are those of a perfect model: real residuals are "
      "correlated and real errors larger. Failures are runs that the estimator itself does not trust; all runs "
      "with numbers count in the statistics. NEES is the squared error over the reported covariance, 1 where "
      "that covariance is right; grey bands hold 95 % of what chance makes of exact intervals.",
      Paragraph::Kind::kNote});
  errors.blocks.emplace_back(Summary(m));
  FigureGrid pictures;
  const auto add = [](auto figure, FigureGrid* grid) {
    if (!figure.sets.empty()) grid->figures.emplace_back(std::move(figure));
  };
  add(BiasAgainstSpread(m), &pictures);
  add(CoverageFigure(m), &pictures);
  if (HasGains(m)) add(Errors(m), &pictures);
  add(Scores(m), &pictures);
  if (!pictures.figures.empty()) errors.blocks.emplace_back(std::move(pictures));
  if (HasGains(m)) {
    for (Table& table : GainTables(m)) errors.blocks.emplace_back(std::move(table));
    Section histograms;
    histograms.title = "Monte Carlo: the gains of all runs";
    FigureGrid grid;
    for (const Index k : Shown(m)) add(Histogram(m, k), &grid);
    if (!grid.figures.empty()) histograms.blocks.emplace_back(std::move(grid));
    if (!histograms.blocks.empty()) sections.push_back(std::move(histograms));
  }
  Section values;
  values.title = "Monte Carlo: all parameters";
  values.blocks.emplace_back(AllParameters(m));
  sections.push_back(std::move(values));
  return sections;
}

}  // namespace idim
