#include "core/model/active_effects.h"

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
      prepared->effect_parameters.push_back({ShapeParameterName(active.effect->id(), shapes[k].name, active.joints),
                                             ParameterKind::kEffectShape,
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

std::string ShapeParameterName(const std::string& effect_id, const std::string& shape, const std::vector<int>& joints) {
  std::string name = effect_id + "_" + shape;
  for (const int joint : joints) name += "_" + std::to_string(joint + 1);
  return name;
}

std::vector<ShapeParameter> ShapesAlong(const PreparedStudy& prepared, const Effect& effect,
                                        const std::vector<int>& joints) {
  std::vector<EffectMotion> motions;
  for (size_t r = 0; r < prepared.recordings.size(); ++r) {
    const JointStates& states = prepared.recordings[r].states;
    EffectMotion motion;
    motion.robot = &prepared.study.robot;
    motion.recording = static_cast<int>(r);
    motion.t = states.t;
    motion.q = states.q;
    motion.dq = states.dq;
    motion.ddq = states.ddq;
    motion.velocity_sigma = prepared.velocity_sigma;
    motion.position_sigma = prepared.position_sigma;
    motions.push_back(std::move(motion));
  }
  return effect.Shapes(motions, joints);
}

VectorXd ShapeOffsets(const PreparedStudy& prepared) {
  VectorXd offsets = VectorXd::Zero(static_cast<Eigen::Index>(prepared.effect_parameters.size()));
  const std::vector<int> first = FirstParameters(prepared);
  for (size_t e = 0; e < prepared.effects.size(); ++e) {
    const int linear = LinearCount(prepared, prepared.effects[e]);
    const int shapes = first[e + 1] - first[e] - linear;
    offsets.segment(first[e] + linear, shapes) = prepared.effects[e].shape.head(shapes);
  }
  return offsets;
}

StatedModel AsStated(const PreparedStudy& prepared, const ArmParameters& arm) {
  StatedModel stated{prepared, arm};
  if (prepared.effects.empty()) return stated;
  const int base = prepared.base.size();
  const std::vector<int> first = FirstParameters(prepared);
  std::vector<ActiveEffect> effects = prepared.effects;
  std::vector<double> chi(arm.chi.data(), arm.chi.data() + base);
  for (size_t e = 0; e < effects.size(); ++e) {
    ActiveEffect& active = effects[e];
    const int linear = LinearCount(prepared, active);
    const double* const values = arm.chi.data() + base + first[e];
    chi.insert(chi.end(), values, values + linear);
    active.values.resize(0);
    if (first[e + 1] - first[e] == linear) continue;
    const std::vector<ShapeParameter> shapes = ShapesAlong(prepared, *active.effect, active.joints);
    for (size_t s = 0; s < shapes.size(); ++s) {
      double& shape = active.shape[static_cast<Eigen::Index>(s)];
      shape = std::clamp(shape + values[linear + static_cast<int>(s)], std::min(shapes[s].lower, shape),
                         std::max(shapes[s].upper, shape));
    }
  }
  // Without effects, with those that the model without gives, with those of that.
  PreparedStudy& model = stated.prepared;
  SetEffects({}, std::vector<EffectMotion>(model.recordings.size()), &model);
  stated.arm.chi = VectorXd::Map(chi.data(), base);
  for (int round = 0; round < 2; ++round) {
    const std::vector<EffectMotion> motions = MotionsOf(model, stated.arm);
    SetEffects(effects, motions, &model);
    stated.arm.chi = VectorXd::Map(chi.data(), static_cast<Eigen::Index>(chi.size()));
  }
  return stated;
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
