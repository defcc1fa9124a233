// From the signals of the drives to the torques of the joints (paper eq. (13), (14)): tau = M diag(g) v.

#ifndef IDIM_CORE_ROBOT_DRIVE_MAP_H_
#define IDIM_CORE_ROBOT_DRIVE_MAP_H_

#include <Eigen/Core>

#include "core/robot/robot.h"

namespace idim {

// Of which a logged quantity is: the joints or the motors.
enum class Side { kJoint, kMotor };

class DriveMap {
 public:
  // M = 1 for signals on the joint side, T' on the motor side (T: Robot::transmission).
  DriveMap(const Robot& robot, Side signal_side);

  int dof() const { return dof_; }
  // N x n [N m or N], row by row. gains: n [N m or N per signal unit]; signal: N x n. Sizes are CHECKed.
  Eigen::MatrixXd Torque(const Eigen::VectorXd& gains, const Eigen::MatrixXd& signal) const;
  // n x n: M diag(gains).
  Eigen::MatrixXd Matrix(const Eigen::VectorXd& gains) const;
  // n x n: M.
  Eigen::MatrixXd Matrix() const { return Matrix(Eigen::VectorXd::Ones(dof_)); }

 private:
  int dof_;
  Eigen::MatrixXd transmission_;  // empty on the joint side
};

}  // namespace idim

#endif  // IDIM_CORE_ROBOT_DRIVE_MAP_H_
