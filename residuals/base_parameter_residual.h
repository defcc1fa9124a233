// How far the base parameters of consistent bodies and their drives are from stated ones.
//
//   r_k = ((B chi_st)_k - value_k) / sigma_k
// with chi_st made of the inertial parameters of every link, from its log-Cholesky coordinates (one block of 10 a
// link), and of all other standard parameters (the last block). Any linear map B will do: rows of the regrouping
// matrix, or unit rows for statements about standard parameters. cov(r) = I where the statements are independent.

#ifndef IDIM_RESIDUALS_BASE_PARAMETER_RESIDUAL_H_
#define IDIM_RESIDUALS_BASE_PARAMETER_RESIDUAL_H_

#include <ceres/dynamic_autodiff_cost_function.h>

#include <Eigen/Core>
#include <memory>
#include <utility>
#include <vector>

#include "core/robot/log_cholesky.h"

namespace idim {

class BaseParameterResidual {
 public:
  // map: residuals x standard parameters; link_begin: first inertial column of each link; drive_columns: columns of
  // the last block.
  BaseParameterResidual(Eigen::MatrixXd map, Eigen::VectorXd value, Eigen::VectorXd sigma,
                        std::vector<Eigen::Matrix4d> references, std::vector<int> link_begin,
                        std::vector<int> drive_columns)
      : map_(std::move(map)),
        value_(std::move(value)),
        sigma_(std::move(sigma)),
        references_(std::move(references)),
        link_begin_(std::move(link_begin)),
        drive_columns_(std::move(drive_columns)) {}

  static ceres::CostFunction* Create(std::unique_ptr<BaseParameterResidual> residual) {
    const int links = static_cast<int>(residual->references_.size());
    const int drives = static_cast<int>(residual->drive_columns_.size());
    const int residuals = static_cast<int>(residual->value_.size());
    auto* cost = new ceres::DynamicAutoDiffCostFunction<BaseParameterResidual, 10>(residual.release());
    for (int link = 0; link < links; ++link) cost->AddParameterBlock(kNumInertial);
    cost->AddParameterBlock(drives);
    cost->SetNumResiduals(residuals);
    return cost;
  }

  template <typename T>
  bool operator()(T const* const* blocks, T* residuals) const {
    Eigen::Matrix<T, Eigen::Dynamic, 1> chi = Eigen::Matrix<T, Eigen::Dynamic, 1>::Zero(map_.cols());
    for (size_t link = 0; link < references_.size(); ++link) {
      InertialFromLogCholesky(references_[link], blocks[link], &chi[link_begin_[link]]);
    }
    for (size_t k = 0; k < drive_columns_.size(); ++k) chi[drive_columns_[k]] = blocks[references_.size()][k];
    for (int k = 0; k < value_.size(); ++k) {
      T sum = T(-value_[k]);
      for (int c = 0; c < map_.cols(); ++c) {
        if (map_(k, c) != 0.0) sum += map_(k, c) * chi[c];
      }
      residuals[k] = sum / sigma_[k];
    }
    return true;
  }

 private:
  const Eigen::MatrixXd map_;
  const Eigen::VectorXd value_, sigma_;
  const std::vector<Eigen::Matrix4d> references_;
  const std::vector<int> link_begin_, drive_columns_;
};

}  // namespace idim

#endif  // IDIM_RESIDUALS_BASE_PARAMETER_RESIDUAL_H_
