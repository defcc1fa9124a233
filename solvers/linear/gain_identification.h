// Global identification of drive gains, base and payload parameters (paper III): the estimators of W_tot x = rho.
//
//   kLs     eq. (15)-(16): the known payload's torque is the response, without error;
//           all else a regressor without error.
//           Noise of the signals sits in regressors, so that gains come out too small ("cases 1, 2" of the paper).
//   kTls    eq. (17)-(20): one noise for every entry of W_tot, structural zeros included ("cases 3, 4").
//   kGtls   scaled TLS: a noise for each column, exact columns exact (solvers/linear/total_least_squares.h).
//           By default only the signals are noisy, each by what its own joint's equations leave of it.
//           The errors of two columns count as uncorrelated.
//   kWls, kWtls, kWgtls   the same with the rows of each joint divided by a standard deviation of their own.
//
// Row weights. The paper divides by the deviation "of the joint's equations": for WLS from LS of that joint alone, for
// TLS by sigma_W^j = s_c^j / sqrt(r - c) of that joint alone (III.C). Neither exists here as it stands: one joint's
// equations are rank deficient (most base parameters, all other gains), so that the smallest singular values of
// W_tot^j are zero by structure; and where the known payload puts no torque on a joint, its own LS is 0 = 0. Both are
// replaced by what the joint's rows leave at the solution x of all joints without weights, of the same kind (LS or
// TLS):
//   sigma^j = |W_tot^j x| / (|x| sqrt(r_j (r - c) / r)),
// whose squares, weighted by r_j, sum to the square of s_c / sqrt(r - c) over all joints. Only ratios of weights matter
// to x; |x| is left out of joint_sigma, which is then in N.m. Repeated `weight_iterations` times.
//
// Statistics: (9)-(11) for LS, (22)-(23) for TLS and its general form for GTLS. Essential parameters by elimination
// (IV.B); gains are never eliminated.
//
// Fails: the header of total_least_squares.h; W_r of deficient rank; a known torque that the arm's own parameters can
// imitate (every recording carries the payload). See also GainSummary::status.

#ifndef IDIM_SOLVERS_LINEAR_GAIN_IDENTIFICATION_H_
#define IDIM_SOLVERS_LINEAR_GAIN_IDENTIFICATION_H_

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "core/base/status.h"
#include "solvers/linear/gain_system.h"
#include "solvers/linear/gain_verdict.h"

namespace idim {

enum class GainEstimator { kLs, kWls, kTls, kWtls, kGtls, kWgtls };

// "ls", "wls", "tls", "wtls", "gtls", "wgtls".
const char* GainEstimatorName(GainEstimator estimator);

struct GainOptions {
  GainEstimator estimator = GainEstimator::kWtls;
  // Times that row weights are taken from the residual and the system is solved again, >= 1 (weighted estimators).
  int weight_iterations = 1;
  // kGtls, kWgtls: standard deviation of the entries of each column (unknowns, then the known torque), a row for each
  // joint's equations or one row for all, >= 0 and 0 if exact; empty: signals by SignalNoise(), all else exact.
  Eigen::MatrixXd column_noise;
  // r_sigma of the essential parameters: 0 keeps all, else > 1; the paper takes 10 to 30.
  double essential_ratio = 0.0;
  // Singular values of the column-scaled W_r below this times the largest count as zero, in (0, 1).
  double rank_tolerance = 1e-10;
  // See TotalLeastSquaresOptions.
  double min_separation = 1.05;
  double min_last_share = 1e-6;
  // A gain whose relative standard deviation is above this is not to be trusted [%], > 0. The paper's are 1 to 3.3 %.
  double max_spread_percent = 25.0;
  // A gain whose GainVerdict::reliability is below this is not to be trusted from an estimator that does not know the
  // noise of each column (all but kGtls and kWgtls), in [0, 1).
  double min_reliability = 0.5;

  bool IsValid(std::string* error) const;
};

struct GainSummary {
  // Untrusted, by name: rank; degenerate TLS; a gain whose sign contradicts its a priori value; a gain whose relative
  // standard deviation is above the limit or whose reliability is below. In all but the first the numbers are there to
  // be shown, not to be used.
  Status status = Status::Untrusted("SolveGains was not called");
  GainOptions given;

  // Of the unknowns of the system; 0 with zero covariance where eliminated. Empty where nothing could be computed.
  Eigen::VectorXd values;
  Eigen::MatrixXd covariance;
  std::vector<std::string> eliminated;  // in order of elimination

  Eigen::VectorXd joint_sigma;            // n [N.m or N], what divided the rows; 1 without weights
  double condition_number = -1.0;         // of W_r as recorded, kept columns
  double condition_number_solved = -1.0;  // of the matrix solved with: weighted rows
  double relative_residual = -1.0;        // |W_tot x| / |V g|, unweighted: the paper's |rho| / |Y|
  double sigma = -1.0;                    // (9) or (22), of the rows solved with
  std::int64_t rows = -1;
  std::int64_t degrees_of_freedom = -1;

  // TLS and GTLS only; see TotalLeastSquares.
  Eigen::VectorXd singular_values;
  double separation = -1.0;
  double last_share = -1.0;
  double scale_significance = -1.0;

  std::vector<GainVerdict> verdicts;  // one a gain, of the data alone

  bool IsSolutionUsable() const { return status.ok(); }
  // 100 * standard deviation / |value| (eq. (11)); inf for a zero value.
  double RelativeSigmaPercent(int unknown) const;
};

// options must be valid (CHECK IsValid).
GainSummary SolveGains(const GainSystem& system, const GainOptions& options);

}  // namespace idim

#endif  // IDIM_SOLVERS_LINEAR_GAIN_IDENTIFICATION_H_
