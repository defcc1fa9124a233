// The errors-in-variables bundle with every latent joint state explicit, in Ceres: the reference that the closed form
// (solvers/bundle/bundle.h) must reproduce, and the form that takes a robust loss.
//
// One block theta = (g, chi, chi_uL) and one block d_k of 3n a sample; torque, joint-state and prior residuals of
// residuals/. Solved by Levenberg-Marquardt on the Schur complement of the latents (DENSE_SCHUR, latents first in the
// elimination order), from d_k = 0. The standard deviations of the signals are given, not estimated.
//
// The derivative of a sample's columns is held in full, 3n matrices of n x (unknowns - n + 1), 50 kB for a 6R arm: for
// a few hundred samples. The torque's derivative D(chi) is put together from those of the columns, by another route
// than the closed form takes.
//
// Huber's loss acts on the norm of a sample's torque residual (all joints together) after the latent has taken its
// part; joint data and priors are never down-weighted. With it, the cost is no more that of the closed form, and the
// covariance is that of the down-weighted rows (Triggs et al. 2000), which is not a consistent one.

#ifndef IDIM_SOLVERS_BUNDLE_CERES_BUNDLE_H_
#define IDIM_SOLVERS_BUNDLE_CERES_BUNDLE_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/base/status.h"
#include "core/dynamics/base_parameters.h"
#include "solvers/bundle/bundle.h"
#include "solvers/bundle/bundle_data.h"

namespace idim {

struct CeresBundleOptions {
  Eigen::VectorXd signal_sigma;       // n [signal unit], > 0
  std::vector<BundlePrior> priors;    // as BundleOptions::priors
  double huber_threshold = 0.0;       // in standard deviations of the norm of a sample's torque residual; 0: no loss
  int max_iterations = 500;           // >= 1
  double function_tolerance = 1e-15;  // converged: the cost changes by less than this fraction, > 0
  bool hold_unknowns = false;         // only the latents move: cost and covariance at the start
  bool covariance = true;             // of theta

  bool IsValid(std::string* error) const;
};

struct CeresBundleSummary {
  Status status = Status::Untrusted("SolveCeresBundle was not called");
  CeresBundleOptions given;

  Eigen::VectorXd values;      // of BundleData::unknowns
  Eigen::MatrixXd deviations;  // samples x 3n, true minus measured joint state
  Eigen::MatrixXd covariance;  // of the unknowns; empty where not asked for or not converged
  // Sum of squared residuals (of rho(squares) with a loss): twice what Ceres calls the cost, as BundleSummary has it.
  double initial_cost = -1.0, final_cost = -1.0;
  bool converged = false;
  std::string brief;  // ceres::Solver::Summary::BriefReport()

  bool IsSolutionUsable() const { return status.ok(); }
};

// start: values of the unknowns, no gain zero. options valid, sizes that fit `data`, state covariances positive
// definite (CHECK). Untrusted: a gain of zero to start from, no convergence, a rank-deficient Jacobian.
CeresBundleSummary SolveCeresBundle(const BaseParameters& base, const BundleData& data, const Eigen::VectorXd& start,
                                    const CeresBundleOptions& options);

}  // namespace idim

#endif  // IDIM_SOLVERS_BUNDLE_CERES_BUNDLE_H_
