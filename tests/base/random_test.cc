// Draws of core/base/random.h that no simulation shows by its results.

#include "core/base/random.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace idim::random_test {
namespace {

TEST(Random, DrawsEachWholeNumberBelowItsBoundEvenly) {
  Random random(3);
  std::array<int, 4> count = {};
  for (int k = 0; k < 4000; ++k) ++count.at(static_cast<size_t>(random.Below(4)));
  // Binomial, standard deviation 27.4: five of them.
  for (const int c : count) EXPECT_NEAR(c, 1000, 137);
  EXPECT_EQ(random.Below(1), 0);
}

TEST(Random, DrawsEvenlyInTheLogarithmAndBothSigns) {
  Random random(4);
  int lower_half = 0, negative = 0;
  for (int k = 0; k < 4000; ++k) {
    const double value = random.LogUniform(0.01, 1.0);
    EXPECT_GE(value, 0.01);
    EXPECT_LE(value, 1.0);
    lower_half += value < 0.1;
    const double sign = random.Sign();
    EXPECT_EQ(std::abs(sign), 1.0);
    negative += sign < 0.0;
  }
  // Standard deviation 31.6.
  EXPECT_NEAR(lower_half, 2000, 158);
  EXPECT_NEAR(negative, 2000, 158);
}

// The words of Random(seed, stream) are fixed by the recordings that are committed.
TEST(Random, OfWordsIsThatOfTheSeedSequence) {
  Random words = Random::FromWords({5, 0, 2}), stream(5, 2), other = Random::FromWords({5, 2});
  const double first = words.Uniform();
  EXPECT_EQ(first, stream.Uniform());
  EXPECT_NE(first, other.Uniform());
}

}  // namespace
}  // namespace idim::random_test
