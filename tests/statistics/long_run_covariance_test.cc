// Long-run covariances against their definitions, written out as sums over pairs of samples.

#include "core/statistics/long_run_covariance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace idim::long_run_covariance_test {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd Noise(Index rows, Index columns) {
  std::mt19937_64 generator(7);
  std::normal_distribution<double> normal;
  MatrixXd result(rows, columns);
  for (double& value : result.reshaped()) value = normal(generator);
  return result;
}

// Of x(k) = rho x(k - 1) + noise.
VectorXd Autoregressive(Index rows, double rho) {
  VectorXd x = Noise(rows, 1);
  for (Index k = 1; k < rows; ++k) x[k] += rho * x[k - 1];
  return x;
}

// Newey & West 1987, eq. (5): pairs up to `lag` apart, weighted by 1 - distance / (lag + 1).
MatrixXd OverPairs(const MatrixXd& rows, const SampleRanges& recordings, int lag) {
  MatrixXd sum = MatrixXd::Zero(rows.cols(), rows.cols());
  for (const auto& [begin, end] : recordings) {
    for (Index a = begin; a < end; ++a) {
      for (Index b = begin; b < end; ++b) {
        const double weight = 1.0 - static_cast<double>(std::abs(a - b)) / (lag + 1.0);
        if (weight > 0.0) sum += weight * rows.row(a).transpose() * rows.row(b);
      }
    }
  }
  return sum;
}

TEST(LongRunCovariance, IsTheWeightedSumOverPairs) {
  const MatrixXd rows = Noise(360, 3);
  // One shorter than the longest lag, one longer than a block of windows.
  const SampleRanges recordings = {{0, 10}, {10, 310}, {310, 360}};
  for (const int lag : {0, 1, 7, 25, 49}) {
    const MatrixXd expected = OverPairs(rows, recordings, lag);
    const double difference = (LongRunCovariance(rows, recordings, lag) - expected).cwiseAbs().maxCoeff();
    EXPECT_LT(difference, 1e-11 * expected.cwiseAbs().maxCoeff()) << lag;
  }
}

// Andrews 1991, (6.2) and (6.4) with alpha(1) of a first-order autoregression; a third of the shortest recording.
double AndrewsLag(const std::vector<double>& rho, double samples) {
  double above = 0.0, below = 0.0;
  for (const double r : rho) {
    above += 4.0 * r * r / (std::pow(1.0 - r, 6) * std::pow(1.0 + r, 2));
    below += 1.0 / std::pow(1.0 - r, 4);
  }
  return 1.1447 * std::pow(above / below * samples, 1.0 / 3.0);
}

double LagOneCorrelation(const VectorXd& x, const SampleRanges& recordings) {
  double lagged = 0.0;
  for (const auto& [begin, end] : recordings) {
    for (Index k = begin + 1; k < end; ++k) lagged += x[k] * x[k - 1];
  }
  return lagged / x.squaredNorm();
}

TEST(LongRunCovariance, LagIsThatOfAndrews) {
  const SampleRanges recordings = {{0, 500}, {500, 800}};
  MatrixXd rows(800, 2);
  for (const double rho : {-0.6, 0.1, 0.4, 0.7}) {
    rows.col(0) = Autoregressive(800, rho);
    rows.col(1) = 5.0 * Noise(800, 1);
    const double one = LagOneCorrelation(rows.col(0), recordings), two = LagOneCorrelation(rows.col(1), recordings);
    EXPECT_NEAR(one, rho, 0.1);
    EXPECT_EQ(ChooseLag(rows, recordings), std::ceil(AndrewsLag({one, two}, 800.0))) << rho;
    EXPECT_EQ(ChooseLag(rows.col(0), recordings), std::ceil(AndrewsLag({one}, 800.0))) << rho;
  }
}

TEST(LongRunCovariance, LagIsAtMostAThirdOfTheShortestRecording) {
  const VectorXd slow = Autoregressive(800, 0.95);
  EXPECT_GT(ChooseLag(slow, {{0, 800}}), 30);
  EXPECT_EQ(ChooseLag(slow, {{0, 710}, {710, 800}}), 30);
  EXPECT_EQ(ChooseLag(slow, {{0, 91}, {91, 800}}), 30);
}

TEST(LongRunCovariance, LagOfWhatDoesNotChange) {
  // A correlation of 1 is taken for 0.97, on either side.
  const VectorXd constant = VectorXd::Ones(1000000);
  EXPECT_EQ(ChooseLag(constant, {{0, 1000000}}), std::ceil(AndrewsLag({0.97}, 1e6)));
  VectorXd alternating = constant;
  for (Index k = 0; k < alternating.size(); k += 2) alternating[k] = -1.0;
  EXPECT_EQ(ChooseLag(alternating, {{0, 1000000}}), std::ceil(AndrewsLag({-0.97}, 1e6)));
  // Columns of zeros have no say.
  EXPECT_EQ(ChooseLag(MatrixXd::Zero(100, 2), {{0, 100}}), 0);
  MatrixXd rows = MatrixXd::Zero(300, 2);
  rows.col(1) = Autoregressive(300, 0.5);
  EXPECT_EQ(ChooseLag(rows, {{0, 300}}), ChooseLag(rows.col(1), {{0, 300}}));
}

}  // namespace
}  // namespace idim::long_run_covariance_test
