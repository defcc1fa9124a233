#include "core/model/active_effects.h"

#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/effects/effect_motion.h"

namespace idim {
namespace {

using Eigen::VectorXd;

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
  const Data& data = *prepared.data;
  std::vector<EffectMotion> motions;
  const int base = prepared.base().size();
  for (size_t r = 0; r < data.recordings.size(); ++r) {
    motions.push_back(MakeEffectMotion(prepared.base(), data.recordings[r].states, static_cast<int>(r),
                                       data.velocity_sigma, arm.chi.head(base), arm.Carried(prepared.model.roles[r]),
                                       data.position_sigma));
    motions.back().derivative_cutoff_hz = kDerivativeBand * data.preprocessing.cutoff_hz;
    for (const EffectEntry& entry : prepared.model.columns->of_recording[r]) {
      motions.back().torque.col(entry.joint) += arm.chi[base + entry.parameter] * entry.torque;
    }
  }
  return motions;
}

Model WithEffects(const PreparedStudy& prepared, const std::vector<ActiveEffect>& effects,
                  const std::vector<EffectMotion>& motions) {
  CHECK_EQ(motions.size(), prepared.data->recordings.size());
  EffectColumns columns;
  columns.of_recording.resize(motions.size());
  for (const ActiveEffect& active : effects) {
    const int first = static_cast<int>(columns.parameters.size());
    const std::vector<Parameter> linear = active.effect->Parameters(prepared.robot(), active.joints);
    const std::vector<ShapeParameter> shapes = active.effect->Shapes(motions, active.joints);
    CHECK_EQ(static_cast<size_t>(active.shape.size()), shapes.size()) << active.effect->id();
    const bool with_shapes = active.values.size() > 0;
    columns.parameters.insert(columns.parameters.end(), linear.begin(), linear.end());
    for (size_t k = 0; with_shapes && k < shapes.size(); ++k) {
      columns.parameters.push_back({ShapeParameterName(active.effect->id(), shapes[k].name, active.joints),
                                    ParameterKind::kEffectShape, active.joints.empty() ? 0 : active.joints[0] + 1,
                                    shapes[k].unit});
    }
    for (size_t r = 0; r < motions.size(); ++r) {
      std::vector<EffectEntry>& entries = columns.of_recording[r];
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
  Model model = prepared.model;
  model.effects = effects;
  model.columns = std::make_shared<const EffectColumns>(std::move(columns));
  return model;
}

Model WithoutEffects(const Model& model) {
  Model result = model;
  EffectColumns none;
  none.of_recording.resize(model.roles.size());
  result.effects.clear();
  result.columns = std::make_shared<const EffectColumns>(std::move(none));
  return result;
}

Model ForRecordings(const Model& model, const std::vector<int>& indices) {
  std::vector<RecordingRole> roles;
  for (const int r : indices) roles.push_back(model.roles[static_cast<size_t>(r)]);
  return ForRecordings(model, indices, roles);
}

Model ForRecordings(const Model& model, const std::vector<int>& indices, const std::vector<RecordingRole>& roles) {
  CHECK_EQ(indices.size(), roles.size());
  const EffectColumns& all = *model.columns;
  EffectColumns columns;
  for (const int r : indices) columns.of_recording.push_back(all.of_recording[static_cast<size_t>(r)]);
  Model result = model;
  result.roles = roles;
  result.effects.clear();
  const Unknowns unknowns(model, UncertainPayload::kExact);
  std::vector<int> index(all.parameters.size(), -1);
  for (size_t e = 0; e < model.effects.size(); ++e) {
    const int begin = unknowns.effect(e).at - unknowns.first_effect();
    const int end = unknowns.effect(e).end() - unknowns.first_effect();
    bool acts = false;
    for (const std::vector<EffectEntry>& entries : columns.of_recording) {
      for (const EffectEntry& entry : entries) acts |= entry.parameter >= begin && entry.parameter < end;
    }
    if (!acts) continue;
    result.effects.push_back(model.effects[e]);
    for (auto k = static_cast<size_t>(begin); k < static_cast<size_t>(end); ++k) {
      index[k] = static_cast<int>(columns.parameters.size());
      columns.parameters.push_back(all.parameters[k]);
    }
  }
  for (std::vector<EffectEntry>& entries : columns.of_recording) {
    for (EffectEntry& entry : entries) entry.parameter = index[static_cast<size_t>(entry.parameter)];
  }
  result.columns = std::make_shared<const EffectColumns>(std::move(columns));
  return result;
}

std::string ShapeParameterName(const std::string& effect_id, const std::string& shape, const std::vector<int>& joints) {
  std::string name = effect_id + "_" + shape;
  for (const int joint : joints) name += "_" + std::to_string(joint + 1);
  return name;
}

std::vector<ShapeParameter> ShapesAlong(const PreparedStudy& prepared, const Effect& effect,
                                        const std::vector<int>& joints) {
  std::vector<EffectMotion> motions;
  for (size_t r = 0; r < prepared.data->recordings.size(); ++r) {
    EffectMotion motion;
    motion.robot = &prepared.robot();
    motion.recording = static_cast<int>(r);
    motion.states = prepared.data->recordings[r].states;
    motion.velocity_sigma = prepared.data->velocity_sigma;
    motion.position_sigma = prepared.data->position_sigma;
    motions.push_back(std::move(motion));
  }
  return effect.Shapes(motions, joints);
}

StatedModel AsStated(const PreparedStudy& prepared, const ArmParameters& arm) {
  StatedModel stated{prepared, arm};
  if (prepared.model.effects.empty()) return stated;
  const int base = prepared.base().size();
  const Unknowns unknowns(prepared.model, UncertainPayload::kExact);
  std::vector<ActiveEffect> effects = prepared.model.effects;
  std::vector<double> chi(arm.chi.data(), arm.chi.data() + base);
  for (size_t e = 0; e < effects.size(); ++e) {
    ActiveEffect& active = effects[e];
    const auto [at, linear, free] = unknowns.effect(e);
    const double* const values = arm.chi.data() + at - unknowns.first_base();
    chi.insert(chi.end(), values, values + linear);
    active.values.resize(0);
    if (free == 0) continue;
    const std::vector<ShapeParameter> shapes = ShapesAlong(prepared, *active.effect, active.joints);
    for (size_t s = 0; s < shapes.size(); ++s) {
      double& shape = active.shape[static_cast<Eigen::Index>(s)];
      shape = std::clamp(shape + values[linear + static_cast<int>(s)], std::min(shapes[s].lower, shape),
                         std::max(shapes[s].upper, shape));
    }
  }
  // Without effects, with those that the model without gives, with those of that.
  stated.prepared.model = WithoutEffects(prepared.model);
  stated.arm.chi = VectorXd::Map(chi.data(), base);
  for (int round = 0; round < 2; ++round) {
    stated.prepared.model = WithEffects(stated.prepared, effects, MotionsOf(stated.prepared, stated.arm));
    stated.arm.chi = VectorXd::Map(chi.data(), static_cast<Eigen::Index>(chi.size()));
  }
  return stated;
}

}  // namespace idim
