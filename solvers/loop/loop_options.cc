#include "solvers/loop/loop_options.h"

#include "core/base/text.h"

namespace idim {

bool LoopOptions::IsValid(std::string* error) const {
  if (!(significance > 0.0 && significance < 1.0)) {
    *error = "significance is " + FormatNumber(significance) + "; expected a number between 0 and 1";
    return false;
  }
  if (!(margin > 0.0 && margin < 1.0)) {
    *error = "margin is " + FormatNumber(margin) + "; expected a number between 0 and 1";
    return false;
  }
  if (max_effects < 0) {
    *error = "max_effects is " + std::to_string(max_effects) + "; expected at least 0";
    return false;
  }
  if (threads < 1) {
    *error = "threads is " + std::to_string(threads) + "; expected at least 1";
    return false;
  }
  return true;
}

}  // namespace idim
