// Closing the loop: residual -> missing effect -> added -> error before and after, until nothing is left to add.
//
// 1. The declared model, with the effects of the study's key (solvers/loop/declared_effects.h), is fitted by the bundle
//    (gains identified or known), with velocities zero at rest (WithVelocityZeroAtRest), so that friction of noise is
//    not traced.
// 2. All candidates are scanned (solvers/loop/effect_scan.h). One is added if its corrected score test passes and if it
//    lowers the held-out error of its joints by more than `margin`, by more than two standard errors of the folds or in
//    at least 85 % of them.
//    Of those, the one that lowers it most; among such as the folds cannot tell from it (one standard error), the one
//    with the fewest parameters. Nothing depends on the order in which candidates are tried.
// 3. Everything is fitted anew through the bundle: gains, parameters, payload, effects; shapes by Gauss-Newton along
//    with them. If the held-out torque error of its joints has not fallen by the margin, or the effect has a sign that
//    physics forbids (Effect::non_negative), the candidate is put aside.
// 4. When nothing passes, each effect that was added is tried again beside all others: it is dropped if it turned its
//    sign or if the held-out error does not need it, and replaced if a rival at the same place does better by two
//    standard errors (a first choice may have stood in for two effects found later).
//
// Held-out error: folds of contiguous blocks of the identification recordings. Validation recordings are never looked
// at while choosing; where there are some, `validation` errors are theirs, else those of the folds.
//
// Rivals of a step: candidates that passed as well, explain the same (mean squared cosine between their columns and
// the chosen one's above 0.5), and are not worse by two standard errors of the folds: the data cannot tell them apart.

#ifndef IDIM_SOLVERS_LOOP_CLOSE_LOOP_H_
#define IDIM_SOLVERS_LOOP_CLOSE_LOOP_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/base/status.h"
#include "core/model/model.h"
#include "solvers/estimators/eiv_identification.h"
#include "solvers/loop/judged_fit.h"
#include "solvers/loop/loop_options.h"
#include "solvers/loop/loop_step.h"
#include "solvers/loop/unexplained.h"

namespace idim {

struct LoopResult {
  // Untrusted: the declared model cannot be fitted.
  Status status = Status::Untrusted("CloseLoop was not called");
  LoopOptions given;
  LoopErrors declared, final;
  std::vector<LoopStep> steps;       // effects of the final model, in the order in which they were found
  std::vector<std::string> dropped;  // found, then not needed or replaced: a sentence each
  std::vector<Unexplained> unexplained;
  bool held_out_by_blocks = true;  // there are no validation recordings
  Identification before, after;    // of the declared and of the final model
  PreparedStudy prepared;          // with the final effects

  explicit LoopResult(PreparedStudy prepared_in) : prepared(std::move(prepared_in)) {}
};

// options valid (CHECK). BadInput: as IdentifyEiv. That the declared model cannot be fitted is in the result's status.
Result<LoopResult> CloseLoop(const PreparedStudy& prepared, const LoopOptions& options);

}  // namespace idim

#endif  // IDIM_SOLVERS_LOOP_CLOSE_LOOP_H_
