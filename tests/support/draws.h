// How many draws a statistical test takes: few in a suite, all of them in a campaign (scripts/run_campaigns.sh, which
// sets IDIM_DRAWS=full). A test's tolerances follow from the number of draws, by its figures' sampling distributions.

#ifndef IDIM_TESTS_SUPPORT_DRAWS_H_
#define IDIM_TESTS_SUPPORT_DRAWS_H_

#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

namespace idim::testing {

inline bool FullDraws() {
  const char* value = std::getenv("IDIM_DRAWS");
  return value != nullptr && std::string(value) == "full";
}

// seed: what the draws begin from. Both go into the test's result.
inline int Draws(int full, int reduced, unsigned seed) {
  const int draws = FullDraws() ? full : reduced;
  ::testing::Test::RecordProperty("draws", draws);
  ::testing::Test::RecordProperty("seed", static_cast<int>(seed));
  return draws;
}

}  // namespace idim::testing

#endif  // IDIM_TESTS_SUPPORT_DRAWS_H_
