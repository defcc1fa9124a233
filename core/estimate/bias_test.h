// Whether least squares is biased on the data: the Durbin-Wu-Hausman test
// as a result to print (solvers/linear/exogeneity.h).

#ifndef IDIM_CORE_ESTIMATE_BIAS_TEST_H_
#define IDIM_CORE_ESTIMATE_BIAS_TEST_H_

#include <cstdint>
#include <string>

#include "core/base/status.h"

namespace idim {

struct BiasTest {
  Status status;          // not ok: no answer, with the reason
  std::string equations;  // "joint 1" or "all joints"
  bool biased = false;
  double f = -1.0;
  int numerator = -1;
  std::int64_t denominator = -1;
  double p_value = -1.0;
  double sargan_p = -1.0;  // small: model or instruments are wrong; -1: not tested
};

// "biased: F(6, 900) = 12, p = 1e-9; Sargan's p = 0.3: the instruments stand", or why there is no answer.
std::string BiasTestSentence(const BiasTest& test);

}  // namespace idim

#endif  // IDIM_CORE_ESTIMATE_BIAS_TEST_H_
