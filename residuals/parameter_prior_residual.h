// What is known of one unknown beforehand: a weighed mass, a value from CAD, an a priori gain.
//
//   r = (theta_i - value) / standard_deviation
// of the one block theta; dr/dtheta_i = 1 / standard_deviation, zero for the others. Variance 1 at the truth.

#ifndef IDIM_RESIDUALS_PARAMETER_PRIOR_RESIDUAL_H_
#define IDIM_RESIDUALS_PARAMETER_PRIOR_RESIDUAL_H_

#include <ceres/cost_function.h>
#include <glog/logging.h>

#include <algorithm>

namespace idim {

class ParameterPriorResidual : public ceres::CostFunction {
 public:
  // size: of theta; index: i in [0, size); standard_deviation > 0 (CHECK).
  static ceres::CostFunction* Create(int size, int index, double value, double standard_deviation) {
    return new ParameterPriorResidual(size, index, value, standard_deviation);
  }

  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override {
    residuals[0] = (blocks[0][index_] - value_) / standard_deviation_;
    if (jacobians != nullptr && jacobians[0] != nullptr) {
      std::fill_n(jacobians[0], size_, 0.0);
      jacobians[0][index_] = 1.0 / standard_deviation_;
    }
    return true;
  }

 private:
  ParameterPriorResidual(int size, int index, double value, double standard_deviation)
      : size_(size), index_(index), value_(value), standard_deviation_(standard_deviation) {
    CHECK(index >= 0 && index < size);
    CHECK_GT(standard_deviation, 0.0);
    set_num_residuals(1);
    mutable_parameter_block_sizes()->push_back(size);
  }

  const int size_, index_;
  const double value_, standard_deviation_;
};

}  // namespace idim

#endif  // IDIM_RESIDUALS_PARAMETER_PRIOR_RESIDUAL_H_
