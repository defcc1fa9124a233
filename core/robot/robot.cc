#include "core/robot/robot.h"

#include <Eigen/Geometry>

namespace idim {

Joint JointFromModifiedDh(JointType type, double alpha, double d, double theta, double r) {
  // Rot_z(theta) commutes with Trans_z(r) and with the motion of the joint, so all constants go in front.
  const Eigen::Matrix3d rot_x = Eigen::AngleAxisd(alpha, Eigen::Vector3d::UnitX()).toRotationMatrix();
  const Eigen::Matrix3d rot_z = Eigen::AngleAxisd(theta, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  Joint joint;
  joint.type = type;
  joint.rotation = rot_x * rot_z;
  joint.translation = Eigen::Vector3d(d, 0.0, 0.0) + rot_x * Eigen::Vector3d(0.0, 0.0, r);
  return joint;
}

}  // namespace idim
