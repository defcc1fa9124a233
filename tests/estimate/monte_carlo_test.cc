// Statistics of simulated runs against numbers by hand and against the distributions that they must follow.

#include "core/estimate/monte_carlo.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "apps/pages/comparison_report.h"
#include "apps/pages/monte_carlo_report.h"
#include "core/base/random.h"

namespace idim::monte_carlo_test {
namespace {

using ::testing::HasSubstr;

Parameter Named(const std::string& name) {
  return {name, name[0] == 'g' ? ParameterKind::kDriveGain : ParameterKind::kBase, 1, "u"};
}

ParameterEstimate Of(const std::string& name, double value, double sigma, double half) {
  ParameterEstimate p;
  p.parameter = Named(name);
  p.value = value;
  p.standard_deviation = sigma;
  p.interval95[0] = value - half;
  p.interval95[1] = value + half;
  return p;
}

Estimate With(const std::vector<ParameterEstimate>& parameters, const Eigen::MatrixXd& covariance) {
  Estimate e;
  e.estimator = "wls";
  e.parameters = parameters;
  e.covariance = covariance;
  return e;
}

Estimate One(double value, double sigma, double half) {
  return With({Of("A", value, sigma, half)}, Eigen::MatrixXd::Constant(1, 1, sigma * sigma));
}

// Truth 10; estimates 11, 9, 14 with reported deviations 1, 2, 2: errors 1, -1, 4, mean 4/3, squares about it
// (1 + 49 + 64) / 9 = 114 / 9, so s^2 = 57 / 9; mean square (1 + 1 + 16) / 3 = 6; reported (1 + 4 + 4) / 3 = 3;
// the first two intervals hold the truth; NEES (1 + 1/4 + 4) / 3 = 1.75.
TEST(MonteCarlo, StatisticsByHand) {
  const std::vector<TrueParameter> truth = {{Named("A"), 10.0}};
  Estimate failed;
  failed.status = Status::Untrusted("no rank");
  Estimate doubtful = One(14.0, 2.0, 3.9);
  doubtful.status = Status::Untrusted("weak");
  std::vector<RunErrors> runs;
  for (const Estimate& e : {One(11.0, 1.0, 1.1), failed, One(9.0, 2.0, 1.0), doubtful}) {
    runs.push_back(RunErrorsOf(truth, e));
  }
  const EstimatorStatistics s = Accumulate("wls", truth, runs);
  EXPECT_EQ(s.estimator, "wls");
  EXPECT_EQ(s.failures, 2);
  EXPECT_EQ(s.without_numbers, 1);
  EXPECT_EQ(s.first_failure, "no rank");
  ASSERT_EQ(s.parameters.size(), 1u);
  const ParameterStatistics& p = s.parameters[0];
  EXPECT_EQ(p.parameter.name, "A");
  EXPECT_EQ(p.truth, 10.0);
  EXPECT_EQ(p.runs, 3) << "the run without numbers does not count, the one that is not trusted does";
  EXPECT_NEAR(p.bias, 4.0 / 3.0, 1e-12);
  EXPECT_NEAR(p.standard_deviation, std::sqrt(57.0 / 9.0), 1e-12);
  EXPECT_NEAR(p.bias_standard_error, std::sqrt(57.0 / 27.0), 1e-12);
  EXPECT_NEAR(p.rmse, std::sqrt(6.0), 1e-12);
  EXPECT_NEAR(p.mean_standard_deviation, std::sqrt(3.0), 1e-12);
  EXPECT_NEAR(p.coverage95, 2.0 / 3.0, 1e-12);
  EXPECT_NEAR(p.coverage95_standard_error, std::sqrt(2.0 / 27.0), 1e-12);
  EXPECT_NEAR(p.scores[3], 2.0, 1e-12);
  EXPECT_TRUE(std::isnan(p.values[1]));
  EXPECT_EQ(s.nees.runs, 3);
  EXPECT_NEAR(s.nees.mean, 1.75, 1e-12);
  // NEES 1, 1/4, 4: squares about the mean 9/16 + 36/16 + 81/16.
  EXPECT_NEAR(s.nees.standard_error, std::sqrt(126.0 / 16.0 / 2.0 / 3.0), 1e-12);
  // Chi-square with 3 degrees of freedom: quantiles 0.2158 and 9.3484 (tables).
  EXPECT_NEAR(s.nees.expected95[0], 0.2158 / 3.0, 1e-4);
  EXPECT_NEAR(s.nees.expected95[1], 9.3484 / 3.0, 1e-4);
  EXPECT_EQ(s.nees_gains.runs, 0) << "there are no gains";
}

// e = (2, 1), P = [4 1; 1 2]: e' P^-1 e = (2*4 - 2*2*1*1 + 4*1) / 7 = 8/7. Gains alone: 2^2 / 4.
TEST(MonteCarlo, NeesUsesCorrelations) {
  const std::vector<TrueParameter> truth = {{Named("g1"), 5.0}, {Named("A"), -1.0}};
  Eigen::Matrix2d covariance;
  covariance << 4.0, 1.0, 1.0, 2.0;
  const Estimate e = With({Of("g1", 7.0, 2.0, 4.0), Of("A", 0.0, std::sqrt(2.0), 3.0)}, covariance);
  RunErrors run = RunErrorsOf(truth, e);
  EXPECT_NEAR(run.nees, 8.0 / 7.0 / 2.0, 1e-12);
  EXPECT_NEAR(run.nees_gains, 1.0, 1e-12);

  // Units of very different size change nothing; a covariance without inverse gives none.
  const double tiny = 1e-9;
  const Eigen::Vector2d unit(1.0, tiny);
  const Estimate scaled = With({Of("g1", 7.0, 2.0, 4.0), Of("A", 0.0, tiny * std::sqrt(2.0), 3.0)},
                               unit.asDiagonal() * covariance * unit.asDiagonal());
  run = RunErrorsOf({{Named("g1"), 5.0}, {Named("A"), -tiny}}, scaled);
  EXPECT_NEAR(run.nees, 8.0 / 7.0 / 2.0, 1e-9);
  covariance << 4.0, 4.0, 4.0, 4.0;
  run = RunErrorsOf(truth, With(e.parameters, covariance));
  EXPECT_EQ(run.nees, -1.0);
  EXPECT_NEAR(run.nees_gains, 1.0, 1e-12);
}

// A parameter that a run left out (not essential) does not count in it; one that is not a number makes a run without.
TEST(MonteCarlo, ParametersThatAreNotThere) {
  const std::vector<TrueParameter> truth = {{Named("A"), 10.0}, {Named("B"), 0.0}};
  const double inf = std::numeric_limits<double>::infinity();
  const EstimatorStatistics s =
      Accumulate("ls", truth, {RunErrorsOf(truth, One(11.0, 1.0, 2.0)), RunErrorsOf(truth, One(inf, 1.0, 2.0))});
  EXPECT_EQ(s.without_numbers, 1);
  EXPECT_EQ(s.parameters[0].runs, 1);
  EXPECT_NEAR(s.parameters[0].bias, 1.0, 1e-12);
  EXPECT_TRUE(std::isnan(s.parameters[0].standard_deviation)) << "one run has no spread";
  EXPECT_EQ(s.parameters[1].runs, 0);
  EXPECT_TRUE(std::isnan(s.parameters[1].bias));
  EXPECT_DEATH(RunErrorsOf({{Named("B"), 0.0}}, One(11.0, 1.0, 2.0)), "no truth for A");
}

// 2000 draws of 5 correlated normal numbers about the truth, reported with their true covariance: mean NEES is
// chi-square with 10000 degrees of freedom over 10000, standard deviation sqrt(2 / 10000) = 0.0141; 4.5 of them
// (false alarm 7e-6) are 0.064, so a variance off by 10 % is found. Coverage: 10000 intervals, standard deviation
// 0.0049 for one parameter's 2000; 4.5 of them 0.022. Bias: 4.5 / sqrt(2000) = 0.1 spreads. 5 parameters:
// below 1e-4 in all.
TEST(MonteCarlo, ExactNormalDrawsAreFoundExact) {
  constexpr int kRuns = 2000, kSize = 5;
  Random random(4);
  Eigen::MatrixXd root(kSize, kSize);
  for (double& r : root.reshaped()) r = random.Normal();
  root.row(2) *= 1e-3;
  const Eigen::MatrixXd covariance = root * root.transpose();
  std::vector<TrueParameter> truth;
  for (int k = 0; k < kSize; ++k) truth.push_back({Named((k < 2 ? "g" : "A") + std::to_string(k)), 3.0 * k});
  std::vector<RunErrors> runs;
  for (int run = 0; run < kRuns; ++run) {
    Eigen::VectorXd draw(kSize);
    for (double& d : draw) d = random.Normal();
    const Eigen::VectorXd error = root * draw;
    std::vector<ParameterEstimate> parameters;
    for (int k = 0; k < kSize; ++k) {
      const double sigma = std::sqrt(covariance(k, k));
      parameters.push_back(Of(truth[k].parameter.name, truth[k].value + error[k], sigma, 1.959964 * sigma));
    }
    runs.push_back(RunErrorsOf(truth, With(parameters, covariance)));
  }
  const EstimatorStatistics s = Accumulate("wls", truth, runs);
  EXPECT_NEAR(s.nees.mean, 1.0, 4.5 * std::sqrt(2.0 / (kRuns * kSize)));
  EXPECT_NEAR(s.nees_gains.mean, 1.0, 4.5 * std::sqrt(2.0 / (kRuns * 2)));
  EXPECT_NEAR(s.nees.standard_error, std::sqrt(2.0 / (kRuns * kSize)), 0.15 * std::sqrt(2.0 / (kRuns * kSize)));
  for (int k = 0; k < kSize; ++k) {
    const ParameterStatistics& p = s.parameters[k];
    const double sigma = std::sqrt(covariance(k, k));
    EXPECT_NEAR(p.coverage95, 0.95, 4.5 * std::sqrt(0.95 * 0.05 / kRuns)) << k;
    EXPECT_LT(std::abs(p.bias), 4.5 * sigma / std::sqrt(kRuns)) << k;
    EXPECT_NEAR(p.standard_deviation / sigma, 1.0, 4.5 / std::sqrt(2.0 * kRuns)) << k;
    EXPECT_NEAR(p.mean_standard_deviation, sigma, 1e-9 * sigma) << k;
  }
}

// P(X <= count) of a binomial with 0.95, summed term by term.
double BinomialAtMost(int count, int runs) {
  double sum = 0.0;
  for (int k = 0; k <= count; ++k) {
    sum += std::exp(std::lgamma(runs + 1.0) - std::lgamma(k + 1.0) - std::lgamma(runs - k + 1.0) + k * std::log(0.95) +
                    (runs - k) * std::log(0.05));
  }
  return sum;
}

// At most 2.5 % lie outside at either end, and more if the band were two runs narrower there.
TEST(MonteCarlo, CoverageBandIsTheBinomials) {
  for (const int runs : {20, 200, 1000}) {
    const auto [lower, upper] = CoverageBand(runs);
    const int first = static_cast<int>(std::lround(lower * runs)), last = static_cast<int>(std::lround(upper * runs));
    EXPECT_NEAR(first, lower * runs, 1e-9);
    EXPECT_LE(BinomialAtMost(first - 1, runs), 0.025) << runs;
    EXPECT_GT(BinomialAtMost(first + 1, runs), 0.025) << runs;
    EXPECT_LE(1.0 - BinomialAtMost(last, runs), 0.025 + 1e-12) << runs;
    EXPECT_GT(1.0 - BinomialAtMost(last - 2, runs), 0.025) << runs;
  }
}

MonteCarlo Example() {
  const std::vector<TrueParameter> truth = {{Named("g1"), -2.0}, {Named("A"), 10.0}};
  const Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();
  std::vector<RunErrors> good, none(3);
  for (const double e : {0.5, -0.1, 0.2}) {
    good.push_back(RunErrorsOf(truth, With({Of("g1", -2.0 + e, 1.0, 1.96), Of("A", 10.0 + e, 1.0, 1.96)}, covariance)));
  }
  Estimate failed;
  failed.status = Status::Untrusted("degenerate");
  for (RunErrors& run : none) run = RunErrorsOf(truth, failed);
  MonteCarlo m;
  m.runs = 3;
  m.seed = 7;
  m.reference = "eiv";
  m.position_noise = Eigen::VectorXd::Constant(1, 1e-5);
  m.signal_noise = Eigen::VectorXd::Constant(1, 0.1);
  m.estimators = {Accumulate("ls", truth, good), Accumulate("tls", truth, none)};
  return m;
}

TEST(MonteCarlo, JsonKeepsTheContract) {
  Comparison comparison;
  comparison.monte_carlo = Example();
  const auto json = nlohmann::json::parse(ComparisonToJson(comparison)).at("monte_carlo");
  EXPECT_EQ(json.at("runs"), 3);
  EXPECT_EQ(json.at("seed"), 7);
  EXPECT_EQ(json.at("reference"), "eiv");
  EXPECT_EQ(json.at("noise").at("signal").at(0), 0.1);
  ASSERT_EQ(json.at("estimators").size(), 2u);
  const auto& ls = json.at("estimators").at(0);
  EXPECT_EQ(ls.at("estimator"), "ls");
  EXPECT_EQ(ls.at("failures"), 0);
  ASSERT_EQ(ls.at("parameters").size(), 2u);
  const auto& g1 = ls.at("parameters").at(0);
  EXPECT_EQ(g1.at("name"), "g1");
  EXPECT_EQ(g1.at("truth"), -2.0);
  EXPECT_NEAR(g1.at("bias").get<double>(), 0.2, 1e-12);
  EXPECT_NEAR(g1.at("standard_deviation").get<double>(), 0.3, 1e-12);
  EXPECT_NEAR(g1.at("rmse").get<double>(), std::sqrt(0.1), 1e-12);
  EXPECT_EQ(g1.at("coverage95"), 1.0);
  EXPECT_NEAR(ls.at("nees").at("mean").get<double>(), 0.1, 1e-12);
  EXPECT_FALSE(g1.contains("values"));
  const auto& tls = json.at("estimators").at(1);
  EXPECT_EQ(tls.at("failures"), 3);
  EXPECT_EQ(tls.at("without_numbers"), 3);
  EXPECT_EQ(tls.at("first_failure"), "degenerate");
  EXPECT_TRUE(tls.at("parameters").at(0).at("bias").is_null());
  EXPECT_TRUE(tls.at("nees").is_null());
  EXPECT_FALSE(nlohmann::json::parse(ComparisonToJson(Comparison())).contains("monte_carlo"));
}

TEST(MonteCarlo, TextAndSectionsSayWhatWasFound) {
  const std::string text = MonteCarloToText(Example());
  EXPECT_THAT(text, HasSubstr("3 runs, seed 7"));
  EXPECT_THAT(text, HasSubstr("IDIM-EIV"));
  EXPECT_THAT(text, HasSubstr("IDIM-TLS, first failure: degenerate"));
  EXPECT_THAT(text, HasSubstr("-10.0")) << "-1.8 where -2 is true is 10 % too small";
  EXPECT_THAT(text, HasSubstr("15.0")) << "spread 0.3 of 2";

  std::vector<std::string> figures;
  for (const Section& section : MonteCarloSections(Example())) {
    for (const Block& block : section.blocks) {
      const auto* grid = std::get_if<FigureGrid>(&block);
      for (size_t k = 0; grid != nullptr && k < grid->figures.size(); ++k) {
        std::visit([&](const auto& figure) { figures.push_back(figure.title); }, grid->figures[k]);
      }
    }
  }
  EXPECT_THAT(figures, ::testing::ElementsAre(HasSubstr("Bias against spread"), HasSubstr("95 % intervals hold"),
                                              HasSubstr("Error: mean"), HasSubstr("Error over"), HasSubstr("g1")));
  // An estimator without any numbers is in the tables, never in a figure, where it would be an empty set.
  for (const Section& section : MonteCarloSections(Example())) {
    for (const Block& block : section.blocks) {
      const auto* grid = std::get_if<FigureGrid>(&block);
      for (size_t k = 0; grid != nullptr && k < grid->figures.size(); ++k) {
        if (const auto* f = std::get_if<HistogramFigure>(&grid->figures[k])) {
          ASSERT_EQ(f->sets.size(), 1u);
          EXPECT_EQ(f->sets[0].name, "IDIM-LS");
        }
      }
    }
  }
}

}  // namespace
}  // namespace idim::monte_carlo_test
