#include "apps/pages/loop_figures.h"

#include <algorithm>
#include <utility>

#include "apps/pages/loop_report.h"
#include "apps/pages/words.h"
#include "core/robot/joint_units.h"
#include "solvers/loop/effect_curves.h"

namespace idim {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

// Data are seen behind the model that runs through them [px].
constexpr double kDataSize = 4.0, kModelSize = 2.5;

JointUnits UnitsOf(const LoopResult& result, Index joint) {
  return UnitsOf(result.prepared.robot(), static_cast<int>(joint));
}

VectorXd Residual(const RecordingSeries& series, Index joint) {
  return series.decimated_torque.col(joint) - series.decimated_model.col(joint);
}

// Of all recordings, one after the other.
template <typename Column>
VectorXd Joined(const std::vector<RecordingSeries>& series, Column&& column) {
  Index count = 0;
  for (const RecordingSeries& s : series) count += s.decimated_t.size();
  VectorXd all(count);
  Index at = 0;
  for (const RecordingSeries& s : series) {
    all.segment(at, s.decimated_t.size()) = column(s);
    at += s.decimated_t.size();
  }
  return all;
}

Section Residuals(const LoopResult& result, bool over_velocity) {
  Section section;
  section.title = over_velocity ? "Residual over velocity" : "Residual over position";
  FigureGrid grid;
  const auto& before = result.before.series;
  const auto& after = result.after.series;
  for (Index j = 0; j < result.prepared.robot().dof(); ++j) {
    const JointUnits units = UnitsOf(result, j);
    ScatterFigure figure;
    figure.title = JointTitle(j);
    figure.x_title = over_velocity ? "velocity [" + units.velocity + "]" : "position [" + units.position + "]";
    figure.y_title = "residual [" + units.torque + "]";
    const auto x = [&](const RecordingSeries& s) {
      return VectorXd(over_velocity ? s.decimated_dq.col(j) : s.decimated_q.col(j));
    };
    const auto y = [&](const RecordingSeries& s) { return Residual(s, j); };
    figure.sets = {{"declared model", Joined(before, x), Joined(before, y), kBefore},
                   {"final model", Joined(after, x), Joined(after, y), kAfter}};
    grid.figures.emplace_back(std::move(figure));
  }
  section.blocks.emplace_back(std::move(grid));
  return section;
}

Section ResidualsOverTime(const LoopResult& result, size_t recording) {
  const RecordingSeries& before = result.before.series[recording];
  const RecordingSeries& after = result.after.series[recording];
  Section section;
  section.title = "Residual over time in " + after.name + " (" + after.use + ")";
  FigureGrid grid;
  for (Index j = 0; j < result.prepared.robot().dof(); ++j) {
    TimeFigure figure;
    figure.title = JointTitle(j);
    figure.y_title = "residual [" + UnitsOf(result, j).torque + "]";
    figure.t = after.decimated_t;
    figure.traces = {{"declared model", Residual(before, j), kBefore}, {"final model", Residual(after, j), kAfter}};
    figure.link = "residual " + after.name;
    grid.figures.emplace_back(std::move(figure));
  }
  section.blocks.emplace_back(std::move(grid));
  return section;
}

}  // namespace

Section FrictionSection(const LoopResult& result) {
  Section section;
  section.title = "Friction curves";
  FigureGrid grid;
  for (const EffectCurve& curve : EffectCurves(result)) {
    if (curve.over != EffectCurve::Over::kVelocity) continue;
    const JointUnits units = UnitsOf(result, curve.joint);
    ScatterFigure figure;
    figure.title = JointTitle(curve.joint) + ": " + Words(curve.effects);
    figure.x_title = "velocity [" + units.velocity + "]";
    figure.y_title = "friction [" + units.torque + "]";
    figure.sets = {{"data", curve.abscissa, curve.data, SeriesColor::kResidual, {}, kDataSize},
                   {"declared model", curve.abscissa, curve.declared, kBefore, {}, kModelSize},
                   {"final model", curve.abscissa, curve.model, kAfter, {}, kModelSize}};
    grid.figures.emplace_back(std::move(figure));
  }
  if (grid.figures.empty()) return section;
  section.blocks.emplace_back(
      Paragraph{"Data: the measured torque less all of the final model that is not friction. Friction that depends on "
                "load, history or time as well is a cloud, not a line."});
  section.blocks.emplace_back(std::move(grid));
  return section;
}

Section OtherEffectsSection(const LoopResult& result) {
  Section section;
  section.title = "Torque of the other effects";
  FigureGrid grid;
  for (const EffectCurve& curve : EffectCurves(result)) {
    if (curve.over == EffectCurve::Over::kVelocity) continue;
    const JointUnits units = UnitsOf(result, curve.joint);
    const bool over_position = curve.over == EffectCurve::Over::kPosition;
    ScatterFigure figure;
    figure.title = JointTitle(curve.joint) + ": " + Words(curve.effects);
    figure.x_title =
        over_position ? "position [" + units.position + "]" : "torque by the final model [" + units.torque + "]";
    figure.y_title = "torque [" + units.torque + "]";
    figure.sets = {{"data", curve.abscissa, curve.data, SeriesColor::kResidual, {}, kDataSize},
                   {"final model", curve.abscissa, curve.model, kAfter, {}, kModelSize}};
    grid.figures.emplace_back(std::move(figure));
  }
  if (grid.figures.empty()) return section;
  section.blocks.emplace_back(Paragraph{
      "Data: the torque of these effects by the final model with its residual on top. Over position where the "
      "torque is a function of it, else over the model's own torque: an effect that is there lies along the "
      "model, one that is not is a cloud that does not rise."});
  section.blocks.emplace_back(std::move(grid));
  return section;
}

std::vector<Section> ResidualSections(const LoopResult& result) {
  std::vector<Section> sections = {Residuals(result, true), Residuals(result, false)};
  for (size_t r = 0; r < result.after.series.size(); ++r) sections.push_back(ResidualsOverTime(result, r));
  return sections;
}

}  // namespace idim
