#include "core/motion/encoder_noise.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/signal/signals.h"

namespace idim::encoder_noise_test {
namespace {

// Tolerances: the median of B block variances with nu degrees of freedom has the relative standard deviation
// 1.253 sqrt(2 / (nu B)), sigma half of it. With N samples and c >= 0.7 of them free, that is at most
// 1.06 / sqrt(N), 0.9 % for the 14 000 samples and 1.4 % for the 6 000 below. 4 % (3 % on the longer ones) is 3 to 4 of
// these and the one per cent that c and the median of chi^2 are good to; the seeds are fixed.

Preprocessing Make(double cutoff) {
  Preprocessing preprocessing;
  preprocessing.cutoff_hz = cutoff;
  preprocessing.decimation = 1;
  return preprocessing;
}

EncoderNoise Estimate(const Recording& recording, double cutoff) {
  const auto states = EstimateJointStates(recording, Make(cutoff));
  EXPECT_TRUE(states.ok()) << states.status().message();
  const auto noise = EstimateEncoderNoise(recording, Make(cutoff), *states);
  EXPECT_TRUE(noise.ok()) << noise.status().message();
  return *noise;
}

Eigen::VectorXd Motion(const Eigen::VectorXd& t) { return Wave(t, 0.31, 0.1, 0) + 0.2 * Wave(t, 1.7, 1.0, 0); }

Eigen::VectorXd Quantized(const Eigen::VectorXd& x, double step) { return (x / step).array().round() * step; }

// 1 rad there in 4 s, rest for 4 s, back in 4 s, rest for 4 s.
Eigen::VectorXd MotionWithDwells(const Eigen::VectorXd& t) {
  return t.unaryExpr([&](double time) {
    const double phase = std::fmod(time - t[0], 16.0);
    const double u = std::min(std::fmod(phase, 8.0), 4.0) / 4.0;
    const double there = u * u * u * (10 - 15 * u + 6 * u * u);
    return phase < 8 ? there : 1 - there;
  });
}

TEST(EstimateEncoderNoise, FindsKnownNoiseOnAUniformClock) {
  const Eigen::VectorXd t = UniformClock(20000, 1e-3);
  for (const double cutoff : {10.0, 60.0, 150.0}) {
    Eigen::MatrixXd q(20000, 2);
    q.col(0) = Motion(t) + 5e-5 * Gaussian(20000, 1, 1);
    q.col(1) = Motion(t) + 8e-6 * Gaussian(20000, 1, 2);
    const EncoderNoise noise = Estimate(MakeRecording(t, q), cutoff);
    EXPECT_NEAR(noise.sigma[0] / 5e-5, 1.0, 0.03) << cutoff;
    EXPECT_NEAR(noise.sigma[1] / 8e-6, 1.0, 0.03) << cutoff;
    EXPECT_EQ(noise.quantization[0], 0.0);
  }
}

TEST(EstimateEncoderNoise, FindsKnownNoiseOnAJitteringClock) {
  const Eigen::VectorXd t = JitteringClock(6000, 0.01, 0.6, 3);
  for (const double cutoff : {8.0, 15.0}) {
    const Eigen::VectorXd q = Motion(t) + 5e-5 * Gaussian(6000, 1, 4);
    EXPECT_NEAR(Estimate(MakeRecording(t, q), cutoff).sigma[0] / 5e-5, 1.0, 0.04) << cutoff;
  }
}

// Quantisation adds step^2 / 12 to the noise in motion; in dwells the data repeat themselves and must not pull it down.
TEST(EstimateEncoderNoise, AddsQuantizationAndIgnoresDwells) {
  for (const bool jitter : {false, true}) {
    const int n = jitter ? 12000 : 28000;
    const Eigen::VectorXd t = jitter ? JitteringClock(n, 0.01, 0.6, 5) : UniformClock(n, 4e-3);
    for (const double sigma : {2e-5, 6e-5}) {
      const Eigen::VectorXd clean = MotionWithDwells(t);
      Eigen::VectorXd q = Quantized(clean + sigma * Gaussian(n, 1, 6), 1e-4);
      // At rest the encoder stands still.
      for (int i = 1; i < n; ++i) {
        if (clean[i] == clean[i - 1]) q[i] = q[i - 1];
      }
      const EncoderNoise noise = Estimate(MakeRecording(t, q), 8.0);
      EXPECT_NEAR(noise.quantization[0], 1e-4, 1e-9);
      EXPECT_NEAR(noise.sigma[0] / std::sqrt(sigma * sigma + 1e-8 / 12), 1.0, 0.05)
          << sigma << (jitter ? " jitter" : "");
    }
  }
}

TEST(EstimateEncoderNoise, ShocksInAFewBlocksDoNotMoveIt) {
  const Eigen::VectorXd t = UniformClock(20000, 1e-3);
  Eigen::VectorXd q = Motion(t) + 5e-5 * Gaussian(20000, 1, 7);
  // 100 Hz with 100 sigma in a tenth of the time.
  for (int i = 0; i < 20000; ++i) {
    if (i % 5000 < 500) q[i] += 5e-3 * std::cos(2 * M_PI * 100 * t[i]);
  }
  // A tenth of the blocks above shifts the median to the 0.556 quantile of the others: 0.14 of their relative standard
  // deviation, 9 % for blocks of about 130, plus a block or two at the borders.
  EXPECT_NEAR(Estimate(MakeRecording(t, q), 30.0).sigma[0] / 5e-5, 1.0, 0.05);
}

TEST(EstimateEncoderNoise, FloorsAndSubstitutes) {
  const Eigen::VectorXd t = UniformClock(8000, 2e-3);
  Eigen::MatrixXd q(8000, 3);
  q.col(0) = Motion(t) + 5e-5 * Gaussian(8000, 1, 8);
  q.col(1).setConstant(0.7);
  // Rests but for a creep of 25 single steps.
  q.col(2) = (Eigen::ArrayXd::LinSpaced(8000, 0, 25).floor() * 1e-4).matrix();
  const EncoderNoise noise = Estimate(MakeRecording(t, q), 30.0);
  EXPECT_EQ(noise.sigma[1], noise.sigma[0]);
  EXPECT_NE(noise.provenance[1].find("never moves"), std::string::npos);
  EXPECT_NEAR(noise.sigma[2], 1e-4 / std::sqrt(12.0), 1e-9);
  EXPECT_NE(noise.provenance[2].find("quantisation"), std::string::npos);

  const Recording still = MakeRecording(t, Eigen::MatrixXd::Constant(8000, 2, 0.3));
  const auto states = EstimateJointStates(still, Make(30.0));
  ASSERT_TRUE(states.ok());
  const auto refused = EstimateEncoderNoise(still, Make(30.0), *states);
  ASSERT_FALSE(refused.ok());
  EXPECT_NE(refused.status().message().find("no joint moves"), std::string::npos);
}

// The shortest recording that the filter accepts still gives a figure of the right size.
TEST(EstimateEncoderNoise, WorksOnTheShortestRecording) {
  for (const bool jitter : {false, true}) {
    const Eigen::VectorXd t = jitter ? JitteringClock(60, 0.01, 0.1, 10) : UniformClock(51, 0.01);
    const Eigen::VectorXd q = Wave(t, 0.5, 0.1, 0) + 1e-3 * Gaussian(t.size(), 1, 11);
    const double sigma = Estimate(MakeRecording(t, q), 10.0).sigma[0];
    // About 20 degrees of freedom: 16 % standard deviation.
    EXPECT_GT(sigma, 0.4e-3);
    EXPECT_LT(sigma, 1.6e-3);
  }
}

TEST(QuantizationStep, IsFoundOnlyWhereThereIsOne) {
  const Eigen::VectorXd t = UniformClock(5000, 1e-2);
  const Eigen::VectorXd x = Motion(t) + 3e-4 * Gaussian(5000, 1, 9);
  EXPECT_EQ(QuantizationStep(x), 0.0);
  EXPECT_NEAR(QuantizationStep(Quantized(x, 1e-4)), 1e-4, 1e-10);
  EXPECT_NEAR(QuantizationStep(Quantized(x, 2 * M_PI / 8192)), 2 * M_PI / 8192, 1e-9);
  EXPECT_EQ(QuantizationStep(Eigen::VectorXd::Constant(100, 2.0)), 0.0);
}

}  // namespace
}  // namespace idim::encoder_noise_test
