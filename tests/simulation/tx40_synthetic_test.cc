// The committed synthetic TX-40 is what its scenario makes, byte for byte.

#include <gtest/gtest.h>

#include <filesystem>
#include <set>
#include <string>

#include "core/base/file.h"
#include "core/effects/simulated_effects.h"
#include "core/recording/study.h"
#include "core/simulation/scenario.h"
#include "core/simulation/simulate_scenario.h"

namespace idim::tx40_synthetic_test {
namespace {

const std::string kFolder = std::string(IDIM_SOURCE_DIR) + "/datasets/tx40_synthetic/";

TEST(Tx40Synthetic, IsAByteExactProductOfItsScenario) {
  const Result<Scenario> scenario = ReadScenario(kFolder + "scenario.yaml", EffectEquations());
  ASSERT_TRUE(scenario.ok()) << scenario.status().message();
  const Result<std::vector<OutputFile>> files = RenderScenario(*scenario);
  ASSERT_TRUE(files.ok()) << files.status().message();
  std::set<std::string> made = {"scenario.yaml", "parameters.yaml", "base_parameters.yaml", "README.md"};
  for (const OutputFile& file : *files) {
    const Result<std::string> committed = ReadFile(kFolder + file.name);
    ASSERT_TRUE(committed.ok()) << committed.status().message();
    EXPECT_TRUE(*committed == file.content)
        << file.name << " differs: idim_simulate datasets/tx40_synthetic/scenario.yaml "
        << "--output=datasets/tx40_synthetic makes it again";
    made.insert(file.name);
  }
  std::uintmax_t bytes = 0;
  for (const auto& entry : std::filesystem::directory_iterator(kFolder)) {
    EXPECT_EQ(made.count(entry.path().filename().string()), 1u) << entry.path();
    bytes += entry.file_size();
  }
  EXPECT_LT(bytes, 3000000u);
}

TEST(Tx40Synthetic, ReadsAsAStudyAndMovesLikeTheScenarioSays) {
  const Result<Study> study = ReadStudy(kFolder + "study.yaml");
  ASSERT_TRUE(study.ok()) << study.status().message();
  const Result<Scenario> scenario = ReadScenario(kFolder + "scenario.yaml", EffectEquations());
  ASSERT_TRUE(scenario.ok());
  ASSERT_EQ(study->recordings.size(), 5u);
  EXPECT_EQ(study->gains, scenario->gains);
  int validation = 0;
  for (size_t r = 0; r < 5; ++r) {
    const Result<Recording> recording = ReadRecording(*study, study->recordings[r]);
    ASSERT_TRUE(recording.ok()) << recording.status().message();
    validation += study->recordings[r].use == Use::kValidation;
    EXPECT_EQ(study->recordings[r].payload, r == 0 ? -1 : 0);
    const Truth truth = SimulateTruth(*scenario, scenario->recordings[r]);
    // Noise of 1e-5 rad and two encoders in joint 6: 6 standard deviations and the steps.
    EXPECT_LT((recording->q - truth.q).cwiseAbs().maxCoeff(), 1e-4);
    EXPECT_LT(truth.dq.cwiseAbs().maxCoeff(), 11.4 + 1e-9);
    // No rest at the end: the motion outlasts the log.
    EXPECT_GT(scenario->recordings[r].trajectory->duration(), truth.t[truth.t.size() - 1]);
    if (study->recordings[r].use == Use::kValidation) continue;
    // The whole workspace: every joint sees more than two thirds of its range.
    const Eigen::VectorXd range = (Eigen::VectorXd(6) << 6.28, 4.36, 4.8, 9.42, 4.42, 9.42).finished();
    const Eigen::VectorXd span = (truth.q.colwise().maxCoeff() - truth.q.colwise().minCoeff()).transpose();
    EXPECT_GT(span.cwiseQuotient(range).minCoeff(), 0.66) << study->recordings[r].name;
  }
  EXPECT_EQ(validation, 3);
}

}  // namespace
}  // namespace idim::tx40_synthetic_test
