#include "core/motion/preprocessing.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/motion/real_recordings.h"
#include "tests/signal/signals.h"

namespace idim::preprocessing_test {
namespace {

Preprocessing Make(double cutoff, int decimation) {
  Preprocessing preprocessing;
  preprocessing.cutoff_hz = cutoff;
  preprocessing.decimation = decimation;
  return preprocessing;
}

// A wave keeps its phase, takes the low-pass's gain, and its derivatives the droop of central differences:
// sin(w h) / (w h) and (sin(w h / 2) / (w h / 2))^2.
TEST(EstimateJointStates, UniformClockHasTheAnalyticResponse) {
  const double h = 1e-3, cutoff = 40.0;
  const Eigen::VectorXd t = UniformClock(2000, h, 3.0);
  for (const double f : {2.0, 20.0, 40.0, 70.0}) {
    const auto states = EstimateJointStates(MakeRecording(t, Wave(t, f, 0.2, 0)), Make(cutoff, 10));
    ASSERT_TRUE(states.ok()) << states.status().message();
    ASSERT_TRUE(states->clock.uniform);
    const double w = 2 * M_PI * f;
    const double gain = 1 / (1 + std::pow(std::tan(M_PI * f * h) / std::tan(M_PI * cutoff * h), 8));
    const double droop[3] = {gain, gain * std::sin(w * h) / (w * h),
                             gain * std::pow(std::sin(w * h / 2) / (w * h / 2), 2)};
    const Eigen::MatrixXd* found[3] = {&states->q, &states->dq, &states->ddq};
    for (int d = 0; d < 3; ++d) {
      const Eigen::VectorXd error = *found[d] - droop[d] * Wave(t, f, 0.2, d);
      EXPECT_LT(error.segment(600, 800).lpNorm<Eigen::Infinity>(), 1e-7 * std::pow(w, d))
          << f << " Hz, derivative " << d;
    }
  }
}

// The same samples through both filters: they differ by the bilinear warping and the droop only, both known.
TEST(EstimateJointStates, BothClocksGiveTheSameFilter) {
  const double h = 2e-3, cutoff = 10.0;
  const int n = 3000;
  const Eigen::VectorXd uniform = UniformClock(n, h);
  // Out of the tolerance of 1 % of a step by a hair: the other filter on all but the same instants.
  Eigen::VectorXd jittering = uniform;
  for (int i = 1; i + 1 < n; i += 2) jittering[i] += 0.0102 * h;
  for (const double f : {1.0, 3.0, 5.0, 9.0, 14.0}) {
    const auto a = EstimateJointStates(MakeRecording(uniform, Wave(uniform, f, 0.2, 0)), Make(cutoff, 50));
    const auto b = EstimateJointStates(MakeRecording(jittering, Wave(jittering, f, 0.2, 0)), Make(cutoff, 50));
    ASSERT_TRUE(a.ok() && b.ok());
    ASSERT_TRUE(a->clock.uniform);
    ASSERT_FALSE(b->clock.uniform);
    const double x = std::tan(M_PI * f * h) / std::tan(M_PI * cutoff * h);
    const double warping = std::abs(1 / (1 + std::pow(x, 8)) - 1 / (1 + std::pow(f / cutoff, 8)));
    const double w = 2 * M_PI * f;
    const double droop[3] = {0, w * w * h * h / 6, w * w * h * h / 12};
    const Eigen::MatrixXd* of_a[3] = {&a->q, &a->dq, &a->ddq};
    const Eigen::MatrixXd* of_b[3] = {&b->q, &b->dq, &b->ddq};
    for (int d = 0; d < 3; ++d) {
      // Instants differ by up to 2e-5 s: w times that is the phase; 1e-3 is what the knots cost.
      const double allowed = warping + droop[d] + 0.0102 * h * w + 1e-3;
      const Eigen::VectorXd difference = *of_a[d] - *of_b[d];
      EXPECT_LT(difference.segment(500, n - 1000).lpNorm<Eigen::Infinity>(), 1.01 * allowed * std::pow(w, d))
          << f << " Hz, derivative " << d;
    }
  }
}

// Parallel decimation keeps a linear relation exact: W chi = y before, W chi = y after, on any clock, edges included.
TEST(MakeDecimator, KeepsLinearRelationsExactly) {
  const Eigen::VectorXd t = JitteringClock(1500, 0.01, 0.7, 1);
  const Recording recording = MakeRecording(t, Wave(t, 0.5, 0.0, 0));
  const auto decimator = MakeDecimator(recording, Make(8.0, 12));
  ASSERT_TRUE(decimator.ok());
  const Eigen::MatrixXd columns = Gaussian(1500, 5, 2);
  const Eigen::VectorXd chi = Gaussian(5, 1, 3);
  EXPECT_LT((decimator->Apply(columns) * chi - decimator->Apply(columns * chi)).norm(), 1e-12);
  // Two periods of the cut-off are dropped, 0.25 s, more than two decimated steps.
  EXPECT_GE(decimator->times()[0], t[0] + 0.25 - 1e-6);
  EXPECT_LT(decimator->times()[0], t[0] + 0.25 + 0.13);
}

TEST(EstimateJointStates, SaysWhatIsWrong) {
  const auto message = [](const Eigen::VectorXd& t, double cutoff) {
    const auto states = EstimateJointStates(MakeRecording(t, Wave(t, 0.1, 0, 0)), Make(cutoff, 1));
    EXPECT_TRUE(states.ok() || states.status().code() == StatusCode::kBadInput);
    return states.ok() ? std::string("ok") : states.status().message();
  };
  // Five periods of 10 samples.
  EXPECT_EQ(message(UniformClock(50, 0.01), 10.0),
            "recording 'test': has 50 samples at 100 Hz; a low-pass at 10 Hz needs at least 51");
  EXPECT_EQ(message(UniformClock(51, 0.01), 10.0), "ok");
  EXPECT_NE(message(UniformClock(2, 0.01), 10.0).find("needs at least 51"), std::string::npos);
  EXPECT_NE(message(UniformClock(500, 0.01), 50.0).find("below half the sampling rate"), std::string::npos);
  EXPECT_NE(message(UniformClock(500, 0.01), 0.0).find("must be positive"), std::string::npos);
  EXPECT_NE(message(UniformClock(500, 0.01), std::nan("")).find("must be positive"), std::string::npos);
  Eigen::VectorXd gap = UniformClock(500, 0.01);
  gap.tail(300).array() += 0.05;
  EXPECT_NE(message(gap, 10.0).find("a gap of 0.06 s without samples after t = 1.99 s"), std::string::npos)
      << message(gap, 10.0);
  EXPECT_EQ(message(gap, 8.0), "ok");

  Preprocessing preprocessing = Make(10.0, 1);
  std::string error;
  preprocessing.options.filter_order = 2;
  EXPECT_FALSE(preprocessing.options.IsValid(&error));
  EXPECT_NE(error.find("filter_order"), std::string::npos);
  preprocessing.options = {};
  preprocessing.options.edge_periods = -1;
  EXPECT_FALSE(
      EstimateJointStates(MakeRecording(UniformClock(500, 0.01), Eigen::VectorXd::Zero(500)), preprocessing).ok());
}

// The shortest recording that is accepted leaves at least one output.
TEST(EstimateJointStates, WhatIsLongEnoughCanBeDecimated) {
  for (const bool jitter : {false, true}) {
    const Eigen::VectorXd t = jitter ? JitteringClock(60, 0.01, 0.1, 4) : UniformClock(51, 0.01);
    const Recording recording = MakeRecording(t, Wave(t, 1.0, 0, 0));
    const auto states = EstimateJointStates(recording, Make(10.0, 10));
    ASSERT_TRUE(states.ok()) << states.status().message();
    const auto decimator = MakeDecimator(recording, Make(10.0, 10));
    ASSERT_TRUE(decimator.ok()) << decimator.status().message();
    EXPECT_GE(decimator->outputs(), 1);
    EXPECT_TRUE(decimator->Apply(states->ddq).allFinite());
  }
}

TEST(AnalyzeClock, TellsUniformFromJittering) {
  const Clock uniform = AnalyzeClock(UniformClock(1000, 0.01, 7.0));
  EXPECT_TRUE(uniform.uniform);
  EXPECT_NEAR(uniform.rate(), 100.0, 1e-6);
  Eigen::VectorXd rounded = UniformClock(45000, 2e-4);
  rounded = (rounded.array() * 1e6).round() / 1e6;
  EXPECT_TRUE(AnalyzeClock(rounded).uniform);
  Eigen::VectorXd missing = UniformClock(1000, 0.01);
  missing.tail(400).array() += 0.01;
  const Clock clock = AnalyzeClock(missing);
  EXPECT_FALSE(clock.uniform);
  EXPECT_EQ(clock.longest, 599);
  EXPECT_NEAR(clock.max_step, 0.02, 1e-12);
  EXPECT_NEAR(clock.step, 0.01, 1e-9);
  // Drift: every step differs from the median by less than a hundredth, the instants do not lie on a grid.
  Eigen::VectorXd drift = UniformClock(1000, 0.01);
  drift.array() += 1e-7 * Eigen::ArrayXd::LinSpaced(1000, 0, 999).square();
  EXPECT_FALSE(AnalyzeClock(drift).uniform);
}

// The controller of the UR10e logs its own velocity: the spline on recorded time must reproduce it.
TEST(EstimateJointStates, AgreesWithTheVelocityThatTheUr10eLogs) {
  const auto recording = LoadUr10e("free_14");
  if (!recording) GTEST_SKIP() << "no recordings here";
  const Preprocessing preprocessing = Make(9.4, 10);
  const auto states = EstimateJointStates(*recording, preprocessing);
  ASSERT_TRUE(states.ok()) << states.status().message();
  EXPECT_FALSE(states->clock.uniform);
  const auto decimator = MakeDecimator(*recording, preprocessing);
  ASSERT_TRUE(decimator.ok());
  const Eigen::MatrixXd logged = decimator->Apply(recording->logged_dq);
  const Eigen::MatrixXd error = decimator->Apply(states->dq) - logged;
  for (int j = 0; j < 6; ++j) EXPECT_LT(error.col(j).norm(), 0.005 * logged.col(j).norm()) << "joint " << j + 1;
}

TEST(MakeDecimator, KeepsTheReferenceOutputsOfTheTx40) {
  const auto recording = LoadTx40();
  if (!recording) GTEST_SKIP() << "no recordings here";
  const auto decimator = MakeDecimator(*recording, Make(100.0, 50));
  ASSERT_TRUE(decimator.ok());
  EXPECT_EQ(decimator->outputs(), 896);
}

}  // namespace
}  // namespace idim::preprocessing_test
