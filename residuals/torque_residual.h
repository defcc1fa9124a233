// What torque at a deviated joint state leaves of a measured signal, in signal units.
//
// With the columns Wbar = [W | known torque] of a sample (n x (c + 1), the coefficient of the last is 1), their
// derivatives Wbar_s by each of the 3n entries of the joint state (q, dq, ddq), and the deviation d of the true state
// from the measured one,
//   y = M^-1 (Wbar + sum_s d_s Wbar_s) (chi; 1),     r_j = (v_j - y_j / g_j) / sigma_j,     j = 1..n.
// Blocks: theta = (g, chi), n + c; d, 3n. cov(r) = I at the truth, sigma the standard deviation of the signal. Linear
// in each of chi, d and 1/g, so that
//   dr_j/dg_j   = y_j / (g_j^2 sigma_j)
//   dr_j/dchi_i = -(M^-1 (Wbar + sum_s d_s Wbar_s))_ji / (g_j sigma_j)
//   dr_j/dd_s   = -(M^-1 Wbar_s (chi; 1))_j / (g_j sigma_j).
// Holds 3n matrices a sample: for reference problems of a few hundred samples.

#ifndef IDIM_RESIDUALS_TORQUE_RESIDUAL_H_
#define IDIM_RESIDUALS_TORQUE_RESIDUAL_H_

#include <ceres/cost_function.h>
#include <glog/logging.h>

#include <Eigen/Core>
#include <utility>
#include <vector>

namespace idim {

class TorqueResidual : public ceres::CostFunction {
 public:
  using RowMajorMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  // columns: n x (c + 1) [N.m or N a unit]; derivatives: 3n of them, each n x (c + 1); signal, sigma: n [signal unit];
  // inverse_drive: M^-1, n x n.
  static ceres::CostFunction* Create(const RowMajorMatrix& columns, const std::vector<RowMajorMatrix>& derivatives,
                                     const Eigen::VectorXd& signal, const Eigen::VectorXd& sigma,
                                     const Eigen::MatrixXd& inverse_drive) {
    std::vector<RowMajorMatrix> driven;
    for (const RowMajorMatrix& derivative : derivatives) driven.push_back(inverse_drive * derivative);
    return new TorqueResidual(inverse_drive * columns, std::move(driven), signal, sigma);
  }

  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override {
    const Eigen::Index n = signal_.size(), c = columns_.cols() - 1;
    const Eigen::Map<const Eigen::VectorXd> gains(blocks[0], n), deviation(blocks[1], 3 * n);
    if ((gains.array() == 0.0).any()) return false;
    Eigen::VectorXd chi(c + 1);
    chi << Eigen::Map<const Eigen::VectorXd>(blocks[0] + n, c), 1.0;
    RowMajorMatrix columns = columns_;
    for (Eigen::Index s = 0; s < 3 * n; ++s) columns += deviation[s] * derivatives_[s];
    const Eigen::VectorXd torque = columns * chi;
    Eigen::Map<Eigen::VectorXd>(residuals, n) = (signal_ - torque.cwiseQuotient(gains)).cwiseQuotient(sigma_);
    if (jacobians == nullptr) return true;
    const Eigen::VectorXd unit = (gains.array() * sigma_.array()).inverse();
    if (jacobians[0] != nullptr) {
      Eigen::Map<RowMajorMatrix> by_theta(jacobians[0], n, n + c);
      by_theta.leftCols(n) = Eigen::VectorXd(torque.cwiseQuotient(gains).cwiseProduct(unit)).asDiagonal();
      by_theta.rightCols(c) = -(unit.asDiagonal() * columns.leftCols(c));
    }
    if (jacobians[1] != nullptr) {
      Eigen::Map<RowMajorMatrix> by_deviation(jacobians[1], n, 3 * n);
      for (Eigen::Index s = 0; s < 3 * n; ++s) {
        by_deviation.col(s) = -unit.cwiseProduct(derivatives_[s] * chi);
      }
    }
    return true;
  }

 private:
  TorqueResidual(RowMajorMatrix columns, std::vector<RowMajorMatrix> derivatives, Eigen::VectorXd signal,
                 Eigen::VectorXd sigma)
      : columns_(std::move(columns)),
        derivatives_(std::move(derivatives)),
        signal_(std::move(signal)),
        sigma_(std::move(sigma)) {
    const Eigen::Index n = signal_.size();
    CHECK_EQ(columns_.rows(), n);
    CHECK_EQ(static_cast<Eigen::Index>(derivatives_.size()), 3 * n);
    CHECK_EQ(sigma_.size(), n);
    CHECK((sigma_.array() > 0.0).all());
    set_num_residuals(static_cast<int>(n));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(n + columns_.cols() - 1));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(3 * n));
  }

  const RowMajorMatrix columns_;                   // M^-1 Wbar
  const std::vector<RowMajorMatrix> derivatives_;  // M^-1 Wbar_s
  const Eigen::VectorXd signal_, sigma_;
};

}  // namespace idim

#endif  // IDIM_RESIDUALS_TORQUE_RESIDUAL_H_
