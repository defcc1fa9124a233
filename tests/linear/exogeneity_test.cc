#include "solvers/linear/exogeneity.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

#include "core/base/decompositions.h"
#include "solvers/linear/gain_identification.h"
#include "tests/support/gain_study.h"

namespace idim::exogeneity_test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using ::testing::HasSubstr;

// X = [x1 x2] with the truth of x1 seen through noise, three instruments of x1, y = X b + e.
struct Data {
  MatrixXd z, x;
  VectorXd y;
  MatrixXd All() const {
    MatrixXd all(z.rows(), z.cols() + x.cols() + 1);
    all << z, x, y;
    return all;
  }
};

Data MakeData(double regressor_noise, std::mt19937_64* generator, int rows = 200) {
  std::normal_distribution<double> normal;
  const auto white = [&](int columns) {
    return MatrixXd::NullaryExpr(rows, columns, [&] { return normal(*generator); }).eval();
  };
  Data data;
  data.z = white(3);
  const MatrixXd x2 = white(1);
  const MatrixXd true_x1 = data.z * VectorXd{{1.0, -0.5, 0.7}} + 0.5 * white(1) + 0.3 * x2;
  data.x.resize(rows, 2);
  data.x << true_x1 + regressor_noise * white(1), x2;
  data.y = 2.0 * true_x1 - x2 + 0.5 * white(1);
  return data;
}

ExogeneityTest RunTest(const Data& data, const ExogeneityOptions& options = ExogeneityOptions()) {
  const MatrixXd all = data.All();
  TriangularFactor factor(static_cast<int>(all.cols()));
  for (Eigen::Index i = 0; i < all.rows(); ++i) factor.AddRow(all.row(i));
  return TestExogeneity(factor.R(), factor.rows(), static_cast<int>(data.z.cols()), {0}, options);
}

// The statistic and the estimates by other routes, on the data themselves: two-stage least squares by projection, F by
// the t of one added column, Sargan's by its own regression.
TEST(Exogeneity, AgreesWithTwoStageLeastSquaresAndStudentsT) {
  std::mt19937_64 generator(1);
  const Data data = MakeData(0.8, &generator);
  const ExogeneityTest test = RunTest(data);
  ASSERT_TRUE(test.status.ok()) << test.status.message();
  MatrixXd instruments(200, 4);
  instruments << data.z, data.x.col(1);
  const auto projected = [&](const MatrixXd& a) {
    return MatrixXd(instruments * instruments.householderQr().solve(a));
  };
  const MatrixXd x_hat = projected(data.x);
  const VectorXd two_stage = (x_hat.transpose() * data.x).inverse() * x_hat.transpose() * data.y;
  EXPECT_LT((test.instrumental - two_stage).norm(), 1e-10);
  EXPECT_LT((test.least_squares - data.x.householderQr().solve(data.y)).norm(), 1e-10);
  MatrixXd augmented(200, 3);
  augmented << data.x, data.x.col(0) - x_hat.col(0);
  const MatrixXd inverse = (augmented.transpose() * augmented).inverse();
  const VectorXd b = inverse * augmented.transpose() * data.y;
  const double s2 = (data.y - augmented * b).squaredNorm() / 197.0;
  EXPECT_NEAR(test.f, b[2] * b[2] / (s2 * inverse(2, 2)), 1e-8 * test.f);
  EXPECT_EQ(test.numerator, 1);
  EXPECT_EQ(test.denominator, 197);
  const VectorXd residual = data.y - data.x * two_stage;
  EXPECT_EQ(test.overidentification, 2);
  // Chi-squared of 2 degrees of freedom: exp(-s / 2).
  const double sargan = 200.0 * projected(residual).squaredNorm() / residual.squaredNorm();
  EXPECT_NEAR(test.sargan_p, std::exp(-0.5 * sargan), 1e-10);
}

// Under exogeneity p is uniform: of 2000 runs 5 % are below 0.05, with a standard deviation of 0.49 %; 4.5 of them make
// a false alarm of 7e-6. With noise in the regressor as large as its own independent part LS is biased by 20 % and
// nearly all runs say so, while two-stage least squares is not.
TEST(Exogeneity, SizeAndPower) {
  std::mt19937_64 generator(2);
  ExogeneityOptions options;
  options.level = 0.05;
  int rejected = 0, sargan = 0, found = 0;
  double ls = 0.0, iv = 0.0;
  const int runs = 2000;
  for (int run = 0; run < runs; ++run) {
    const ExogeneityTest exact = RunTest(MakeData(0.0, &generator), options);
    ASSERT_TRUE(exact.status.ok());
    rejected += exact.biased;
    sargan += exact.sargan_p < 0.05;
    const ExogeneityTest noisy = RunTest(MakeData(0.8, &generator), options);
    found += noisy.biased;
    ls += noisy.least_squares[0] / runs;
    iv += noisy.instrumental[0] / runs;
  }
  EXPECT_NEAR(rejected / double(runs), 0.05, 4.5 * std::sqrt(0.05 * 0.95 / runs));
  EXPECT_NEAR(sargan / double(runs), 0.05, 4.5 * std::sqrt(0.05 * 0.95 / runs) + 0.005);  // asymptotic: r = 200
  EXPECT_GT(found, 0.98 * runs);
  EXPECT_LT(ls, 1.75);  // 2 (1.74 + 0.25) / (1.99 + 0.64) = 1.51 without x2's share
  EXPECT_NEAR(iv, 2.0, 0.02);
}

// An instrument that is correlated with the error: Sargan's statistic tells, the test itself cannot.
TEST(Exogeneity, SargansStatisticSeesAnIllegitimateInstrument) {
  std::mt19937_64 generator(3);
  Data data = MakeData(0.0, &generator, 2000);
  const VectorXd b{{2.0, -1.0}};
  data.z.col(2) += data.y - data.x * b;
  EXPECT_LT(RunTest(data).sargan_p, 1e-6);
}

TEST(Exogeneity, RefusesWeakInstruments) {
  std::mt19937_64 generator(4);
  Data data = MakeData(0.5, &generator);
  data.z = MakeData(0.0, &generator).z;
  const ExogeneityTest test = RunTest(data);
  EXPECT_EQ(test.status.code(), StatusCode::kUntrusted);
  EXPECT_THAT(test.status.message(), HasSubstr("weak instruments"));
  EXPECT_EQ(test.p_value, -1.0);
}

// Equations of one joint do not determine all parameters: a dependent column changes nothing.
TEST(Exogeneity, DependentColumnsAreHarmless) {
  std::mt19937_64 generator(5);
  Data data = MakeData(0.8, &generator);
  const ExogeneityTest full = RunTest(data);
  MatrixXd more(200, 4);
  more << data.x, 3.0 * data.x.col(1), VectorXd::Zero(200);
  data.x = more;
  const ExogeneityTest deficient = RunTest(data);
  EXPECT_NEAR(full.f, deficient.f, 1e-8 * full.f);
  EXPECT_EQ(full.denominator, deficient.denominator);
  EXPECT_NEAR(full.instrumental[0], deficient.instrumental[0], 1e-10);
}

TEST(ExogeneityOptions, RefusesWhatMakesNoSense) {
  std::string error;
  ExogeneityOptions options;
  EXPECT_TRUE(options.IsValid(&error)) << error;
  options.level = 0.0;
  EXPECT_FALSE(options.IsValid(&error));
  options = ExogeneityOptions();
  options.min_first_stage_f = -1.0;
  EXPECT_FALSE(options.IsValid(&error));
}

// The claim behind lagged instruments: white noise through the decimator is correlated by less than 4 % from two
// outputs on, 1 % from nine on, and not at all beyond 20.
TEST(LaggedInstruments, DecimatedNoiseForgetsItself) {
  testing::GainScenario scenario = testing::Tx40Gains();
  scenario.samples = 1000;
  const testing::GainStudy study = MakeGainStudy(scenario);
  const std::vector<double>& taps = study.prepared.data->recordings[0].decimator->Taps();
  const Eigen::Map<const VectorXd> g(taps.data(), Eigen::Index(taps.size()));
  for (int lag = 2; lag < 20; ++lag) {
    const Eigen::Index shared = g.size() - lag * scenario.decimation;
    EXPECT_LT(std::abs(g.head(shared).dot(g.tail(shared))), (lag < 9 ? 0.04 : 0.01) * g.squaredNorm()) << lag;
  }
  EXPECT_EQ(g.size(), 20 * scenario.decimation + 1);
}

// White noise on the signals and nothing else wrong: the test says that LS is biased, accepts the instruments, and
// two-stage least squares is nearer to the true gains than LS; without noise there is nothing to say.
TEST(LaggedInstruments, SayThatSignalNoiseBiasesLeastSquares) {
  testing::GainScenario scenario = testing::Tx40Gains();
  scenario.signal_noise = 0.15;  // a recorded sample; the decimator leaves a third of it
  const testing::GainStudy study = MakeGainStudy(scenario);
  const Result<LaggedSystem> lagged = BuildLaggedSystem(study.prepared, LaggedOptions());
  ASSERT_TRUE(lagged.ok()) << lagged.status().message();
  const Result<GainSystem> system = BuildGainSystem(study.prepared);
  ASSERT_TRUE(system.ok());
  GainOptions options;
  options.estimator = GainEstimator::kWgtls;
  const GainSummary wgtls = SolveGains(*system, options);
  const ExogeneityTest test = TestAllExogeneity(*lagged, wgtls.joint_sigma);
  ASSERT_TRUE(test.status.ok()) << test.status.message();
  EXPECT_TRUE(test.biased);
  EXPECT_EQ(test.numerator, 6);
  EXPECT_GT(test.sargan_p, 1e-4);
  for (int j = 0; j < 6; ++j) {
    EXPECT_LT(std::abs(test.instrumental[j] - study.truth[j]), std::abs(test.least_squares[j] - study.truth[j])) << j;
  }
  const ExogeneityTest second = TestJointExogeneity(*lagged, 1);
  ASSERT_TRUE(second.status.ok()) << second.status.message();
  EXPECT_TRUE(second.biased);
  // The mass alone is known, and the last axis meets the origin that it is about.
  const ExogeneityTest last = TestJointExogeneity(*lagged, 5);
  EXPECT_EQ(last.status.code(), StatusCode::kUntrusted);
  EXPECT_THAT(last.status.message(), HasSubstr("joint 6 alone hold nothing known"));
}

TEST(LaggedInstruments, AllColumnsMayBeSuspected) {
  testing::GainScenario scenario = testing::Tx40Gains();
  scenario.signal_noise = 0.5;
  const testing::GainStudy study = MakeGainStudy(scenario);
  LaggedOptions options;
  options.suspects = Suspects::kAll;
  const Result<LaggedSystem> lagged = BuildLaggedSystem(study.prepared, options);
  ASSERT_TRUE(lagged.ok());
  EXPECT_EQ(lagged->suspects.size(), std::size_t(study.truth.size()));
  EXPECT_EQ(lagged->instruments, 2 * study.truth.size());
  options.lag = 0;
  EXPECT_EQ(BuildLaggedSystem(study.prepared, options).status().code(), StatusCode::kBadInput);
}

}  // namespace
}  // namespace idim::exogeneity_test
