// What columns explain beyond a fitted bundle, against dense least squares, and the size of the test.

#include "solvers/bundle/residual_model.h"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "core/base/decompositions.h"
#include "solvers/bundle/bundle_problem.h"
#include "solvers/loop/effect_fit.h"
#include "tests/support/simulated_study.h"

namespace idim::testing::residual_model_test {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

struct Fitted {
  EffectFit fit;
  ResidualModel model;
  MatrixXd j;  // whitened columns of all unknowns
};

const Fitted& Arm(bool effect) {
  const auto make = [](bool with) {
    SimulatedStudy study;
    if (with) {
      ReplaceOnce("recordings:\n", "effects:\n  - {id: joint_spring, joints: [2], stiffness: 3.0}\nrecordings:\n",
                  &study.scenario_text);
    }
    study.Simulate();
    Result<EffectFit> fit = FitDeclared(study.Prepare());
    if (!fit.ok()) throw std::runtime_error(fit.status().message());
    ResidualModel model(fit->prepared.base(), fit->data, fit->summary);
    BundleProblem problem(fit->prepared.base(), fit->data, fit->data.priors, HuberNorm{});
    problem.HoldFriction(fit->summary.values);
    const BundleProblem::Rows rows = problem.Linearize(fit->summary.values, fit->summary.signal_sigma);
    MatrixXd j = rows.rows.leftCols(fit->data.num_unknowns());
    const VectorXd scale = j.colwise().norm().cwiseInverse();
    j = (j * scale.asDiagonal()).eval();
    return new Fitted{std::move(fit).value(), std::move(model), std::move(j)};
  };
  static const Fitted* const without = make(false);
  static const Fitted* const with = make(true);
  return effect ? *with : *without;
}

// First-order autoregressive columns.
MatrixXd RandomColumns(Index samples, int dof, int columns, double rho, std::mt19937_64* generator) {
  std::normal_distribution<double> normal;
  MatrixXd z(samples * dof, columns);
  for (int c = 0; c < columns; ++c) {
    for (int j = 0; j < dof; ++j) {
      double state = normal(*generator) / std::sqrt(1.0 - rho * rho);
      for (Index k = 0; k < samples; ++k) {
        z(k * dof + j, c) = state;
        state = rho * state + normal(*generator);
      }
    }
  }
  return z;
}

VectorXd LeastSquares(const MatrixXd& a, const VectorXd& b) { return a.colPivHouseholderQr().solve(b); }

TEST(ResidualModel, ExplainsTheDecreaseOfADenseFit) {
  const Fitted& arm = Arm(true);
  std::mt19937_64 generator(1);
  const MatrixXd z = RandomColumns(arm.model.samples(), arm.model.dof(), 3, 0.9, &generator);
  MatrixXd all(z.rows(), arm.j.cols() + z.cols());
  all << arm.j, z;
  const VectorXd& r = arm.model.residual();
  const double before = (r - arm.j * LeastSquares(arm.j, r)).squaredNorm();
  const double after = (r - all * LeastSquares(all, r)).squaredNorm();
  const MatrixXd remainder = arm.model.Remainder(z);
  ASSERT_EQ(remainder.cols(), 3);
  EXPECT_NEAR(arm.model.Explained(remainder), before - after, 1e-6 * before);
  EXPECT_LT((arm.j.transpose() * remainder).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_LT((remainder.transpose() * remainder - MatrixXd::Identity(3, 3)).cwiseAbs().maxCoeff(), 1e-9);
  // What the model imitates is dropped.
  EXPECT_EQ(arm.model.Remainder(arm.j.leftCols(2)).cols(), 0);
}

// Several candidates at once, each against a dense fit of its own; the step is the dense coefficient.
TEST(ResidualModel, ExplainsCandidatesSideBySide) {
  const Fitted& arm = Arm(true);
  std::mt19937_64 generator(4);
  MatrixXd z = RandomColumns(arm.model.samples(), arm.model.dof(), 6, 0.9, &generator);
  z.col(1) *= 1e3;
  z.col(3) = z.col(2) + 1e-3 * z.col(3);  // imitated by its neighbour
  const VectorXd& r = arm.model.residual();
  const double before = (r - arm.j * LeastSquares(arm.j, r)).squaredNorm();
  const std::vector<ResidualModel::Explanation> side_by_side = arm.model.Explain(z, 2);
  ASSERT_EQ(side_by_side.size(), 3u);
  for (Index k = 0; k < 3; ++k) {
    const Index columns = k == 1 ? 1 : 2;
    MatrixXd all(z.rows(), arm.j.cols() + columns);
    all << arm.j, z.middleCols(2 * k, columns);
    const VectorXd fit = LeastSquares(all, r);
    const ResidualModel::Explanation& one = side_by_side[static_cast<size_t>(k)];
    EXPECT_NEAR(one.explained, before - (r - all * fit).squaredNorm(), 1e-6 * before) << k;
    // A parameter's column is the derivative of the residual.
    EXPECT_LT((one.step.head(columns) + fit.tail(columns)).norm(), 1e-6 * fit.tail(columns).norm()) << k;
    if (columns == 1) {
      EXPECT_EQ(one.step[1], 0.0);
    }
  }
  const ResidualModel::Explanation imitated = arm.model.Explain(arm.j.leftCols(1), 1)[0];
  EXPECT_EQ(imitated.explained, 0.0);
  EXPECT_EQ(imitated.step[0], 0.0);
}

TEST(ResidualModel, HoldsOutAsADenseRefitDoes) {
  const Fitted& arm = Arm(true);
  const int n = arm.model.dof();
  std::mt19937_64 generator(2);
  const MatrixXd z = arm.model.Remainder(RandomColumns(arm.model.samples(), n, 2, 0.9, &generator));
  MatrixXd all(z.rows(), arm.j.cols() + z.cols());
  all << arm.j, z;
  const ResidualModel::HeldOut held_out = arm.model.CrossValidate(z);
  const int fold = 3;
  std::vector<Index> fitted, left;
  for (Index row = 0; row < all.rows(); ++row) {
    (arm.model.folds()[static_cast<size_t>(row / n)] == fold ? left : fitted).push_back(row);
  }
  ASSERT_FALSE(left.empty());
  const VectorXd& r = arm.model.residual();
  const VectorXd move = LeastSquares(all(fitted, Eigen::all), r(fitted));
  const VectorXd remainder = r(left) - all(left, Eigen::all) * move;
  VectorXd squares = VectorXd::Zero(n);
  for (size_t k = 0; k < left.size(); ++k) squares[left[k] % n] += std::pow(remainder[static_cast<Index>(k)], 2);
  EXPECT_LT((held_out.squares.row(fold).transpose() - squares).cwiseAbs().maxCoeff(), 1e-5 * squares.sum());
}

double LargestDistanceFromUniform(std::vector<double> p) {
  std::sort(p.begin(), p.end());
  double largest = 0.0;
  for (size_t k = 0; k < p.size(); ++k) {
    const double count = static_cast<double>(p.size());
    largest = std::max({largest, std::abs(p[k] - k / count), std::abs(p[k] - (k + 1) / count)});
  }
  return largest;
}

// 400 columns that have nothing to do with the residual of a true model. Kolmogorov's bound at a false alarm of 1e-4 is
// 2.2 / sqrt(400) = 0.11, to which 0.03 is added for the finite pieces of the F distribution.
TEST(ResidualModel, PValuesOfWhiteNoiseAreUniform) {
  const Fitted& arm = Arm(false);
  std::mt19937_64 generator(3);
  std::vector<double> p;
  for (int k = 0; k < 400; ++k) {
    p.push_back(
        arm.model.Test(arm.model.Remainder(RandomColumns(arm.model.samples(), 3, 1 + k % 3, 0.0, &generator))).p_value);
  }
  EXPECT_LT(LargestDistanceFromUniform(p), 0.14);
}

// A residual with a spring in it, and slow columns that have nothing to do with it. At 5 % the test for independent
// samples rejects nearly half of them; the robust one, whose lag is that of an AR(1), still 14 %: it is not exact where
// the correlation is longer than it looks at lag one, hence levels far below 5 % and the folds beside it.
TEST(ResidualModel, SlowColumnsOnASlowResidualAreNotRejectedOften) {
  const Fitted& arm = Arm(true);
  std::mt19937_64 generator(4);
  int rejected = 0, naive = 0;
  const int runs = 300;
  for (int k = 0; k < runs; ++k) {
    const MatrixXd remainder = arm.model.Remainder(RandomColumns(arm.model.samples(), 3, 1, 0.8, &generator));
    rejected += arm.model.Test(remainder).p_value < 0.05;
    naive += arm.model.Explained(remainder) >
             3.84 * arm.model.residual().squaredNorm() / static_cast<double>(arm.model.residual().size());
  }
  EXPECT_LT(rejected, 0.2 * runs) << naive;
  EXPECT_GT(naive, 0.25 * runs);
}

}  // namespace
}  // namespace idim::testing::residual_model_test
