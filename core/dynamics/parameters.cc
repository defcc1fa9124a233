#include "core/dynamics/parameters.h"

#include <glog/logging.h>

#include "core/robot/inertia.h"
#include "core/robot/joint_units.h"

namespace idim {

const char* ParameterKindName(ParameterKind kind) {
  switch (kind) {
    case ParameterKind::kDriveGain:
      return "drive_gain";
    case ParameterKind::kBase:
      return "base";
    case ParameterKind::kFriction:
      return "friction";
    case ParameterKind::kDriveInertia:
      return "drive_inertia";
    case ParameterKind::kPayload:
      return "payload";
    case ParameterKind::kEffect:
    case ParameterKind::kEffectShape:
      return "effect";
  }
  LOG(FATAL) << "no such kind of parameter";
  return "";
}

std::string StandardUnit(int standard_index, bool prismatic) {
  CHECK_GE(standard_index, 0);
  CHECK_LT(standard_index, kNumStandard);
  if (standard_index < kMX) return "kg.m^2";
  if (standard_index < kM) return "kg.m";
  if (standard_index == kM) return "kg";
  const JointUnits units = UnitsOf(prismatic ? JointType::kPrismatic : JointType::kRevolute);
  if (standard_index == kIa) return units.inertia;
  if (standard_index == kFv) return units.damping;
  return units.torque;
}

}  // namespace idim
