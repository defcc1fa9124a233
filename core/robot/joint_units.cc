#include "core/robot/joint_units.h"

#include <algorithm>
#include <functional>
#include <vector>

#include "core/base/text.h"

namespace idim {

JointUnits UnitsOf(JointType type) {
  if (type == JointType::kPrismatic) return {"m", "m/s", "N", "N.s/m", "kg"};
  return {"rad", "rad/s", "N.m", "N.m.s/rad", "kg.m^2"};
}

JointUnits UnitsOf(const Robot& robot, int joint) { return UnitsOf(robot.joints.at(static_cast<size_t>(joint)).type); }

std::string GainUnit(const Robot& robot, int joint, Side signal_side) {
  const JointUnits units = signal_side == Side::kMotor ? UnitsOf(JointType::kRevolute) : UnitsOf(robot, joint);
  return units.torque + " per signal unit";
}

std::string TorqueUnits(const Robot& robot) {
  std::vector<std::string> units;
  for (const Joint& joint : robot.joints) units.push_back(UnitsOf(joint.type).torque);
  const bool same = std::adjacent_find(units.begin(), units.end(), std::not_equal_to<>()) == units.end();
  if (same && !units.empty()) units.resize(1);
  return Join(units, ", ");
}

}  // namespace idim
