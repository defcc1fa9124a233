// Standard parameters of a robot that could exist, with given base parameters.
//
// Base parameters leave a subspace of standard parameters open, and not every point of it is a set of bodies with mass
// everywhere positive. Sought is the maximum a posteriori estimate
//   min sum ((B chi_st)_k - value_k)^2 / sigma_k^2  +  sum over links |theta|^2 / spread^2
// where every link's ten parameters come from log-Cholesky coordinates theta about a rough body (core/robot/
// log_cholesky.h): each link is physically consistent (positive definite pseudo-inertia; Wensing, Kim & Slotine, IEEE
// Robotics and Automation Letters 3(1), 2018) whatever theta is. Drive inertias and friction are kept at or above zero
// by bounds, offsets are free. Minimised by Levenberg-Marquardt (Ceres) from theta = 0, drives at the stated values.
// There may be other local minima; what counts is the distance that is reached, which the summary states.

#ifndef IDIM_SOLVERS_CONSISTENT_PLAUSIBLE_PARAMETERS_H_
#define IDIM_SOLVERS_CONSISTENT_PLAUSIBLE_PARAMETERS_H_

#include <Eigen/Core>
#include <string>

#include "core/dynamics/base_parameters.h"
#include "core/simulation/plausible_request.h"

namespace idim {

struct PlausibleSummary {
  std::string message = "FindPlausibleParameters() was not called";
  bool converged = false;
  int iterations = -1;
  Eigen::VectorXd chi;           // standard parameters, in the order of StandardModel::parameters()
  Eigen::VectorXd base;          // their base parameters
  Eigen::VectorXd distance;      // of request.base: (reached - stated) / standard deviation
  double largest_distance = -1;  // of those
  double prior_distance = -1;    // root mean square of theta / spread

  bool IsSolutionUsable() const { return converged; }
};

// CHECKs that the request fits the model (one body a link, indices in range).
PlausibleSummary FindPlausibleParameters(const BaseParameters& base, const PlausibleRequest& request);

}  // namespace idim

#endif  // IDIM_SOLVERS_CONSISTENT_PLAUSIBLE_PARAMETERS_H_
