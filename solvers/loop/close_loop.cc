#include "solvers/loop/close_loop.h"

#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <future>
#include <optional>
#include <utility>

#include "core/base/text.h"
#include "core/model/active_effects.h"
#include "solvers/loop/declared_effects.h"

namespace idim {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Folds cannot tell two candidates apart below this many standard errors of their difference; and are sure above.
constexpr double kSame = 1.0, kSure = 2.0;
constexpr int kSweeps = 2;

// An effect that acts in spells gains much in some folds and little in others: its standard error is large, its sign
// sure.
bool IsInMostFolds(const VectorXd& gain) {
  return static_cast<double>((gain.array() > 0.0).count()) >= 0.85 * static_cast<double>(gain.size());
}

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

bool Has(const std::vector<ActiveEffect>& effects, const ActiveEffect& one) {
  return std::any_of(effects.begin(), effects.end(), [&](const ActiveEffect& other) { return SameEffect(other, one); });
}

class Loop {
 public:
  Loop(const LoopOptions& options, JudgedFit declared)
      : options_(options), model_(std::move(declared)), declared_(model_.fit.prepared.model.effects) {}

  const JudgedFit& model() const { return model_; }

  int added() const { return static_cast<int>(model_.fit.prepared.model.effects.size() - declared_.size()); }

  // Adds one effect. False: nothing passes.
  bool Add(LoopResult* result) {
    const EffectScan scan = Scan(model_, {});
    std::vector<EffectCandidate> passing;
    for (const EffectCandidate& candidate : scan.candidates) {
      if (!Has(aside_, candidate.effect) && Passes(candidate)) passing.push_back(candidate);
    }
    while (!passing.empty()) {
      const size_t chosen = Choose(passing);
      Say("fitting with " + EffectTitle(passing[chosen].effect));
      Result<EffectFit> fit = With(passing[chosen].effect);
      if (fit.ok()) {
        JudgedFit next(std::move(fit).value());
        if (!Has(OfWrongSign(next.fit), passing[chosen].effect) &&
            IsBetter(model_, next, passing[chosen].effect.joints)) {
          Record(scan, passing, chosen, next, result);
          model_ = std::move(next);
          return true;
        }
      }
      Say((fit.ok() ? "no better with " : "no fit with ") + EffectTitle(passing[chosen].effect));
      aside_.push_back(passing[chosen].effect);
      passing.erase(passing.begin() + static_cast<std::ptrdiff_t>(chosen));
    }
    return false;
  }

  // Drops effects that turned their sign. False: there is none.
  bool DropWrongSigns(LoopResult* result) {
    bool changed = false;
    for (const ActiveEffect& effect : WrongSigns(model_.fit)) {
      std::optional<JudgedFit> without = JudgedWithout(effect);
      if (!without) continue;
      Drop(effect, " came out negative beside what was found later, which it cannot be", *std::move(without), result);
      changed = true;
    }
    return changed;
  }

  // Drops or replaces effects beside all others. False: nothing changed.
  bool Reconsider(LoopResult* result) {
    // Shapes that were held while effects were missing may be told now.
    std::vector<ActiveEffect> released = model_.fit.prepared.model.effects;
    const bool any_held =
        std::any_of(released.begin(), released.end(), [](const ActiveEffect& effect) { return effect.held; });
    for (ActiveEffect& effect : released) effect.held = false;
    if (any_held) {
      if (Result<EffectFit> fit = Refit(model_.fit, released); fit.ok()) model_ = JudgedFit(std::move(fit).value());
    }
    bool changed = DropWrongSigns(result);
    // While one is judged the next is fitted already, for nothing where the model changes.
    std::future<std::optional<JudgedFit>> ahead;
    for (size_t e = 0; e < model_.fit.prepared.model.effects.size();) {
      const ActiveEffect effect = model_.fit.prepared.model.effects[e];
      if (Has(declared_, effect)) {
        ++e;
        continue;
      }
      Say("is " + EffectTitle(effect) + " needed beside the others?");
      std::optional<JudgedFit> without = ahead.valid() ? ahead.get() : JudgedWithout(effect);
      if (options_.threads > 1 && e + 1 < model_.fit.prepared.model.effects.size()) {
        const ActiveEffect next = model_.fit.prepared.model.effects[e + 1];
        ahead = std::async(std::launch::async, [this, next] { return JudgedWithout(next); });
      }
      if (!without) {
        ++e;
        continue;
      }
      // A model in which another effect turns its sign is none to go back to.
      if (WrongSigns(without->fit).empty() && !IsBetter(*without, model_, effect.joints)) {
        ahead = {};
        Drop(effect, " is not needed beside what was found later", *std::move(without), result);
        changed = true;
        continue;
      }
      if (std::optional<Replacement> better = BetterAt(effect, *without)) {
        ahead = {};
        Replace(effect, *std::move(without), *std::move(better), result);
        changed = true;
      }
      ++e;
    }
    return changed;
  }

 private:
  void Say(const std::string& text) const {
    if (options_.progress) {
      options_.progress(Format("%d effects, ", added()) + text);
    }
  }

  EffectScan Scan(const JudgedFit& model, const std::vector<int>& only_joints) const {
    ScanOptions options;
    options.significance = options_.significance;
    options.threads = options_.threads;
    options.only_joints = only_joints;
    options.progress = [this](const std::string& text) { Say(text); };
    return ScanEffects(model.fit.prepared, model.residual, model.fit.Arm(), options);
  }

  bool Passes(const EffectCandidate& candidate) const {
    return candidate.held_out_decrease > options_.DecreaseOfSquares() &&
           (candidate.held_out_decrease > kSure * candidate.held_out_error || IsInMostFolds(candidate.held_out_gain));
  }

  // The best by held-out squares; of those that cannot be told from it, the one with the fewest parameters.
  static size_t Choose(const std::vector<EffectCandidate>& passing) {
    size_t chosen = 0;
    for (size_t k = 1; k < passing.size(); ++k) {
      const VectorXd behind = passing[0].held_out_gain - passing[k].held_out_gain;
      if (behind.sum() > kSame * StandardErrorOfSum(behind) || !Overlap(passing[0], passing[k])) continue;
      if (passing[k].parameters < passing[chosen].parameters) chosen = k;
    }
    return chosen;
  }

  // Explains the same: their columns point half of the way in the same directions, or more.
  static bool Overlap(const EffectCandidate& a, const EffectCandidate& b) {
    // Mean squared cosine between the spaces, of which both have orthonormal columns.
    return (a.remainder.transpose() * b.remainder).squaredNorm() >
           0.5 * static_cast<double>(std::min(a.remainder.cols(), b.remainder.cols()));
  }

  Result<EffectFit> With(const ActiveEffect& effect) const {
    std::vector<ActiveEffect> effects = model_.fit.prepared.model.effects;
    effects.push_back(effect);
    return Refit(model_.fit, effects);
  }

  Result<EffectFit> Without(const ActiveEffect& effect) const {
    std::vector<ActiveEffect> others;
    for (const ActiveEffect& other : model_.fit.prepared.model.effects) {
      if (!SameEffect(other, effect)) others.push_back(other);
    }
    return Refit(model_.fit, others);
  }

  std::optional<JudgedFit> JudgedWithout(const ActiveEffect& effect) const {
    Result<EffectFit> fit = Without(effect);
    if (!fit.ok()) return std::nullopt;
    return JudgedFit(std::move(fit).value());
  }

  void Drop(const ActiveEffect& effect, const std::string& why, JudgedFit without, LoopResult* result) {
    result->dropped.push_back(EffectTitle(effect) + why);
    Forget(effect, result);
    model_ = std::move(without);
  }

  // The held-out error of `with` is below that of `without` by the margin and by more than the folds' uncertainty.
  bool IsBetter(const JudgedFit& without, const JudgedFit& with, const std::vector<int>& joints) const {
    const VectorXd squares = HeldOutByFold(without.residual, without, joints);
    const VectorXd gain = squares - HeldOutByFold(without.residual, with, joints);
    return gain.sum() > options_.DecreaseOfSquares() * squares.sum() &&
           (gain.sum() > kSame * StandardErrorOfSum(gain) || IsInMostFolds(gain));
  }

  void Record(const EffectScan& scan, const std::vector<EffectCandidate>& passing, size_t chosen, const JudgedFit& next,
              LoopResult* result) const {
    LoopStep step;
    step.effect = next.fit.prepared.model.effects.back();
    step.candidate = passing[chosen];
    step.threshold = options_.significance;
    step.before = ErrorsOf(model_, result->held_out_by_blocks);
    step.after = ErrorsOf(next, result->held_out_by_blocks);
    step.moved = MovedBetween(model_.fit, next.fit);
    for (const EffectCandidate& candidate : scan.candidates) {
      step.ranking.push_back(candidate);
      step.ranking.back().remainder.resize(0, 0);
    }
    for (size_t k = 0; k < passing.size(); ++k) {
      const VectorXd behind = passing[chosen].held_out_gain - passing[k].held_out_gain;
      if (k == chosen || !Overlap(passing[chosen], passing[k]) || behind.sum() > kSure * StandardErrorOfSum(behind))
        continue;
      const MatrixXd residual = model_.residual.CrossValidate(passing[k].remainder).residual;
      step.confusable_with.push_back({passing[k].effect, 100.0 * residual.norm() / model_.residual.torque().norm()});
    }
    step.candidate.remainder.resize(0, 0);
    result->steps.push_back(std::move(step));
  }

  static void Forget(const ActiveEffect& effect, LoopResult* result) {
    auto& steps = result->steps;
    steps.erase(
        std::remove_if(steps.begin(), steps.end(), [&](const LoopStep& s) { return SameEffect(s.effect, effect); }),
        steps.end());
  }

  // Of effects that the loop added.
  std::vector<ActiveEffect> WrongSigns(const EffectFit& fit) const {
    std::vector<ActiveEffect> added;
    for (const ActiveEffect& effect : OfWrongSign(fit)) {
      if (!Has(declared_, effect)) added.push_back(effect);
    }
    return added;
  }

  struct Replacement {
    EffectScan scan;
    EffectCandidate candidate;
    JudgedFit model;
  };

  // A rival at the same place, beside all other effects, that does better. `without`: the model that lacks `effect`.
  std::optional<Replacement> BetterAt(const ActiveEffect& effect, const JudgedFit& without) const {
    if (effect.joints.empty()) return std::nullopt;
    EffectScan scan = Scan(without, effect.joints);
    for (const EffectCandidate& candidate : scan.candidates) {
      if (SameEffect(candidate.effect, effect) || !Passes(candidate)) continue;
      std::vector<ActiveEffect> effects = without.fit.prepared.model.effects;
      effects.push_back(candidate.effect);
      Result<EffectFit> fit = Refit(without.fit, effects);
      if (!fit.ok() || !WrongSigns(*fit).empty()) continue;
      JudgedFit next(std::move(fit).value());
      const VectorXd gain =
          HeldOutByFold(without.residual, model_, effect.joints) - HeldOutByFold(without.residual, next, effect.joints);
      // The best of them is no better.
      if (gain.sum() <= kSure * StandardErrorOfSum(gain) || gain.sum() <= 0.0) return std::nullopt;
      return Replacement{scan, candidate, std::move(next)};
    }
    return std::nullopt;
  }

  void Replace(const ActiveEffect& effect, JudgedFit without, Replacement by, LoopResult* result) {
    result->dropped.push_back(EffectTitle(effect) + " is replaced by " + EffectTitle(by.candidate.effect) +
                              ", which explains more beside what was found later");
    Forget(effect, result);
    model_ = std::move(without);
    Record(by.scan, {by.candidate}, 0, by.model, result);
    model_ = std::move(by.model);
  }

  const LoopOptions& options_;
  JudgedFit model_;
  const std::vector<ActiveEffect> declared_;  // by the study: neither dropped nor replaced
  std::vector<ActiveEffect> aside_;
};

}  // namespace

bool LoopOptions::IsValid(std::string* error) const {
  if (!(significance > 0.0 && significance < 1.0)) {
    *error = "significance is " + FormatNumber(significance) + "; expected a number between 0 and 1";
    return false;
  }
  if (!(margin > 0.0 && margin < 1.0)) {
    *error = "margin is " + FormatNumber(margin) + "; expected a number between 0 and 1";
    return false;
  }
  if (max_effects < 0) {
    *error = "max_effects is " + std::to_string(max_effects) + "; expected at least 0";
    return false;
  }
  if (threads < 1) {
    *error = "threads is " + std::to_string(threads) + "; expected at least 1";
    return false;
  }
  return true;
}

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
  Loop loop(options, JudgedFit(std::move(declared).value()));
  result.declared = ErrorsOf(loop.model(), result.held_out_by_blocks);
  for (int sweep = 0; sweep <= kSweeps; ++sweep) {
    bool added = false;
    while (loop.added() < options.max_effects) {
      if (!loop.Add(&result)) break;
      added = true;
    }
    if (sweep == kSweeps || (sweep > 0 && !added) || !loop.Reconsider(&result)) break;
  }
  loop.DropWrongSigns(&result);
  result.final = ErrorsOf(loop.model(), result.held_out_by_blocks);
  // Values and shapes of the last fit, in which effects found later take part.
  for (LoopStep& step : result.steps) {
    for (const ActiveEffect& effect : loop.model().fit.prepared.model.effects) {
      if (SameEffect(step.effect, effect)) step.effect = effect;
    }
  }
  if (options.progress) options.progress("what is left");
  result.unexplained = FindUnexplained(loop.model().fit.prepared, loop.model().residual, UnexplainedOptions());
  result.after = IdentificationOf(loop.model().fit);
  result.prepared = loop.model().fit.prepared;
  result.status = result.after.estimate.status;
  return result;
}

}  // namespace idim
