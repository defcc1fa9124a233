#include "core/motion/state_covariance.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "tests/signal/signals.h"

namespace idim::state_covariance_test {
namespace {

struct Chain {
  Recording recording;
  Preprocessing preprocessing;
  Decimator decimator;
  StateCovariance covariance;
};

Chain Make(const Eigen::VectorXd& t, double cutoff, int decimation, int order = 4) {
  Preprocessing preprocessing;
  preprocessing.cutoff_hz = cutoff;
  preprocessing.decimation = decimation;
  preprocessing.options.filter_order = order;
  Recording recording = MakeRecording(t, Eigen::MatrixXd::Zero(t.size(), 1));
  Result<Decimator> decimator = MakeDecimator(recording, preprocessing);
  EXPECT_TRUE(decimator.ok()) << decimator.status().message();
  Result<StateCovariance> covariance = StateCovariance::Create(t, preprocessing, *decimator);
  EXPECT_TRUE(covariance.ok()) << covariance.status().message();
  return {recording, preprocessing, *decimator, *covariance};
}

// The columns of q through the whole chain that users call: q, dq, ddq, each outputs x columns (or samples x columns).
std::array<Eigen::MatrixXd, 3> Filter(const Chain& chain, const Eigen::MatrixXd& q, bool decimate) {
  Recording recording = chain.recording;
  recording.q = q;
  const auto states = EstimateJointStates(recording, chain.preprocessing);
  EXPECT_TRUE(states.ok());
  if (!decimate) return {states->q, states->dq, states->ddq};
  return {chain.decimator.Apply(states->q), chain.decimator.Apply(states->dq), chain.decimator.Apply(states->ddq)};
}

// sum over columns of row k of x_a times row l of x_b.
Eigen::Matrix3d Products(const std::array<Eigen::MatrixXd, 3>& x, int k, int l) {
  Eigen::Matrix3d products;
  for (int a = 0; a < 3; ++a) {
    for (int b = 0; b < 3; ++b) products(a, b) = x[a].row(k).dot(x[b].row(l));
  }
  return products;
}

// Entry by entry relative to the root of the product of the variances.
double Distance(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  const Eigen::Vector3d scale = b.diagonal().cwiseSqrt().cwiseInverse();
  return (scale.asDiagonal() * (a - b) * scale.asDiagonal()).cwiseAbs().maxCoeff();
}

const Eigen::VectorXd& Uniform() {
  static const Eigen::VectorXd t = UniformClock(700, 0.002);
  return t;
}
const Eigen::VectorXd& Jittering() {
  static const Eigen::VectorXd t = JitteringClock(600, 0.01, 0.8, 1);
  return t;
}

// A unit impulse at every sample gives the chain's matrix S itself, and the covariance is S S'.
TEST(StateCovariance, UniformClockEqualsTheMatrixOfTheChain) {
  for (const int order : {3, 4, 6}) {
    const Chain chain = Make(Uniform(), 50.0, 10, order);
    const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(700, 700);
    const auto s = Filter(chain, identity, true);
    const int middle = chain.decimator.outputs() / 2;
    EXPECT_LT(Distance(chain.covariance.decimated(), Products(s, middle, middle)), 1e-8);
    EXPECT_LT(Distance(chain.covariance.DecimatedOf({middle})[0], Products(s, middle, middle)), 1e-8);
    for (const int lag : {0, 1, 2, -1, -3, 8}) {
      const Eigen::Matrix3d error = chain.covariance.DecimatedAtLag(lag) - Products(s, middle, middle + lag);
      EXPECT_LT(Distance(chain.covariance.decimated() + error, chain.covariance.decimated()), 1e-8) << lag;
    }
    EXPECT_EQ(chain.covariance.DecimatedAtLag(1000), Eigen::Matrix3d::Zero());
    const auto full = Filter(chain, identity, false);
    EXPECT_LT(Distance(chain.covariance.full_rate(), Products(full, 350, 350)), 1e-8);
    // Outputs whose windows are cut: the documented approximation holds to a factor.
    for (int k = 0; k < chain.decimator.outputs(); ++k) {
      const Eigen::Vector3d ratio = Products(s, k, k).diagonal().cwiseQuotient(chain.covariance.decimated().diagonal());
      const bool cut = k < 8 || k >= chain.decimator.outputs() - 8;
      EXPECT_LT(ratio.maxCoeff(), cut ? 2.0 : 1.001) << k;
      EXPECT_GT(ratio.minCoeff(), cut ? 0.5 : 0.999) << k;
    }
  }
}

TEST(StateCovariance, JitteringClockEqualsTheMatrixOfTheChain) {
  const Chain chain = Make(Jittering(), 10.0, 9);
  const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(600, 600);
  const auto s = Filter(chain, identity, true);
  const int outputs = chain.decimator.outputs();
  std::vector<int> all;
  for (int k = 0; k < outputs; ++k) all.push_back(k);
  const std::vector<Eigen::Matrix3d> covariances = chain.covariance.DecimatedOf(all);
  Eigen::Matrix3d mean = Eigen::Matrix3d::Zero();
  for (int k = 0; k < outputs; ++k) {
    EXPECT_LT(Distance(covariances[k], Products(s, k, k)), 1e-8) << k;
    mean += covariances[k] / outputs;
  }
  // 32 representatives of about 60 outputs.
  EXPECT_LT(Distance(chain.covariance.decimated(), mean), 0.05);
  Eigen::Matrix3d lagged = Eigen::Matrix3d::Zero();
  for (int k = 0; k + 1 < outputs; ++k) lagged += Products(s, k, k + 1) / (outputs - 1);
  EXPECT_LT(Distance(mean + chain.covariance.DecimatedAtLag(1) - lagged, mean), 0.05);
  EXPECT_EQ(chain.covariance.DecimatedAtLag(-1), chain.covariance.DecimatedAtLag(1).transpose());
  const auto full = Filter(chain, identity, false);
  Eigen::Matrix3d expected = Eigen::Matrix3d::Zero();
  for (int i = 60; i < 540; ++i) expected += Products(full, i, i) / 480;
  EXPECT_LT(Distance(chain.covariance.full_rate(), expected), 0.1);
}

TEST(StateCovariance, PositionAndAccelerationAreCorrelatedVelocityIsNot) {
  const Eigen::Matrix3d c = Make(Uniform(), 50.0, 10).covariance.decimated();
  EXPECT_LT(c(0, 2) / std::sqrt(c(0, 0) * c(2, 2)), -0.5);
  EXPECT_NEAR(c(0, 1) / std::sqrt(c(0, 0) * c(1, 1)), 0.0, 1e-9);
  EXPECT_NEAR(c(1, 2) / std::sqrt(c(1, 1) * c(2, 2)), 0.0, 1e-9);
}

// Monte-Carlo with R = 4000 runs of white noise of standard deviation sigma. Each entry of the sample covariance (mean
// known, 0) of Gaussian data has the variance (S_aa S_bb + S_ab^2) / R, Wishart's. 27 entries a clock at 5 standard
// deviations: false alarm below 27 * 2 * 6e-7 = 3e-5 (the seed is fixed); an error of 12 % in a variance is detected
// almost surely.
void MonteCarlo(const Chain& chain, unsigned seed) {
  const int runs = 4000;
  const double sigma = 3e-5;
  const Eigen::MatrixXd noise = sigma * Gaussian(chain.recording.samples(), runs, seed);
  const auto x = Filter(chain, noise, true);
  const std::vector<int> outputs = {chain.decimator.outputs() / 3, chain.decimator.outputs() / 2};
  const auto exact = chain.covariance.DecimatedOf(outputs);
  for (size_t i = 0; i < outputs.size(); ++i) {
    const Eigen::Matrix3d s = sigma * sigma * exact[i];
    const Eigen::Matrix3d found = Products(x, outputs[i], outputs[i]) / runs;
    for (int a = 0; a < 3; ++a) {
      for (int b = a; b < 3; ++b) {
        const double deviation = std::sqrt((s(a, a) * s(b, b) + s(a, b) * s(a, b)) / runs);
        EXPECT_NEAR(found(a, b), s(a, b), 5 * deviation) << "output " << outputs[i] << ", entry " << a << b;
      }
    }
  }
  // Between neighbouring outputs, where the lag's covariance is that of any pair: uniform clocks only.
  if (!AnalyzeClock(chain.recording.t).uniform) return;
  const Eigen::Matrix3d s = sigma * sigma * chain.covariance.decimated();
  const Eigen::Matrix3d lagged = sigma * sigma * chain.covariance.DecimatedAtLag(1);
  const Eigen::Matrix3d found = Products(x, outputs[1], outputs[1] + 1) / runs;
  for (int a = 0; a < 3; ++a) {
    for (int b = 0; b < 3; ++b) {
      const double deviation = std::sqrt((s(a, a) * s(b, b) + lagged(a, b) * lagged(a, b)) / runs);
      EXPECT_NEAR(found(a, b), lagged(a, b), 5 * deviation) << "lag 1, entry " << a << b;
    }
  }
}

TEST(StateCovariance, MonteCarloOnAUniformClock) { MonteCarlo(Make(Uniform(), 50.0, 10), 2); }
TEST(StateCovariance, MonteCarloOnAJitteringClock) { MonteCarlo(Make(Jittering(), 10.0, 9), 3); }
TEST(StateCovariance, MonteCarloWithoutDecimation) { MonteCarlo(Make(Uniform(), 50.0, 1), 4); }

}  // namespace
}  // namespace idim::state_covariance_test
