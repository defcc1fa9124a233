// Poses of the frames of a robot, straight from the definition in core/robot/robot.h.

#ifndef IDIM_TESTS_SUPPORT_FORWARD_KINEMATICS_H_
#define IDIM_TESTS_SUPPORT_FORWARD_KINEMATICS_H_

#include <Eigen/Geometry>

#include "core/robot/robot.h"

namespace idim {

// Of frame j in frame j-1.
inline Eigen::Isometry3d JointPose(const Joint& joint, double q) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = joint.rotation;
  pose.translation() = joint.translation;
  if (joint.type == JointType::kRevolute) {
    pose.rotate(Eigen::AngleAxisd(q, Eigen::Vector3d::UnitZ()));
  } else {
    pose.translate(Eigen::Vector3d(0.0, 0.0, q));
  }
  return pose;
}

// Of the last frame in the base.
inline Eigen::Isometry3d ForwardKinematics(const Robot& robot, const Eigen::VectorXd& q) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  for (int j = 0; j < robot.dof(); ++j) pose = pose * JointPose(robot.joints[j], q[j]);
  return pose;
}

}  // namespace idim

#endif  // IDIM_TESTS_SUPPORT_FORWARD_KINEMATICS_H_
