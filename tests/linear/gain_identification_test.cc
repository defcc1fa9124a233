#include "solvers/linear/gain_identification.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "core/base/decompositions.h"
#include "tests/support/edit_data.h"
#include "tests/support/gain_study.h"

namespace idim::gain_identification_test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using testing::EditRecordings;
using testing::GainScenario;
using testing::GainStudy;
using ::testing::HasSubstr;
using testing::KeepRecordings;
using testing::MakeGainStudy;
using ::testing::Not;
using testing::Tx40Gains;

constexpr GainEstimator kAll[] = {GainEstimator::kLs,   GainEstimator::kWls,  GainEstimator::kTls,
                                  GainEstimator::kWtls, GainEstimator::kGtls, GainEstimator::kWgtls};

GainSystem Build(const GainStudy& study) {
  Result<GainSystem> system = BuildGainSystem(study.prepared);
  EXPECT_TRUE(system.ok()) << system.status().message();
  return std::move(system).value();
}

GainSummary Solve(const GainSystem& system, GainEstimator estimator) {
  GainOptions options;
  options.estimator = estimator;
  return SolveGains(system, options);
}

void ExpectTruth(const GainScenario& scenario) {
  const GainStudy study = MakeGainStudy(scenario);
  const GainSystem system = Build(study);
  ASSERT_EQ(static_cast<Eigen::Index>(system.unknowns.size()), study.truth.size());
  for (const GainEstimator estimator : kAll) {
    const GainSummary summary = Solve(system, estimator);
    ASSERT_TRUE(summary.IsSolutionUsable()) << GainEstimatorName(estimator) << ": " << summary.status.message();
    for (int k = 0; k < study.truth.size(); ++k) {
      EXPECT_NEAR(summary.values[k], study.truth[k], 1e-8 * std::abs(study.truth[k]))
          << GainEstimatorName(estimator) << " " << system.unknowns[k].name;
    }
    EXPECT_LT(summary.relative_residual, 1e-12);
  }
}

// The paper's arm and gains: case 2 and 4 (mass known), case 1 and 3 (all ten known), and some in between.
TEST(GainIdentification, NoiseFreeTx40GivesTheTruthMassKnown) { ExpectTruth(Tx40Gains()); }

TEST(GainIdentification, NoiseFreeTx40GivesTheTruthTenKnown) {
  GainScenario scenario = Tx40Gains();
  scenario.known = {kXX, kXY, kXZ, kYY, kYZ, kZZ, kMX, kMY, kMZ, kM};
  ExpectTruth(scenario);
}

TEST(GainIdentification, NoiseFreeTx40GivesTheTruthAnySubset) {
  GainScenario scenario = Tx40Gains();
  scenario.known = {kZZ, kMX, kMZ};  // not even the mass
  ExpectTruth(scenario);
}

// Signals on the motor side: motor 6 loads joints 5 and 6.
TEST(GainIdentification, NoiseFreeMotorSide) {
  GainScenario scenario = Tx40Gains();
  scenario.robot.transmission = VectorXd{{32, 32, 45, -48, 45, 32}}.asDiagonal();
  scenario.robot.transmission(5, 4) = 32.0;
  scenario.gains = VectorXd{{1.06, 1.01, 0.54, 0.19, 0.36, 0.21}};
  ExpectTruth(scenario);
}

TEST(GainIdentification, NoiseFreeGeneralArmWithAPrismaticJoint) {
  Random random(4);
  GainScenario scenario;
  scenario.robot = testing::RandomArm("RPR", &random);
  scenario.gains = VectorXd{{12.0, -150.0, 3.5}};
  ExpectTruth(scenario);
}

// All rows of W_tot, in the order of the system's columns, joint by joint.
struct Rows {
  std::vector<MatrixXd> joints;
  MatrixXd Stacked(const VectorXd& sigma) const {
    MatrixXd all(joints[0].rows() * Eigen::Index(joints.size()), joints[0].cols());
    for (size_t j = 0; j < joints.size(); ++j) {
      all.middleRows(Eigen::Index(j) * joints[0].rows(), joints[0].rows()) = joints[j] / sigma[Eigen::Index(j)];
    }
    return all;
  }
};

// A synthetic system with every column in every joint but gains, noisy,
// so that formulas can be checked with dense matrices.
struct Synthetic {
  Rows rows;
  GainSystem system;
};

Synthetic MakeSynthetic(double noise, unsigned seed, double last_parameter = 1.0) {
  const int n = 2, parameters = 4, samples = 300;
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal;
  std::vector<Parameter> unknowns = GainParameters(Robot{"", {}, std::vector<Joint>(n), {}, {}, {}}, Side::kJoint);
  for (int k = 0; k < parameters; ++k) unknowns.push_back({"p" + std::to_string(k), ParameterKind::kBase, 1, "N.m"});
  Synthetic synthetic{{}, GainSystem(unknowns, n)};
  const VectorXd chi{{0.7, -0.4, 1.1, 0.3}}, gains{{2.0, -0.5}};
  for (int j = 0; j < n; ++j) {
    MatrixXd rows = MatrixXd::Zero(samples, n + parameters + 1);
    MatrixXd w = MatrixXd::NullaryExpr(samples, parameters, [&] { return normal(generator); });
    VectorXd known = VectorXd::NullaryExpr(samples, [&] { return normal(generator); });
    if (j == 1) w.col(0).setZero();
    w.col(parameters - 1) *= last_parameter;
    rows.col(j) = (w * chi + known) / gains[j];
    rows.middleCols(n, parameters) = -w;
    rows.col(n + parameters) = -known;
    for (Eigen::Index i = 0; i < rows.size(); ++i) rows.data()[i] += noise * (j + 1) * normal(generator);
    for (int i = 0; i < samples; ++i) {
      synthetic.system.joints[j].AddRow(rows.row(i));
      Eigen::RowVectorXd load(n + 2);
      load << rows.row(i).head(n), -rows(i, n + parameters), 0.0;
      synthetic.system.loads[j].AddRow(load);
    }
    synthetic.rows.joints.push_back(rows);
  }
  return synthetic;
}

// TLS of the factors against the singular value decomposition of the whole W_tot, and eq. (22), (23) written out.
TEST(GainIdentification, TlsIsTheSingularVectorOfTheWholeMatrix) {
  const Synthetic synthetic = MakeSynthetic(0.05, 3);
  for (const GainEstimator estimator : {GainEstimator::kTls, GainEstimator::kWtls}) {
    const GainSummary summary = Solve(synthetic.system, estimator);
    ASSERT_TRUE(summary.IsSolutionUsable()) << summary.status.message();
    const MatrixXd w = synthetic.rows.Stacked(summary.joint_sigma);
    const Eigen::JacobiSVD<MatrixXd> svd(w, Eigen::ComputeThinU | Eigen::ComputeThinV);
    const Eigen::Index c = w.cols();
    const VectorXd x = svd.matrixV().col(c - 1) / svd.matrixV()(c - 1, c - 1);
    EXPECT_LT((summary.values - x.head(c - 1)).norm(), 1e-10 * x.norm());
    EXPECT_LT((summary.singular_values - svd.singularValues()).norm(), 1e-10 * svd.singularValues()[0]);
    const double s = svd.singularValues()[c - 1] / std::sqrt(double(w.rows() - c));
    EXPECT_NEAR(summary.sigma, s, 1e-10 * s);
    const MatrixXd corrected =
        w - svd.singularValues()[c - 1] * svd.matrixU().col(c - 1) * svd.matrixV().col(c - 1).transpose();
    const MatrixXd a = corrected.leftCols(c - 1);
    const MatrixXd covariance = s * s * (1.0 + x.head(c - 1).squaredNorm()) * (a.transpose() * a).inverse();
    EXPECT_LT((summary.covariance - covariance).norm(), 1e-9 * covariance.norm());
    EXPECT_NEAR(summary.separation, svd.singularValues()[c - 2] / svd.singularValues()[c - 1], 1e-9);
  }
}

// Eq. (16), (9), (10) by normal equations, and the weights of the header.
TEST(GainIdentification, LsAndWeightsAreTheFormulasOfThePaper) {
  const Synthetic synthetic = MakeSynthetic(0.05, 4);
  VectorXd unweighted;
  for (const GainEstimator estimator : {GainEstimator::kLs, GainEstimator::kWls}) {
    const GainSummary summary = Solve(synthetic.system, estimator);
    ASSERT_TRUE(summary.IsSolutionUsable()) << summary.status.message();
    if (estimator == GainEstimator::kWls) {
      VectorXd x(7);
      x << unweighted, 1.0;
      for (int j = 0; j < 2; ++j) {
        const double sigma = (synthetic.rows.joints[j] * x).norm() / std::sqrt(300.0 * (600.0 - 7.0) / 600.0);
        EXPECT_NEAR(summary.joint_sigma[j], sigma, 1e-10 * sigma);
      }
      EXPECT_GT(summary.joint_sigma[1], 1.2 * summary.joint_sigma[0]);
    }
    const MatrixXd w = synthetic.rows.Stacked(summary.joint_sigma);
    const MatrixXd a = w.leftCols(6);
    const MatrixXd inverse = (a.transpose() * a).inverse();
    const VectorXd x = -inverse * a.transpose() * w.col(6);
    EXPECT_LT((summary.values - x).norm(), 1e-10 * x.norm());
    const double s2 = (w.col(6) + a * x).squaredNorm() / (600 - 6);
    EXPECT_LT((summary.covariance - s2 * inverse).norm(), 1e-10 * s2 * inverse.norm());
    unweighted = summary.values;
    EXPECT_EQ(summary.degrees_of_freedom, 594);
  }
}

// The squares of the joints' parts of the smallest singular value sum to it.
TEST(GainIdentification, RowWeightsOfTlsAddUpToEquation22) {
  const Synthetic synthetic = MakeSynthetic(0.05, 5);
  const GainSummary tls = Solve(synthetic.system, GainEstimator::kTls);
  const GainSummary weighted = Solve(synthetic.system, GainEstimator::kWtls);
  VectorXd x(7);
  x << tls.values, 1.0;
  EXPECT_NEAR(std::sqrt(weighted.joint_sigma.squaredNorm() / 2.0) / x.norm(), tls.sigma, 1e-10 * tls.sigma);
}

TEST(GainIdentification, FactorsOfRecordingsMerge) {
  const Synthetic a = MakeSynthetic(0.05, 6), b = MakeSynthetic(0.05, 7);
  GainSystem merged = a.system;
  merged.Merge(b.system);
  MatrixXd both(1200, 7);
  both << a.rows.Stacked(VectorXd::Ones(2)), b.rows.Stacked(VectorXd::Ones(2));
  const Eigen::JacobiSVD<MatrixXd> svd(both, Eigen::ComputeThinV);
  const GainSummary summary = Solve(merged, GainEstimator::kTls);
  EXPECT_LT((summary.values - svd.matrixV().col(6).head(6) / svd.matrixV()(6, 6)).norm(), 1e-10);
  EXPECT_EQ(summary.rows, 1200);
}

// A parameter that is nothing goes; gains stay even where theirs is the largest relative spread.
TEST(GainIdentification, EssentialParametersNeverTakeAGain) {
  const Synthetic synthetic = MakeSynthetic(0.05, 8);
  for (const GainEstimator estimator : kAll) {
    GainOptions options;
    options.estimator = estimator;
    options.essential_ratio = 1.01;  // eliminates as long as it may
    const GainSummary summary = SolveGains(synthetic.system, options);
    EXPECT_GE(summary.eliminated.size(), 3u) << GainEstimatorName(estimator);
    for (const std::string& name : summary.eliminated) EXPECT_EQ(name[0], 'p');
    for (int k = 2; k < 6; ++k) {
      const bool gone = std::count(summary.eliminated.begin(), summary.eliminated.end(), "p" + std::to_string(k - 2));
      EXPECT_EQ(summary.values[k] == 0.0, gone);
      EXPECT_EQ(summary.covariance(k, k) == 0.0, gone);
    }
    EXPECT_NE(summary.values[0], 0.0);
    EXPECT_NE(summary.values[1], 0.0);
  }
}

TEST(GainIdentification, RefusesAStudyWithoutScale) {
  GainStudy study = MakeGainStudy(Tx40Gains());
  study.prepared.model.payloads[0].known.fill(std::nullopt);
  Result<GainSystem> system = BuildGainSystem(study.prepared);
  ASSERT_FALSE(system.ok());
  EXPECT_EQ(system.status().code(), StatusCode::kBadInput);
  EXPECT_THAT(system.status().message(), HasSubstr("weighed mass"));
  study = MakeGainStudy(Tx40Gains());
  study.prepared.model.gains_mode = GainsMode::kKnown;
  system = BuildGainSystem(study.prepared);
  ASSERT_FALSE(system.ok());
  EXPECT_THAT(system.status().message(), HasSubstr("expected 'identify'"));
}

// The payload on in every recording: its torque is that of the last link's own parameters.
TEST(GainIdentification, NamesAMissingUnloadedRecording) {
  GainScenario scenario = Tx40Gains();
  scenario.known = {kXX, kXY, kXZ, kYY, kYZ, kZZ, kMX, kMY, kMZ, kM};
  GainStudy study = MakeGainStudy(scenario);
  KeepRecordings({1}, &study.prepared);
  const GainSystem system = Build(study);
  for (const GainEstimator estimator : kAll) {
    const GainSummary summary = Solve(system, estimator);
    EXPECT_EQ(summary.status.code(), StatusCode::kUntrusted);
    EXPECT_THAT(summary.status.message(), HasSubstr("gains have no scale"));
  }
}

TEST(GainIdentification, NamesGainsOfTheWrongSignAndOfLargeSpread) {
  Synthetic synthetic = MakeSynthetic(0.05, 9);
  synthetic.system.a_priori_gains = VectorXd{{2.0, 0.5}};
  GainSummary summary = Solve(synthetic.system, GainEstimator::kWtls);
  EXPECT_EQ(summary.status.code(), StatusCode::kUntrusted);
  EXPECT_THAT(summary.status.message(), HasSubstr("g2 = -0."));
  EXPECT_THAT(summary.status.message(), HasSubstr("opposite sign of its a priori value 0.5"));
  EXPECT_THAT(summary.status.message(), Not(HasSubstr("g1 = ")));
  EXPECT_GT(summary.values.size(), 0);
  synthetic.system.a_priori_gains = VectorXd{{2.0, -0.5}};
  GainOptions options;
  options.estimator = GainEstimator::kTls;
  summary = SolveGains(synthetic.system, options);
  EXPECT_TRUE(summary.IsSolutionUsable()) << summary.status.message();
  options.max_spread_percent = 0.5 * summary.RelativeSigmaPercent(0);
  summary = SolveGains(synthetic.system, options);
  EXPECT_EQ(summary.status.code(), StatusCode::kUntrusted);
  EXPECT_THAT(summary.status.message(), HasSubstr("g1 = "));
  EXPECT_THAT(summary.status.message(), HasSubstr("relative standard deviation"));
}

// A parameter whose column is nothing but noise makes a second smallest singular value as small as the first.
TEST(GainIdentification, NamesADegenerateTls) {
  const Synthetic synthetic = MakeSynthetic(0.05, 10, 1e-4);
  GainSummary summary = Solve(synthetic.system, GainEstimator::kTls);
  EXPECT_LT(summary.separation, 1.05);
  EXPECT_EQ(summary.status.code(), StatusCode::kUntrusted);
  EXPECT_THAT(summary.status.message(), HasSubstr("the two smallest singular values are not separated"));
  EXPECT_THAT(summary.status.message(), HasSubstr("p3"));
  EXPECT_FALSE(summary.IsSolutionUsable());
  // The other defect, by its limit.
  GainOptions options;
  options.estimator = GainEstimator::kTls;
  options.min_last_share = 0.99;
  summary = SolveGains(MakeSynthetic(0.05, 10).system, options);
  EXPECT_EQ(summary.status.code(), StatusCode::kUntrusted);
  EXPECT_THAT(summary.status.message(), HasSubstr("the last component of the singular vector is near zero"));
}

// Scaled TLS is told the noise of each column and each joint: the generalised eigenvector of the summed covariance.
TEST(GainIdentification, GtlsTakesTheNoiseOfEachColumnAndJoint) {
  const Synthetic synthetic = MakeSynthetic(0.05, 11);
  GainOptions options;
  options.column_noise.resize(2, 7);
  options.column_noise << 0.1, 0.0, 0.2, 0.1, 0.3, 0.1, 0.05,  //
      0.0, 0.3, 0.1, 0.2, 0.1, 0.1, 0.2;
  for (const GainEstimator estimator : {GainEstimator::kGtls, GainEstimator::kWgtls}) {
    options.estimator = estimator;
    const GainSummary summary = SolveGains(synthetic.system, options);
    ASSERT_TRUE(summary.IsSolutionUsable()) << summary.status.message();
    const MatrixXd w = synthetic.rows.Stacked(summary.joint_sigma);
    const VectorXd squares =
        (summary.joint_sigma.cwiseInverse().asDiagonal() * options.column_noise).colwise().squaredNorm();
    const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> eigen(w.transpose() * w, MatrixXd(squares.asDiagonal()));
    const VectorXd x = eigen.eigenvectors().col(0) / eigen.eigenvectors()(6, 0);
    EXPECT_LT((summary.values - x.head(6)).norm(), 1e-10 * x.norm()) << GainEstimatorName(estimator);
  }
}

TEST(GainIdentification, NamesWhatIsNotIdentifiable) {
  GainStudy study = MakeGainStudy(Tx40Gains());
  EditRecordings(&study.prepared, [](Recording*, JointStates* states) {
    states->dq.col(3).setZero();
    states->ddq.col(3).setZero();
  });
  const GainSummary summary = Solve(Build(study), GainEstimator::kTls);
  EXPECT_EQ(summary.status.code(), StatusCode::kUntrusted);
  EXPECT_THAT(summary.status.message(), HasSubstr("Fv4"));
  EXPECT_EQ(summary.values.size(), 0);
}

TEST(GainOptions, RefusesWhatMakesNoSense) {
  std::string error;
  GainOptions options;
  EXPECT_TRUE(options.IsValid(&error)) << error;
  options.weight_iterations = 0;
  EXPECT_FALSE(options.IsValid(&error));
  EXPECT_THAT(error, HasSubstr("weight_iterations is 0"));
  options = GainOptions();
  options.column_noise = MatrixXd::Ones(2, 7);
  EXPECT_TRUE(options.IsValid(&error)) << error;
  options.column_noise(1, 2) = -1.0;
  EXPECT_FALSE(options.IsValid(&error));
  options = GainOptions();
  options.min_separation = 0.5;
  EXPECT_FALSE(options.IsValid(&error));
  options = GainOptions();
  options.min_reliability = 1.0;
  EXPECT_FALSE(options.IsValid(&error));
  options = GainOptions();
  options.max_spread_percent = 0.0;
  EXPECT_FALSE(options.IsValid(&error));
}

}  // namespace
}  // namespace idim::gain_identification_test
