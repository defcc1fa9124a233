// The order in which the loop asks: forward steps, then every effect that was added again beside all others.
//
//   add           all candidates that pass both gates (PassesScoreTest, PassesHeldOut), the chosen one fitted along
//                 with everything; put aside if it has a forbidden sign or is not needed after the fit, and another
//                 chosen; until one is added or none is left
//   reconsider    shapes that were held are released; effects that turned their sign are dropped; then each effect
//                 that was added is dropped if the model does not need it, or else replaced if the first candidate at
//                 its place that can be fitted in its stead does better
//
// A template over what is searched, so that the order can be tested by models that are but tables
// (tests/support/scripted_model.h). The decisions themselves: solvers/loop/loop_rules.h.
//
// `Problem` is, const and callable from two threads:
//
//   Model                                        a fitted model
//   Effect                                       has `joints` and `held`; SameEffect(a, b), EffectTitle(a)
//   Candidate                                    a CandidateRow with `effect`
//   Step                                         what is recorded of an effect that was added; has `effect`
//   Effects(Model) -> vector<Effect>             those in the model, new ones last
//   Fit(Model from, vector<Effect>) -> optional<Model>
//   Scan(Model, vector<int> joints, say) -> vector<Candidate>
//                                                best first; at these joints alone, anywhere if there are none
//   ForbiddenSigns(Model) -> vector<Effect>      effects in it whose sign physics forbids
//   HeldOut(Model measure, Model, vector<int> joints) -> VectorXd
//                                                squared held-out residuals by fold, by the weights of `measure`
//   Overlap(Candidate, Candidate) -> bool        they explain the same
//   Record(Model before, Model after, vector<Candidate> scan, Candidate chosen, vector<Candidate> rivals) -> Step

#ifndef IDIM_SOLVERS_LOOP_LOOP_SEARCH_H_
#define IDIM_SOLVERS_LOOP_LOOP_SEARCH_H_

#include <Eigen/Core>
#include <algorithm>
#include <functional>
#include <future>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/text.h"
#include "solvers/loop/loop_options.h"
#include "solvers/loop/loop_rules.h"

namespace idim {

enum class WhyDropped { kForbiddenSign, kNotNeeded, kReplaced };

template <class Problem>
class LoopSearch {
 public:
  using Model = typename Problem::Model;
  using Effect = typename Problem::Effect;
  using Candidate = typename Problem::Candidate;
  using Step = typename Problem::Step;

  struct Dropped {
    Effect effect;
    WhyDropped why;
    std::optional<Effect> replaced_by;
  };

  // problem, options: must outlive the search. The effects of `declared` are neither dropped nor replaced.
  LoopSearch(const Problem& problem, const LoopOptions& options, Model declared)
      : problem_(problem),
        options_(options),
        model_(std::move(declared)),
        declared_(problem.Effects(model_)),
        say_([this](const std::string& text) { Say(text); }) {}
  LoopSearch(const LoopSearch&) = delete;
  LoopSearch& operator=(const LoopSearch&) = delete;

  const Model& model() const { return model_; }
  // Of the effects that were added and are still in the model, in the order in which they were found.
  const std::vector<Step>& steps() const { return steps_; }
  std::vector<Step> TakeSteps() { return std::move(steps_); }
  const std::vector<Dropped>& dropped() const { return dropped_; }

  void Run() {
    for (int sweep = 0;; ++sweep) {
      bool added = false;
      while (NumAdded() < options_.max_effects && Add()) added = true;
      if (!IsReconsideredAgain(sweep, added) || !Reconsider()) break;
    }
    DropForbiddenSigns();
  }

 private:
  int NumAdded() const { return static_cast<int>(problem_.Effects(model_).size() - declared_.size()); }

  static bool Has(const std::vector<Effect>& effects, const Effect& one) {
    return std::any_of(effects.begin(), effects.end(), [&](const Effect& other) { return SameEffect(other, one); });
  }

  static std::vector<CandidateRow> Rows(const std::vector<Candidate>& candidates) {
    return {candidates.begin(), candidates.end()};
  }

  void Say(const std::string& text) const {
    if (options_.progress) options_.progress(Format("%d effects, ", NumAdded()) + text);
  }

  bool Passes(const Candidate& candidate) const {
    return PassesScoreTest(candidate.p_value, options_.significance) && PassesHeldOut(candidate, options_.margin);
  }

  bool IsNeededIn(const Model& with, const Model& without, const Effect& effect) const {
    return IsNeeded(problem_.HeldOut(without, without, effect.joints), problem_.HeldOut(without, with, effect.joints),
                    options_.margin);
  }

  // Which of the candidates explain the same as `one`.
  std::vector<bool> Overlaps(const Candidate& one, const std::vector<Candidate>& candidates) const {
    std::vector<bool> overlaps;
    for (const Candidate& candidate : candidates) overlaps.push_back(problem_.Overlap(one, candidate));
    return overlaps;
  }

  // Of the effects that the loop added.
  std::vector<Effect> ForbiddenSigns(const Model& model) const {
    std::vector<Effect> added;
    for (const Effect& effect : problem_.ForbiddenSigns(model)) {
      if (!Has(declared_, effect)) added.push_back(effect);
    }
    return added;
  }

  std::optional<Model> With(const Model& model, const Effect& effect) const {
    std::vector<Effect> effects = problem_.Effects(model);
    effects.push_back(effect);
    return problem_.Fit(model, effects);
  }

  std::optional<Model> Without(const Effect& effect) const {
    std::vector<Effect> others;
    for (const Effect& other : problem_.Effects(model_)) {
      if (!SameEffect(other, effect)) others.push_back(other);
    }
    return problem_.Fit(model_, others);
  }

  // One effect. False: nothing passes.
  bool Add() {
    const std::vector<Candidate> scan = problem_.Scan(model_, {}, say_);
    std::vector<Candidate> passing;
    for (const Candidate& candidate : scan) {
      if (!Has(aside_, candidate.effect) && Passes(candidate)) passing.push_back(candidate);
    }
    while (!passing.empty()) {
      const size_t chosen = ChooseCandidate(Rows(passing), Overlaps(passing[0], passing));
      const Effect effect = passing[chosen].effect;
      Say("fitting with " + EffectTitle(effect));
      std::optional<Model> next = With(model_, effect);
      if (next && !Has(problem_.ForbiddenSigns(*next), effect) && IsNeededIn(*next, model_, effect)) {
        Record(model_, *next, scan, passing, chosen);
        model_ = *std::move(next);
        return true;
      }
      Say((next ? "no better with " : "no fit with ") + EffectTitle(effect));
      aside_.push_back(effect);
      passing.erase(passing.begin() + static_cast<std::ptrdiff_t>(chosen));
    }
    return false;
  }

  void Record(const Model& before, const Model& after, const std::vector<Candidate>& scan,
              const std::vector<Candidate>& passing, size_t chosen) {
    std::vector<Candidate> rivals;
    for (const size_t k : RivalsOf(chosen, Rows(passing), Overlaps(passing[chosen], passing))) {
      rivals.push_back(passing[k]);
    }
    steps_.push_back(problem_.Record(before, after, scan, passing[chosen], rivals));
  }

  // Drops or replaces effects beside all others. False: nothing changed.
  bool Reconsider() {
    Release();
    bool changed = DropForbiddenSigns();
    std::vector<Effect> added;
    for (const Effect& effect : problem_.Effects(model_)) {
      if (!Has(declared_, effect)) added.push_back(effect);
    }
    // While one is judged the next is fitted already, for nothing where the model changes.
    std::future<std::optional<Model>> ahead;
    for (size_t e = 0; e < added.size(); ++e) {
      const Effect& effect = added[e];
      Say("is " + EffectTitle(effect) + " needed beside the others?");
      std::optional<Model> without = ahead.valid() ? ahead.get() : Without(effect);
      if (options_.threads > 1 && e + 1 < added.size()) {
        ahead = std::async(std::launch::async, [this, &next = added[e + 1]] { return Without(next); });
      }
      if (!without) continue;
      // A model in which another effect turns its sign is none to go back to.
      if (ForbiddenSigns(*without).empty() && !IsNeededIn(model_, *without, effect)) {
        ahead = {};
        Drop({effect, WhyDropped::kNotNeeded, std::nullopt}, *std::move(without));
        changed = true;
      } else if (std::optional<Replacement> better = BetterAt(effect, *without)) {
        ahead = {};
        Replace(effect, *without, *std::move(better));
        changed = true;
      }
    }
    return changed;
  }

  // Shapes that were held while effects were missing may be identifiable now.
  void Release() {
    std::vector<Effect> effects = problem_.Effects(model_);
    bool any = false;
    for (Effect& effect : effects) {
      any |= effect.held;
      effect.held = false;
    }
    if (!any) return;
    if (std::optional<Model> released = problem_.Fit(model_, effects)) model_ = *std::move(released);
  }

  // One after the other, since those that are left may turn theirs again. False: there is none.
  bool DropForbiddenSigns() {
    bool changed = false;
    while (DropAForbiddenSign()) changed = true;
    return changed;
  }

  bool DropAForbiddenSign() {
    for (const Effect& effect : ForbiddenSigns(model_)) {
      std::optional<Model> without = Without(effect);
      if (!without) continue;
      Drop({effect, WhyDropped::kForbiddenSign, std::nullopt}, *std::move(without));
      return true;
    }
    return false;
  }

  void Drop(Dropped dropped, Model without) {
    Forget(dropped.effect);
    dropped_.push_back(std::move(dropped));
    model_ = std::move(without);
  }

  void Forget(const Effect& effect) {
    steps_.erase(
        std::remove_if(steps_.begin(), steps_.end(), [&](const Step& step) { return SameEffect(step.effect, effect); }),
        steps_.end());
  }

  struct Replacement {
    std::vector<Candidate> scan;
    Candidate candidate;
    Model model;
  };

  // Another effect at the same place, beside all others, that does better. `without`: the model that lacks `effect`.
  std::optional<Replacement> BetterAt(const Effect& effect, const Model& without) const {
    if (effect.joints.empty()) return std::nullopt;
    const std::vector<Candidate> scan = problem_.Scan(without, effect.joints, say_);
    for (const Candidate& candidate : scan) {
      if (SameEffect(candidate.effect, effect) || !Passes(candidate)) continue;
      std::optional<Model> next = With(without, candidate.effect);
      if (!next || !ForbiddenSigns(*next).empty()) continue;
      // Only the best of them is compared.
      if (!IsReplacedBy(problem_.HeldOut(without, model_, effect.joints),
                        problem_.HeldOut(without, *next, effect.joints))) {
        return std::nullopt;
      }
      return Replacement{scan, candidate, *std::move(next)};
    }
    return std::nullopt;
  }

  void Replace(const Effect& effect, const Model& without, Replacement by) {
    Forget(effect);
    dropped_.push_back({effect, WhyDropped::kReplaced, by.candidate.effect});
    Record(without, by.model, by.scan, {by.candidate}, 0);
    model_ = std::move(by.model);
  }

  const Problem& problem_;
  const LoopOptions& options_;
  Model model_;
  const std::vector<Effect> declared_;
  const std::function<void(const std::string&)> say_;
  std::vector<Effect> aside_;  // not worth their fit
  std::vector<Step> steps_;
  std::vector<Dropped> dropped_;
};

}  // namespace idim

#endif  // IDIM_SOLVERS_LOOP_LOOP_SEARCH_H_
