#include "solvers/loop/loop_problem.h"

#include <cmath>
#include <utility>

#include "core/model/active_effects.h"

namespace idim {

using Eigen::MatrixXd;

namespace {

std::vector<MovedParameter> MovedBetween(const EffectFit& before, const EffectFit& after) {
  std::vector<MovedParameter> moved;
  const double factor = 1.96 * before.summary.interval_factor;
  for (int a = 0; a < before.data.num_unknowns(); ++a) {
    const double deviation = std::sqrt(before.summary.robust_covariance(a, a));
    for (int b = 0; b < after.data.num_unknowns(); ++b) {
      if (after.data.unknowns[b].name != before.data.unknowns[a].name) continue;
      const double was = before.summary.values[a], is = after.summary.values[b];
      if (std::abs(is - was) > factor * deviation && !IsOfEffect(before.data.unknowns[a].kind)) {
        moved.push_back({before.data.unknowns[a], was, is, deviation});
      }
    }
  }
  return moved;
}

}  // namespace

std::optional<JudgedFit> LoopProblem::Fit(const JudgedFit& from, const std::vector<ActiveEffect>& effects) {
  Result<EffectFit> fit = Refit(from.fit, effects);
  if (!fit.ok()) return std::nullopt;
  return JudgedFit(std::move(fit).value());
}

std::vector<EffectCandidate> LoopProblem::Scan(const JudgedFit& model, const std::vector<int>& joints,
                                               const std::function<void(const std::string&)>& say) const {
  ScanOptions options;
  options.significance = options_.significance;
  options.threads = options_.threads;
  options.only_joints = joints;
  options.progress = say;
  return ScanEffects(model.fit.prepared, model.residual, model.fit.Arm(), options).candidates;
}

LoopStep LoopProblem::Record(const JudgedFit& before, const JudgedFit& after, const std::vector<EffectCandidate>& scan,
                             const EffectCandidate& chosen, const std::vector<EffectCandidate>& rivals) const {
  LoopStep step;
  step.effect = after.fit.prepared.model.effects.back();
  step.candidate = chosen;
  step.candidate.remainder.resize(0, 0);
  step.threshold = options_.significance;
  step.before = LoopErrorsOf(before, held_out_by_blocks_);
  step.after = LoopErrorsOf(after, held_out_by_blocks_);
  step.moved = MovedBetween(before.fit, after.fit);
  for (const EffectCandidate& candidate : scan) {
    step.ranking.push_back(candidate);
    step.ranking.back().remainder.resize(0, 0);
  }
  for (const EffectCandidate& rival : rivals) {
    const MatrixXd residual = before.residual.CrossValidate(rival.remainder).residual;
    step.confusable_with.push_back({rival.effect, 100.0 * residual.norm() / before.residual.torque().norm()});
  }
  return step;
}

}  // namespace idim
