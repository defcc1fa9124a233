// What the final residual still depends on, without a name for it: a nonparametric test.
//
// The residual of a joint (whitened, orthogonal to all that was fitted) is averaged in cells of one signal (10 cells of
// equal count) or of a pair (6 x 6) among q, dq, ddq of every joint, the joint's torque and time. The cells' means,
// from the other folds and shrunk by their count, predict the fold left out: the share of the squared residual that
// this takes away is what the residual depends on. p-value: the same for the residual shifted in time against the
// signals, within each recording and around its end (which keeps the correlation in time), and the largest share of all
// signals and pairs in each shift (Westfall & Young: corrected for all that is tried).

#ifndef IDIM_SOLVERS_LOOP_UNEXPLAINED_H_
#define IDIM_SOLVERS_LOOP_UNEXPLAINED_H_

#include <string>
#include <vector>

#include "core/model/model.h"
#include "solvers/bundle/residual_model.h"

namespace idim {

struct Unexplained {
  int joint = 0;                        // zero-based
  std::vector<std::string> depends_on;  // "q2", "dq3", "ddq1", "tau3", "t"
  double share_percent = 0.0;           // of the squared residual
  double p_value = 1.0;
};

struct UnexplainedOptions {
  double significance = 0.01;  // in (0, 1)
  int shifts = 199;            // >= 99; the p-value is no smaller than 1 / (shifts + 1)
};

// At most one a joint, its best; a pair only where it takes away more than either of its signals by a fifth.
std::vector<Unexplained> FindUnexplained(const PreparedStudy& prepared, const ResidualModel& residual,
                                         const UnexplainedOptions& options);

}  // namespace idim

#endif  // IDIM_SOLVERS_LOOP_UNEXPLAINED_H_
