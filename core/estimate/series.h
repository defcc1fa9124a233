// Measured and modelled torque along a recording, for residuals.csv and the pictures.

#ifndef IDIM_CORE_ESTIMATE_SERIES_H_
#define IDIM_CORE_ESTIMATE_SERIES_H_

#include <Eigen/Core>
#include <string>
#include <vector>

namespace idim {

// Joint side, [N.m or N]; n columns.
struct RecordingSeries {
  std::string name;
  std::string use;
  // At the recorded instants: unfiltered torque and the model's.
  Eigen::VectorXd t;
  Eigen::MatrixXd torque, model;
  // Decimated: both sides through the same filter.
  Eigen::VectorXd decimated_t;
  Eigen::MatrixXd decimated_q, decimated_dq, decimated_torque, decimated_model;
};

// The decimated samples as CSV: recording,use,t,q1..qn,dq1..dqn,tau1..taun,model1..modeln,residual1..residualn.
std::string ResidualsToCsv(const std::vector<RecordingSeries>& series);

}  // namespace idim

#endif  // IDIM_CORE_ESTIMATE_SERIES_H_
