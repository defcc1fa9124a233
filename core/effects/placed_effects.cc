#include "core/effects/placed_effects.h"

#include <algorithm>
#include <utility>

#include "core/base/text.h"

namespace idim {
namespace {

Status Refuse(const std::string& where, const std::string& problem, const std::string& expected) {
  return Status::BadInput(where + ": " + problem + "; expected " + expected);
}

Result<const Effect*> FindDeclared(const DeclaredEffect& declared) {
  const Effect* const effect = FindEffect(declared.id);
  if (effect == nullptr) {
    std::vector<std::string> ids;
    for (const Effect* known : AllEffects()) {
      if (!known->in_standard_model()) ids.push_back(known->id());
    }
    return Refuse(declared.id_where, "'" + Clip(declared.id) + "' is not known",
                  "one of " + Join(ids, ", ") + " (nearest: " + NearestName(declared.id, ids) + ")");
  }
  if (effect->in_standard_model()) {
    return Refuse(declared.id_where, "'" + declared.id + "' is part of the drive model",
                  "it in the list of key 'friction'");
  }
  return effect;
}

Status CheckJoints(const DeclaredEffect& declared, EffectSite site) {
  const std::string& where = declared.joints_where;
  const size_t count = declared.joints.size();
  if (site == EffectSite::kArm) {
    if (count == 0) return Status::Ok();
    return Refuse(where, "'" + declared.id + "' is an effect of the whole arm", "no joints");
  }
  if (site == EffectSite::kJointPair ? count != 2 : count == 0) {
    return Refuse(where, (count == 0 ? "missing: " : "") + std::to_string(count) + " joints for '" + declared.id + "'",
                  site == EffectSite::kJoint ? "a list of one or more" : "a list of two");
  }
  std::vector<int> sorted = declared.joints;
  std::sort(sorted.begin(), sorted.end());
  if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end()) {
    return Refuse(where, "a joint is given twice", "distinct joints");
  }
  return Status::Ok();
}

}  // namespace

Result<std::vector<PlacedEffect>> PlaceDeclaredEffects(const Study& study) {
  std::vector<PlacedEffect> placed;
  for (const DeclaredEffect& declared : study.effects) {
    const Result<const Effect*> effect = FindDeclared(declared);
    IDIM_RETURN_IF_ERROR(effect);
    const EffectSite site = (*effect)->site();
    IDIM_RETURN_IF_ERROR(CheckJoints(declared, site));
    std::vector<int> joints = declared.joints;
    std::sort(joints.begin(), joints.end());
    std::vector<std::vector<int>> places = {joints};
    if (site == EffectSite::kJoint) {
      places.clear();
      for (const int joint : joints) places.push_back({joint});
    }
    for (std::vector<int>& place : places) {
      for (const PlacedEffect& other : placed) {
        if (other.effect != *effect || other.joints != place) continue;
        const std::string on = place.empty() ? "" : " on joint " + std::to_string(place[0] + 1);
        return Refuse(declared.where, "'" + declared.id + "'" + on + " is given twice",
                      "one effect of an id at a place");
      }
      placed.push_back({*effect, std::move(place), declared.shape, declared.where});
    }
  }
  return placed;
}

}  // namespace idim
