#include "core/robot/joint_units.h"

#include <gtest/gtest.h>

#include "core/dynamics/parameters.h"
#include "core/robot/inertia.h"
#include "solvers/linear/gain_system.h"

namespace idim::joint_units_test {
namespace {

Robot Of(const std::vector<JointType>& types) {
  Robot robot;
  for (const JointType type : types) robot.joints.push_back(JointFromModifiedDh(type, 0.0, 0.0, 0.0, 0.0));
  return robot;
}

TEST(JointUnits, FollowTheKindOfTheJoint) {
  const Robot robot = Of({JointType::kRevolute, JointType::kPrismatic});
  EXPECT_EQ(UnitsOf(robot, 0).position, "rad");
  EXPECT_EQ(UnitsOf(robot, 0).velocity, "rad/s");
  EXPECT_EQ(UnitsOf(robot, 0).torque, "N.m");
  EXPECT_EQ(UnitsOf(robot, 1).position, "m");
  EXPECT_EQ(UnitsOf(robot, 1).velocity, "m/s");
  EXPECT_EQ(UnitsOf(robot, 1).torque, "N");
  EXPECT_EQ(StandardUnit(kFv, true), "N.s/m");
  EXPECT_EQ(StandardUnit(kFv, false), "N.m.s/rad");
  EXPECT_EQ(StandardUnit(kFs, true), "N");
  EXPECT_EQ(StandardUnit(kIa, true), "kg");
  EXPECT_EQ(StandardUnit(kIa, false), "kg.m^2");
}

TEST(JointUnits, ARowOfTorques) {
  EXPECT_EQ(TorqueUnits(Of({JointType::kRevolute, JointType::kRevolute})), "N.m");
  EXPECT_EQ(TorqueUnits(Of({JointType::kPrismatic})), "N");
  EXPECT_EQ(TorqueUnits(Of({JointType::kRevolute, JointType::kPrismatic, JointType::kRevolute})), "N.m, N, N.m");
}

TEST(JointUnits, OfGains) {
  const Robot robot = Of({JointType::kRevolute, JointType::kPrismatic});
  EXPECT_EQ(GainParameters(robot, Side::kJoint)[0].unit, "N.m per signal unit");
  EXPECT_EQ(GainParameters(robot, Side::kJoint)[1].unit, "N per signal unit");
  EXPECT_EQ(GainParameters(robot, Side::kMotor)[1].unit, "N.m per signal unit");
}

}  // namespace
}  // namespace idim::joint_units_test
