// A report with every kind of block and figure, from made-up data of an arm.

#ifndef IDIM_TESTS_REPORT_DEMO_REPORT_H_
#define IDIM_TESTS_REPORT_DEMO_REPORT_H_

#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <vector>

#include "core/report/report.h"

namespace idim::testing {

inline Report DemoReport(int joints, int samples) {
  Report report;
  report.title = "Stäubli TX-40 – weighted least squares";
  report.subtitle = "Made-up data, to look at the report itself";

  Section& summary = report.sections.emplace_back();
  summary.title = "Summary";
  summary.blocks.push_back(
      Paragraph{"Dynamic parameters and drive gains from one recording.", Paragraph::Kind::kPlain});
  summary.blocks.push_back(KeyValues{{{"samples read", std::to_string(samples)},
                                      {"samples kept", std::to_string(samples / 50)},
                                      {"cut-off frequency", "100 Hz"},
                                      {"decimation", "50"},
                                      {"condition number", "2177"},
                                      {"relative error, all joints", "8.8 %"}}});
  summary.blocks.push_back(Paragraph{"Joint 4: the residual grows with velocity.", Paragraph::Kind::kNote});
  summary.blocks.push_back(Paragraph{"Two parameters are not determined by these data.", Paragraph::Kind::kWarning});

  // Noise from a fixed linear congruence, so that the demo is the same everywhere.
  unsigned state = 1;
  const auto noise = [&state] {
    state = 1664525u * state + 1013904223u;
    return (state >> 8) / 16777216.0 - 0.5;
  };
  const Eigen::VectorXd t = Eigen::VectorXd::LinSpaced(samples, 0.0, 9.0);
  FigureGrid torque, residual, scatter;
  BarFigure error;
  error.title = "Relative error by joint";
  error.x_title = "joint";
  error.y_title = "relative error [%]";
  error.sets = {{"identification", Eigen::VectorXd(joints), SeriesColor::kModel},
                {"validation", Eigen::VectorXd(joints), SeriesColor::kOrange}};
  for (int j = 0; j < joints; ++j) {
    const std::string joint = "Joint " + std::to_string(j + 1);
    Eigen::VectorXd velocity(samples), model(samples), measured(samples);
    for (int k = 0; k < samples; ++k) {
      velocity[k] = 3.0 * std::sin((1.3 + 0.4 * j) * t[k]) * std::cos(0.3 * t[k]);
      model[k] = (60.0 - 9.0 * j) * (std::cos((1.3 + 0.4 * j) * t[k]) + 0.15 * std::tanh(20.0 * velocity[k]));
      measured[k] = model[k] + (6.0 - 0.8 * j) * noise() + 0.8 * velocity[k];
    }
    torque.figures.push_back(TimeFigure{joint,
                                        "torque [N.m]",
                                        t,
                                        {{"measured", measured, SeriesColor::kMeasured},
                                         {"modelled", model, SeriesColor::kModel},
                                         {"residual", measured - model, SeriesColor::kResidual}},
                                        "recording"});
    scatter.figures.push_back(ScatterFigure{
        joint, "velocity [rad/s]", "residual [N.m]", {{"residual", velocity, measured - model, SeriesColor::kModel}}});
    error.categories.push_back(std::to_string(j + 1));
    error.sets[0].value[j] = 7.2 + 1.7 * j;
    error.sets[1].value[j] = 7.9 + 1.9 * j;
  }
  Section& fit = report.sections.emplace_back();
  fit.title = "Measured and modelled torque";
  fit.blocks.push_back(torque);
  Section& left = report.sections.emplace_back();
  left.title = "Residual over velocity";
  left.blocks.push_back(scatter);

  Table table;
  table.caption = "Base parameters with their 95 % intervals";
  table.columns = {{"parameter", Table::Align::kLeft}, {"value", Table::Align::kNumber},
                   {"σ", Table::Align::kNumber},       {"σ/|value| [%]", Table::Align::kNumber},
                   {"unit", Table::Align::kLeft},      {"regrouping", Table::Align::kLeft}};
  IntervalFigure all;
  all.title = "Base parameters relative to their estimates";
  all.value_title = "value / estimate";
  all.scale = IntervalFigure::Scale::kRelativeToFirst;
  all.limits = {-1.0, 3.0};
  const int parameters = 10 * joints + 1;
  Eigen::VectorXd value(parameters), half(parameters), published(parameters);
  for (int i = 0; i < parameters; ++i) {
    value[i] = 1.25 * std::exp(-0.06 * i) * (i % 3 == 1 ? -1.0 : 1.0);
    half[i] = std::abs(value[i]) * (i % 11 == 10 ? 4.0 : 0.03 + 0.02 * (i % 7));
    published[i] = i % 5 == 4 ? std::numeric_limits<double>::quiet_NaN() : value[i] * (1.0 + 0.2 * noise());
    const std::string name = (i % 2 ? "MX" : "ZZ") + std::to_string(i / 10 + 1) + "R";
    char text[32], sigma[32], percent[32];
    std::snprintf(text, sizeof(text), "%.*f", 2 + i % 3, value[i]);
    std::snprintf(sigma, sizeof(sigma), "%.2g", half[i] / 1.96);
    std::snprintf(percent, sizeof(percent), "%.1f", 100.0 * half[i] / 1.96 / std::abs(value[i]));
    all.parameters.push_back(name);
    table.rows.push_back({name, text, sigma, percent, i % 2 ? "kg m" : "kg m²",
                          i % 10 == 0 ? "ZZ1 + YY2 + YY3 + 0.05 M4 + 0.05 M5 + 0.05 M6 + Ia1" : ""});
    if (half[i] > std::abs(value[i])) table.muted_rows.push_back(i);
  }
  const Eigen::VectorXd none = Eigen::VectorXd::Constant(parameters, std::numeric_limits<double>::quiet_NaN());
  all.sets = {{"estimate, 95 % interval", value, value - half, value + half, SeriesColor::kModel},
              {"published", published, none, none, SeriesColor::kOrange}};
  IntervalFigure gains;
  gains.title = "Drive gains";
  gains.value_title = "gain [N.m per signal unit]";
  gains.vertical = true;
  Eigen::VectorXd gain(joints);
  for (int j = 0; j < joints; ++j) {
    gains.parameters.push_back("g" + std::to_string(j + 1));
    gain[j] = 33.9 - 4.0 * j;
  }
  gains.sets = {{"errors in variables", gain, gain.array() - 1.2, gain.array() + 1.2, SeriesColor::kModel},
                {"total least squares", gain * 0.95, gain * 0.93, gain * 0.97, SeriesColor::kTeal}};
  Section& estimates = report.sections.emplace_back();
  estimates.title = "Parameters";
  estimates.blocks.push_back(FigureGrid{2, {error, gains}});
  estimates.blocks.push_back(FigureGrid{1, {all}});
  estimates.blocks.push_back(table);

  ScatterFigure spread;
  spread.title = "Bias against spread";
  spread.x_title = "spread [%]";
  spread.y_title = "bias [%]";
  spread.logarithmic = true;
  spread.show_labels = true;
  spread.rays = {{"bias = spread", 1.0}};
  spread.sets = {{"one",
                  Eigen::Vector3d(0.1, 2.0, 30.0),
                  Eigen::Vector3d(0.01, 5.0, 0.0),
                  SeriesColor::kCyan,
                  {"g1", "g2", "g3"}}};
  ScatterFigure coverage;
  coverage.title = "Coverage";
  coverage.y_title = "coverage [%]";
  coverage.categories = {"least squares", "errors in variables"};
  coverage.band = ReferenceBand{"95 %", 95.0, 92.0, 98.0};
  coverage.sets = {{"gains",
                    Eigen::Vector3d(0.0, 0.9, 1.1),
                    Eigen::Vector3d(20.0, 94.0, 97.0),
                    SeriesColor::kModel,
                    {"g1", "g1", "g2"}}};
  HistogramFigure histogram;
  histogram.title = "Scores";
  histogram.x_title = "score";
  histogram.mark = HistogramFigure::Mark{"truth", 0.2};
  histogram.limits = {-2.0, 2.0};
  histogram.bins = 20;
  histogram.standard_normal = true;
  Eigen::VectorXd scores(300);
  for (double& score : scores) score = noise() + noise() + noise() + noise() + 3.0 * noise();
  histogram.sets = {{"estimates", scores, SeriesColor::kOrange}};
  Section& runs = report.sections.emplace_back();
  runs.title = "Monte Carlo";
  runs.blocks.push_back(FigureGrid{2, {spread, coverage, histogram}});
  return report;
}

}  // namespace idim::testing

#endif  // IDIM_TESTS_REPORT_DEMO_REPORT_H_
