// Units of what belongs to a joint, by its kind: the one place where pages, tables and messages take them from.

#ifndef IDIM_CORE_ROBOT_JOINT_UNITS_H_
#define IDIM_CORE_ROBOT_JOINT_UNITS_H_

#include <string>

#include "core/robot/drive_map.h"
#include "core/robot/robot.h"

namespace idim {

struct JointUnits {
  std::string position;  // "rad" or "m"
  std::string velocity;  // "rad/s" or "m/s"
  std::string torque;    // "N.m" or "N"
  std::string damping;   // "N.m.s/rad" or "N.s/m"
  std::string inertia;   // "kg.m^2" or "kg", of a drive
};

JointUnits UnitsOf(JointType type);
JointUnits UnitsOf(const Robot& robot, int joint);  // zero-based

// Of the drive gain of a joint (zero-based). On the motor side a gain makes the torque of a motor, which turns whatever
// its joint does.
std::string GainUnit(const Robot& robot, int joint, Side signal_side);

// Of a row with one torque a joint: "N.m" where all joints are of one kind, else one a joint, as in "N.m, N, N.m".
std::string TorqueUnits(const Robot& robot);

}  // namespace idim

#endif  // IDIM_CORE_ROBOT_JOINT_UNITS_H_
