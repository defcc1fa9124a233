#include "solvers/declared_effects.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>

#include "solvers/active_effects.h"
#include "solvers/estimators.h"
#include "tests/solvers/simulated_study.h"

namespace idim::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

// A Stribeck effect on joint 2, a large load friction on joint 1.
constexpr char kTrueEffects[] =
    "effects:\n"
    "  - {id: stribeck, joints: [2], Fst: 1.5, vs: 0.3}\n"
    "  - {id: load_friction, joints: [1], mu: 0.06}\n";
const std::map<std::string, double> kTruth = {{"Fst2", 1.5}, {"stribeck_vs_2", 0.3}, {"Fl1", 0.06}};
constexpr char kBoth[] = "effects: [{id: stribeck, joints: [2]}, {id: load_friction, joints: [1]}]\n";

const SimulatedStudy& Arm() {
  static const SimulatedStudy* const arm = [] {
    auto* study = new SimulatedStudy;
    ReplaceOnce("recordings:\n", std::string(kTrueEffects) + "recordings:\n", &study->scenario_text);
    study->Simulate();
    return study;
  }();
  return *arm;
}

PreparedStudy PreparedWith(const std::string& keys) {
  const Result<Study> study = ReadStudy(Arm().folder.Write("with.yaml", Arm().study_text + keys));
  if (!study.ok()) throw std::runtime_error(study.status().message());
  Result<PreparedStudy> prepared = PrepareStudy(*study);
  if (!prepared.ok()) throw std::runtime_error(prepared.status().message());
  return std::move(prepared).value();
}

Estimate EstimateOf(const PreparedStudy& plain, const std::string& estimator, double r_sigma = 0.0) {
  const Result<PreparedStudy> prepared = DeclareEffects(plain);
  if (!prepared.ok()) throw std::runtime_error(prepared.status().message());
  const Result<EstimatorRunner> runner = EstimatorRunner::Create(&*prepared);
  if (!runner.ok()) throw std::runtime_error(runner.status().message());
  Result<Identification> result = runner->Run(estimator, r_sigma);
  if (!result.ok()) throw std::runtime_error(result.status().message());
  return result->estimate;
}

// Tolerance of 4.5 standard deviations (false alarm 1e-5 a value); Fst2 without its load on the right joint, or a shape
// of which the step is stated, is off by more than 20.
void ExpectTruth(const Estimate& with) {
  ASSERT_TRUE(with.status.ok()) << with.status.message();
  for (const auto& [name, truth] : kTruth) {
    const ParameterEstimate* p = with.Find(name);
    ASSERT_NE(p, nullptr) << with.estimator << " " << name;
    EXPECT_STREQ(ParameterKindName(p->parameter.kind), "effect") << name;
    EXPECT_NEAR(p->value, truth, 4.5 * p->standard_deviation) << with.estimator << " " << name;
    EXPECT_LT(p->standard_deviation, 0.1 * std::abs(truth)) << with.estimator << " " << name;
    EXPECT_NEAR(0.5 * (p->interval95[0] + p->interval95[1]), p->value, 1e-9) << with.estimator << " " << name;
  }
}

TEST(DeclaredEffects, EveryEstimatorFindsTheTruthAndALowerError) {
  for (const std::string estimator : {"ls", "wls", "eiv"}) {
    const Estimate with = EstimateOf(PreparedWith(kBoth), estimator);
    const Estimate without = EstimateOf(PreparedWith(""), estimator);
    ExpectTruth(with);
    ASSERT_EQ(with.recordings.size(), without.recordings.size());
    for (size_t r = 0; r < with.recordings.size(); ++r) {
      for (const int j : {0, 1}) {
        EXPECT_LT(with.recordings[r].relative_error_percent[j], 0.8 * without.recordings[r].relative_error_percent[j])
            << estimator << " " << with.recordings[r].name << " joint " << j + 1;
      }
    }
  }
}

}  // namespace
}  // namespace idim::testing
