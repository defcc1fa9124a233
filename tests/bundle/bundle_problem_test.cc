// One pass over the samples against the formulas of solvers/bundle/bundle.h as dense matrices, inverted whole.

#include "solvers/bundle/bundle_problem.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <string>
#include <vector>

#include "core/base/decompositions.h"
#include "tests/support/bundle_study.h"

namespace idim::bundle_problem_test {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using testing::BundleStudy;
using testing::GainScenario;

// A coupled drive whose signals are on the motor side: M is not diagonal.
GainScenario CoupledRpr() {
  Random random(11);
  GainScenario scenario;
  scenario.robot = testing::RandomArm("RPR", &random);
  scenario.robot.transmission = MatrixXd{{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.4, 1.0}};
  scenario.robot.couplings.push_back({2, {1, 2}, {0.4, 1.0}});
  scenario.gains = VectorXd{{33.9, -24.2, 6.79}};
  return scenario;
}

struct Dense {
  double cost = 0.0, log_determinants = 0.0;
  MatrixXd normal, scores;  // sum w [J r]' V^-1 [J r] + priors; w J' V^-1 r of each sample
  VectorXd squares, spread;
  size_t beyond = 0;  // the loss's threshold
};

Dense EvaluateDense(const BundleStudy& study, const std::vector<BundlePrior>& priors, const VectorXd& theta,
                    const VectorXd& sigma, double threshold) {
  const BundleData& data = study.data;
  const int n = data.dof, c = data.num_unknowns();
  StateDerivatives derivatives(study.prepared.base(), data);
  const VectorXd gains = data.Gains(theta), chi = theta.tail(data.num_columns());
  const MatrixXd drive = gains.cwiseInverse().asDiagonal() * data.inverse_drive;
  Dense result;
  result.normal.setZero(c + 1, c + 1);
  result.scores.setZero(static_cast<Index>(data.samples().size()), c);
  result.squares = result.spread = VectorXd::Zero(n);
  for (size_t k = 0; k < data.samples().size(); ++k) {
    const BundleSample& sample = data.samples()[k];
    MatrixXd d;
    StateDerivatives::RowMajorMatrix change;
    derivatives.Torque(sample, chi, &d);
    const MatrixXd b = drive * d, covariance = StateCovarianceOf(data, sample.recording);
    const MatrixXd spread = b * covariance * b.transpose();
    const MatrixXd v = spread + MatrixXd(sigma.cwiseAbs2().asDiagonal()), inverse = v.inverse();
    const VectorXd torque = sample.columns * chi + sample.known, residual = sample.signal - drive * torque;
    const VectorXd deviation = covariance * b.transpose() * inverse * residual;
    derivatives.Columns(sample, deviation, &change);
    MatrixXd rows = MatrixXd::Zero(n, c + 1);
    rows.middleCols(data.num_gains(), data.num_columns()) = -drive * (sample.columns + change);
    if (data.num_gains() > 0) {
      rows.leftCols(n) = (drive * (torque + d * deviation)).cwiseQuotient(gains).asDiagonal();
    }
    rows.col(c) = residual;
    const double s = residual.dot(inverse * residual);
    const double weight = s > threshold * threshold ? threshold / std::sqrt(s) : 1.0;
    result.beyond += s > threshold * threshold;
    result.cost += s > threshold * threshold ? 2.0 * threshold * std::sqrt(s) - threshold * threshold : s;
    result.log_determinants += std::log(v.determinant());
    result.normal += weight * rows.transpose() * inverse * rows;
    result.scores.row(static_cast<Index>(k)) = weight * (rows.leftCols(c).transpose() * inverse * residual).transpose();
    result.squares += weight * residual.cwiseAbs2();
    result.spread += spread.diagonal();
  }
  for (const BundlePrior& prior : priors) {
    VectorXd row = VectorXd::Zero(c + 1);
    row[prior.unknown] = 1.0 / prior.standard_deviation;
    row[c] = (theta[prior.unknown] - prior.value) / prior.standard_deviation;
    result.cost += row[c] * row[c];
    result.normal += row * row.transpose();
  }
  return result;
}

// Largest difference, entries in units of the diagonal's roots: parameters are of all sizes.
double Apart(const MatrixXd& normal, const MatrixXd& expected) {
  const VectorXd scale = expected.diagonal().cwiseSqrt().cwiseInverse();
  return (scale.asDiagonal() * (normal - expected) * scale.asDiagonal()).cwiseAbs().maxCoeff();
}

struct Case {
  std::string name;
  bool known_gains;
  double threshold;
};

class Whitening : public ::testing::TestWithParam<Case> {};

INSTANTIATE_TEST_SUITE_P(Problems, Whitening,
                         ::testing::Values(Case{"squares", false, 0.0}, Case{"huber", false, 1.5},
                                           Case{"known_gains", true, 0.0}),
                         [](const auto& problem) { return problem.param.name; });

TEST_P(Whitening, IsThatOfTheDenseMatrices) {
  for (GainScenario scenario : {testing::Tx40Gains(), CoupledRpr()}) {
    scenario.samples = 1000;
    scenario.decimation = 20;
    BundleStudy study = testing::MakeBundleStudy(scenario, 1e-4, 0.03);
    BundleData& data = study.data;
    const int n = data.dof;
    VectorXd theta = study.truth;
    for (Index i = 0; i < theta.size(); ++i) theta[i] *= i % 2 == 0 ? 1.05 : 0.95;
    if (GetParam().known_gains) {
      data.unknowns = data.unknowns.WithKnownGains(theta.head(n));
      theta = theta.tail(data.num_columns()).eval();
    }
    const std::vector<BundlePrior> priors = {{1, theta[1] + 0.3, 0.5}, {data.num_unknowns() - 1, 0.1, 0.2}};
    const double huge = 1e9, threshold = GetParam().threshold > 0.0 ? GetParam().threshold : huge;
    const Dense expected = EvaluateDense(study, priors, theta, study.sigma, threshold);
    EXPECT_GE(2 * expected.beyond, GetParam().threshold > 0.0 ? data.samples().size() : 0);
    BundleProblem problem(study.prepared.base(), data, priors, HuberNorm{GetParam().threshold});
    const BundleProblem::Evaluation at = problem.Evaluate(theta, study.sigma);
    EXPECT_NEAR(at.cost, expected.cost, 1e-11 * expected.cost);
    EXPECT_NEAR(at.log_determinants, expected.log_determinants, 1e-11 * std::abs(expected.log_determinants));
    EXPECT_LT((at.squares - expected.squares).norm(), 1e-11 * expected.squares.norm());
    EXPECT_LT((at.spread - expected.spread).norm(), 1e-11 * expected.spread.norm());
    EXPECT_LT(Apart(at.r.transpose() * at.r, expected.normal), 1e-11);
    const MatrixXd scores = problem.Scores(theta, study.sigma).scores;
    const VectorXd scale = expected.normal.diagonal().head(data.num_unknowns()).cwiseSqrt();
    EXPECT_LT(((scores - expected.scores) * scale.cwiseInverse().asDiagonal()).cwiseAbs().maxCoeff(), 1e-11);
  }
}

}  // namespace
}  // namespace idim::bundle_problem_test
