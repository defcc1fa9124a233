// The three residuals of the errors-in-variables bundle: values by hand, which a wrong sign does not survive, and
// derivatives against numeric ones, which say nothing about values.

#include <ceres/gradient_checker.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <memory>
#include <vector>

#include "residuals/joint_state_residual.h"
#include "residuals/parameter_prior_residual.h"
#include "residuals/torque_residual.h"
#include "tests/support/random_arm.h"

namespace idim::bundle_residuals_test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using RowMajorMatrix = TorqueResidual::RowMajorMatrix;

VectorXd Evaluate(const ceres::CostFunction& cost, const std::vector<const double*>& blocks) {
  VectorXd residuals(cost.num_residuals());
  EXPECT_TRUE(cost.Evaluate(blocks.data(), residuals.data(), nullptr));
  return residuals;
}

void ExpectDerivatives(const ceres::CostFunction& cost, const std::vector<const double*>& blocks) {
  const std::vector<const ceres::Manifold*>* none = nullptr;
  ceres::GradientChecker checker(&cost, none, ceres::NumericDiffOptions());
  ceres::GradientChecker::ProbeResults results;
  EXPECT_TRUE(checker.Probe(blocks.data(), 1e-7, &results)) << results.error_log;
}

// W = (2, 3), known torque 5, moved by d_q = 0.2 to (2.2, 3) and 5.1: torque 1.1 - 3 + 5.1 = 3.2 with
// chi = (0.5, -1), 1.6 on the motor's side of a gear 1/2, a signal of 0.4 at gain 4; 1.0 measured, sigma 0.3.
TEST(TorqueResidual, IsMeasuredMinusModelInStandardDeviationsOfTheSignal) {
  RowMajorMatrix columns(1, 3), by_q(1, 3), by_dq(1, 3), by_ddq(1, 3);
  columns << 2.0, 3.0, 5.0;
  by_q << 1.0, 0.0, 0.5;
  by_dq << 0.0, 7.0, 0.0;
  by_ddq << 0.0, 0.0, 11.0;
  const std::unique_ptr<ceres::CostFunction> cost(
      TorqueResidual::Create(columns, {by_q, by_dq, by_ddq}, VectorXd::Constant(1, 1.0), VectorXd::Constant(1, 0.3),
                             MatrixXd::Constant(1, 1, 0.5)));
  const double theta[] = {4.0, 0.5, -1.0};
  const double deviation[] = {0.2, 0.0, 0.0};
  EXPECT_NEAR(Evaluate(*cost, {theta, deviation})[0], 2.0, 1e-14);
  // d_dq = 0.1 adds 0.7 to the second column, torque -0.7; d_ddq = 0.1 adds 1.1: in all 3.6, a signal of 0.45.
  const double other[] = {0.2, 0.1, 0.1};
  EXPECT_NEAR(Evaluate(*cost, {theta, other})[0], (1.0 - 0.45) / 0.3, 1e-14);
  const double zero_gain[] = {0.0, 0.5, -1.0};
  const double* blocks[] = {zero_gain, deviation};
  double residual = 0.0;
  EXPECT_FALSE(cost->Evaluate(blocks, &residual, nullptr));
}

TEST(TorqueResidual, DerivativesAreThoseOfTheValue) {
  Random random(3);
  const int n = 3, c = 7;
  const auto matrix = [&](int rows, int cols) {
    return MatrixXd(MatrixXd::NullaryExpr(rows, cols, [&] { return random.Uniform(-1.0, 1.0); }));
  };
  std::vector<RowMajorMatrix> derivatives;
  for (int s = 0; s < 3 * n; ++s) derivatives.emplace_back(matrix(n, c + 1));
  const std::unique_ptr<ceres::CostFunction> cost(TorqueResidual::Create(
      matrix(n, c + 1), derivatives, random.Vector(n, 1.0), VectorXd{{0.3, 0.5, 0.8}}, matrix(n, n)));
  VectorXd theta(n + c);
  theta << 1.3, -0.7, 2.1, random.Vector(c, 1.0);
  const VectorXd deviation = random.Vector(3 * n, 0.5);
  ExpectDerivatives(*cost, {theta.data(), deviation.data()});
}

// d = (q1, q2, dq1, dq2, ddq1, ddq2); standard deviations (2, 3, 4) and (1, 5, 10).
TEST(JointStateResidual, OrdersByJoint) {
  const Eigen::Matrix3d first = Eigen::Vector3d(4.0, 9.0, 16.0).asDiagonal();
  const Eigen::Matrix3d second = Eigen::Vector3d(1.0, 25.0, 100.0).asDiagonal();
  const std::unique_ptr<ceres::CostFunction> cost(JointStateResidual::Create({first, second}));
  const double deviation[] = {2.0, 3.0, 6.0, 10.0, 12.0, 50.0};
  const VectorXd expected{{1.0, 2.0, 3.0, 3.0, 2.0, 5.0}};
  EXPECT_LT((Evaluate(*cost, {deviation}) - expected).norm(), 1e-14);
}

// Variances as far apart as those of encoders at 1 kHz, position and acceleration correlated.
TEST(JointStateResidual, SquaresToTheMahalanobisDistance) {
  Eigen::Matrix3d covariance;
  covariance << 4e-10, 0.0, -0.7 * 2e-5 * 0.7, 0.0, 2.25e-6, 0.0, -0.7 * 2e-5 * 0.7, 0.0, 0.49;
  const std::unique_ptr<ceres::CostFunction> cost(JointStateResidual::Create({covariance}));
  const Eigen::Vector3d deviation(3e-5, -1e-3, 0.4);
  const VectorXd residual = Evaluate(*cost, {deviation.data()});
  // By hand: with u = 1.5, w = 4/7 standard deviations of the correlated pair, rho = -0.7.
  const double u = 1.5, w = 0.4 / 0.7, rho = -0.7;
  const double expected = (u * u - 2.0 * rho * u * w + w * w) / (1.0 - rho * rho) + std::pow(1e-3 / 1.5e-3, 2);
  EXPECT_NEAR(residual.squaredNorm(), expected, 1e-12 * expected);
  EXPECT_GT(residual[0], 0.0);
  ExpectDerivatives(*cost, {deviation.data()});
}

TEST(ParameterPriorResidual, IsTheDistanceInStandardDeviations) {
  const std::unique_ptr<ceres::CostFunction> cost(ParameterPriorResidual::Create(4, 2, 4.59, 0.01));
  const double theta[] = {1.0, 2.0, 4.62, 3.0};
  EXPECT_NEAR(Evaluate(*cost, {theta})[0], 3.0, 1e-12);
  ExpectDerivatives(*cost, {theta});
}

}  // namespace
}  // namespace idim::bundle_residuals_test
