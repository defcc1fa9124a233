// One recording as the estimators see it: joint positions and control signals on the recorded clock.

#ifndef IDIM_CORE_RECORDING_RECORDING_H_
#define IDIM_CORE_RECORDING_RECORDING_H_

#include <Eigen/Core>
#include <string>

namespace idim {

struct Recording {
  std::string name;
  Eigen::VectorXd t;       // [s], N, strictly increasing, as recorded (jitter and all)
  Eigen::MatrixXd q;       // N x n joint side [rad or m]
  Eigen::MatrixXd signal;  // N x n, on the side that the study declares, in the controller's unit
  // Joint velocities and accelerations where the controller logged them; else 0 x 0.
  Eigen::MatrixXd logged_dq;
  Eigen::MatrixXd logged_ddq;
  bool signal_is_torque = false;  // the file has tau1.. in place of v1..: `signal` is joint torque [N.m], gains are 1

  int samples() const { return static_cast<int>(t.size()); }
  int dof() const { return static_cast<int>(q.cols()); }
};

}  // namespace idim

#endif  // IDIM_CORE_RECORDING_RECORDING_H_
