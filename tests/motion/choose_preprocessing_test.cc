#include "core/motion/choose_preprocessing.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/signal/butterworth.h"
#include "core/signal/spectrum.h"
#include "tests/motion/real_recordings.h"
#include "tests/signal/signals.h"

namespace idim::choose_preprocessing_test {
namespace {

Preprocessing Choose(const std::vector<const Recording*>& recordings, const PreprocessingRequest& request = {}) {
  const auto chosen = ChoosePreprocessing(recordings, request);
  EXPECT_TRUE(chosen.ok()) << chosen.status().message();
  return chosen.ok() ? *chosen : Preprocessing();
}

// White noise through a zero-phase filter of order 2 at f0 has the density D / (1 + (f / f0)^4)^2, the encoder's noise
// D / 10^13 (in power): they meet at f0 (10^6.5)^(1/4) = 42.2 f0. The velocity's power is below
// f0 (5 int x^2 / (1 + x^4)^2 dx / 1000)^(-1/5) = 3.72 f0 to 99.9 %, so that the crossing lies within its limits.
Recording Coloured(const Eigen::VectorXd& t, double f0, unsigned seed) {
  const int fine = 4 * static_cast<int>(t.size());
  const double step = (t[t.size() - 1] - t[0]) / (fine - 1);
  Eigen::MatrixXd q(t.size(), 3);
  for (int j = 0; j < 2; ++j) {
    // On a grid four times as fine, read at the recorded instants by cubic interpolation.
    const Eigen::VectorXd x = ButterworthFilter(2, f0, step).ZeroPhase(Gaussian(fine, 1, seed + j));
    for (int i = 0; i < t.size(); ++i) {
      const double u = (t[i] - t[0]) / step;
      const int k = std::min(std::max(static_cast<int>(u), 1), fine - 3);
      const double s = u - k;
      q(i, j) = -s * (s - 1) * (s - 2) / 6 * x[k - 1] + (s + 1) * (s - 1) * (s - 2) / 2 * x[k] -
                (s + 1) * s * (s - 2) / 2 * x[k + 1] + (s + 1) * s * (s - 1) / 6 * x[k + 2];
    }
    // One-sided density of the input 2 step, of white noise of deviation sigma 2 h sigma^2.
    const double h = (t[t.size() - 1] - t[0]) / static_cast<double>(t.size() - 1);
    q.col(j) += std::sqrt(step / h * 1e-13) * Gaussian(t.size(), 1, seed + 10 + j);
  }
  // A joint that stands still says nothing.
  q.col(2).setConstant(1.0);
  return MakeRecording(t, q);
}

TEST(ChoosePreprocessing, FindsTheCrossing) {
  const Recording uniform = Coloured(UniformClock(40000, 5e-3), 0.5, 1);
  const Preprocessing chosen = Choose({&uniform});
  EXPECT_NEAR(chosen.cutoff_hz, 21.1, 0.15 * 21.1) << chosen.reason;
  EXPECT_EQ(chosen.decimation, static_cast<int>(200.0 / chosen.cutoff_hz)) << chosen.reason;
  EXPECT_NE(chosen.reason.find("there"), std::string::npos) << chosen.reason;

  const Recording jittering = Coloured(JitteringClock(40000, 5e-3, 0.4, 5), 0.5, 2);
  EXPECT_NEAR(Choose({&jittering}).cutoff_hz, 21.1, 0.15 * 21.1);
}

// Sines up to 2 Hz and nothing above: the crossing is where they end, the cut-off five times that.
TEST(ChoosePreprocessing, LeavesRoomAboveTheMotion) {
  const Eigen::VectorXd t = UniformClock(20000, 5e-3);
  Eigen::VectorXd q = 1e-5 * Gaussian(20000, 1, 3);
  for (int k = 1; k <= 10; ++k) q += Wave(t, 0.2 * k, 0.7 * k * k, 0) / k;
  const Recording recording = MakeRecording(t, q);
  const Preprocessing chosen = Choose({&recording});
  EXPECT_GE(chosen.cutoff_hz, 10.0) << chosen.reason;
  EXPECT_LE(chosen.cutoff_hz, 12.0) << chosen.reason;
}

// Without noise the position never meets it: twenty times the motion, but not above 0.4 of the rate.
TEST(ChoosePreprocessing, KeepsTheUpperLimits) {
  const Eigen::VectorXd t = UniformClock(20000, 5e-3);
  const Recording slow = MakeRecording(t, Wave(t, 0.5, 0.1, 0));
  const Preprocessing chosen = Choose({&slow});
  EXPECT_LE(chosen.cutoff_hz, 20 * 0.7) << chosen.reason;
  EXPECT_GE(chosen.cutoff_hz, 5 * 0.5) << chosen.reason;
  Recording fast = Coloured(UniformClock(40000, 5e-3), 6.0, 4);
  fast.name = "fast";
  const Preprocessing limited = Choose({&fast, &slow});
  EXPECT_NEAR(limited.cutoff_hz, 80.0, 1e-9) << limited.reason;
  EXPECT_EQ(limited.decimation, 2);
}

TEST(ChoosePreprocessing, RequestsOverride) {
  const Recording recording = Coloured(UniformClock(4000, 5e-3), 0.5, 6);
  Preprocessing chosen = Choose({&recording}, {12.5, 3});
  EXPECT_EQ(chosen.cutoff_hz, 12.5);
  EXPECT_EQ(chosen.decimation, 3);
  EXPECT_NE(chosen.reason.find("as requested; decimation 3 as requested"), std::string::npos) << chosen.reason;
  chosen = Choose({&recording}, {12.5, std::nullopt});
  EXPECT_EQ(chosen.decimation, 16);
  const double free = Choose({&recording}).cutoff_hz;
  chosen = Choose({&recording}, {std::nullopt, 3});
  EXPECT_EQ(chosen.cutoff_hz, free);
  EXPECT_EQ(chosen.decimation, 3);
  EXPECT_FALSE(ChoosePreprocessing({&recording}, {100.0, 3}).ok());
  EXPECT_FALSE(ChoosePreprocessing({&recording}, {-1.0, 3}).ok());
  EXPECT_FALSE(ChoosePreprocessing({&recording}, {std::nan(""), 3}).ok());
  EXPECT_FALSE(ChoosePreprocessing({&recording}, {10.0, 0}).ok());
}

TEST(ChoosePreprocessing, RefusesWhatSaysNothing) {
  const auto message = [](const Eigen::VectorXd& t, const Eigen::VectorXd& q) {
    const Recording recording = MakeRecording(t, q);
    const auto chosen = ChoosePreprocessing({&recording}, {});
    return chosen.ok() ? "ok" : chosen.status().message();
  };
  const Eigen::VectorXd t = UniformClock(1000, 0.01);
  EXPECT_NE(message(t, Eigen::VectorXd::Constant(1000, 0.5)).find("no joint moves"), std::string::npos);
  EXPECT_NE(message(t.head(63), Wave(t.head(63), 1, 0, 0)).find("has 63 samples"), std::string::npos);
  Eigen::VectorXd gap = t;
  gap.tail(300).array() += 0.06;
  EXPECT_NE(message(gap, Wave(gap, 1, 0, 0)).find("after t = 6.99 s"), std::string::npos)
      << message(gap, Wave(gap, 1, 0, 0));
}

// A short gap lowers the cut-off until the filter accepts the recording.
TEST(ChoosePreprocessing, LowersTheCutoffForAGap) {
  Eigen::VectorXd t = UniformClock(4000, 0.01);
  t.tail(1000).array() += 0.035;
  const Recording recording = MakeRecording(t, Wave(t, 2.0, 0.1, 0) + 1e-6 * Gaussian(4000, 1, 8));
  Preprocessing chosen = Choose({&recording});
  EXPECT_NE(chosen.reason.find("gap"), std::string::npos) << chosen.reason;
  EXPECT_NEAR(chosen.cutoff_hz, 0.5 / 0.045, 0.2);
  EXPECT_TRUE(EstimateJointStates(recording, chosen).ok());
}

// People chose 100 Hz, D = 50 for the TX-40 and 9.4 Hz, about D = 10, for the UR10e.
TEST(ChoosePreprocessing, ComesNearWhatPeopleChoseForRealArms) {
  const auto tx40 = LoadTx40();
  if (!tx40) GTEST_SKIP() << "no recordings here";
  Preprocessing chosen = Choose({&*tx40});
  EXPECT_GE(chosen.cutoff_hz, 100 / 1.5) << chosen.reason;
  EXPECT_LE(chosen.cutoff_hz, 100 * 1.5) << chosen.reason;
  const auto free_12 = LoadUr10e("free_12");
  const auto free_14 = LoadUr10e("free_14");
  ASSERT_TRUE(free_12 && free_14);
  chosen = Choose({&*free_12, &*free_14});
  EXPECT_GE(chosen.cutoff_hz, 9.4 / 1.5) << chosen.reason;
  EXPECT_LE(chosen.cutoff_hz, 9.4 * 1.5) << chosen.reason;
  EXPECT_TRUE(EstimateJointStates(*free_14, chosen).ok());
}

TEST(WelchSpectrum, IntegratesToTheVarianceAndFindsALine) {
  const double step = 0.01;
  const Eigen::MatrixXd noise = Gaussian(100000, 1, 9);
  const Spectrum white = WelchSpectrum(2.0 * noise, step, 1024);
  // 194 segments: each bin scatters by 7 %, the mean of 500 by 0.5 %.
  EXPECT_NEAR(white.density.col(0).segment(5, 500).mean(), 4 * 2 * step, 0.03 * 8 * step);
  EXPECT_NEAR(white.frequency[512], 50.0, 1e-9);
  const Eigen::VectorXd t = UniformClock(8192, step);
  const Spectrum line = WelchSpectrum(3.0 * Wave(t, 12.5, 0.1, 0), step, 1024);
  EXPECT_NEAR(line.density.col(0).sum() * line.frequency[1], 4.5, 1e-6);
  Eigen::Index peak = 0;
  line.density.col(0).maxCoeff(&peak);
  EXPECT_NEAR(line.frequency[peak], 12.5, 1e-9);
}

}  // namespace
}  // namespace idim::choose_preprocessing_test
