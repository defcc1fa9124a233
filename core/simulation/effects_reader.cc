#include "core/simulation/effects_reader.h"

#include <string>
#include <vector>

#include "core/simulation/effects_truth.h"

namespace idim::internal {
namespace {

SimulatedEffect ReadOne(YamlFile* file, const YAML::Node& node, const std::string& key, const Scenario& scenario) {
  SimulatedEffect effect;
  if (!node.IsMap()) {
    file->Fail(node, key, "not a mapping", "{id: .., joints: [..], ..}");
    return effect;
  }
  std::vector<std::string> ids;
  for (const SimulatedEffectKind& kind : SimulatedEffectKinds()) ids.push_back(kind.id);
  if (!file->Require(node, key, "id", "the id of an effect")) return effect;
  const SimulatedEffectKind& kind = SimulatedEffectKinds()[file->Choice(node["id"], KeyPath(key, "id"), ids)];
  effect.id = kind.id;
  std::vector<std::string> keys = {"id", "recording"};
  if (kind.joints != EffectJoints::kNone) keys.push_back("joints");
  for (const SimulatedEffectKey& value : kind.keys) keys.push_back(value.name);
  if (!file->Map(node, key, keys)) return effect;

  if (kind.joints != EffectJoints::kNone) {
    const std::string expected = kind.joints == EffectJoints::kTwo ? "a list of two joints" : "a list of joints";
    const std::string joints_key = KeyPath(key, "joints");
    if (!file->Require(node, key, "joints", expected)) return effect;
    effect.joints = file->Joints(node["joints"], joints_key, scenario.robot.dof(), expected);
  }
  for (const SimulatedEffectKey& value : kind.keys) {
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

void ReadEffects(YamlFile* file, const YAML::Node& node, Scenario* scenario) {
  if (!file->ok() || !node.IsDefined() || !file->List(node, "effects", "a list of effects")) return;
  for (size_t k = 0; k < node.size() && file->ok(); ++k) {
    const std::string key = KeyPath("effects", k);
    scenario->effects.push_back(ReadOne(file, node[k], key, *scenario));
    if (!file->ok()) return;
    const Status status = CheckEffects(*scenario);
    // The message names the effect, as the key does.
    if (!status.ok()) file->Fail(node[k], key, status.message().substr(status.message().find(": ") + 2), "");
  }
}

}  // namespace idim::internal
