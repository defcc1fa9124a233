#include "solvers/active_effects.h"

#include <glog/logging.h>

#include <algorithm>
#include <cmath>

#include "core/effects/effect_motion.h"

namespace idim {
namespace {

using Eigen::VectorXd;

int LinearCount(const PreparedStudy& prepared, const ActiveEffect& active) {
  return static_cast<int>(active.effect->Parameters(prepared.study.robot, active.joints).size());
}

// Central difference, within the limits, by a small part of the shape.
void AddSensitivity(const ActiveEffect& active, const ShapeParameter& shape, int k, const EffectMotion& motion,
                    int parameter, std::vector<EffectEntry>* entries) {
  const double step = std::max(1e-4 * std::abs(active.shape[k]), 1e-6 * (shape.upper - shape.lower));
  VectorXd above = active.shape, below = active.shape;
  above[k] = std::min(shape.upper, above[k] + step);
  below[k] = std::max(shape.lower, below[k] - step);
  const double width = above[k] - below[k];
  for (const bool up : {true, false}) {
    for (EffectEntry entry : active.effect->Columns(motion, active.joints, up ? above : below)) {
      entry.torque *= (up ? 1.0 : -1.0) * active.values[entry.parameter] / width;
      entry.parameter = parameter;
      entries->push_back(std::move(entry));
    }
  }
}

}  // namespace

std::string EffectTitle(const ActiveEffect& active) {
  std::string title = active.effect->id();
  for (size_t k = 0; k < active.joints.size(); ++k) {
    title += k > 0 ? " and " : active.joints.size() > 1 ? " on joints " : " on joint ";
    title += std::to_string(active.joints[k] + 1);
  }
  return title;
}

bool SameEffect(const ActiveEffect& a, const ActiveEffect& b) { return a.effect == b.effect && a.joints == b.joints; }

std::vector<EffectMotion> MotionsOf(const PreparedStudy& prepared, const ArmParameters& arm) {
  std::vector<EffectMotion> motions;
  const int base = prepared.base.size();
  for (size_t r = 0; r < prepared.recordings.size(); ++r) {
    const PreparedRecording& recording = prepared.recordings[r];
    motions.push_back(MakeEffectMotion(prepared.base, recording.states, static_cast<int>(r), prepared.velocity_sigma,
                                       arm.chi.head(base), arm.Carried(recording.entry), prepared.position_sigma));
    motions.back().derivative_cutoff_hz = kDerivativeBand * prepared.preprocessing.cutoff_hz;
    for (const EffectEntry& entry : recording.effects) {
      motions.back().torque.col(entry.joint) += arm.chi[base + entry.parameter] * entry.torque;
    }
  }
  return motions;
}

void SetEffects(const std::vector<ActiveEffect>& effects, const std::vector<EffectMotion>& motions,
                PreparedStudy* prepared) {
  CHECK_EQ(motions.size(), prepared->recordings.size());
  prepared->effects = effects;
  prepared->effect_parameters.clear();
  for (PreparedRecording& recording : prepared->recordings) recording.effects.clear();
  for (const ActiveEffect& active : effects) {
    const int first = static_cast<int>(prepared->effect_parameters.size());
    const std::vector<Parameter> linear = active.effect->Parameters(prepared->study.robot, active.joints);
    const std::vector<ShapeParameter> shapes = active.effect->Shapes(motions, active.joints);
    CHECK_EQ(static_cast<size_t>(active.shape.size()), shapes.size()) << active.effect->id();
    const bool with_shapes = active.values.size() > 0;
    prepared->effect_parameters.insert(prepared->effect_parameters.end(), linear.begin(), linear.end());
    for (size_t k = 0; with_shapes && k < shapes.size(); ++k) {
      std::string name = shapes[k].name;
      for (const int joint : active.joints) name += "_" + std::to_string(joint + 1);
      prepared->effect_parameters.push_back({active.effect->id() + "_" + name, ParameterKind::kEffect,
                                             active.joints.empty() ? 0 : active.joints[0] + 1, shapes[k].unit});
    }
    for (size_t r = 0; r < motions.size(); ++r) {
      std::vector<EffectEntry>& entries = prepared->recordings[r].effects;
      for (EffectEntry entry : active.effect->Columns(motions[r], active.joints, active.shape)) {
        entry.parameter += first;
        entries.push_back(std::move(entry));
      }
      for (size_t k = 0; with_shapes && k < shapes.size(); ++k) {
        AddSensitivity(active, shapes[k], static_cast<int>(k), motions[r], first + static_cast<int>(linear.size() + k),
                       &entries);
      }
    }
  }
}

std::vector<int> FirstParameters(const PreparedStudy& prepared) {
  std::vector<int> first = {0};
  for (const ActiveEffect& active : prepared.effects) {
    const int shapes = active.values.size() > 0 ? static_cast<int>(active.shape.size()) : 0;
    first.push_back(first.back() + LinearCount(prepared, active) + shapes);
  }
  return first;
}

}  // namespace idim
