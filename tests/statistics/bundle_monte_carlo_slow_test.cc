// The bundle's errors over repeated draws of a general three-joint arm, mass of the payload known, against what its
// covariances say. No Coulomb friction: its sign is no part of the errors-in-variables model (gain_figure_slow_test.cc
// has it).
//
// Faults that the suite is made for: a derivative of a wrong sign, a derivative dropped, a variance off by 10 %,
// residuals in units of torque. Each test's false-alarm rate is 1e-4, whatever the number of draws; what all of them
// detect is said beside it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <boost/math/distributions/normal.hpp>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "solvers/bundle/bundle.h"
#include "tests/support/draws.h"
#include "tests/support/eiv_draws.h"
#include "tests/support/monte_carlo.h"

namespace idim::bundle_monte_carlo_slow_test {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using testing::Draws;
using testing::EivDraws;
using testing::Inconsistencies;
using ::testing::IsEmpty;
using testing::MonteCarloRun;
using testing::MonteCarloStatistics;
using testing::Print;
using testing::ReportedCovariance;
using testing::RunMonteCarlo;
using testing::Summarize;

constexpr double kAlarm = 1e-4;
constexpr unsigned kSeed = 1;
const Vector3d kJointNoise(3e-5, 0.1, 0.6);

// 2 x (samples - 4) decimated samples at 25 Hz.
EivDraws Arm3(const Vector3d& state_noise, double signal_noise, int samples, double signal_correlation = 0.0) {
  Random random(21);
  testing::GainScenario arm;
  arm.robot = testing::RandomArm("RRR", &random);
  arm.gains = VectorXd{{33.9, -24.2, 6.79}};
  arm.decimation = 20;
  arm.samples = samples * arm.decimation;
  arm.friction.coulomb = false;
  testing::EivNoise noise;
  noise.state = state_noise;
  noise.signal = signal_noise;
  noise.signal_correlation = signal_correlation;
  noise.seed = kSeed;
  return EivDraws(MakeGainStudy(arm), noise);
}

MonteCarloRun Solve(const EivDraws& draws, int run, const BundleOptions& options) {
  return testing::RunOf(SolveBundle(draws.base(), draws.Draw(run), draws.truth(), options), draws.truth(),
                        draws.sigma());
}

BundleOptions KnownSigma(const EivDraws& draws) {
  BundleOptions options;
  options.signal_sigma = draws.sigma();
  options.max_weight_iterations = 0;
  return options;
}

// Three quarters of the residual's variance and more are joint noise. Weights known, so that nothing but the
// errors-in-variables model is judged: of 200 runs x 37 parameters the mean NEES is known to 1.6 %, 7 % is
// detected (a covariance off by 10 % is 10 %); a bias of 0.34 spreads in one parameter.
TEST(BundleMonteCarlo, ErrorsAreWhatTheSchurComplementSays) {
  const EivDraws draws = Arm3(kJointNoise, 0.02, 204);
  const auto results = RunMonteCarlo(Draws(200, 60, kSeed), [&](int r) { return Solve(draws, r, KnownSigma(draws)); });
  ASSERT_THAT(testing::Failures(results), IsEmpty());
  const MonteCarloStatistics statistics = Summarize(results, draws.names(), ReportedCovariance::kSchur);
  Print("weights known", statistics);
  EXPECT_THAT(Inconsistencies(statistics, kAlarm), IsEmpty());
}

// Of one joint: mean variance of the residual at the truth, joint noise included, over that of the signal's noise; and
// the root of the mean of its square.
VectorXd ResidualVariance(const EivDraws& draws) {
  const BundleData data = draws.Draw(0);
  const int n = data.dof;
  StateDerivatives derivatives(draws.base(), data);
  const VectorXd chi = draws.truth().tail(data.num_columns());
  VectorXd squares = VectorXd::Zero(n);
  MatrixXd d;
  for (const BundleSample& sample : data.samples()) {
    derivatives.Torque(sample, chi, &d);
    const MatrixXd b = draws.truth().head(n).cwiseInverse().asDiagonal() * data.inverse_drive * d;
    const MatrixXd v = b * StateCovarianceOf(data, sample.recording) * b.transpose();
    squares += (v.diagonal().cwiseQuotient(draws.sigma().cwiseAbs2()) + VectorXd::Ones(n)).cwiseAbs2();
  }
  return (squares / static_cast<double>(data.samples().size())).cwiseSqrt();
}

// Weights found from the residuals. Over R runs of K samples, the variance found scatters about the true one by
// sqrt(2 / (R K)) of the residual's variance, joint noise included; that each joint is charged with the same part of
// the c unknowns' freedom, and not its own, may move it by c / (n K) of it. R = 30, K = 1600: 0.65 and 0.8 % of
// residual variances that are up to 2.5 times the signal's, together up to 8.5 % at a false alarm of 1e-4. (The joint
// noise is half of the other tests'.) A signal variance off by 10 % is seen, as is a covariance of the joint data off
// by 10 %.
TEST(BundleMonteCarlo, WeightsAreRecovered) {
  const EivDraws draws = Arm3(0.5 * kJointNoise, 0.02, 804);
  const auto results = RunMonteCarlo(Draws(30, 10, kSeed), [&](int r) { return Solve(draws, r, {}); });
  ASSERT_THAT(testing::Failures(results), IsEmpty());
  const VectorXd found = testing::MeanVarianceRatio(results), residual = ResidualVariance(draws);
  const double runs = static_cast<double>(results.size()), samples = 1600.0;
  const double freedom = static_cast<double>(draws.truth().size()) / (3.0 * samples);
  const double quantile = boost::math::quantile(boost::math::normal(), 1.0 - kAlarm / 6.0);
  for (int j = 0; j < 3; ++j) {
    const double tolerance = residual[j] * (quantile * std::sqrt(2.0 / (runs * samples)) + freedom);
    std::printf("joint %d: variance found / true %.4f, allowed +-%.4f, residual's %.3f\n", j + 1, found[j], tolerance,
                residual[j]);
    EXPECT_NEAR(found[j], 1.0, tolerance) << j + 1;
  }
}

// Signal noise of correlation 0.8 from sample to sample. The Schur complement takes its 500 samples a recording for
// independent: its errors are too small, which the mean NEES of p parameters over R runs tells, known to sqrt(2 / (R
// p)) where the covariance is right (4.5 of these: a false alarm of 3e-6), and its intervals hold less often than the
// sandwich's of the same runs. Those hold nine tenths: a coverage of c scatters by sqrt(c (1 - c) / R), the mean of
// correlated parameters by less.
TEST(BundleMonteCarlo, CorrelatedResidualsNeedTheSandwich) {
  const EivDraws draws = Arm3(kJointNoise, 0.02, 504, 0.8);
  const auto results = RunMonteCarlo(Draws(60, 40, kSeed), [&](int r) { return Solve(draws, r, KnownSigma(draws)); });
  ASSERT_THAT(testing::Failures(results), IsEmpty());
  const auto schur = Summarize(results, draws.names(), ReportedCovariance::kSchur);
  const auto robust = Summarize(results, draws.names(), ReportedCovariance::kRobust);
  Print("correlated, Schur", schur);
  Print("correlated, robust", robust);
  const double few = std::sqrt(60.0 / static_cast<double>(results.size()));
  const double terms = static_cast<double>(results.size()) * static_cast<double>(draws.truth().size());
  EXPECT_GT(schur.MeanNees(), 1.0 + 4.5 * std::sqrt(2.0 / terms));
  EXPECT_GT(robust.MeanCoverage(), schur.MeanCoverage() + 0.03);
  EXPECT_GT(robust.MeanCoverage(), 0.9 - 0.05 * few);
}

// Priors on a gain and on a payload parameter, as sharp as the data, drawn about the truth as they claim to be.
TEST(BundleMonteCarlo, PriorsAreCountedOnce) {
  const EivDraws draws = Arm3(kJointNoise, 0.02, 204);
  const std::vector<int> unknowns = {1, static_cast<int>(draws.truth().size()) - 1};
  const MonteCarloRun without = Solve(draws, 0, KnownSigma(draws));
  ASSERT_EQ(without.failure, "");
  const auto results = RunMonteCarlo(Draws(80, 40, kSeed), [&](int r) {
    BundleOptions options = KnownSigma(draws);
    std::mt19937_64 generator(1000 + r);
    std::normal_distribution<double> normal;
    for (const int k : unknowns) {
      const double deviation = std::sqrt(without.covariance(k, k));
      options.priors.push_back({k, draws.truth()[k] + deviation * normal(generator), deviation});
    }
    return Solve(draws, r, options);
  });
  ASSERT_THAT(testing::Failures(results), IsEmpty());
  const MonteCarloStatistics statistics = Summarize(results, draws.names(), ReportedCovariance::kSchur);
  Print("priors", statistics);
  EXPECT_THAT(Inconsistencies(statistics, kAlarm), IsEmpty());
  for (const int k : unknowns) EXPECT_LT(statistics.predicted[k], 0.8 * std::sqrt(without.covariance(k, k)));
}

}  // namespace
}  // namespace idim::bundle_monte_carlo_slow_test
