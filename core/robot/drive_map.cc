#include "core/robot/drive_map.h"

#include <glog/logging.h>

namespace idim {

DriveMap::DriveMap(const Robot& robot, Side signal_side) : dof_(robot.dof()) {
  if (signal_side == Side::kMotor) transmission_ = robot.transmission;
}

Eigen::MatrixXd DriveMap::Torque(const Eigen::VectorXd& gains, const Eigen::MatrixXd& signal) const {
  CHECK_EQ(gains.size(), dof_);
  CHECK_EQ(signal.cols(), dof_);
  const Eigen::MatrixXd torque = signal * gains.asDiagonal();
  if (transmission_.size() == 0) return torque;
  return torque * transmission_;  // rows are tau' = (T' diag(g) v)'
}

Eigen::MatrixXd DriveMap::Matrix(const Eigen::VectorXd& gains) const {
  return Torque(gains, Eigen::MatrixXd::Identity(dof_, dof_)).transpose();
}

}  // namespace idim
