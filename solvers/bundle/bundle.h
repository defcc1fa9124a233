// The errors-in-variables bundle: maximum likelihood of gains, parameters and the true joint states of every sample.
//
// Unknown: theta = (g, chi, chi_uL) and for each decimated sample k the deviation d_k of the true joint state from the
// measured one. Residuals, in units of their standard deviations (solvers/bundle/bundle_data.h for the symbols):
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
// Converged: the gradient in units of the unknowns' standard deviations (Newton decrement), undamped, is below
// `step_tolerance`. A rank-deficient start or minimum is reported by the names of what the data do not see.
//
// Rest. Where the sign of a velocity is not known, dry friction may be anything between -Fs and Fs: V_k has the
// variance (Fs / g)^2 (1 - E[sign | measured]^2) of each joint besides S, Fs held like a weight (not in
// solvers/bundle/ceres_bundle.h). Samples at rest then say little of friction, those where the sign is known say all.
//
// Robust loss (option): Huber's of the norm of a sample's whitened residual V_k^-1/2 r_k, all joints together, by
// reweighted rows; weights and covariance are made consistent for normal residuals. Unlike
// solvers/bundle/ceres_bundle.h, where the loss acts on the torque residual after the latent has taken its part, it
// bears outliers of the joint data too.
//
// Covariance. `covariance`: inverse of the Schur complement, right where the model is true and samples are independent.
// J is taken at estimated states, whose error u has the covariance Q = C - C B' V^-1 B C: of K = J' V^-1 J the part
// N = E sum dJ(u)' V^-1 dJ(u) is noise. The curvature of the cost is A = K - N, the variance of its gradient K, hence
// `model_covariance` = A^-1 K A^-1; steps near the minimum are taken with A. First order in the joint noise, N = 0,
// leaves `covariance`. Weights that are estimated have an influence of their own, by the change of the scores with each
// sigma^2; it is in both covariances below. `noise_share` is the largest eigenvalue of K^-1/2 N K^-1/2; above 0.5 the
// correction itself is rough. `robust_covariance`: A^-1 (N n / (N n - c) sum of score autocovariances with Bartlett
// weights + priors) A^-1, right for residuals correlated in time and between joints, and of a variance that changes
// along the motion (Newey & West 1987). The lag comes from the scores' own first autocorrelations, scaled to the
// parameters (Andrews 1991, AR(1), Bartlett). `interval_factor` widens intervals for the lag being a share b of the
// samples: the critical values of Kiefer & Vogelsang 2005 (Econometric Theory 21, table 1, Bartlett, 95 %) over the
// normal one.
//
// Consistent for known C (up to what linearisation leaves, of second order in the joint noise); the estimating equation
// sum J' V^-1 r has zero mean at the truth because the noise of the columns in J and that of d_k cancel.
// Fails: C wrong biases gains by the error of B C B' against V; a flat cost (gains without a known payload).

#ifndef IDIM_SOLVERS_BUNDLE_BUNDLE_H_
#define IDIM_SOLVERS_BUNDLE_BUNDLE_H_

#include <Eigen/Core>
#include <limits>
#include <string>
#include <vector>

#include "core/base/status.h"
#include "core/dynamics/base_parameters.h"
#include "solvers/bundle/bundle_data.h"
#include "solvers/bundle/bundle_problem.h"

namespace idim {

struct BundleOptions {
  int max_iterations = 100;        // Levenberg-Marquardt steps in all, >= 1
  double step_tolerance = 1e-6;    // converged: the minimum is nearer than this many standard deviations, > 0
  int max_weight_iterations = 20;  // >= 0; 0 keeps `signal_sigma`
  double weight_tolerance = 1e-4;  // converged: no sigma changes by more than this fraction, > 0
  Eigen::VectorXd signal_sigma;    // n [signal unit] to start from; empty: from the residual of the start
  std::vector<BundlePrior> priors;
  double huber_threshold = 0.0;   // in standard deviations: of the norm, divided by sqrt(n); 0: no loss
  int hac_lag = -1;               // >= 0, or -1: chosen from the scores
  bool inference = true;          // false: of the covariances only `covariance` is computed; for a fit on the way
  double rank_tolerance = 1e-10;  // as GainOptions::rank_tolerance, of the whitened rows

  bool IsValid(std::string* error) const;
};

struct BundleSummary {
  // Untrusted: a gain of zero to start from, directions that the data do not see, no convergence of the unknowns or of
  // the weights.
  Status status = Status::Untrusted("SolveBundle was not called");
  BundleOptions given;

  Eigen::VectorXd values;                         // of BundleData::unknowns
  Eigen::MatrixXd covariance;                     // Schur complement; empty where rank deficient
  Eigen::MatrixXd model_covariance;               // of independent samples, the states' error accounted for; likewise
  Eigen::MatrixXd robust_covariance;              // sandwich; likewise
  double noise_share = -1.0;                      // of the curvature: what the states' error makes up, where it is most
  double interval_factor = -1.0;                  // >= 1, for intervals from robust_covariance
  Eigen::VectorXd signal_sigma;                   // n [signal unit]
  double initial_cost = -1.0, final_cost = -1.0;  // sum r' V^-1 r + priors (of rho with a loss), each with its weights
  double deviance = std::numeric_limits<double>::infinity();  // final cost + sum log |V|: -2 log L but for a constant
  int iterations = -1, weight_iterations = -1;
  double decrement = -1.0;  // distance to the minimum of the last quadratic model, in standard deviations
  bool converged = false;
  double degrees_of_freedom = -1.0;
  int hac_lag = -1;
  double condition_number = -1.0;  // of the whitened Jacobian, columns scaled to unit norm

  bool IsSolutionUsable() const { return status.ok(); }
};

// start: values of the unknowns, no gain zero. options valid and sizes that fit `data` (CHECK).
BundleSummary SolveBundle(const BaseParameters& base, const BundleData& data, const Eigen::VectorXd& start,
                          const BundleOptions& options = BundleOptions());

}  // namespace idim

#endif  // IDIM_SOLVERS_BUNDLE_BUNDLE_H_
