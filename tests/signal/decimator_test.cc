#include "core/signal/decimator.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/signal/signals.h"

namespace idim::decimator_test {
namespace {

Decimator Make(const Eigen::VectorXd& t, int decimation, double edge_outputs = 2.0, double edge_seconds = 0.0) {
  Result<Decimator> decimator = Decimator::Create(t, AnalyzeClock(t), {decimation, edge_outputs, edge_seconds});
  EXPECT_TRUE(decimator.ok()) << decimator.status().message();
  return std::move(decimator).value();
}

// The taps of a windowed-sinc low-pass with cut-off at 1/D of the Nyquist frequency, as textbooks index them:
// 0 to 20 D.
std::vector<double> Firwin(int d) {
  const int n = 20 * d + 1;
  std::vector<double> taps(n);
  double sum = 0;
  for (int i = 0; i < n; ++i) {
    const double m = i - 0.5 * (n - 1);
    const double hamming = 0.54 - 0.46 * std::cos(2 * M_PI * i / (n - 1));
    taps[i] = hamming * (m == 0 ? 1.0 / d : std::sin(M_PI * m / d) / (M_PI * m));
    sum += taps[i];
  }
  for (double& tap : taps) tap /= sum;
  return taps;
}

TEST(Decimator, KeepsTheReferenceOutputs) {
  const Decimator decimator = Make(UniformClock(45000, 2e-4), 50);
  EXPECT_EQ(decimator.outputs(), 896);
  EXPECT_NEAR(decimator.times()[0], 0.02, 1e-12);
  EXPECT_NEAR(decimator.times()[895], 0.02 + 895 * 0.01, 1e-12);
  EXPECT_EQ(decimator.max_open(), 21);
}

TEST(Decimator, IsTheFirDecimationOnAUniformClock) {
  for (const int d : {2, 3, 7, 50}) {
    const int n = 40 * d + 13;
    const Decimator decimator = Make(UniformClock(n, 0.01), d);
    const Eigen::MatrixXd x = Gaussian(n, 3, 1);
    const Eigen::MatrixXd out = decimator.Apply(x);
    const std::vector<double> taps = Firwin(d);
    int whole = 0;
    for (int k = 0; k < decimator.outputs(); ++k) {
      const int centre = (k + 2) * d;
      // Convolution with the taps inside the recording, divided by the sum of those used.
      Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
      double norm = 0;
      for (int j = 0; j <= 20 * d; ++j) {
        const int i = centre + j - 10 * d;
        if (i < 0 || i >= n) continue;
        sum += taps[j] * x.row(i);
        norm += taps[j];
      }
      whole += centre >= 10 * d && centre + 10 * d < n;
      EXPECT_LT((out.row(k) - sum / norm).norm(), 1e-12) << "D " << d << ", output " << k;
    }
    EXPECT_GE(whole, 20);
    EXPECT_LT(whole, decimator.outputs());
  }
}

TEST(Decimator, TapsAreTheFilter) {
  const Decimator decimator = Make(UniformClock(2000, 0.01), 5);
  const std::vector<double> expected = Firwin(5);
  ASSERT_EQ(decimator.Taps().size(), expected.size());
  for (size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(decimator.Taps()[i], expected[i], 1e-15);
}

TEST(Decimator, ConstantsPassEverywhere) {
  for (const bool jitter : {false, true}) {
    const Eigen::VectorXd t = jitter ? JitteringClock(700, 0.01, 0.8, 2) : UniformClock(700, 0.01);
    for (const double edge : {0.0, 2.0, 15.0}) {
      const Decimator decimator = Make(t, 8, edge);
      const Eigen::MatrixXd out = decimator.Apply(Eigen::MatrixXd::Constant(700, 1, 3.0));
      EXPECT_LT((out.array() - 3.0).abs().maxCoeff(), 1e-13);
      EXPECT_GE(decimator.times()[0], t[0] + edge * 0.08 * 0.99 * (1 - 0.1 * jitter));
    }
  }
}

// What a caller does with a ring of accumulators gives the same numbers, in one pass over the samples.
TEST(Decimator, StreamsThroughARing) {
  for (const bool jitter : {false, true}) {
    for (const int d : {1, 4, 60}) {
      const int n = 2000;
      const Eigen::VectorXd t = jitter ? JitteringClock(n, 0.01, 0.8, 3) : UniformClock(n, 0.01);
      const Decimator decimator = Make(t, d, 3.0, 0.05);
      const Eigen::MatrixXd x = Gaussian(n, 1, 4);
      const int ring = decimator.max_open();
      EXPECT_LE(ring, d == 1 ? 1 : 23);
      std::vector<double> accumulators(ring, 0.0);
      std::vector<double> out;
      int previous = 0;
      for (int i = 0; i < n; ++i) {
        const Decimator::Contribution part = decimator.At(i);
        ASSERT_GE(part.count, 0);
        ASSERT_LE(part.count, ring);
        if (part.count == 0) continue;
        ASSERT_GE(part.first, previous);
        previous = part.first;
        for (int j = 0; j < part.count; ++j) accumulators[(part.first + j) % ring] += part.weights[j] * x(i, 0);
        while (static_cast<int>(out.size()) < decimator.outputs() &&
               decimator.LastSample(static_cast<int>(out.size())) == i) {
          double& done = accumulators[out.size() % ring];
          out.push_back(done);
          done = 0;
        }
      }
      const Eigen::MatrixXd expected = decimator.Apply(x);
      ASSERT_EQ(static_cast<int>(out.size()), decimator.outputs());
      for (int k = 0; k < decimator.outputs(); ++k) ASSERT_NEAR(out[k], expected(k, 0), 1e-14) << k;
    }
  }
}

TEST(Decimator, JitterThatVanishesGivesTheUniformResult) {
  const int n = 1000;
  const Eigen::VectorXd uniform = UniformClock(n, 0.01, 100.0);
  // Beyond the tolerance for a uniform clock by little, so that the other path is taken.
  Eigen::VectorXd t = uniform;
  for (int i = 1; i + 1 < n; i += 2) t[i] += 0.0101 * 0.01;
  ASSERT_FALSE(AnalyzeClock(t).uniform);
  const Eigen::MatrixXd x = Wave(uniform, 1.0, 0.3, 0);
  const Eigen::MatrixXd a = Make(uniform, 10).Apply(x);
  const Eigen::MatrixXd b = Make(t, 10).Apply(Wave(t, 1.0, 0.3, 0));
  const int common = static_cast<int>(std::min(a.rows(), b.rows()));
  EXPECT_NEAR(a.rows(), b.rows(), 1.0);
  // Steps differ by 2 %: h^2 terms by 4 %, of an error that is itself below 1e-3 here.
  EXPECT_LT((a.topRows(common) - b.topRows(common)).lpNorm<Eigen::Infinity>(), 2e-4);
}

// The bound of the header: the sum is the trapezoidal rule for int g y ds / int g ds, each of whose steps errs by at
// most step^3 / 12 max |(g y)''|.
TEST(Decimator, QuadratureErrorIsWithinItsBound) {
  const int n = 3000, d = 8;
  const double step = 0.01, period = d * step;
  const Eigen::VectorXd t = JitteringClock(n, step, 0.8, 5);
  const Clock clock = AnalyzeClock(t);
  const Decimator decimator = Make(t, d);
  const double nominal = d * clock.step;
  EXPECT_NEAR(nominal, period, 0.1 * period);
  const auto g = [&](double s) {
    const double u = s / nominal;
    if (std::abs(u) > 10) return 0.0;
    const double sinc = std::abs(u) < 1e-9 ? 1.0 : std::sin(M_PI * u) / (M_PI * u);
    return sinc * (0.54 + 0.46 * std::cos(M_PI * u / 10));
  };
  for (const double f : {0.5, 2.0, 5.0}) {
    const Eigen::MatrixXd out = decimator.Apply(Wave(t, f, 0.3, 0));
    for (const int k : {30, 100, 200, 300}) {
      const double centre = decimator.times()[k];
      double signal = 0, norm = 0, curvature_signal = 0, curvature = 0;
      const double e = nominal / 400;
      const auto y = [&](double s) { return std::cos(2 * M_PI * f * (centre + s) + 0.3); };
      for (double s = -10 * nominal; s <= 10 * nominal; s += e) {
        signal += e * g(s) * y(s);
        norm += e * g(s);
        curvature_signal += std::abs(g(s + e) * y(s + e) - 2 * g(s) * y(s) + g(s - e) * y(s - e)) / e;
        curvature += std::abs(g(s + e) - 2 * g(s) + g(s - e)) / e;
      }
      const double bound = clock.max_step * clock.max_step / 12 * (curvature_signal + curvature) / norm;
      EXPECT_LE(std::abs(out(k, 0) - signal / norm), bound) << f << " Hz, output " << k;
      // The bound means something: it is well below the signal.
      if (f < 1) {
        EXPECT_LT(bound, 0.2);
      }
      EXPECT_LT(std::abs(out(k, 0) - signal / norm), 0.03);
    }
  }
}

TEST(Decimator, OneIsTheIdentityOnEitherClock) {
  for (const bool jitter : {false, true}) {
    const Eigen::VectorXd t = jitter ? JitteringClock(200, 0.01, 0.8, 6) : UniformClock(200, 0.01, 5.0);
    const Decimator decimator = Make(t, 1, 2.0, 0.1);
    const Eigen::MatrixXd x = Gaussian(200, 2, 7);
    const int first = static_cast<int>(std::find(t.data(), t.data() + 200, decimator.times()[0]) - t.data());
    ASSERT_LT(first, 30);
    EXPECT_GE(t[first], t[0] + 0.1 - 1e-6);
    EXPECT_LT(t[first - 1], t[0] + 0.1);
    EXPECT_EQ(decimator.Apply(x), x.middleRows(first, decimator.outputs()));
    EXPECT_EQ(decimator.times(), t.segment(first, decimator.outputs()));
  }
}

TEST(Decimator, EdgesByTheLongerOfOutputsAndSeconds) {
  const Eigen::VectorXd t = UniformClock(1001, 0.01);
  EXPECT_EQ(Make(t, 10, 0.0).outputs(), 101);
  EXPECT_EQ(Make(t, 10, 2.0).outputs(), 97);
  EXPECT_EQ(Make(t, 10, 2.0, 0.35).outputs(), 93);
}

TEST(Decimator, RefusesWhatItCannotDo) {
  const Eigen::VectorXd t = UniformClock(100, 0.01);
  const auto message = [](const Eigen::VectorXd& clock, const DecimatorOptions& options) {
    const Result<Decimator> result = Decimator::Create(clock, AnalyzeClock(clock), options);
    return result.ok() ? std::string("ok") : result.status().message();
  };
  EXPECT_NE(message(t, {0, 2.0, 0.0}).find("decimation is 0"), std::string::npos);
  EXPECT_NE(message(t, {2, -1.0, 0.0}).find("edge_outputs"), std::string::npos);
  EXPECT_NE(message(t, {2, 1.0, std::nan("")}).find("edge_seconds"), std::string::npos);
  EXPECT_NE(message(t, {2, 1.0, 0.6}).find("nothing is left of 100 samples"), std::string::npos);
  EXPECT_NE(message(t, {60, 2.0, 0.0}).find("nothing is left"), std::string::npos);
  Eigen::VectorXd gap = t;
  gap.tail(50).array() += 0.05;
  EXPECT_NE(message(gap, {4, 2.0, 0.0}).find("after t = 0.49 s"), std::string::npos) << message(gap, {4, 2.0, 0.0});
  EXPECT_EQ(message(gap, {1, 2.0, 0.0}), "ok");
}

}  // namespace
}  // namespace idim::decimator_test
