#include "core/signal/butterworth.h"

#include <gtest/gtest.h>

#include <cmath>

namespace idim::butterworth_test {
namespace {

constexpr double kStep = 1e-3;
constexpr double kCutoff = 40.0;

Eigen::VectorXd Cosine(int n, double frequency, double phase) {
  return (2.0 * M_PI * frequency * kStep * Eigen::ArrayXd::LinSpaced(n, 0, n - 1) + phase).cos();
}

// The gain of equation (1), written independently: the bilinear transformation maps f to tan(pi f h).
double Gain(int order, double frequency) {
  const double x = std::tan(M_PI * frequency * kStep) / std::tan(M_PI * kCutoff * kStep);
  return 1.0 / (1.0 + std::pow(x, 2 * order));
}

TEST(ButterworthFilter, HasTheSquaredMagnitudeAndNoPhase) {
  const int n = 3000;
  for (int order = 1; order <= 7; ++order) {
    const ButterworthFilter filter(order, kCutoff, kStep);
    for (const double f : {0.0, 1.0, 13.0, 30.0, 40.0, 55.0, 120.0, 400.0, 499.0}) {
      EXPECT_NEAR(filter.ZeroPhaseGain(f), Gain(order, f), 1e-14);
      const Eigen::VectorXd x = Cosine(n, f, 0.7);
      // 40 periods of the cut-off from the ends the transient of the slowest pole, sin(pi / 14) for order 7, is
      // exp(-2 pi 40 0.22), below rounding.
      const Eigen::VectorXd error = filter.ZeroPhase(x) - Gain(order, f) * x;
      EXPECT_LT(error.segment(1000, n - 2000).lpNorm<Eigen::Infinity>(), 1e-10)
          << "order " << order << ", " << f << " Hz";
    }
  }
}

TEST(ButterworthFilter, HalvesTheCutoff) {
  EXPECT_NEAR(ButterworthFilter(4, kCutoff, kStep).ZeroPhaseGain(kCutoff), 0.5, 1e-14);
}

TEST(ButterworthFilter, ImpulseResponseIsSymmetric) {
  Eigen::VectorXd impulse = Eigen::VectorXd::Zero(2001);
  impulse[1000] = 1.0;
  for (const int order : {2, 3, 4}) {
    const Eigen::VectorXd g = ButterworthFilter(order, kCutoff, kStep).ZeroPhase(impulse);
    EXPECT_LT((g - g.reverse()).lpNorm<Eigen::Infinity>(), 1e-14);
    EXPECT_NEAR(g.sum(), 1.0, 1e-12);
    EXPECT_GT(g[1000], 0.05);
  }
}

TEST(ButterworthFilter, PassesPolynomialsBelowTwiceTheOrder) {
  const int n = 2001;
  const Eigen::ArrayXd u = Eigen::ArrayXd::LinSpaced(n, -1.0, 1.0);
  for (const int order : {1, 2, 4}) {
    const ButterworthFilter filter(order, kCutoff, kStep);
    for (int degree = 0; degree < 2 * order; ++degree) {
      const Eigen::VectorXd x = u.pow(degree);
      const Eigen::VectorXd error = filter.ZeroPhase(x) - x;
      EXPECT_LT(error.segment(900, 201).lpNorm<Eigen::Infinity>(), 1e-11) << "order " << order << ", degree " << degree;
    }
    // One degree more comes out changed, so the test above can fail.
    const Eigen::VectorXd x = 1e6 * u.pow(2 * order);
    EXPECT_GT((filter.ZeroPhase(x) - x).segment(900, 201).lpNorm<Eigen::Infinity>(), 1e-9);
  }
}

TEST(ButterworthFilter, PassesConstantsUpToTheEnds) {
  for (const double cutoff : {0.02, 40.0, 450.0}) {
    const ButterworthFilter filter(4, cutoff, kStep);
    const Eigen::VectorXd x = Eigen::VectorXd::Constant(filter.padding() + 10, 1e3);
    EXPECT_LT((filter.ZeroPhase(x, 1).array() - 1e3).abs().maxCoeff(), 1e-9) << cutoff;
  }
}

// A line is no steady state of the sections: what the start makes of it must have died out over the padding.
TEST(ButterworthFilter, StaysNearAStraightLineAtTheEnds) {
  const int n = 1000;
  const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(n, 5.0, 15.0);
  const Eigen::VectorXd error = ButterworthFilter(4, kCutoff, kStep).ZeroPhase(x) - x;
  // The delay of the filter is about 0.4 / cutoff, 0.1 in x; after the padding 1 to 2 % of it are left.
  EXPECT_LT(error.lpNorm<Eigen::Infinity>(), 3e-3);
  EXPECT_LT(error.segment(100, n - 200).lpNorm<Eigen::Infinity>(), 1e-4);
}

TEST(ButterworthFilter, MarginContinuesTheSameSignal) {
  const Eigen::VectorXd x = Cosine(500, 7.0, 0.3);
  const ButterworthFilter filter(4, kCutoff, kStep);
  EXPECT_EQ(filter.ZeroPhase(x, 3).segment(3, 500), filter.ZeroPhase(x));
  EXPECT_EQ(filter.ZeroPhase(x, 3).size(), 506);
}

}  // namespace
}  // namespace idim::butterworth_test
