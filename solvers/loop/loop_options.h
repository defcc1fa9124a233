// What the loop is asked for.

#ifndef IDIM_SOLVERS_LOOP_LOOP_OPTIONS_H_
#define IDIM_SOLVERS_LOOP_LOOP_OPTIONS_H_

#include <functional>
#include <string>

#include "solvers/loop/loop_rules.h"

namespace idim {

struct LoopOptions {
  double significance = 0.05;  // of the score test, corrected for all that is tried, in (0, 1)
  double margin = 0.02;        // relative decrease of the held-out error that an effect must bring, in (0, 1)
  int max_effects = 24;        // >= 0
  int threads = 1;             // >= 1
  std::function<void(const std::string&)> progress;

  bool IsValid(std::string* error) const;
  double DecreaseOfSquares() const { return idim::DecreaseOfSquares(margin); }
};

}  // namespace idim

#endif  // IDIM_SOLVERS_LOOP_LOOP_OPTIONS_H_
