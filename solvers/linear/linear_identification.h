// IDIM-LS and IDIM-WLS: least squares for parameters that the torque is linear in (paper II.C, eq. (6)-(11)).
//
//   Y = W chi + rho,   chi = W^+ Y,   s^2 = |Y - W chi|^2 / (r - c),   cov(chi) = s^2 (W'W)^-1
// assuming W without error and rho white with one variance (LS), or one variance a joint (WLS). WLS divides the rows
// of joint j by the standard deviation of the residual which ordinary LS of that joint's equations alone leaves
// (Gautier 1997, paper II.C); a joint's equations determine fewer parameters than all do, and the degrees of freedom
// count its own rank. Everything comes from one triangular factor a joint: W is never held.
//
// Essential parameters (paper IV.B): the parameter with the largest relative standard deviation is cancelled and the
// rest solved again, until max / min of the relative standard deviations is below r_sigma.
//
// Fails, as a diagnosed result, where W has not full column rank: the parameters of each direction that the data do
// not see are named. Biased where W is noisy (solvers/bundle/bundle.h is not); intervals too short where rho is
// correlated in time.

#ifndef IDIM_SOLVERS_LINEAR_LINEAR_IDENTIFICATION_H_
#define IDIM_SOLVERS_LINEAR_LINEAR_IDENTIFICATION_H_

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "core/base/status.h"
#include "core/dynamics/parameters.h"
#include "core/statistics/triangular_factor.h"

namespace idim {

// One factor a joint of the rows [W | Y] of its equations.
struct LinearSystem {
  std::vector<Parameter> unknowns;
  std::vector<TriangularFactor> joints;  // columns: unknowns, then the torque [N.m or N]

  explicit LinearSystem(std::vector<Parameter> unknowns_in, int dof)
      : unknowns(std::move(unknowns_in)), joints(dof, TriangularFactor(static_cast<int>(unknowns.size()) + 1)) {}
};

struct LinearOptions {
  // Rows of each joint divided by their standard deviation (WLS) or left alone (LS).
  bool weighted = true;
  // Standard deviations of the joints' rows [N.m or N] where they are known a priori; empty: from the data.
  Eigen::VectorXd a_priori_sigma;
  // r_sigma of the essential parameters: 0 keeps all, else > 1; the paper takes 10 to 30.
  double essential_ratio = 0.0;
  // Singular values of the column-scaled W below this times the largest count as zero, in (0, 1).
  double rank_tolerance = 1e-10;

  bool IsValid(std::string* error) const;
};

struct LinearSummary {
  Status status = Status::Untrusted("SolveLinear was not called");
  LinearOptions given;

  // Of the unknowns of the system; 0 with zero covariance where eliminated.
  Eigen::VectorXd values;
  Eigen::MatrixXd covariance;
  std::vector<std::string> eliminated;  // in order of elimination

  Eigen::VectorXd joint_sigma;            // n [N.m or N]: a priori or of each joint's own LS residual
  double condition_number = -1.0;         // of W as recorded, kept columns
  double condition_number_solved = -1.0;  // of the matrix solved with: weighted rows
  double sigma = -1.0;                    // eq. (9), of the rows solved with
  std::int64_t rows = -1;
  std::int64_t degrees_of_freedom = -1;

  bool IsSolutionUsable() const { return status.ok(); }
  // 100 * standard deviation / |value| (eq. (11)); inf for a zero value.
  double RelativeSigmaPercent(int unknown) const;
};

// options must be valid (CHECK IsValid).
LinearSummary SolveLinear(const LinearSystem& system, const LinearOptions& options);

}  // namespace idim

#endif  // IDIM_SOLVERS_LINEAR_LINEAR_IDENTIFICATION_H_
