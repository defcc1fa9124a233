#include "apps/pages/loop_facts.h"

#include <algorithm>
#include <cmath>

#include "core/base/text.h"
#include "core/model/active_effects.h"
#include "solvers/loop/effect_curves.h"

namespace idim {
namespace {

std::string Decrease(const EffectCandidate& candidate) {
  return Format("%.1f +- %.1f %%", 100.0 * candidate.held_out_decrease, 100.0 * candidate.held_out_error);
}

}  // namespace

std::vector<NamedShape> ShapesOf(const LoopResult& result, const ActiveEffect& active) {
  std::vector<NamedShape> shapes;
  for (ShapeParameter& parameter : ShapesAlong(result.prepared, *active.effect, active.joints)) {
    const auto k = static_cast<Eigen::Index>(shapes.size());
    if (k < active.shape.size()) shapes.push_back({std::move(parameter), active.shape[k]});
  }
  return shapes;
}

std::vector<ParameterEstimate> EffectEstimates(const LoopResult& result, const ActiveEffect& active) {
  const Model& model = result.prepared.model;
  const Unknowns unknowns(model, UncertainPayload::kExact);
  std::vector<ParameterEstimate> found;
  for (size_t e = 0; e < model.effects.size(); ++e) {
    if (!SameEffect(model.effects[e], active)) continue;
    for (int k = unknowns.effect(e).at; k < unknowns.effect(e).end(); ++k) {
      const ParameterEstimate* estimate = result.after.estimate.Find(unknowns[k].name);
      if (estimate != nullptr) found.push_back(*estimate);
    }
  }
  return found;
}

std::vector<Movement> Movements(const LoopResult& result) {
  std::vector<Movement> moved;
  for (const ParameterEstimate& before : result.before.estimate.parameters) {
    const ParameterEstimate* after = result.after.estimate.Find(before.parameter.name);
    if (after == nullptr) continue;
    if (after->value < before.interval95[0] || after->value > before.interval95[1]) moved.push_back({before, *after});
  }
  std::stable_sort(moved.begin(), moved.end(), [](const Movement& a, const Movement& b) {
    const auto is_gain = [](const Movement& m) { return m.before.parameter.kind == ParameterKind::kDriveGain; };
    return is_gain(a) && !is_gain(b);
  });
  return moved;
}

std::string HeldOutName(const LoopResult& result) {
  return result.held_out_by_blocks ? "held-out blocks" : "validation recordings";
}

std::string ValueText(const ParameterEstimate& p) {
  std::string text = Format("%.4g +- %.2g", p.value, p.standard_deviation);
  if (!p.parameter.unit.empty() && p.parameter.unit != "1") text += " " + p.parameter.unit;
  return text;
}

std::string PValueText(double p_value) { return p_value > 0.0 ? Format("%.1e", p_value) : "below 1e-300"; }

std::string UnexplainedSentence(const Unexplained& unexplained) {
  return Format(
      "The residual of joint %d still depends on %s: %.0f %% of its square, p = %s. No effect of the "
      "catalogue explains it.",
      unexplained.joint + 1, Join(unexplained.depends_on, " and ").c_str(), unexplained.share_percent,
      PValueText(unexplained.p_value).c_str());
}

std::string OfItsJoints(const LoopStep& step, const Eigen::VectorXd& before, const Eigen::VectorXd& after) {
  if (before.size() == 0 || after.size() == 0) return "";
  std::vector<std::string> texts;
  for (const int joint : step.effect.joints) {
    texts.push_back(Format("joint %d: %.2f -> %.2f %%", joint + 1, before[joint], after[joint]));
  }
  return Join(texts, ", ");
}

std::string EvidenceSentence(const LoopResult& result, const LoopStep& step) {
  const EffectCandidate& c = step.candidate;
  const std::string where = step.effect.joints.size() == 1 ? Format("joint %d", step.effect.joints[0] + 1) : "the arm";
  return Format(
      "score test %.4g, p = %s after correction for all that was tried (limit %.3g); on blocks not fitted the "
      "squared residual of %s falls by %s (at least %.3g %% asked)",
      c.score.statistic, PValueText(c.p_value).c_str(), step.threshold, where.c_str(), Decrease(c).c_str(),
      100.0 * result.given.DecreaseOfSquares());
}

std::string RivalSentence(const LoopStep& step) {
  if (step.confusable_with.empty()) return "no other candidate explains the same as well";
  std::vector<std::string> names;
  for (const LoopRival& rival : step.confusable_with) {
    names.push_back(EffectTitle(rival.effect) + Format(" (%.2f %% on held-out blocks)", rival.held_out_error_percent));
  }
  return "these data do not tell it from " + Join(names, "; ");
}

std::vector<std::string> Warnings(const LoopResult& result) {
  std::vector<std::string> warnings;
  for (const EffectCurve& curve : EffectCurves(result)) {
    if (curve.driving_share <= 0.01) continue;
    warnings.push_back(
        Format("The friction of joint %d by the final model (%s) drives the joint at %.0f %% of the samples in motion, "
               "which no friction does: these effects stand in for something else, or for each other.",
               curve.joint + 1, curve.effects.c_str(), 100.0 * curve.driving_share));
  }
  return warnings;
}

}  // namespace idim
