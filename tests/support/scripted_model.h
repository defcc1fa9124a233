// What the loop searches, as tables: each model is the set of its effects, and what it leaves is written down.

#ifndef IDIM_TESTS_SUPPORT_SCRIPTED_MODEL_H_
#define IDIM_TESTS_SUPPORT_SCRIPTED_MODEL_H_

#include <Eigen/Core>
#include <algorithm>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "solvers/loop/loop_rules.h"
#include "solvers/loop/loop_search.h"

namespace idim::testing {

struct ScriptedEffect {
  std::string name;
  std::vector<int> joints = {0};
  bool held = false;
};
inline bool SameEffect(const ScriptedEffect& a, const ScriptedEffect& b) { return a.name == b.name; }
inline std::string EffectTitle(const ScriptedEffect& effect) { return effect.name; }

struct ScriptedCandidate : CandidateRow {
  ScriptedEffect effect;
};

// Passes both gates; gains `gain` of 100 in all, the same in each fold.
inline ScriptedCandidate Candidate(const std::string& name, double gain, int parameters = 1,
                                   const std::vector<int>& joints = {0}) {
  ScriptedCandidate candidate;
  candidate.effect = {name, joints};
  candidate.parameters = parameters;
  candidate.p_value = 0.0;
  SetHeldOut(Eigen::VectorXd::Constant(4, gain / 4.0), 100.0, &candidate);
  return candidate;
}

// Titles of what the search recorded.
struct ScriptedStep {
  ScriptedEffect effect;
  std::string before, after;
  std::vector<std::string> ranking, rivals;
};

// Models are named by their effects in alphabetical order, "a b"; the one without any is "". A table that has no entry
// for a model that is asked for throws.
class ScriptedProblem {
 public:
  using Model = std::vector<ScriptedEffect>;
  using Effect = ScriptedEffect;
  using Candidate = ScriptedCandidate;
  using Step = ScriptedStep;

  std::map<std::string, std::vector<ScriptedCandidate>> scans;  // of a model; no entry: nothing is found
  std::map<std::string, Eigen::VectorXd> squares;               // held out, by fold: of all joints, or "a b at 0"
  std::map<std::string, std::set<std::string>> forbidden;       // effects of a forbidden sign in a model
  std::set<std::string> unfittable;                             // models
  std::set<std::set<std::string>> overlapping;                  // pairs of effects
  // What was asked: "scan a b", "scan a at 0", "fit a", with a star for an effect whose shape is held.
  mutable std::vector<std::string> asked;

  // The same in each of four folds.
  void Leaves(const std::string& model, double sum) { squares[model] = Eigen::VectorXd::Constant(4, sum / 4.0); }

  static std::string Name(const Model& model) {
    std::vector<std::string> names;
    for (const ScriptedEffect& effect : model) names.push_back(effect.name);
    std::sort(names.begin(), names.end());
    std::string joined;
    for (const std::string& name : names) joined += (joined.empty() ? "" : " ") + name;
    return joined;
  }

  static const Model& Effects(const Model& model) { return model; }

  std::optional<Model> Fit(const Model& from, const std::vector<ScriptedEffect>& effects) const {
    std::string text = "fit " + Name(effects) + " from " + Name(from);
    for (const ScriptedEffect& effect : effects) text += effect.held ? "*" : "";
    Note(text);
    if (unfittable.count(Name(effects)) > 0) return std::nullopt;
    return effects;
  }

  std::vector<ScriptedCandidate> Scan(const Model& model, const std::vector<int>& joints,
                                      const std::function<void(const std::string&)>& say) const {
    Note("scan " + Name(model) + At(joints));
    say("scanning");
    std::vector<ScriptedCandidate> found;
    const auto scan = scans.find(Name(model));
    if (scan == scans.end()) return found;
    for (const ScriptedCandidate& candidate : scan->second) {
      if (joints.empty() || candidate.effect.joints == joints) found.push_back(candidate);
    }
    return found;
  }

  std::vector<ScriptedEffect> ForbiddenSigns(const Model& model) const {
    std::vector<ScriptedEffect> result;
    const auto names = forbidden.find(Name(model));
    for (const ScriptedEffect& effect : model) {
      if (names != forbidden.end() && names->second.count(effect.name) > 0) result.push_back(effect);
    }
    return result;
  }

  // By the weights of the smaller model, so that neither of two that are compared has weights of its own.
  Eigen::VectorXd HeldOut(const Model& measure, const Model& model, const std::vector<int>& joints) const {
    if (measure.size() > model.size()) throw std::logic_error("weights of " + Name(measure));
    const auto of_joints = squares.find(Name(model) + At(joints));
    return of_joints != squares.end() ? of_joints->second : squares.at(Name(model));
  }

  bool Overlap(const ScriptedCandidate& a, const ScriptedCandidate& b) const {
    return a.effect.name == b.effect.name || overlapping.count({a.effect.name, b.effect.name}) > 0;
  }

  ScriptedStep Record(const Model& before, const Model& after, const std::vector<ScriptedCandidate>& scan,
                      const ScriptedCandidate& chosen, const std::vector<ScriptedCandidate>& rivals) const {
    return {chosen.effect, Name(before), Name(after), Names(scan), Names(rivals)};
  }

 private:
  static std::string At(const std::vector<int>& joints) {
    std::string where;
    for (const int joint : joints) where += (where.empty() ? " at " : ",") + std::to_string(joint);
    return where;
  }

  static std::vector<std::string> Names(const std::vector<ScriptedCandidate>& candidates) {
    std::vector<std::string> names;
    for (const ScriptedCandidate& candidate : candidates) names.push_back(candidate.effect.name);
    return names;
  }

  void Note(const std::string& text) const {
    const std::lock_guard<std::mutex> lock(mutex_);
    asked.push_back(text);
  }

  mutable std::mutex mutex_;
};

// What came out, in words.
struct Outcome {
  std::string model;
  std::vector<ScriptedStep> steps;
  std::vector<std::string> found;    // effects of the steps
  std::vector<std::string> dropped;  // "a not needed", "a replaced by b", "a forbidden sign"
};

inline Outcome Searched(const ScriptedProblem& problem, const LoopOptions& options = LoopOptions(),
                        const std::vector<ScriptedEffect>& declared = {}) {
  using Search = LoopSearch<ScriptedProblem>;
  Search search(problem, options, declared);
  search.Run();
  Outcome outcome{ScriptedProblem::Name(search.model()), search.steps(), {}, {}};
  for (const ScriptedStep& step : outcome.steps) outcome.found.push_back(step.effect.name);
  for (const Search::Dropped& dropped : search.dropped()) {
    outcome.dropped.push_back(dropped.effect.name +
                              (dropped.why == WhyDropped::kNotNeeded       ? " not needed"
                               : dropped.why == WhyDropped::kForbiddenSign ? " forbidden sign"
                                                                           : " replaced by ") +
                              (dropped.replaced_by ? dropped.replaced_by->name : ""));
  }
  return outcome;
}

}  // namespace idim::testing

#endif  // IDIM_TESTS_SUPPORT_SCRIPTED_MODEL_H_
