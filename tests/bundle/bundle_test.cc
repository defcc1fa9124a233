// The closed-form bundle apart from its minimum (which ceres_bundle_test checks): loss, rank, known gains, covariances.

#include "solvers/bundle/bundle.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <random>
#include <string>

#include "core/base/decompositions.h"
#include "tests/support/bundle_study.h"

namespace idim::bundle_test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using ::testing::AllOf;
using testing::BundleStudy;
using testing::EditSamples;
using ::testing::HasSubstr;

BundleStudy Arm3(unsigned noise_seed = 1) {
  Random random(21);
  testing::GainScenario scenario;
  scenario.robot = testing::RandomArm("RRR", &random);
  scenario.gains = VectorXd{{33.9, -24.2, 6.79}};
  scenario.samples = 4000;
  scenario.noise_seed = noise_seed;
  return testing::MakeBundleStudy(scenario, 2e-4, 0.03);
}

double Distance(const VectorXd& a, const VectorXd& b, const MatrixXd& covariance) {
  return (a - b).cwiseQuotient(covariance.diagonal().cwiseSqrt()).cwiseAbs().maxCoeff();
}

// The factors against means over 2e5 draws: their relative sampling errors are below 0.2 %, five of them 1 %.
TEST(HuberNorm, FactorsAreThoseOfNormalResiduals) {
  std::mt19937_64 generator(3);
  std::normal_distribution<double> normal;
  for (const int n : {1, 3, 6}) {
    const HuberNorm loss{1.2 * std::sqrt(n)};
    double weighted = 0.0, twice = 0.0;
    constexpr int kDraws = 200000;
    for (int k = 0; k < kDraws; ++k) {
      double s = 0.0;
      for (int i = 0; i < n; ++i) s += std::pow(normal(generator), 2);
      weighted += loss.Weight(s) * s / kDraws;
      twice += loss.Weight(s) * loss.Weight(s) * s / kDraws;
    }
    EXPECT_NEAR(n * loss.Consistency(n) / weighted, 1.0, 0.01) << n;
    EXPECT_NEAR(loss.VarianceFactor(n) * weighted / twice, 1.0, 0.01) << n;
    EXPECT_LT(loss.Consistency(n), 0.95) << "else the threshold cuts nothing";
  }
  // Weight is the derivative of Cost, which is continuous where the loss sets in.
  const HuberNorm loss{2.0};
  for (const double s : {1.0, 3.999, 4.001, 25.0}) {
    EXPECT_NEAR((loss.Cost(s + 1e-5) - loss.Cost(s - 1e-5)) / 2e-5, loss.Weight(s), 1e-6) << s;
  }
}

// Without outliers the loss costs little and biases neither weights nor gains; with 4 % of signals 60 standard
// deviations off it keeps the gains, which squares lose. Standard deviations of sigma are 1 / sqrt(2 * 800) = 2.5 %.
TEST(Bundle, HuberLossBearsOutliersAndKeepsTheWeights) {
  BundleStudy study = Arm3();
  BundleOptions squares, huber;
  huber.huber_threshold = 1.5;
  const BundleSummary clean = SolveBundle(study.prepared.base(), study.data, study.truth, squares);
  const BundleSummary robust = SolveBundle(study.prepared.base(), study.data, study.truth, huber);
  ASSERT_TRUE(clean.IsSolutionUsable() && robust.IsSolutionUsable()) << robust.status.message();
  EXPECT_GT(Distance(robust.values, clean.values, clean.covariance), 1e-3) << "the loss does something";
  EXPECT_LT(Distance(robust.values, clean.values, clean.covariance), 1.0);
  for (int j = 0; j < 3; ++j) {
    EXPECT_NEAR(robust.signal_sigma[j] / clean.signal_sigma[j], 1.0, 0.05) << j;
    EXPECT_NEAR(robust.signal_sigma[j] / study.sigma[j], 1.0, 0.15) << j;
    EXPECT_GT(robust.covariance(j, j), clean.covariance(j, j));
    EXPECT_LT(robust.covariance(j, j), 1.3 * clean.covariance(j, j));
  }
  EditSamples(&study.data, [&](std::vector<BundleSample>* samples) {
    for (size_t k = 5; k < samples->size(); k += 25) (*samples)[k].signal += 60.0 * study.sigma;
  });
  const BundleSummary lost = SolveBundle(study.prepared.base(), study.data, study.truth, squares);
  const BundleSummary kept = SolveBundle(study.prepared.base(), study.data, study.truth, huber);
  ASSERT_TRUE(kept.IsSolutionUsable()) << kept.status.message();
  const double off = Distance(lost.values, clean.values, clean.covariance);
  EXPECT_GT(off, 10.0);
  EXPECT_LT(Distance(kept.values, clean.values, clean.covariance), 0.2 * off);
}

// Gains held by narrow priors and gains that are known are the same problem by two routes.
TEST(Bundle, KnownGainsAreGainsWithNarrowPriors) {
  const BundleStudy study = Arm3();
  BundleOptions options;
  for (int j = 0; j < 3; ++j) options.priors.push_back({j, study.truth[j], 1e-9 * std::abs(study.truth[j])});
  const BundleSummary held = SolveBundle(study.prepared.base(), study.data, study.truth, options);
  PreparedStudy prepared = study.prepared;
  prepared.model.gains_mode = GainsMode::kKnown;
  prepared.model.gains = study.truth.head(3);
  Result<BundleData> known = BuildBundleData(prepared);
  ASSERT_TRUE(known.ok()) << known.status().message();
  ASSERT_EQ(known->num_gains(), 0);
  EditSamples(&*known, [&](std::vector<BundleSample>* samples) {
    for (size_t k = 0; k < samples->size(); ++k) (*samples)[k].signal = study.data.samples()[k].signal;
  });
  const int c = known->num_unknowns();
  const BundleSummary summary = SolveBundle(prepared.base(), *known, study.truth.tail(c), BundleOptions());
  ASSERT_TRUE(held.IsSolutionUsable() && summary.IsSolutionUsable()) << summary.status.message();
  // The freedom of three unknowns more is 1e-4 of the residual's, of which the weights know.
  EXPECT_LT(Distance(summary.values, held.values.tail(c), summary.covariance), 1e-2);
  for (int k = 0; k < c; ++k) EXPECT_NEAR(summary.covariance(k, k) / held.covariance(k + 3, k + 3), 1.0, 5e-3);
}

// The sandwich by its definition: autocovariances of the scores up to a lag, Bartlett weights.
TEST(Bundle, RobustCovarianceIsTheSumOfAutocovariances) {
  const BundleStudy study = Arm3();
  BundleOptions options;
  options.hac_lag = 7;
  options.priors = {{1, study.truth[1], 0.3}};
  const BundleSummary summary = SolveBundle(study.prepared.base(), study.data, study.truth, options);
  ASSERT_TRUE(summary.IsSolutionUsable()) << summary.status.message();
  BundleProblem problem(study.prepared.base(), study.data, options.priors, HuberNorm{});
  problem.HoldFriction(summary.values);
  const BundleProblem::Sensitivity sensitivity = problem.Scores(summary.values, summary.signal_sigma);
  EXPECT_LT(sensitivity.variances.colwise().sum().cwiseAbs().maxCoeff(),
            1e-3 * summary.signal_sigma.cwiseAbs2().minCoeff());
  const MatrixXd by_variance = problem.ScoreByVariance(summary.values, summary.signal_sigma, 2000);
  MatrixXd scores = sensitivity.scores;
  // Scores and the prior's pull balance at the minimum.
  VectorXd pull = scores.colwise().sum().transpose();
  pull[1] += (summary.values[1] - study.truth[1]) / (0.3 * 0.3);
  EXPECT_LT(std::sqrt(pull.dot(summary.covariance * pull)), 1e-4);
  scores += sensitivity.variances * by_variance.transpose();

  MatrixXd middle = MatrixXd::Zero(scores.cols(), scores.cols());
  const auto& samples = study.data.samples();
  for (int lag = 0; lag <= 7; ++lag) {
    MatrixXd gamma = MatrixXd::Zero(scores.cols(), scores.cols());
    for (Eigen::Index k = lag; k < scores.rows(); ++k) {
      if (samples[k].recording == samples[k - lag].recording) gamma += scores.row(k).transpose() * scores.row(k - lag);
    }
    middle += (1.0 - lag / 8.0) * (lag == 0 ? gamma : MatrixXd(gamma + gamma.transpose()));
  }
  middle *= 3.0 * static_cast<double>(samples.size()) / summary.degrees_of_freedom;
  middle(1, 1) += 1.0 / (0.3 * 0.3);
  const MatrixXd noise = problem.NoiseInformation(summary.values, summary.signal_sigma, 2000);
  const MatrixXd bread = (summary.covariance.inverse() - noise).inverse();
  const MatrixXd expected = bread * middle * bread;
  const MatrixXd of_variances =
      by_variance * (sensitivity.variances.transpose() * sensitivity.variances) * by_variance.transpose();
  const MatrixXd model = bread * (summary.covariance.inverse() + of_variances) * bread;
  EXPECT_LT((model - summary.model_covariance).norm(), 1e-7 * model.norm());
  const VectorXd scale = expected.diagonal().cwiseSqrt().cwiseInverse();
  EXPECT_LT((scale.asDiagonal() * (summary.robust_covariance - expected) * scale.asDiagonal()).cwiseAbs().maxCoeff(),
            1e-7);
  EXPECT_NEAR(summary.interval_factor, 1.0 + 2.9694 / 1.96 * 8.0 / static_cast<double>(samples.size()), 1e-3);
}

// What the estimated states' error adds to the information, densely and from every sample.
TEST(Bundle, NoiseInformationIsTheSumOverTheStatesErrors) {
  BundleStudy study = Arm3();
  EditSamples(&study.data, [](std::vector<BundleSample>* samples) { samples->resize(40); });
  const int n = study.data.dof;
  const auto& [base, data] = std::tie(study.prepared.base(), study.data);
  StateDerivatives derivatives(base, data);
  const VectorXd inverse_gains = study.truth.head(n).cwiseInverse(), chi = study.truth.tail(data.num_columns());
  MatrixXd d, expected = MatrixXd::Zero(study.truth.size(), study.truth.size());
  StateDerivatives::RowMajorMatrix change;
  for (const BundleSample& sample : data.samples()) {
    derivatives.Torque(sample, chi, &d);
    const MatrixXd b = inverse_gains.asDiagonal() * data.inverse_drive * d;
    const MatrixXd c = StateCovarianceOf(data, sample.recording);
    MatrixXd v = b * c * b.transpose();
    v.diagonal() += study.sigma.cwiseAbs2();
    const MatrixXd q = c - c * b.transpose() * v.inverse() * b * c;
    // E dJ' V^-1 dJ over u ~ N(0, Q) is the sum of Q_ab dJ_a' V^-1 dJ_b over pairs of coordinates.
    std::vector<MatrixXd> rows;
    for (int s = 0; s < 3 * n; ++s) {
      derivatives.Columns(sample, VectorXd::Unit(3 * n, s), &change);
      MatrixXd of_state(n, study.truth.size());
      of_state << MatrixXd(b.col(s).cwiseProduct(inverse_gains).asDiagonal()),
          -(inverse_gains.asDiagonal() * (data.inverse_drive * change));
      rows.push_back(of_state);
    }
    const MatrixXd weight = v.inverse();
    for (int s = 0; s < 3 * n; ++s) {
      for (int t = 0; t < 3 * n; ++t) expected += q(s, t) * rows[s].transpose() * weight * rows[t];
    }
  }
  BundleProblem problem(base, data, {}, HuberNorm{});
  const MatrixXd noise = problem.NoiseInformation(study.truth, study.sigma);
  const VectorXd scale = expected.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  EXPECT_LT((scale.asDiagonal() * (noise - expected) * scale.asDiagonal()).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_GT(expected.diagonal().maxCoeff(), 0.0);
  // Of every other sample: about the same.
  const MatrixXd half = problem.NoiseInformation(study.truth, study.sigma, 20);
  EXPECT_NEAR(half.trace() / noise.trace(), 1.0, 0.3);
}

// A sample at rest tells nothing of dry friction, one in motion all: the weight of the residual is that of a torque
// anywhere between -Fs and Fs, and the weights that are estimated do not take it for noise of the signal.
TEST(Bundle, SamplesAtRestDoNotTellFriction) {
  BundleStudy study = Arm3();
  const BundleSummary before = SolveBundle(study.prepared.base(), study.data, study.truth, BundleOptions());
  // Every fifth sample: joint 2's friction torque is half of Fs off, and its sign is not known.
  const int joint = 1, column = study.data.coulomb_columns[joint];
  ASSERT_GE(column, 0);
  const double friction = study.truth[3 + column] / study.truth[joint];
  EditSamples(&study.data, [&](std::vector<BundleSample>* samples) {
    for (size_t k = 0; k < samples->size(); k += 5) {
      (*samples)[k].signal[joint] += (k % 2 == 0 ? 0.5 : -0.5) * friction;
    }
  });
  const BundleSummary fooled = SolveBundle(study.prepared.base(), study.data, study.truth, BundleOptions());
  EditSamples(&study.data, [&](std::vector<BundleSample>* samples) {
    for (size_t k = 0; k < samples->size(); k += 5) (*samples)[k].sign_variance = VectorXd::Unit(3, joint);
  });
  const BundleSummary careful = SolveBundle(study.prepared.base(), study.data, study.truth, BundleOptions());
  ASSERT_TRUE(before.IsSolutionUsable() && fooled.IsSolutionUsable() && careful.IsSolutionUsable())
      << careful.status.message();
  EXPECT_GT(fooled.signal_sigma[joint], 1.2 * before.signal_sigma[joint]);
  EXPECT_NEAR(careful.signal_sigma[joint] / before.signal_sigma[joint], 1.0, 0.1);
  EXPECT_LT(Distance(careful.values, before.values, before.covariance), 3.0);
  EXPECT_GT(careful.covariance(joint, joint), before.covariance(joint, joint));
  EXPECT_LT(careful.covariance(joint, joint), fooled.covariance(joint, joint));
}

// Independent samples need no lag; signals whose noise lasts ask for one. AR(1) of 0.9: 1.1447 (4 r^2 / (1 - r^2)^2
// T)^(1/3) = 1.1447 (90 * 1200)^(1/3) = 54 at most, where the scores kept all of it.
TEST(Bundle, LagGrowsWithTheCorrelationOfTheNoise) {
  BundleStudy study = Arm3();
  const BundleSummary white = SolveBundle(study.prepared.base(), study.data, study.truth, BundleOptions());
  std::mt19937_64 generator(8);
  std::normal_distribution<double> normal;
  VectorXd state = VectorXd::Zero(3);
  EditSamples(&study.data, [&](std::vector<BundleSample>* samples) {
    for (BundleSample& sample : *samples) {
      for (int j = 0; j < 3; ++j) state[j] = 0.9 * state[j] + 2.0 * study.sigma[j] * normal(generator);
      sample.signal += state;
    }
  });
  const BundleSummary lasting = SolveBundle(study.prepared.base(), study.data, study.truth, BundleOptions());
  EXPECT_LE(white.hac_lag, 4);
  EXPECT_GE(lasting.hac_lag, 8);
  EXPECT_LE(lasting.hac_lag, 55);
  // Where noise lasts the covariance of independent samples is too small.
  double ratio = 0.0;
  for (int j = 0; j < 3; ++j) ratio += lasting.robust_covariance(j, j) / lasting.covariance(j, j) / 3.0;
  EXPECT_GT(ratio, 1.5);
}

TEST(Bundle, DirectionsThatTheDataDoNotSeeAreNamed) {
  BundleStudy study = Arm3();
  const int a = 5, b = 9;
  EditSamples(&study.data, [&](std::vector<BundleSample>* samples) {
    for (BundleSample& sample : *samples) sample.columns.col(b - 3) = 2.0 * sample.columns.col(a - 3);
  });
  for (auto& of_joints : study.data.state_covariance) {
    for (auto& covariance : of_joints) covariance.setZero();  // else the derivatives tell the two apart
  }
  const BundleSummary summary = SolveBundle(study.prepared.base(), study.data, study.truth, BundleOptions());
  EXPECT_EQ(summary.status.code(), StatusCode::kUntrusted);
  EXPECT_THAT(summary.status.message(), AllOf(HasSubstr("not identifiable"), HasSubstr(study.data.unknowns[a].name),
                                              HasSubstr(study.data.unknowns[b].name)));
  EXPECT_EQ(summary.covariance.size(), 0);
  // A prior on one of them is all that it takes.
  BundleOptions options;
  options.priors = {{b, study.truth[b], 0.01}};
  EXPECT_TRUE(SolveBundle(study.prepared.base(), study.data, study.truth, options).IsSolutionUsable());
}

TEST(Bundle, FewerEquationsThanUnknownsAreRefused) {
  BundleStudy study = Arm3();
  EditSamples(&study.data, [](std::vector<BundleSample>* samples) { samples->resize(5); });
  const BundleSummary summary = SolveBundle(study.prepared.base(), study.data, study.truth, BundleOptions());
  EXPECT_THAT(summary.status.message(), HasSubstr("15 equations"));
}

TEST(Bundle, StopsWithoutClaimingMoreThanItKnows) {
  const BundleStudy study = Arm3();
  BundleOptions options;
  options.max_iterations = 1;
  VectorXd start = study.truth;
  start.head(3) *= 0.3;
  const BundleSummary summary = SolveBundle(study.prepared.base(), study.data, start, options);
  EXPECT_FALSE(summary.converged);
  EXPECT_THAT(summary.status.message(), HasSubstr("not converged"));
  EXPECT_EQ(BundleSummary().status.code(), StatusCode::kUntrusted);
}

TEST(Bundle, OptionsThatMeanNothingAreInvalid) {
  std::string error;
  EXPECT_TRUE(BundleOptions().IsValid(&error)) << error;
  const auto expect_invalid = [&](auto change) {
    BundleOptions options;
    change(&options);
    error.clear();
    EXPECT_FALSE(options.IsValid(&error));
    EXPECT_FALSE(error.empty());
  };
  expect_invalid([](BundleOptions* o) { o->max_iterations = 0; });
  expect_invalid([](BundleOptions* o) { o->step_tolerance = 0.0; });
  expect_invalid([](BundleOptions* o) { o->weight_tolerance = 0.0; });
  expect_invalid([](BundleOptions* o) { o->max_weight_iterations = -1; });
  expect_invalid([](BundleOptions* o) { o->max_weight_iterations = 0; });
  expect_invalid([](BundleOptions* o) { o->signal_sigma = VectorXd::Zero(2); });
  expect_invalid([](BundleOptions* o) { o->priors = {{0, 1.0, 0.0}}; });
  expect_invalid([](BundleOptions* o) { o->huber_threshold = -1.0; });
  expect_invalid([](BundleOptions* o) { o->hac_lag = -2; });
  expect_invalid([](BundleOptions* o) { o->rank_tolerance = 0.0; });
}

}  // namespace
}  // namespace idim::bundle_test
