// Base parameters: the least set from which the torque can be computed (Gautier 1991; paper II.A, eq. (2)).
//
// The standard model is sampled at random states (q, dq, ddq). Its columns are visited in their order: a column is kept
// if what the kept ones leave of it is more than `tolerance` of its norm (a QR decomposition whose dependent
// columns leave no direction); a column that is always zero has no effect on any torque. The dropped columns are
// combinations of the kept ones, W_d = W_k B, hence
//   chi = chi_k + B chi_d      (regrouping),      W_k chi = W_st chi_st for every state.
// Order link 1 to n keeps the parameters that the closed-form rules of Gautier & Khalil (1990) keep. The regressor of
// base parameters is a subset of the standard columns: no product is needed to evaluate it.
//
// Fails where geometry is nearly, but not exactly, special (a twist of 1.5708 for pi/2): such columns differ by
// less than any measurement can tell, so `tolerance` is far above rounding.

#ifndef IDIM_CORE_DYNAMICS_BASE_PARAMETERS_H_
#define IDIM_CORE_DYNAMICS_BASE_PARAMETERS_H_

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "core/dynamics/standard_model.h"

namespace idim {

struct BaseParameterOptions {
  double tolerance = 1e-5;  // relative to the norm of the column, in (0, 1)
  std::uint64_t seed = 1;   // of the random states
};

class BaseParameters {
 public:
  explicit BaseParameters(StandardModel model, const BaseParameterOptions& options = BaseParameterOptions());

  // Number of base parameters.
  int size() const { return static_cast<int>(kept_.size()); }
  // Indices of the kept standard columns, increasing.
  const std::vector<int>& kept() const { return kept_; }
  // size(); names as the paper writes them: "ZZ1R" where others are regrouped into it, else "Fv3".
  const std::vector<Parameter>& parameters() const { return parameters_; }
  // "ZZ1 + YY2 + 0.0506 M3 + Ia1", empty where nothing is regrouped.
  const std::vector<std::string>& regroupings() const { return regroupings_; }
  // Standard parameters without effect on any torque.
  const std::vector<std::string>& without_effect() const { return without_effect_; }
  // size() x number of standard parameters: chi = projection * chi_st.
  const Eigen::MatrixXd& projection() const { return projection_; }
  const StandardModel& model() const { return model_; }
  // Smallest remainder of a kept column and largest of a dropped one, relative to the column's norm: how clear the
  // decision was.
  double smallest_kept() const { return smallest_kept_; }
  double largest_dropped() const { return largest_dropped_; }

 private:
  StandardModel model_;
  std::vector<int> kept_;
  std::vector<Parameter> parameters_;
  std::vector<std::string> regroupings_;
  std::vector<std::string> without_effect_;
  Eigen::MatrixXd projection_;
  double smallest_kept_ = 1.0;
  double largest_dropped_ = 0.0;
};

}  // namespace idim

#endif  // IDIM_CORE_DYNAMICS_BASE_PARAMETERS_H_
