// Random arms, parameters and states for identity tests; the seed says it all.

#ifndef IDIM_TESTS_SUPPORT_RANDOM_ARM_H_
#define IDIM_TESTS_SUPPORT_RANDOM_ARM_H_

#include <Eigen/Dense>
#include <cmath>
#include <vector>

#include "core/base/random.h"
#include "core/robot/robot.h"

namespace idim::testing {

// A physically consistent body: a random mass distribution of five point masses.
inline InertialVector RandomBody(Random* random) {
  Eigen::Matrix4d pseudo = Eigen::Matrix4d::Zero();
  for (int k = 0; k < 5; ++k) {
    Eigen::Vector4d point;
    point << random->Vector(3, 0.3), 1.0;
    pseudo += random->Uniform(0.2, 2.0) * point * point.transpose();
  }
  return InertialFromPseudoInertia(pseudo);
}

// `types`: 'R' or 'P' a joint; general twists, lengths and offsets.
inline Robot RandomArm(const std::string& types, Random* random) {
  Robot robot;
  robot.name = "random_" + types;
  for (const char type : types) {
    robot.joints.push_back(JointFromModifiedDh(type == 'R' ? JointType::kRevolute : JointType::kPrismatic,
                                               random->Uniform(-M_PI, M_PI), random->Uniform(-0.5, 0.5),
                                               random->Uniform(-M_PI, M_PI), random->Uniform(-0.5, 0.5)));
  }
  robot.gravity = random->Vector(3, 10.0);
  return robot;
}

// The Staubli TX-40 of the paper, with its 5-6 coupling.
inline Robot Tx40() {
  Robot robot;
  robot.name = "staubli_tx40";
  const double dh[6][4] = {{0.0, 0.0, 0.0, 0.0},      {-M_PI_2, 0.0, -M_PI_2, 0.0}, {0.0, 0.225, M_PI_2, 0.035},
                           {M_PI_2, 0.0, 0.0, 0.225}, {-M_PI_2, 0.0, 0.0, 0.0},     {M_PI_2, 0.0, M_PI, 0.0}};
  for (const auto& row : dh) {
    robot.joints.push_back(JointFromModifiedDh(JointType::kRevolute, row[0], row[1], row[2], row[3]));
  }
  robot.couplings.push_back({5, {4, 5}, {1.0, 1.0}});
  return robot;
}

// Pose of frame `link` (zero-based) in the base as a homogeneous matrix, by the product of the joints' transforms.
inline Eigen::Matrix4d Pose(const Robot& robot, const Eigen::VectorXd& q, int link) {
  Eigen::Matrix4d pose = Eigen::Matrix4d::Identity();
  for (int j = 0; j <= link; ++j) {
    Eigen::Matrix4d fixed = Eigen::Matrix4d::Identity();
    fixed.topLeftCorner<3, 3>() = robot.joints[j].rotation;
    fixed.topRightCorner<3, 1>() = robot.joints[j].translation;
    Eigen::Matrix4d motion = Eigen::Matrix4d::Identity();
    if (robot.joints[j].type == JointType::kRevolute) {
      motion.topLeftCorner<2, 2>() << std::cos(q[j]), -std::sin(q[j]), std::sin(q[j]), std::cos(q[j]);
    } else {
      motion(2, 3) = q[j];
    }
    pose = pose * fixed * motion;
  }
  return pose;
}

}  // namespace idim::testing

#endif  // IDIM_TESTS_SUPPORT_RANDOM_ARM_H_
