// A serial arm: the geometry of its joints, gravity, the transmission and the couplings of its drives.
//
// Frame j is fixed to link j, with z along (revolute: about) joint j. Its pose in frame j-1 is
//   revolute:  Trans(translation) * rotation * Rot_z(q_j)
//   prismatic: Trans(translation) * rotation * Trans_z(q_j)
// which holds the modified Denavit-Hartenberg form of Khalil & Kleinfinger (1986),
// Rot_x(alpha) Trans_x(d) Rot_z(theta + q) Trans_z(r), and any serial URDF. Frame 0 is the base.

#ifndef IDIM_CORE_ROBOT_ROBOT_H_
#define IDIM_CORE_ROBOT_ROBOT_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/base/status.h"
#include "core/robot/inertia.h"

namespace idim {

enum class JointType { kRevolute, kPrismatic };

struct Joint {
  JointType type = JointType::kRevolute;
  std::string name;                                        // of the URDF joint, else "1", "2", ...
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();  // of frame j in frame j-1 at q = 0
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();   // [m] of the origin of frame j in frame j-1 at q = 0
};

// alpha, theta [rad], d, r [m]; theta (revolute) and r (prismatic) are the constant offsets of the joint variable.
Joint JointFromModifiedDh(JointType type, double alpha, double d, double theta, double r);

// The extra drive-chain terms of eq. (25): motor m turns with the weighted sum of the velocities of several
// joints, sum_j weight_j dq_j, and loads each of them with its inertia and friction.
struct Coupling {
  int motor = -1;               // zero-based
  std::vector<int> joints;      // zero-based, contains `motor`, at least two
  std::vector<double> weights;  // of `joints`: T(motor, j) / T(motor, motor), or 1 without a transmission
};

struct Robot {
  std::string name;
  Eigen::Vector3d gravity = Eigen::Vector3d(0.0, 0.0, -9.81);  // [m/s^2] in the base frame
  std::vector<Joint> joints;
  // n x n: motor position = transmission * joint position; its transpose maps motor torque to joint torque.
  Eigen::MatrixXd transmission;
  std::vector<Coupling> couplings;
  // Inertial parameters that a URDF declares, one a link, zero where it declares none; empty for MDH.
  std::vector<InertialVector> declared_inertials;

  int dof() const { return static_cast<int>(joints.size()); }
};

}  // namespace idim

#endif  // IDIM_CORE_ROBOT_ROBOT_H_
