#include "core/report/report.h"

#include <limits>
#include <utility>

#include "apps/paper_study/page.h"
#include "core/robot/joint_units.h"

namespace idim {

std::string RenderPaperReport(const PaperStudy& paper) {
  Report report;
  report.title = "The paper's study on a simulated TX-40";
  report.subtitle = "After Gautier & Briot (2014); the tables are in datasets/paper_study/README.md";

  const PaperCase& shown = paper.cases[kCase4];
  const RecordingSeries& series = shown.validation.series.front();
  Section figure;
  figure.title = "Fig. 2: torque along trajectory 1 with the payload of 4.59 kg, case 4";
  figure.blocks.emplace_back(
      Paragraph{"Joint side. Red: identified gain times signal; blue: the inverse dynamic model with identified "
                "parameters. Neither was fitted to this recording."});
  FigureGrid torques;
  for (Eigen::Index j = 0; j < series.decimated_torque.cols(); ++j) {
    TimeFigure joint;
    joint.title = "joint " + std::to_string(j + 1);
    joint.y_title = "torque [" + UnitsOf(paper.scenario.robot, static_cast<int>(j)).torque + "]";
    joint.t = series.decimated_t;
    joint.traces = {{"gain x signal", series.decimated_torque.col(j), SeriesColor::kMeasured},
                    {"model", series.decimated_model.col(j), SeriesColor::kModel}};
    joint.link = "trajectory 1";
    torques.figures.emplace_back(std::move(joint));
  }
  figure.blocks.emplace_back(std::move(torques));
  report.sections.push_back(std::move(figure));

  // The first set divides the others, so that the truth stands at 1.
  const int n = paper.scenario.robot.dof();
  IntervalFigure gains;
  gains.title = "Gains with 95 % intervals, relative to the truth";
  gains.value_title = "gain / truth";
  gains.scale = IntervalFigure::Scale::kRelativeToFirst;
  gains.vertical = true;
  const Eigen::VectorXd none = Eigen::VectorXd::Constant(n, std::numeric_limits<double>::quiet_NaN());
  gains.sets.push_back({"truth", paper.scenario.gains, none, none, ColorOfSet(0)});
  for (int j = 0; j < n; ++j) gains.parameters.push_back("g" + std::to_string(j + 1));
  for (int c = kCase1; c < kNumPaperCases; ++c) {
    IntervalFigure::Estimates set{paper.cases[c].name, paper.cases[c].validation.gains, none, none,
                                  ColorOfSet(gains.sets.size())};
    for (const ParameterEstimate& p : paper.cases[c].estimate.parameters) {
      for (int j = 0; j < n; ++j) {
        if (p.parameter.name != gains.parameters[j]) continue;
        set.lower[j] = p.interval95[0];
        set.upper[j] = p.interval95[1];
      }
    }
    gains.sets.push_back(std::move(set));
  }
  Section gain_section;
  gain_section.title = "Drive gains";
  gain_section.blocks.emplace_back(FigureGrid{1, {std::move(gains)}});
  report.sections.push_back(std::move(gain_section));
  return RenderReport(report);
}

}  // namespace idim
