// Uses the installed headers and the installed library: exit code 0 if frame 1 stands where the MDH row puts it.

#include <Eigen/Core>
#include <iostream>

#include "core/robot/robot.h"

int main() {
  const double half_pi = 1.5707963267948966;
  // T = Rot_x(pi/2) Trans_x(2) Rot_z(0) Trans_z(3): the z axis of the joint is -y of its parent.
  const idim::Joint joint = idim::JointFromModifiedDh(idim::JointType::kRevolute, half_pi, 2.0, 0.0, 3.0);
  const double error = (joint.translation - Eigen::Vector3d(2.0, -3.0, 0.0)).norm() +
                       (joint.rotation.col(2) - Eigen::Vector3d(0.0, -1.0, 0.0)).norm();
  std::cout << "distance from the expected frame: " << error << "\n";
  return error < 1e-12 ? 0 : 1;
}
