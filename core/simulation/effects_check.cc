#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "core/simulation/effects_links.h"
#include "core/simulation/effects_truth.h"

namespace idim {
namespace {

using internal::EffectsIn;
using internal::Links;

std::string Name(size_t k) { return "effects[" + std::to_string(k + 1) + "]"; }

std::string ProblemOfRepetition(const Scenario& scenario, size_t k) {
  const SimulatedEffect& effect = scenario.effects[k];
  for (size_t other = 0; other < k && effect.equation->once_a_joint(); ++other) {
    const SimulatedEffect& before = scenario.effects[other];
    if (before.equation != effect.equation ||
        !(before.recording == effect.recording || before.recording.empty() || effect.recording.empty())) {
      continue;
    }
    for (int j : effect.joints) {
      if (std::count(before.joints.begin(), before.joints.end(), j) == 0) continue;
      return "acts on joint " + std::to_string(j + 1) + " already by " + Name(other);
    }
  }
  return "";
}

// "" if it can be simulated in this recording.
std::string ProblemInRecording(const Scenario& scenario, const ScenarioRecording& recording,
                               const SimulatedEffect& effect) {
  if (!effect.equation->is_flexible()) return "";
  // The joints that are flexible together, first of all alone where their stiffness comes from.
  std::set<int> together;
  for (const SimulatedEffect* other : EffectsIn(scenario, recording)) {
    if (other->equation->is_flexible()) together.insert(other->joints.begin(), other->joints.end());
  }
  if (together.empty()) return "";  // the effect is of another recording
  const std::vector<int> joints(together.begin(), together.end());
  Links bare = internal::BareLinks(scenario);
  const auto bare_torque = [&](double t, const JointState& s) { return bare.Torque(t, s); };
  for (int j : joints) {
    if (!internal::InertiaIsPositive({j}, bare_torque, *scenario.recordings.front().trajectory, 0.0, 0.0)) {
      return "link " + std::to_string(j + 1) + " has no inertia about its joint";
    }
  }
  Links links(scenario, recording, EffectsIn(scenario, recording));
  const auto torque = [&](double t, const JointState& s) { return links.Torque(t, s); };
  if (!internal::InertiaIsPositive(joints, torque, *recording.trajectory, 0.0, DurationOf(recording))) {
    return "the links have no positive inertia about the flexible joints in recording " + recording.name;
  }
  return "";
}

}  // namespace

Status CheckEffects(const Scenario& scenario) {
  const Eigen::VectorXd fs = internal::Split(StandardModel(scenario.robot, FrictionModel()), scenario.chi).fs;
  for (size_t k = 0; k < scenario.effects.size(); ++k) {
    const SimulatedEffect& effect = scenario.effects[k];
    const auto bad = [&](const std::string& problem) { return Status::BadInput(Name(k) + ": " + problem); };
    std::string error;
    if (!effect.IsValid(scenario.robot, &error)) return bad(error);
    const std::string& id = effect.equation->id();
    const bool known = std::any_of(scenario.recordings.begin(), scenario.recordings.end(),
                                   [&](const ScenarioRecording& r) { return r.name == effect.recording; });
    if (!effect.recording.empty() && !known) return bad("there is no recording '" + effect.recording + "'");
    const std::string repetition = ProblemOfRepetition(scenario, k);
    if (!repetition.empty()) return bad(id + " " + repetition);
    for (int j : effect.joints) {
      if (!effect.equation->needs_coulomb_friction() || fs[j] > 0.0) continue;
      return bad(id + " needs a Coulomb friction Fs" + std::to_string(j + 1) + " above 0");
    }
  }
  for (size_t k = 0; k < scenario.effects.size(); ++k) {
    for (const ScenarioRecording& recording : scenario.recordings) {
      const std::string problem = ProblemInRecording(scenario, recording, scenario.effects[k]);
      if (problem.empty()) continue;
      return Status::BadInput(Name(k) + ": " + scenario.effects[k].equation->id() + ": " + problem);
    }
  }
  return Status::Ok();
}

}  // namespace idim
