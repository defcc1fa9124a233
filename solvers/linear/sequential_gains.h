// Baseline: drive gains one joint at a time, from the equation of that joint alone (references [11],
// [12] of the paper).
//
// The paper says of them: gains are identified "for each actuated joint separately by using a known payload", "using
// only data coming from the corresponding joint equation", "a sequential procedure which accumulates errors from step
// to step", with "good results only for the first four joints". It does not give their algorithms. What stands here is
// no more than these sentences ask for:
//
//   at joint j, from its rows of W_tot alone,   V_j g_j - W_j chi - W_uL,j chi_uL = W_kL,j chi_kL,
//   by least squares, all of chi, chi_uL and other joints' gains in these rows being nuisances (the equations of one
//   joint do not determine them all; what is independent of them determines g_j).
//
// With the mass alone known, the joints of a spherical wrist see nothing known, or nothing that their own unknown
// payload parameters would not make as well. They wait until all others are done and take over what those found of the
// payload, of each parameter the value with the smallest standard deviation, as if known. This is how errors
// accumulate. A joint that still sees nothing known keeps no gain. Joints in the order 1 to n.
//
// The standard deviation counts the row noise of that joint alone, not the errors of what was passed on: too small, as
// in the papers of that method.

#ifndef IDIM_SOLVERS_LINEAR_SEQUENTIAL_GAINS_H_
#define IDIM_SOLVERS_LINEAR_SEQUENTIAL_GAINS_H_

#include <Eigen/Core>
#include <vector>

#include "core/base/status.h"
#include "solvers/linear/gain_system.h"

namespace idim {

struct SequentialGains {
  // Untrusted where a joint has no gain, naming it.
  Status status = Status::Untrusted("SolveSequentialGains was not called");
  Eigen::VectorXd gains;               // n, NaN where not found
  Eigen::VectorXd standard_deviation;  // n, NaN likewise
  std::vector<int> order;              // zero-based joints as they were done
  std::vector<int> after_others;       // of these, the ones that took over payload parameters
};

SequentialGains SolveSequentialGains(const GainSystem& system, double rank_tolerance = 1e-10);

}  // namespace idim

#endif  // IDIM_SOLVERS_LINEAR_SEQUENTIAL_GAINS_H_
