// Simulated runs through the whole chain, where theory says what must come out.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "solvers/estimators/estimators.h"
#include "solvers/judge/monte_carlo.h"
#include "tests/support/edit_data.h"
#include "tests/support/simulated_study.h"

namespace idim::monte_carlo_run_test {
namespace {

using ::testing::HasSubstr;

class MonteCarloRun : public ::testing::Test {
 protected:
  // The arm of three joints; `gains` replaces the study's line.
  PreparedStudy Prepare(bool identify_gains) {
    study_.Simulate();
    if (identify_gains) testing::ReplaceOnce("mode: known", "mode: identify", &study_.study_text);
    return study_.Prepare();
  }

  static Estimate EstimateOf(const PreparedStudy& prepared, const std::string& estimator) {
    const Result<EstimatorRunner> runner = EstimatorRunner::Create(&prepared);
    EXPECT_TRUE(runner.ok()) << runner.status().message();
    const Result<Identification> identification = runner->Run(estimator, 0.0);
    EXPECT_TRUE(identification.ok()) << identification.status().message();
    return identification->estimate;
  }

  testing::SimulatedStudy study_;
};

std::string Dump(const MonteCarlo& m) { return MonteCarloJson(m).dump(); }

// Gains known, encoders exact: W is exact and WLS unbiased. 60 runs, fewer than 40 parameters.
//   bias: |mean| below 5.5 standard errors (Student's t, 59 degrees of freedom: 9e-7 each, below 4e-5 in all); a bias
//   of one spread is found.
//   spread: s / sigma has a standard deviation of 1 / sqrt(2 * 59) = 0.092; 0.45 is 4.9 of them (1e-6 each).
//   coverage: one parameter's has a standard deviation of 0.028; their mean, were only five of them independent,
//   0.0126, of which 0.06 is 4.7 (3e-6); intervals 25 % too short (coverage 0.86) are found.
//   NEES: its mean is chi-square with 60 p degrees of freedom over their number; 4.5 standard deviations are 0.14 for
//   p = 37; a variance off by 20 % is found.
TEST_F(MonteCarloRun, WlsWithKnownGainsIsUnbiasedAndHonest) {
  testing::ReplaceOnce("position: 1.0e-6", "position: 1.0e-9", &study_.scenario_text);
  const PreparedStudy prepared = Prepare(false);
  const Estimate reference = EstimateOf(prepared, "wls");
  MonteCarloOptions options;
  options.runs = 60;
  options.threads = 2;
  const Result<MonteCarlo> result = RunMonteCarlo(prepared, reference, {"ls", "wls"}, options, nullptr);
  ASSERT_TRUE(result.ok()) << result.status().message();
  EXPECT_EQ(result->runs, 60);
  EXPECT_EQ(result->reference, "wls");
  ASSERT_EQ(result->estimators.size(), 2u);
  const EstimatorStatistics& wls = result->estimators[1];
  EXPECT_EQ(wls.estimator, "wls");
  EXPECT_EQ(wls.failures, 0);
  ASSERT_EQ(wls.parameters.size(), reference.parameters.size());
  double covered = 0.0;
  for (size_t k = 0; k < wls.parameters.size(); ++k) {
    const ParameterStatistics& p = wls.parameters[k];
    EXPECT_EQ(p.parameter.name, reference.parameters[k].parameter.name);
    EXPECT_EQ(p.truth, reference.parameters[k].value) << "the estimate is the truth";
    EXPECT_EQ(p.runs, 60);
    EXPECT_LT(std::abs(p.bias), 5.5 * p.bias_standard_error) << p.parameter.name;
    EXPECT_NEAR(p.standard_deviation / p.mean_standard_deviation, 1.0, 0.45) << p.parameter.name;
    // The noise of the real recordings is white and its size is found to 1 % (4000 samples a joint): what the runs
    // report of themselves is what the reference reports. Decimated to 800, its variance is known to 5 % a joint.
    EXPECT_NEAR(p.mean_standard_deviation / reference.parameters[k].standard_deviation, 1.0, 0.15) << p.parameter.name;
    covered += p.coverage95 / static_cast<double>(wls.parameters.size());
  }
  EXPECT_NEAR(covered, 0.95, 0.06);
  const double freedom = 60.0 * static_cast<double>(wls.parameters.size());
  EXPECT_NEAR(wls.nees.mean, 1.0, 4.5 * std::sqrt(2.0 / freedom));
}

// The noise is what the header says it is: its size is seen in what the runs estimate of it, and signals twice as noisy
// spread the estimates twice as far.
TEST_F(MonteCarloRun, SpreadFollowsTheNoiseOfTheReference) {
  const PreparedStudy prepared = Prepare(false);
  Estimate reference = EstimateOf(prepared, "wls");
  MonteCarloOptions options;
  options.runs = 20;
  const Result<MonteCarlo> once = RunMonteCarlo(prepared, reference, {"wls"}, options, nullptr);
  reference.signal_noise *= 2.0;
  const Result<MonteCarlo> twice = RunMonteCarlo(prepared, reference, {"wls"}, options, nullptr);
  ASSERT_TRUE(once.ok() && twice.ok());
  EXPECT_EQ(twice->signal_noise, 2.0 * once->signal_noise);
  for (size_t k = 0; k < once->estimators[0].parameters.size(); ++k) {
    const ParameterStatistics &a = once->estimators[0].parameters[k], &b = twice->estimators[0].parameters[k];
    // The same draws scaled: no sampling error, only that of the small position noise.
    EXPECT_NEAR(b.standard_deviation / a.standard_deviation, 2.0, 0.1) << a.parameter.name;
    EXPECT_NEAR(b.mean_standard_deviation / a.mean_standard_deviation, 2.0, 0.1) << a.parameter.name;
  }
}

// Encoders a thousand times coarser than the arm's own: the positions of the runs must be as noisy.
TEST_F(MonteCarloRun, PositionsAreNoisyToo) {
  PreparedStudy prepared = Prepare(false);
  const Estimate reference = EstimateOf(prepared, "wls");
  MonteCarloOptions options;
  options.runs = 10;
  const Result<MonteCarlo> fine = RunMonteCarlo(prepared, reference, {"wls"}, options, nullptr);
  testing::EditData(&prepared, [](Data* data) { data->position_noise *= 1000.0; });
  const Result<MonteCarlo> coarse = RunMonteCarlo(prepared, reference, {"wls"}, options, nullptr);
  ASSERT_TRUE(fine.ok() && coarse.ok());
  EXPECT_EQ(coarse->position_noise, 1000.0 * fine->position_noise);
  for (size_t k = 0; k < fine->estimators[0].parameters.size(); ++k) {
    const ParameterStatistics &a = fine->estimators[0].parameters[k], &b = coarse->estimators[0].parameters[k];
    EXPECT_GT(b.rmse, 1.3 * a.rmse) << a.parameter.name;
  }
}

TEST_F(MonteCarloRun, SameSeedSameNumbersOnAnyNumberOfThreads) {
  const PreparedStudy prepared = Prepare(true);
  const Estimate reference = EstimateOf(prepared, "wgtls");
  ASSERT_TRUE(reference.status.ok()) << reference.status.message();
  MonteCarloOptions options;
  options.runs = 5;
  const std::vector<std::string> names = {"ls", "tls", "wgtls"};
  std::vector<int> done;
  const Result<MonteCarlo> one = RunMonteCarlo(prepared, reference, names, options, [&](int k) { done.push_back(k); });
  ASSERT_TRUE(one.ok()) << one.status().message();
  EXPECT_THAT(done, ::testing::ElementsAre(1, 2, 3, 4, 5));
  for (const int threads : {2, 3, 50}) {
    options.threads = threads;
    done.clear();
    const Result<MonteCarlo> more =
        RunMonteCarlo(prepared, reference, names, options, [&](int k) { done.push_back(k); });
    ASSERT_TRUE(more.ok());
    EXPECT_EQ(Dump(*more), Dump(*one)) << threads;
    EXPECT_THAT(done, ::testing::ElementsAre(1, 2, 3, 4, 5)) << "one call at a time, in order";
    for (size_t k = 0; k < one->estimators[0].parameters.size(); ++k) {
      EXPECT_EQ(more->estimators[0].parameters[k].values, one->estimators[0].parameters[k].values);
    }
  }
  // Runs differ from each other, and another seed from this one, in its upper bits too.
  const Eigen::VectorXd values = one->estimators[0].parameters[0].values;
  EXPECT_EQ(std::set<double>(values.begin(), values.end()).size(), 5u);
  for (const std::uint64_t seed : {std::uint64_t{2}, std::uint64_t{1} | std::uint64_t{1} << 40}) {
    options.seed = seed;
    const Result<MonteCarlo> other = RunMonteCarlo(prepared, reference, names, options, nullptr);
    ASSERT_TRUE(other.ok());
    for (int k = 0; k < 5; ++k) EXPECT_NE(other->estimators[0].parameters[0].values[k], values[k]);
  }
  // Gains first, then base parameters, then the payload's, as in the estimates.
  ASSERT_EQ(one->estimators[0].parameters.size(), reference.parameters.size());
  for (size_t k = 0; k < reference.parameters.size(); ++k) {
    EXPECT_EQ(one->estimators[0].parameters[k].parameter.name, reference.parameters[k].parameter.name);
    EXPECT_EQ(one->estimators[0].parameters[k].truth, reference.parameters[k].value);
  }
}

// Signals on the side of the motors: the torque must go back through the transmission. With little noise every estimate
// is the truth, a wrong map would be off by far more.
TEST_F(MonteCarloRun, MotorSideSignals) {
  study_.robot += "transmission: [[50, 0, 0], [0, 40, 0], [0, 10, 30]]\n";
  testing::ReplaceOnce("rate: 200\n", "rate: 200\nsignal_side: motor\n", &study_.scenario_text);
  testing::ReplaceOnce("signal: [0.02, 0.05, 0.1]", "signal: [2.0e-4, 2.0e-4, 2.0e-4]", &study_.scenario_text);
  const PreparedStudy prepared = Prepare(true);
  const Estimate reference = EstimateOf(prepared, "wgtls");
  ASSERT_FALSE(reference.parameters.empty()) << reference.status.message();
  MonteCarloOptions options;
  options.runs = 3;
  const Result<MonteCarlo> result = RunMonteCarlo(prepared, reference, {"wgtls"}, options, nullptr);
  ASSERT_TRUE(result.ok()) << result.status().message();
  for (int j = 0; j < 3; ++j) {
    const ParameterStatistics& p = result->estimators[0].parameters[j];
    EXPECT_LT(p.rmse, 0.02 * std::abs(p.truth)) << p.parameter.name;
  }
}

// A run that the chain refuses counts as a failure with its reason, and the others go on.
TEST_F(MonteCarloRun, RefusedRunsAreFailures) {
  PreparedStudy prepared = Prepare(false);
  const Estimate reference = EstimateOf(prepared, "wls");
  // So noisy that the joints seem to stand still.
  testing::EditData(&prepared, [](Data* data) { data->position_noise.setConstant(10.0); });
  MonteCarloOptions options;
  options.runs = 2;
  const Result<MonteCarlo> result = RunMonteCarlo(prepared, reference, {"ls", "wls"}, options, nullptr);
  ASSERT_TRUE(result.ok()) << result.status().message();
  for (const EstimatorStatistics& e : result->estimators) {
    EXPECT_EQ(e.failures, 2);
    EXPECT_EQ(e.without_numbers, 2);
    EXPECT_THAT(e.first_failure, HasSubstr("never moves"));
  }
}

TEST_F(MonteCarloRun, OptionsAreChecked) {
  const PreparedStudy prepared = Prepare(false);
  const Estimate reference = EstimateOf(prepared, "wls");
  MonteCarloOptions options;
  std::string error;
  EXPECT_TRUE(options.IsValid(&error));
  options.runs = 1;
  const Result<MonteCarlo> result = RunMonteCarlo(prepared, reference, {"wls"}, options, nullptr);
  EXPECT_EQ(result.status().code(), StatusCode::kBadInput);
  EXPECT_EQ(result.status().message(), "runs = 1, must be at least 2");
  options.runs = 2;
  options.threads = 0;
  EXPECT_FALSE(options.IsValid(&error));
  EXPECT_THAT(error, HasSubstr("threads = 0"));
  options.threads = 1;
  options.essential_ratio = 0.5;
  EXPECT_FALSE(options.IsValid(&error));
  EXPECT_THAT(error, HasSubstr("essential_ratio"));
}

}  // namespace
}  // namespace idim::monte_carlo_run_test
