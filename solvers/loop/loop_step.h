// What is recorded of an effect that the loop added.

#ifndef IDIM_SOLVERS_LOOP_LOOP_STEP_H_
#define IDIM_SOLVERS_LOOP_LOOP_STEP_H_

#include <vector>

#include "core/dynamics/parameters.h"
#include "core/model/model.h"
#include "solvers/loop/effect_scan.h"
#include "solvers/loop/judged_fit.h"

namespace idim {

struct LoopRival {
  ActiveEffect effect;
  double held_out_error_percent = -1.0;  // of the folds, with it in place of the chosen one
};

// A parameter that moved by more than its 95 % interval when an effect was added.
struct MovedParameter {
  Parameter parameter;
  double before = 0.0, after = 0.0;
  double standard_deviation = 0.0;  // before
};

struct LoopStep {
  ActiveEffect effect;
  EffectCandidate candidate;             // as it was found
  std::vector<EffectCandidate> ranking;  // of the scan in which it was found, best first, without their columns
  double threshold = 0.0;
  LoopErrors before, after;
  std::vector<LoopRival> confusable_with;
  std::vector<MovedParameter> moved;
};

}  // namespace idim

#endif  // IDIM_SOLVERS_LOOP_LOOP_STEP_H_
