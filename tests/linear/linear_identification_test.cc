#include "solvers/linear/linear_identification.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

#include "core/base/decompositions.h"

namespace idim::linear_identification_test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Two "joints" of `rows` equations each, 4 unknowns; joint 2 does not see the first unknown.
struct Data {
  MatrixXd w[2];
  VectorXd truth{{1.5, -0.4, 3.0, 0.02}};
};

Data MakeData(int rows, unsigned seed) {
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal;
  Data data;
  for (MatrixXd& w : data.w) w = MatrixXd::NullaryExpr(rows, 4, [&] { return normal(generator); });
  data.w[1].col(0).setZero();
  return data;
}

std::vector<Parameter> Unknowns() {
  std::vector<Parameter> unknowns;
  for (const char* name : {"a", "b", "c", "d"}) unknowns.push_back({name, ParameterKind::kBase, 1, "N.m"});
  return unknowns;
}

LinearSystem System(const Data& data, const VectorXd& noise1, const VectorXd& noise2) {
  LinearSystem system(Unknowns(), 2);
  const VectorXd noise[2] = {noise1, noise2};
  for (int j = 0; j < 2; ++j) {
    MatrixXd rows(data.w[j].rows(), 5);
    rows << data.w[j], data.w[j] * data.truth + noise[j];
    for (Eigen::Index i = 0; i < rows.rows(); ++i) system.joints[j].AddRow(rows.row(i));
  }
  return system;
}

// Eq. (7) to (11) by the normal equations of the stacked matrix, with the same weights.
TEST(LinearIdentification, FormulasOfThePaper) {
  const Data data = MakeData(200, 1);
  std::mt19937_64 generator(2);
  std::normal_distribution<double> normal;
  const VectorXd e1 = VectorXd::NullaryExpr(200, [&] { return 0.1 * normal(generator); });
  const VectorXd e2 = VectorXd::NullaryExpr(200, [&] { return 2.0 * normal(generator); });
  for (const bool weighted : {false, true}) {
    LinearOptions options;
    options.weighted = weighted;
    const LinearSummary summary = SolveLinear(System(data, e1, e2), options);
    ASSERT_TRUE(summary.IsSolutionUsable()) << summary.status.message();
    MatrixXd w(400, 4);
    VectorXd y(400);
    const VectorXd* errors[] = {&e1, &e2};
    for (int j = 0; j < 2; ++j) {
      // The weight of a joint: its own LS, which for joint 2 has rank 3.
      const VectorXd yj = data.w[j] * data.truth + *errors[j];
      const MatrixXd own = j == 0 ? data.w[0] : MatrixXd(data.w[1].rightCols(3));
      const VectorXd remainder = yj - own * (own.transpose() * own).ldlt().solve(own.transpose() * yj);
      const double sigma = remainder.norm() / std::sqrt(200.0 - double(own.cols()));
      EXPECT_NEAR(summary.joint_sigma[j], sigma, 1e-10 * sigma);
      w.middleRows(200 * j, 200) = data.w[j] / (weighted ? sigma : 1.0);
      y.segment(200 * j, 200) = yj / (weighted ? sigma : 1.0);
    }
    const MatrixXd inverse = (w.transpose() * w).inverse();
    const VectorXd chi = inverse * w.transpose() * y;
    const double s2 = (y - w * chi).squaredNorm() / 396.0;
    EXPECT_LT((summary.values - chi).norm(), 1e-10);
    EXPECT_LT((summary.covariance - s2 * inverse).norm(), 1e-10 * inverse.norm() * s2);
    EXPECT_NEAR(summary.sigma * summary.sigma, s2, 1e-10 * s2);
    EXPECT_NEAR(
        summary.condition_number_solved,
        [&] {
          const VectorXd s = w.jacobiSvd().singularValues();
          return s[0] / s[3];
        }(),
        1e-8);
    EXPECT_EQ(summary.rows, 400);
    EXPECT_EQ(summary.degrees_of_freedom, 396);
    EXPECT_NEAR(summary.RelativeSigmaPercent(1), 100 * std::sqrt(s2 * inverse(1, 1)) / std::abs(chi[1]), 1e-8);
  }
}

// Where the assumptions hold (W exact, white noise, one variance a joint) the 95 % intervals hold the truth in 95 % of
// the runs, and WLS is not worse than LS. 2000 runs: the count of 95 % events has a standard deviation of 0.49 %, 4.5
// of them make a false alarm of 7e-6 a parameter; a standard deviation wrong by 10 % (coverage 92.2 %) is seen.
TEST(LinearIdentification, IntervalsHoldTheTruth) {
  std::mt19937_64 generator(77);
  std::normal_distribution<double> normal;
  const Data data = MakeData(60, 5);
  const int runs = 2000;
  VectorXd held = VectorXd::Zero(4), square_ls = VectorXd::Zero(4), square_wls = VectorXd::Zero(4);
  for (int run = 0; run < runs; ++run) {
    const VectorXd e1 = VectorXd::NullaryExpr(60, [&] { return 0.1 * normal(generator); });
    const VectorXd e2 = VectorXd::NullaryExpr(60, [&] { return 2.0 * normal(generator); });
    const LinearSystem system = System(data, e1, e2);
    LinearOptions options;
    const LinearSummary wls = SolveLinear(system, options);
    options.weighted = false;
    const LinearSummary ls = SolveLinear(system, options);
    for (int k = 0; k < 4; ++k) {
      const double error = wls.values[k] - data.truth[k];
      held[k] += std::abs(error) < 1.98 * std::sqrt(wls.covariance(k, k));  // t(0.975, 116)
      square_wls[k] += error * error;
      square_ls[k] += std::pow(ls.values[k] - data.truth[k], 2);
    }
  }
  for (int k = 0; k < 4; ++k) {
    EXPECT_NEAR(held[k] / runs, 0.95, 4.5 * std::sqrt(0.95 * 0.05 / runs)) << k;
    // Variances in the ratio 1 : 400. The first unknown is in joint 1's rows alone: what WLS gains there is that the
    // others no longer disturb it.
    EXPECT_LT(square_wls[k], (k == 0 ? 1.0 : 0.1) * square_ls[k]) << k;
  }
}

TEST(LinearIdentification, NoiseFreeDataGiveTheTruth) {
  const Data data = MakeData(50, 6);
  const VectorXd zero = VectorXd::Zero(50);
  const LinearSummary summary = SolveLinear(System(data, zero, zero), LinearOptions());
  ASSERT_TRUE(summary.IsSolutionUsable());
  EXPECT_LT((summary.values - data.truth).norm(), 1e-12);
}

TEST(LinearIdentification, NamesWhatIsNotIdentifiable) {
  Data data = MakeData(50, 7);
  for (MatrixXd& w : data.w) w.col(3) = 2.0 * w.col(1);
  const VectorXd zero = VectorXd::Zero(50);
  LinearSummary summary = SolveLinear(System(data, zero, zero), LinearOptions());
  EXPECT_FALSE(summary.IsSolutionUsable());
  EXPECT_EQ(summary.status.code(), StatusCode::kUntrusted);
  EXPECT_THAT(summary.status.message(), ::testing::HasSubstr("1 direction of the parameters"));
  EXPECT_THAT(summary.status.message(), ::testing::HasSubstr("b + d."));
  for (MatrixXd& w : data.w) w.col(2).setZero();
  summary = SolveLinear(System(data, zero, zero), LinearOptions());
  EXPECT_THAT(summary.status.message(), ::testing::HasSubstr("torque: c."));
  EXPECT_FALSE(SolveLinear(System(MakeData(2, 1), VectorXd::Zero(2), VectorXd::Zero(2)), LinearOptions()).status.ok());
}

// A parameter that is zero in truth goes, those that matter stay; what is left equals the solution without its column.
TEST(LinearIdentification, EssentialParameters) {
  Data data = MakeData(300, 8);
  data.truth[3] = 0.0;
  std::mt19937_64 generator(3);
  std::normal_distribution<double> normal;
  const VectorXd e1 = VectorXd::NullaryExpr(300, [&] { return 0.1 * normal(generator); });
  const VectorXd e2 = VectorXd::NullaryExpr(300, [&] { return 0.1 * normal(generator); });
  LinearOptions options;
  options.weighted = false;
  options.essential_ratio = 15.0;
  const LinearSummary summary = SolveLinear(System(data, e1, e2), options);
  EXPECT_THAT(summary.eliminated, ::testing::ElementsAre("d"));
  EXPECT_EQ(summary.values[3], 0.0);
  EXPECT_EQ(summary.covariance.row(3).norm(), 0.0);
  MatrixXd w(600, 3);
  w << data.w[0].leftCols(3), data.w[1].leftCols(3);
  VectorXd y(600);
  y << data.w[0] * data.truth + e1, data.w[1] * data.truth + e2;
  EXPECT_LT((summary.values.head(3) - w.householderQr().solve(y)).norm(), 1e-12);
  EXPECT_EQ(summary.degrees_of_freedom, 597);
}

TEST(LinearOptions, RefusesWhatMakesNoSense) {
  std::string error;
  LinearOptions options;
  EXPECT_TRUE(options.IsValid(&error));
  options.essential_ratio = 0.5;
  EXPECT_FALSE(options.IsValid(&error));
  EXPECT_THAT(error, ::testing::HasSubstr("essential_ratio is 0.5"));
  options = LinearOptions();
  options.a_priori_sigma = VectorXd::Zero(2);
  EXPECT_FALSE(options.IsValid(&error));
}

}  // namespace
}  // namespace idim::linear_identification_test
