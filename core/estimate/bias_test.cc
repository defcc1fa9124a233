#include "core/estimate/bias_test.h"

#include <cstdio>

namespace idim {

std::string BiasTestSentence(const BiasTest& test) {
  if (!test.status.ok()) return "no answer: " + test.status.message();
  char text[200];
  std::snprintf(text, sizeof(text), "%s: F(%d, %lld) = %.3g, p = %.2g", test.biased ? "biased" : "no bias seen",
                test.numerator, static_cast<long long>(test.denominator), test.f, test.p_value);
  std::string sentence = text;
  if (test.sargan_p < 0.0) return sentence;
  std::snprintf(text, sizeof(text), "; Sargan's p = %.2g: %s", test.sargan_p,
                test.sargan_p < 0.01
                    ? "the model lacks effects that the instruments see, so that more than noise is wrong"
                    : "the instruments stand");
  return sentence + text;
}

}  // namespace idim
