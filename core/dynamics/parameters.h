// What a column of a torque model is called and what it means.

#ifndef IDIM_CORE_DYNAMICS_PARAMETERS_H_
#define IDIM_CORE_DYNAMICS_PARAMETERS_H_

#include <string>
#include <vector>

namespace idim {

enum class ParameterKind { kDriveGain, kBase, kFriction, kDriveInertia, kPayload, kEffect, kEffectShape };

// "drive_gain", "base", ... as in estimate.json, where a shape is an "effect" too.
const char* ParameterKindName(ParameterKind kind);

// A linear parameter of an effect, or a shape.
inline bool IsOfEffect(ParameterKind kind) {
  return kind == ParameterKind::kEffect || kind == ParameterKind::kEffectShape;
}

struct Parameter {
  std::string name;  // "ZZ1", "Fv3", "Iam6"
  ParameterKind kind = ParameterKind::kBase;
  int joint = 0;  // one-based; the last link's for a payload
  std::string unit;
};

// Units of the ten inertial parameters, Ia, Fv, Fs and off, by StandardIndex; friction and drive inertia of a prismatic
// joint are forces and masses.
std::string StandardUnit(int standard_index, bool prismatic);

}  // namespace idim

#endif  // IDIM_CORE_DYNAMICS_PARAMETERS_H_
