// IDIM-EIV from a study to an estimate, on a simulated arm whose truth is known.

#include "solvers/estimators/eiv_identification.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "solvers/estimators/estimators.h"
#include "tests/support/simulated_study.h"

namespace idim::eiv_identification_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::ReplaceOnce;
using testing::SimulatedStudy;

constexpr double kTruth[] = {20.0, -11.0, 5.0};

struct ArmWithUnknownGains : SimulatedStudy {
  ArmWithUnknownGains() {
    ReplaceOnce("mode: known", "mode: identify", &scenario_text);
    Simulate();
  }
};

Estimate Estimated(const SimulatedStudy& study, double r_sigma = 0.0, const std::string& estimator = "eiv") {
  const PreparedStudy prepared = study.Prepare();
  const Result<EstimatorRunner> runner = EstimatorRunner::Create(&prepared);
  if (!runner.ok()) throw std::runtime_error(runner.status().message());
  const Result<Identification> result = runner->Run(estimator, r_sigma);
  if (!result.ok()) throw std::runtime_error(result.status().message());
  return result->estimate;
}

const ParameterEstimate& Find(const Estimate& estimate, const std::string& name) {
  for (const ParameterEstimate& p : estimate.parameters) {
    if (p.parameter.name == name) return p;
  }
  throw std::runtime_error(name + " is not in the estimate: " + estimate.status.message());
}

TEST(EivIdentification, FindsGainsAndSaysWhereItStarted) {
  const Estimate e = Estimated(ArmWithUnknownGains());
  ASSERT_TRUE(e.status.ok()) << e.status.message();
  EXPECT_EQ(e.estimator, "eiv");
  EXPECT_THAT(e.start, HasSubstr("start: WGTLS"));
  EXPECT_THAT(e.uncertainty, HasSubstr("correlated over up to"));
  for (int j = 0; j < 3; ++j) {
    const ParameterEstimate& g = e.parameters[j];
    // Four and a half standard deviations: a false alarm in 5e-5 for the three.
    EXPECT_NEAR(g.value, kTruth[j], 4.5 * g.standard_deviation) << g.parameter.name;
    EXPECT_LT(g.standard_deviation, 0.05 * std::abs(kTruth[j]));
    EXPECT_GT(g.model_standard_deviation, 0.0);
    EXPECT_GT(g.interval95[1] - g.interval95[0], 3.9 * g.standard_deviation);
  }
  EXPECT_EQ(e.signal_noise_decimated.size(), 3);
  EXPECT_EQ(e.recordings.size(), 3u);
  EXPECT_EQ(e.gain_diagnoses.size(), 3u);
  EXPECT_GT(e.condition_number, 1.0);
  EXPECT_GT(e.condition_number_weighted, 1.0);
}

// A gain whose a priori sign is wrong makes WGTLS unsound, so that every start is tried. None ends at another minimum
// than the sound start did (that from three times and minus the truth, with parameters to match, finds no way back and
// says so), and the contradiction is said.
TEST(EivIdentification, NoStartEndsAtAnotherMinimum) {
  ArmWithUnknownGains study;
  const Estimate best = Estimated(study);
  ReplaceOnce("{mode: identify}", "{mode: identify, values: [60, 33, 15]}", &study.study_text);
  const Estimate e = Estimated(study);
  EXPECT_THAT(e.start, AllOf(HasSubstr("a priori gains"), HasSubstr("WGTLS, which is not sound"), HasSubstr("WLS"),
                             HasSubstr("at the same minimum"), Not(HasSubstr("another minimum"))));
  EXPECT_EQ(e.status.code(), StatusCode::kUntrusted);
  EXPECT_THAT(e.status.message(), HasSubstr("g2 = -11"));
  for (int j = 0; j < 3; ++j) {
    EXPECT_NEAR(e.parameters[j].value, best.parameters[j].value, 1e-4 * best.parameters[j].standard_deviation);
  }
}

// All gains and inertias hang on the weighed mass: known to 1 %, its share of every relative variance is 1e-4, and the
// mass comes back as it was weighed.
TEST(EivIdentification, AWeighedMassWithAStandardDeviationWidensAllGains) {
  ArmWithUnknownGains study;
  const Estimate exact = Estimated(study);
  ReplaceOnce("M: 3", "M: 3, standard_deviation: {M: 0.03}", &study.study_text);
  const Estimate e = Estimated(study);
  ASSERT_TRUE(e.status.ok()) << e.status.message();
  for (int j = 0; j < 3; ++j) {
    const auto relative = [&](const Estimate& of) {
      return std::pow(of.parameters[j].model_standard_deviation / of.parameters[j].value, 2);
    };
    EXPECT_NEAR(relative(e) - relative(exact), 1e-4, 2e-6) << j;
    EXPECT_NEAR(e.parameters[j].value, exact.parameters[j].value, 1e-3 * e.parameters[j].standard_deviation);
  }
  EXPECT_NEAR(Find(e, "M4").value, 3.0, 1e-6);
  EXPECT_NEAR(Find(e, "M4").standard_deviation, 0.03, 1e-5);
  EXPECT_EQ(e.parameters.size(), exact.parameters.size() + 1);
}

TEST(EivIdentification, PriorsPullTheParametersThatTheyName) {
  ArmWithUnknownGains study;
  const Estimate without = Estimated(study);
  const ParameterEstimate& g3 = Find(without, "g3");
  // As sure as the data and three standard deviations off: it ends half-way.
  const double value = g3.value + 3.0 * g3.model_standard_deviation;
  const std::string text = study.study_text;
  study.study_text += "priors:\n  - {parameter: g3, value: " + std::to_string(value) +
                      ", standard_deviation: " + std::to_string(g3.model_standard_deviation) + "}\n";
  const Estimate with = Estimated(study);
  EXPECT_NEAR(Find(with, "g3").value, g3.value + 1.5 * g3.model_standard_deviation, 0.1 * g3.model_standard_deviation);
  EXPECT_NEAR(Find(with, "g3").model_standard_deviation, std::sqrt(0.5) * g3.model_standard_deviation,
              0.05 * g3.model_standard_deviation);

  study.study_text = text + "priors:\n  - {parameter: ZZ9, value: 1, standard_deviation: 1}\n";
  try {
    Estimated(study);
    FAIL() << "a prior on what is not identified must be refused";
  } catch (const std::runtime_error& refused) {
    EXPECT_THAT(refused.what(),
                AllOf(HasSubstr("study.yaml:"), HasSubstr("priors[1]"), HasSubstr("ZZ9"), HasSubstr("g1 g2 g3 ")));
  }
}

// With gains known and exact encoders nothing but the weights differs from WLS.
TEST(EivIdentification, KnownGainsGiveWhatWlsGives) {
  SimulatedStudy study;
  study.Simulate();
  const Estimate wls = Estimated(study, 0.0, "wls"), eiv = Estimated(study);
  ASSERT_TRUE(eiv.status.ok()) << eiv.status.message();
  ASSERT_EQ(eiv.parameters.size(), wls.parameters.size());
  EXPECT_THAT(eiv.start, HasSubstr("start: WLS"));
  for (size_t k = 0; k < wls.parameters.size(); ++k) {
    EXPECT_EQ(eiv.parameters[k].parameter.name, wls.parameters[k].parameter.name);
    EXPECT_NEAR(eiv.parameters[k].value, wls.parameters[k].value, 0.1 * wls.parameters[k].standard_deviation);
    EXPECT_NEAR(eiv.parameters[k].model_standard_deviation / wls.parameters[k].standard_deviation, 1.0, 0.05);
  }
}

TEST(EivIdentification, EssentialParametersAreKeptTheOthersAreZero) {
  const ArmWithUnknownGains study;
  const Estimate all = Estimated(study), essential = Estimated(study, 40.0);
  ASSERT_TRUE(essential.status.ok()) << essential.status.message();
  ASSERT_FALSE(essential.eliminated.empty());
  EXPECT_EQ(essential.parameters.size() + essential.eliminated.size(), all.parameters.size());
  double smallest = 1e300, largest = 0.0;
  for (const ParameterEstimate& p : essential.parameters) {
    const double relative = p.model_standard_deviation / std::abs(p.value);
    smallest = std::min(smallest, relative);
    largest = std::max(largest, relative);
  }
  EXPECT_LT(largest, 42.0 * smallest);  // r_sigma is judged before the last solve
  EXPECT_LT(Find(essential, "g1").standard_deviation, 1.05 * Find(all, "g1").standard_deviation);
}

TEST(EivIdentification, TooLittleToTellAGainIsSaid) {
  SimulatedStudy study;
  ReplaceOnce("mode: known", "mode: identify", &study.scenario_text);
  ReplaceOnce("signal: [0.02, 0.05, 0.1]", "signal: [8, 12, 30]", &study.scenario_text);
  study.Simulate();
  const Estimate e = Estimated(study);
  EXPECT_EQ(e.status.code(), StatusCode::kUntrusted);
  EXPECT_FALSE(e.status.message().empty());
}

TEST(EivIdentification, ALossIsRefusedWhereThereIsNone) {
  const ArmWithUnknownGains study;
  const PreparedStudy prepared = study.Prepare();
  const Result<EstimatorRunner> runner = EstimatorRunner::Create(&prepared);
  ASSERT_TRUE(runner.ok());
  EXPECT_THAT(runner->Run("wls", 0.0, 2.0).status().message(), HasSubstr("--huber"));
  EXPECT_THAT(runner->Run("eiv", 0.0, -2.0).status().message(), HasSubstr("--huber"));
  const Result<Identification> plain = runner->Run("eiv", 0.0), huber = runner->Run("eiv", 0.0, 1.5);
  ASSERT_TRUE(plain.ok() && huber.ok());
  EXPECT_NE(plain->estimate.parameters[0].value, huber->estimate.parameters[0].value);
}

}  // namespace
}  // namespace idim::eiv_identification_test
