#include "apps/pages/identification_report.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "apps/pages/words.h"
#include "core/base/text.h"
#include "core/report/report.h"
#include "core/robot/joint_units.h"

namespace idim {
namespace {

Section Summary(const Estimate& e) {
  Section section;
  section.title = "Summary";
  KeyValues facts;
  facts.entries = {{"estimator", EstimatorTitle(e.estimator)},
                   {"parameters", std::to_string(e.parameters.size())},
                   {"relative error |ρ| / |Y|", Format("%.2f %%", e.relative_error_percent)},
                   {"condition number of W", Format("%.0f", e.condition_number)},
                   {"of the weighted W", Format("%.0f", e.condition_number_weighted)},
                   {"filter", e.preprocessing}};
  if (!e.start.empty()) facts.entries.emplace_back("start", e.start);
  if (!e.uncertainty.empty()) facts.entries.emplace_back("uncertainty", e.uncertainty);
  if (!e.status.ok()) {
    section.blocks.emplace_back(Paragraph{"Not to be trusted: " + e.status.message(), Paragraph::Kind::kWarning});
  }
  section.blocks.emplace_back(facts);

  Table errors;
  errors.columns = {{"recording"}, {"use"}, {"samples", Table::Align::kRight}};
  const Eigen::Index n = e.recordings.empty() ? 0 : e.recordings[0].rms_torque.size();
  for (Eigen::Index j = 0; j < n; ++j) errors.columns.push_back({JointTitle(j), Table::Align::kNumber});
  errors.columns.push_back({"all", Table::Align::kNumber});
  double lag1 = 0.0;
  BarFigure bars;
  bars.title = "Relative error per joint";
  bars.y_title = "relative error [%]";
  for (Eigen::Index j = 0; j < n; ++j) bars.categories.push_back(JointTitle(j));
  for (const RecordingFit& r : e.recordings) {
    std::vector<std::string> row = {r.name, r.use, std::to_string(r.samples)};
    for (const double error : r.relative_error_percent) row.push_back(Format("%.2f", error));
    row.push_back(Format("%.2f", r.relative_error_percent_all));
    errors.rows.push_back(std::move(row));
    bars.sets.push_back({r.name, r.relative_error_percent, ColorOfSet(bars.sets.size())});
    if (r.use == "identification") lag1 = std::max(lag1, r.residual_lag1.maxCoeff());
  }
  errors.caption = "Relative error per joint on the decimated samples, %";
  section.blocks.emplace_back(std::move(errors));
  section.blocks.emplace_back(FigureGrid{2, {bars}});
  if (lag1 > 0.2) {
    section.blocks.emplace_back(
        Paragraph{"The residual is correlated in time (lag-1 autocorrelation up to " + Format("%.2f", lag1) +
                      "): the model lacks effects that last longer than a sample" +
                      (e.uncertainty.empty() ? ", and the intervals below, which assume white residuals, are too short."
                                             : ". The intervals below allow for it."),
                  Paragraph::Kind::kWarning});
  }
  return section;
}

Section Gains(const Estimate& e) {
  Section section;
  section.title = "Drive gains";
  Table table;
  table.columns = {{"gain"}, {"value", Table::Align::kNumber}, {"% σ", Table::Align::kNumber}, {"verdict"}, {"why"}};
  for (const GainDiagnosis& g : e.gain_diagnoses) {
    std::vector<std::string> row = {g.name, "", "", g.strength, g.sentence};
    for (const ParameterEstimate& p : e.parameters) {
      if (p.parameter.name != g.name) continue;
      row[1] = Format("%.4g", p.value);
      row[2] = Format("%.2f", p.RelativeSigmaPercent());
    }
    table.rows.push_back(std::move(row));
  }
  section.blocks.emplace_back(std::move(table));
  return section;
}

Section Parameters(const Estimate& e, const std::vector<Reference>& references) {
  Section section;
  section.title = "Parameters";
  Table table;
  table.columns = {{"parameter"},
                   {"value", Table::Align::kNumber},
                   {"% σ", Table::Align::kNumber},
                   {"95 % from", Table::Align::kNumber},
                   {"to", Table::Align::kNumber},
                   {"unit"}};
  for (const Reference& reference : references) {
    table.columns.push_back({reference.name, Table::Align::kNumber});
    table.columns.push_back({"difference in σ", Table::Align::kNumber});
  }
  Table relations;
  relations.caption = "What is regrouped into a base parameter";
  relations.columns = {{"parameter"}, {"relation"}};
  for (size_t k = 0; k < e.parameters.size(); ++k) {
    const ParameterEstimate& p = e.parameters[k];
    std::vector<std::string> row = {p.parameter.name,
                                    Format("%.4g", p.value),
                                    Format("%.2f", p.RelativeSigmaPercent()),
                                    Format("%.4g", p.interval95[0]),
                                    Format("%.4g", p.interval95[1]),
                                    p.parameter.unit};
    for (const Reference& reference : references) {
      const Reference::Entry* entry = reference.Find(p.parameter.name);
      row.push_back(entry == nullptr ? "" : Format("%.4g", entry->value));
      row.push_back(entry == nullptr ? "" : Format("%+.1f", DifferenceInSigmas(p, *entry)));
    }
    if (!p.regrouping.empty()) relations.rows.push_back({p.parameter.name, p.regrouping});
    table.rows.push_back(std::move(row));
    if (p.interval95[0] < 0.0 && p.interval95[1] > 0.0) table.muted_rows.push_back(static_cast<int>(k));
  }
  table.caption = "Pale rows: the interval holds zero, the data do not tell the sign.";
  section.blocks.emplace_back(std::move(table));
  if (!relations.rows.empty()) section.blocks.emplace_back(std::move(relations));
  if (!e.eliminated.empty()) {
    std::string names;
    for (const std::string& name : e.eliminated) names += " " + name;
    section.blocks.emplace_back(Paragraph{"Not essential, set to zero:" + names});
  }

  IntervalFigure figure;
  figure.title = "Estimates and 95 % intervals, divided by the estimate";
  figure.value_title = "relative to the estimate";
  figure.scale = IntervalFigure::Scale::kRelativeToFirst;
  figure.limits = std::make_pair(-1.0, 3.0);
  const Eigen::Index count = static_cast<Eigen::Index>(e.parameters.size());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto blank = [&] { return Eigen::VectorXd::Constant(count, nan).eval(); };
  IntervalFigure::Estimates own{EstimatorTitle(e.estimator), blank(), blank(), blank(), ColorOfSet(0)};
  for (Eigen::Index k = 0; k < count; ++k) {
    const ParameterEstimate& p = e.parameters[k];
    figure.parameters.push_back(p.parameter.name);
    own.value[k] = p.value;
    own.lower[k] = p.interval95[0];
    own.upper[k] = p.interval95[1];
  }
  figure.sets.push_back(std::move(own));
  for (const Reference& reference : references) {
    IntervalFigure::Estimates set{reference.name, blank(), blank(), blank(), ColorOfSet(figure.sets.size())};
    for (Eigen::Index k = 0; k < count; ++k) {
      const Reference::Entry* entry = reference.Find(figure.parameters[k]);
      if (entry == nullptr) continue;
      set.value[k] = entry->value;
      if (entry->standard_deviation == 0.0) continue;
      set.lower[k] = entry->value - 1.96 * entry->standard_deviation;
      set.upper[k] = entry->value + 1.96 * entry->standard_deviation;
    }
    figure.sets.push_back(std::move(set));
  }
  section.blocks.emplace_back(FigureGrid{1, {figure}});
  return section;
}

Section Torques(const Robot& robot, const RecordingSeries& s) {
  Section section;
  section.title = "Torque in " + s.name + " (" + s.use + ")";
  FigureGrid grid;
  for (Eigen::Index j = 0; j < s.torque.cols(); ++j) {
    TimeFigure figure;
    figure.title = JointTitle(j);
    figure.y_title = "torque [" + UnitsOf(robot, static_cast<int>(j)).torque + "]";
    figure.t = s.t;
    figure.traces = {{"measured", s.torque.col(j), SeriesColor::kMeasured},
                     {"model", s.model.col(j), SeriesColor::kModel}};
    figure.link = "torque " + s.name;
    grid.figures.emplace_back(std::move(figure));
  }
  section.blocks.emplace_back(
      Paragraph{"Unfiltered measured torque and the model's, joint side. Drag over a time range to "
                "zoom all joints together."});
  section.blocks.emplace_back(std::move(grid));
  return section;
}

Section ResidualsOverTime(const Robot& robot, const RecordingSeries& s) {
  Section section;
  section.title = "Residual over time in " + s.name;
  FigureGrid grid;
  for (Eigen::Index j = 0; j < s.torque.cols(); ++j) {
    TimeFigure figure;
    figure.title = JointTitle(j);
    figure.y_title = "residual [" + UnitsOf(robot, static_cast<int>(j)).torque + "]";
    figure.t = s.decimated_t;
    figure.traces = {{"residual", s.decimated_torque.col(j) - s.decimated_model.col(j), SeriesColor::kResidual}};
    figure.link = "residual " + s.name;
    grid.figures.emplace_back(std::move(figure));
  }
  section.blocks.emplace_back(std::move(grid));
  return section;
}

Section ResidualsOverVelocity(const Robot& robot, const std::vector<RecordingSeries>& series) {
  Section section;
  section.title = "Residual over velocity";
  FigureGrid grid;
  const Eigen::Index n = series.empty() ? 0 : series[0].torque.cols();
  for (Eigen::Index j = 0; j < n; ++j) {
    ScatterFigure figure;
    figure.title = JointTitle(j);
    figure.x_title = "velocity [" + UnitsOf(robot, static_cast<int>(j)).velocity + "]";
    figure.y_title = "residual [" + UnitsOf(robot, static_cast<int>(j)).torque + "]";
    for (size_t k = 0; k < series.size(); ++k) {
      const RecordingSeries& s = series[k];
      figure.sets.push_back(
          {s.name, s.decimated_dq.col(j), s.decimated_torque.col(j) - s.decimated_model.col(j), ColorOfSet(k)});
    }
    grid.figures.emplace_back(std::move(figure));
  }
  section.blocks.emplace_back(
      Paragraph{"A curve here is friction that the declared model lacks; a fan is torque or position "
                "that it depends on."});
  section.blocks.emplace_back(std::move(grid));
  return section;
}

}  // namespace

std::string RenderIdentificationReport(const Robot& robot, const Estimate& estimate,
                                       const std::vector<RecordingSeries>& series,
                                       const std::vector<Reference>& references) {
  Report report;
  report.title = estimate.robot;
  report.subtitle = "Dynamic parameters by " + EstimatorTitle(estimate.estimator);
  report.sections.push_back(Summary(estimate));
  if (!estimate.gain_diagnoses.empty()) report.sections.push_back(Gains(estimate));
  for (const RecordingSeries& s : series) report.sections.push_back(Torques(robot, s));
  report.sections.push_back(Parameters(estimate, references));
  for (const RecordingSeries& s : series) report.sections.push_back(ResidualsOverTime(robot, s));
  report.sections.push_back(ResidualsOverVelocity(robot, series));
  return RenderReport(report);
}

}  // namespace idim
