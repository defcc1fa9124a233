// How far the true joint state of a sample is from the measured one, joint by joint.
//
//   r_(3j + a) = (L_j^-1 (d_q, d_dq, d_ddq)_j)_a,     C_j = L_j L_j',     j = 1..n, a = 0, 1, 2,
// with d = (q, dq, ddq) of all joints, 3n, true minus measured, and C_j the covariance of the measured state of joint
// j: its position and acceleration come from the same samples and are correlated. Joints are independent. cov(r) = I at
// the truth; dr/dd = L^-1, constant.

#ifndef IDIM_RESIDUALS_JOINT_STATE_RESIDUAL_H_
#define IDIM_RESIDUALS_JOINT_STATE_RESIDUAL_H_

#include <ceres/cost_function.h>
#include <glog/logging.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <utility>
#include <vector>

namespace idim {

class JointStateResidual : public ceres::CostFunction {
 public:
  // covariance: one a joint, of (q, dq, ddq), positive definite (CHECK) [rad, rad/s, rad/s^2]^2.
  static ceres::CostFunction* Create(const std::vector<Eigen::Matrix3d>& covariance) {
    const Eigen::Index n = static_cast<Eigen::Index>(covariance.size());
    RowMajorMatrix whitening = RowMajorMatrix::Zero(3 * n, 3 * n);
    for (Eigen::Index j = 0; j < n; ++j) {
      // Scaled to a unit diagonal: variances of position and acceleration are ten orders apart.
      const Eigen::Vector3d scale = covariance[j].diagonal().cwiseSqrt();
      const Eigen::LLT<Eigen::Matrix3d> llt(scale.cwiseInverse().asDiagonal() * covariance[j] *
                                            scale.cwiseInverse().asDiagonal());
      CHECK(llt.info() == Eigen::Success) << "covariance of joint " << j + 1 << " is not positive definite";
      const Eigen::Matrix3d inverse =
          Eigen::Matrix3d(llt.matrixL().solve(Eigen::Matrix3d::Identity())) * scale.cwiseInverse().asDiagonal();
      for (int a = 0; a < 3; ++a) {
        for (int b = 0; b <= a; ++b) whitening(3 * j + a, b * n + j) = inverse(a, b);
      }
    }
    return new JointStateResidual(std::move(whitening));
  }

  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override {
    const Eigen::Index size = whitening_.rows();
    Eigen::Map<Eigen::VectorXd>(residuals, size) = whitening_ * Eigen::Map<const Eigen::VectorXd>(blocks[0], size);
    if (jacobians != nullptr && jacobians[0] != nullptr) {
      Eigen::Map<RowMajorMatrix>(jacobians[0], size, size) = whitening_;
    }
    return true;
  }

 private:
  using RowMajorMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  explicit JointStateResidual(RowMajorMatrix whitening) : whitening_(std::move(whitening)) {
    set_num_residuals(static_cast<int>(whitening_.rows()));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(whitening_.rows()));
  }

  const RowMajorMatrix whitening_;  // 3n x 3n, L^-1 of every joint
};

}  // namespace idim

#endif  // IDIM_RESIDUALS_JOINT_STATE_RESIDUAL_H_
