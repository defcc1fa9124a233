// The errors-in-variables bundle: maximum likelihood of gains, parameters and the true joint states of every sample.
//
// Unknown: theta = (g, chi, chi_uL) and for each decimated sample k the deviation d_k of the true joint state from the
// measured one. Residuals, in units of their standard deviations (solvers/bundle_data.h for the symbols):
//   torque, in signal units   S^-1/2 (v_k - diag(1/g) M^-1 tau_k(chi, d_k)),   S = diag(sigma_1^2, ..., sigma_n^2)
//   joint data                C_k^-1/2 d_k,                                    C_k: 3 x 3 blocks a joint
//   priors                    (theta_i - p_i) / s_i
// In units of the signal, not of torque: g v - W chi would be made small by small g and chi, which is the bias of LS.
//
// Each d_k enters linearly (tau is linearised about the measured state) and is eliminated in closed form: with
// B_k = diag(1/g) M^-1 D_k(chi) and r_k the torque residual at d_k = 0,
//   d_k = C B' V^-1 r_k,   V_k = S + B C B'  (n x n),   cost = sum r_k' V_k^-1 r_k + priors,
// and the Gauss-Newton step of the whole bundle, latents included, is that of the rows V_k^-1/2 [J_k(d_k) | r_k] with
// J the derivative by theta at d_k: the Schur complement of the latents, one n x n matrix a sample. Rows go into one
// triangular factor, so the cost is linear in the samples and its memory that of the samples. Steps are taken in 1/g,
// in which the residual is linear: a gain of the wrong sign passes through 1/g = 0, not through the pole at g = 0.
//
// Weights: sigma_j^2 is what the residual's mean square leaves after the joint data's share,
// sum_k r_kj^2 / (K - c / n) - mean (B C B')_jj, repeated until it settles. The c unknowns are shared between the n
// joints, and each joint bears an equal part of the freedom they take; its true part is not computed.
// What the model lacks counts as noise of the signal.
//
// Covariance: inverse of the Schur complement; and a robust one (sandwich) for residuals correlated in time and between
// joints, with Bartlett weights over `hac_lag` samples of a recording (Newey & West 1987).
//
// Consistent for known C (up to what linearisation leaves, of second order in the joint noise); the estimating equation
// sum J' V^-1 r has zero mean at the truth because the noise of the columns in J and that of d_k cancel.
// Fails: C wrong biases gains by the error of B C B' against V; a flat cost (gains without a known payload).

#ifndef IDIM_SOLVERS_BUNDLE_H_
#define IDIM_SOLVERS_BUNDLE_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/base/status.h"
#include "core/dynamics/base_parameters.h"
#include "solvers/bundle_data.h"

namespace idim {

struct BundlePrior {
  int unknown = -1;
  double value = 0.0;
  double standard_deviation = 0.0;  // > 0
};

struct BundleOptions {
  int max_iterations = 100;        // Levenberg-Marquardt steps between two weights, >= 1
  double step_tolerance = 1e-6;    // converged: no unknown moves by more than this many of its standard deviations, > 0
  int max_weight_iterations = 20;  // >= 0; 0 keeps `signal_sigma`
  double weight_tolerance = 1e-4;  // settled: no sigma changes by more than this fraction, > 0
  Eigen::VectorXd signal_sigma;    // n [signal unit] to start from; empty: from the residual of the start
  std::vector<BundlePrior> priors;
  int hac_lag = -1;  // >= 0, or -1: 4 (K / 100)^(2/9) of the shortest recording (Newey & West 1994)

  bool IsValid(std::string* error) const;
};

struct BundleSummary {
  Status status = Status::Untrusted("SolveBundle was not called");
  BundleOptions given;

  Eigen::VectorXd values;                         // of BundleData::unknowns
  Eigen::MatrixXd covariance;                     // Schur complement
  Eigen::MatrixXd robust_covariance;              // sandwich
  Eigen::VectorXd signal_sigma;                   // n [signal unit]
  double initial_cost = -1.0, final_cost = -1.0;  // sum r' V^-1 r + priors, each with its own weights
  int iterations = -1, weight_iterations = -1;
  double largest_step = -1.0;  // of the last iteration, in standard deviations
  bool converged = false;
  double degrees_of_freedom = -1.0;
  int hac_lag = -1;

  bool IsSolutionUsable() const { return status.ok(); }
};

// start: values of the unknowns, no gain zero. options valid (CHECK).
BundleSummary SolveBundle(const BaseParameters& base, const BundleData& data, const Eigen::VectorXd& start,
                          const BundleOptions& options = BundleOptions());

}  // namespace idim

#endif  // IDIM_SOLVERS_BUNDLE_H_
