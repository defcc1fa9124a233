// Is least squares biased on these data? The Durbin-Wu-Hausman test as an augmented regression.
//
// Model: y = X b + e. LS is consistent only where no column of X is correlated with e (exogenous); noise in X is such a
// correlation. Given instruments Z, correlated with X and not with e:
//   1. each suspect column x of X is regressed on all exogenous columns and Z; its residual v holds what of x can be
//      correlated with e;
//   2. y is regressed on X and all v. Under exogeneity their coefficients are 0, tested by
//        F = ((RSS(X) - RSS(X, v)) / q) / (RSS(X, v) / (r - rank(X, v))),   q = rank(X, v) - rank(X),
//      and the coefficients of X in it are those of two-stage least squares (Hausman 1978; Davidson & MacKinnon 1993,
//      7.9). Ranks come from a QR decomposition with column pivoting, for the equations of one joint do not determine
//      all parameters.
// A test is worth what its instruments are, which Janot, Vandanjon & Gautier (2016, "A revised Durbin-Wu-Hausman test
// for industrial robot identification", Control Engineering Practice 48) make part of it: instruments that explain
// little of a suspect (first-stage F below 10) make the test refuse rather than answer; where there are more
// instruments than suspects, Sargan's statistic tests that e is not correlated with them. Their instruments are the
// columns of a SIMULATED robot (a closed-loop forward simulation with the LS parameters). Any instruments can be given
// here; those of BuildLaggedFactors are:
//
//   the same columns L decimated samples before and after. Legitimate where the noise of two samples L apart is
//   independent (white noise through the decimator is correlated by less than 4 % from 2 samples on, 1 % from 9 on, not
//   at all beyond 20) while the motion is slow enough to be seen L samples away. NOT where e holds model errors that
//   last longer than L samples, like wrong friction: then Sargan's statistic should say so, and LS is wrong for a
//   reason that no instrument mends.
//
// F assumes e white; residuals correlated in time make the test reject too often, which `stride` (use each stride-th
// sample) mends at the price of power.

#ifndef IDIM_SOLVERS_LINEAR_EXOGENEITY_H_
#define IDIM_SOLVERS_LINEAR_EXOGENEITY_H_

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "core/base/status.h"
#include "core/model/model.h"
#include "core/statistics/triangular_factor.h"

namespace idim {

struct ExogeneityOptions {
  double level = 0.01;            // exogeneity is rejected where p is below this, in (0, 1)
  double min_first_stage_f = 10;  // below it instruments count as weak (Staiger & Stock 1997), >= 0
  double rank_tolerance = 1e-10;  // in (0, 1)

  bool IsValid(std::string* error) const;
};

struct ExogeneityTest {
  // Untrusted: no answer (weak instruments, nothing to test, too few rows), with the reason.
  Status status = Status::Untrusted("TestExogeneity was not called");
  ExogeneityOptions given;
  double f = -1.0;
  int numerator = -1;             // q
  std::int64_t denominator = -1;  // r - rank(X, v)
  double p_value = -1.0;
  bool biased = false;            // p_value < level: LS is biased
  Eigen::VectorXd first_stage_f;  // of each suspect
  Eigen::VectorXd least_squares;  // of X
  Eigen::VectorXd instrumental;   // of X, two-stage least squares; minimum norm where not determined
  double sargan_p = -1.0;         // -1 without surplus instruments; small: instruments or model are wrong
  int overidentification = 0;     // surplus instruments
};

// r: any matrix with R'R = [Z X y]'[Z X y]; rows: of the data; instruments: columns of Z; suspects: columns of X,
// counted from 0 in X, all others being exogenous and their own instruments. options valid (CHECK).
ExogeneityTest TestExogeneity(const Eigen::MatrixXd& r, std::int64_t rows, int instruments,
                              const std::vector<int>& suspects, const ExogeneityOptions& options = ExogeneityOptions());

// Which columns of W_r (eq. (15)) may be noisy: the signals, or all of them (noise of positions too).
enum class Suspects { kSignals, kAll };

struct LaggedOptions {
  int lag = 3;     // decimated samples, >= 1
  int stride = 1;  // >= 1
  Suspects suspects = Suspects::kSignals;
};

// For each joint the rows [Z | X | y] of its equations (15): X the columns of the unknowns of BuildGainSystem, y the
// known payload's torque, Z each suspect `lag` samples before, then after.
struct LaggedSystem {
  int dof = 0;
  int instruments = 0;
  std::vector<int> suspects;             // columns of X
  std::vector<TriangularFactor> joints;  // n
};
// BadInput as BuildGainSystem, or options out of range.
Result<LaggedSystem> BuildLaggedSystem(const PreparedStudy& prepared, const LaggedOptions& options);

// The equations of one joint (zero-based) alone. Untrusted also where the joint's torque of the known payload is one
// that its unknown parameters make as well: its equations then hold nothing to test.
ExogeneityTest TestJointExogeneity(const LaggedSystem& system, int joint,
                                   const ExogeneityOptions& options = ExogeneityOptions());

// The equations of all joints, rows divided by row_sigma (n, [N.m or N]; GainSummary::joint_sigma): whether the WLS of
// all gains is biased, and what the instruments say that they are.
ExogeneityTest TestAllExogeneity(const LaggedSystem& system, const Eigen::VectorXd& row_sigma,
                                 const ExogeneityOptions& options = ExogeneityOptions());

}  // namespace idim

#endif  // IDIM_SOLVERS_LINEAR_EXOGENEITY_H_
