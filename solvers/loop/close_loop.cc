#include "solvers/loop/close_loop.h"

#include <glog/logging.h>

#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "core/model/active_effects.h"
#include "solvers/loop/declared_effects.h"
#include "solvers/loop/loop_search.h"

namespace idim {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

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

// The loop's candidates on fitted bundles (solvers/loop/loop_search.h).
class LoopProblem {
 public:
  using Model = JudgedFit;
  using Effect = ActiveEffect;
  using Candidate = EffectCandidate;
  using Step = LoopStep;

  LoopProblem(const LoopOptions& options, bool held_out_by_blocks)
      : options_(options), held_out_by_blocks_(held_out_by_blocks) {}

  static const std::vector<ActiveEffect>& Effects(const JudgedFit& model) { return model.fit.prepared.model.effects; }

  static std::optional<JudgedFit> Fit(const JudgedFit& from, const std::vector<ActiveEffect>& effects) {
    Result<EffectFit> fit = Refit(from.fit, effects);
    if (!fit.ok()) return std::nullopt;
    return JudgedFit(std::move(fit).value());
  }

  std::vector<EffectCandidate> Scan(const JudgedFit& model, const std::vector<int>& joints,
                                    const std::function<void(const std::string&)>& say) const {
    ScanOptions options;
    options.significance = options_.significance;
    options.threads = options_.threads;
    options.only_joints = joints;
    options.progress = say;
    return ScanEffects(model.fit.prepared, model.residual, model.fit.Arm(), options).candidates;
  }

  static std::vector<ActiveEffect> ForbiddenSigns(const JudgedFit& model) { return OfWrongSign(model.fit); }

  static VectorXd HeldOut(const JudgedFit& measure, const JudgedFit& model, const std::vector<int>& joints) {
    return HeldOutByFold(measure.residual, model, joints);
  }

  static bool Overlap(const EffectCandidate& a, const EffectCandidate& b) {
    return idim::Overlap(a.remainder, b.remainder);
  }

  LoopStep Record(const JudgedFit& before, const JudgedFit& after, const std::vector<EffectCandidate>& scan,
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

 private:
  const LoopOptions& options_;
  const bool held_out_by_blocks_;
};

using Search = LoopSearch<LoopProblem>;

std::string Sentence(const Search::Dropped& dropped) {
  const std::string title = EffectTitle(dropped.effect);
  switch (dropped.why) {
    case WhyDropped::kForbiddenSign:
      return title + " came out negative beside what was found later, which it cannot be";
    case WhyDropped::kNotNeeded:
      return title + " is not needed beside what was found later";
    case WhyDropped::kReplaced:
      return title + " is replaced by " + EffectTitle(*dropped.replaced_by) +
             ", which explains more beside what was found later";
  }
  LOG(FATAL) << "a reason without a sentence";
}

}  // namespace

Result<LoopResult> CloseLoop(const PreparedStudy& as_recorded, const LoopOptions& options) {
  std::string error;
  CHECK(options.IsValid(&error)) << error;
  const PreparedStudy prepared{WithVelocityZeroAtRest(*as_recorded.data), as_recorded.model};
  LoopResult result(prepared);
  result.given = options;
  result.held_out_by_blocks = prepared.model.RecordingsFor(Use::kValidation).empty();
  if (options.progress) options.progress("fitting the declared model");
  Result<EffectFit> declared = FitWithDeclaredEffects(prepared);
  if (!declared.ok()) {
    if (declared.status().code() == StatusCode::kBadInput) return declared.status();
    result.status = declared.status();
    return result;
  }
  result.before = IdentificationOf(*declared);
  const LoopProblem problem(options, result.held_out_by_blocks);
  Search search(problem, options, JudgedFit(std::move(declared).value()));
  result.declared = LoopErrorsOf(search.model(), result.held_out_by_blocks);
  search.Run();
  const JudgedFit& final = search.model();
  result.final = LoopErrorsOf(final, result.held_out_by_blocks);
  result.steps = search.TakeSteps();
  for (const Search::Dropped& dropped : search.dropped()) result.dropped.push_back(Sentence(dropped));
  // Values and shapes of the last fit, in which effects found later take part.
  for (LoopStep& step : result.steps) {
    for (const ActiveEffect& effect : final.fit.prepared.model.effects) {
      if (SameEffect(step.effect, effect)) step.effect = effect;
    }
  }
  if (options.progress) options.progress("what is left");
  result.unexplained = FindUnexplained(final.fit.prepared, final.residual, UnexplainedOptions());
  result.after = IdentificationOf(final.fit);
  result.prepared = final.fit.prepared;
  result.status = result.after.estimate.status;
  return result;
}

}  // namespace idim
