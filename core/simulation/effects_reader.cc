#include "core/simulation/effects_reader.h"

#include <string>
#include <vector>

#include "core/simulation/effects_truth.h"

namespace idim::internal {
namespace {

SimulatedEffect ReadOne(YamlFile* file, const YAML::Node& node, const std::string& key,
                        const EffectEquationList& equations, const Scenario& scenario) {
  SimulatedEffect effect;
  if (!node.IsMap()) {
    file->Fail(node, key, "not a mapping", "{id: .., joints: [..], ..}");
    return effect;
  }
  std::vector<std::string> ids;
  for (const EffectEquation* equation : equations) ids.push_back(equation->id());
  if (!file->Require(node, key, "id", "the id of an effect")) return effect;
  const int chosen_id = file->Choice(node["id"], KeyPath(key, "id"), ids);
  if (!file->ok()) return effect;
  effect.equation = equations[static_cast<size_t>(chosen_id)];
  const EffectEquation& equation = *effect.equation;
  std::vector<std::string> keys = {"id", "recording"};
  if (equation.joints() != EffectJoints::kNone) keys.push_back("joints");
  for (const EffectKey& value : equation.keys()) keys.push_back(value.name);
  if (!file->Map(node, key, keys)) return effect;

  if (equation.joints() != EffectJoints::kNone) {
    const std::string expected = equation.joints() == EffectJoints::kTwo ? "a list of two joints" : "a list of joints";
    const std::string joints_key = KeyPath(key, "joints");
    if (!file->Require(node, key, "joints", expected)) return effect;
    effect.joints = file->Joints(node["joints"], joints_key, scenario.robot.dof(), expected);
  }
  for (const EffectKey& value : equation.keys()) {
    const YAML::Node given = node[value.name];
    if (given.IsDefined()) effect.values[value.name] = file->Number(given, KeyPath(key, value.name));
  }
  if (node["recording"].IsDefined()) {
    std::vector<std::string> names;
    for (const ScenarioRecording& recording : scenario.recordings) names.push_back(recording.name);
    const int chosen = file->Choice(node["recording"], KeyPath(key, "recording"), names);
    if (file->ok()) effect.recording = names[chosen];
  }
  return effect;
}

}  // namespace

void ReadEffects(YamlFile* file, const YAML::Node& node, const EffectEquationList& equations, Scenario* scenario) {
  if (!file->ok() || !node.IsDefined() || !file->List(node, "effects", "a list of effects")) return;
  for (size_t k = 0; k < node.size() && file->ok(); ++k) {
    const std::string key = KeyPath("effects", k);
    scenario->effects.push_back(ReadOne(file, node[k], key, equations, *scenario));
    if (!file->ok()) return;
    const Status status = CheckEffects(*scenario);
    // The message names the effect, as the key does.
    if (!status.ok()) file->Fail(node[k], key, status.message().substr(status.message().find(": ") + 2), "");
  }
}

}  // namespace idim::internal
