// idim_close_loop as its user runs it, on a simulated arm of three joints with and without an undeclared effect.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/apps/comparison_study.h"
#include "tests/apps/small_study.h"
#include "tests/support/browser.h"
#include "tests/support/simulated_study.h"

namespace idim::idim_close_loop_test {
namespace {

using ::testing::ElementsAre;
using testing::FilesIn;
using ::testing::HasSubstr;
using Json = nlohmann::json;

class IdimCloseLoop : public ::testing::Test {
 protected:
  void Make(const std::string& effects) {
    simulated_.scenario_text += effects;
    simulated_.Simulate();
    simulated_.folder.Write("study.yaml", simulated_.study_text);
  }
  testing::ProgramRun Run(const std::string& flags = "") {
    return testing::RunProgram("idim_close_loop",
                               folder() / "study.yaml" + " --output=" + folder() / "out" + " " + flags);
  }
  TempFolder& folder() { return simulated_.folder; }
  Json Loop() { return testing::ReadJson(folder() / "out/loop.json"); }

  testing::SimulatedStudy simulated_;
};

constexpr char kPowerViscous[] = "effects:\n  - {id: power_viscous, joints: [2], coefficient: 4.0, exponent: 0.4}\n";

TEST_F(IdimCloseLoop, FindsTheEffectAndWritesTheContract) {
  Make(kPowerViscous);
  const testing::ProgramRun run = Run();
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.err, "") << "progress is for terminals";
  EXPECT_THAT(FilesIn(folder() / "out"), ElementsAre("estimate.json", "loop.json", "report.html", "residuals.csv"));
  const Json loop = Loop();
  EXPECT_EQ(loop.at("schema"), "idim.loop.1");
  EXPECT_EQ(loop.at("status"), "ok");
  for (const char* model : {"declared", "final"}) {
    EXPECT_GT(loop.at(model).at("identification_error_percent").get<double>(), 0.0);
    EXPECT_GT(loop.at(model).at("validation_error_percent").get<double>(), 0.0);
    EXPECT_EQ(loop.at(model).at("per_joint").at("identification").size(), 3u);
    EXPECT_EQ(loop.at(model).at("per_joint").at("validation").size(), 3u);
  }
  EXPECT_TRUE(loop.at("unexplained").is_array());
  EXPECT_EQ(loop.at("held_out_by_blocks"), false) << "there is a validation recording";
  ASSERT_EQ(loop.at("steps").size(), 1u) << loop.at("steps");
  const Json& step = loop.at("steps").at(0);
  EXPECT_EQ(step.at("effect"), "power_viscous");
  EXPECT_THAT(step.at("joints"), ElementsAre(2));
  EXPECT_LT(step.at("p_value").get<double>(), step.at("threshold").get<double>());
  EXPECT_LT(step.at("error_after").at("validation").get<double>(),
            step.at("error_before").at("validation").get<double>());
  // The truth, within five of its own standard deviations (of which the simulated noise leaves more than enough).
  ASSERT_EQ(step.at("parameters").size(), 2u);
  const double truth[] = {4.0, 0.4};
  for (int k = 0; k < 2; ++k) {
    const Json& p = step.at("parameters").at(k);
    EXPECT_NEAR(p.at("value").get<double>(), truth[k], 5.0 * p.at("standard_deviation").get<double>()) << p;
    EXPECT_LT(p.at("standard_deviation").get<double>(), 0.25 * truth[k]) << p;
  }
  // The final estimate is that of the whole model.
  const Json estimate = testing::ReadJson(folder() / "out/estimate.json");
  EXPECT_EQ(estimate.at("schema"), "idim.estimate.1");
  EXPECT_EQ(testing::FindParameter(estimate, "Fp2").at("value"), step.at("parameters").at(0).at("value"));
  EXPECT_EQ(testing::FindParameter(estimate, "Fp2").at("kind"), "effect");
  for (const char* part : {"power_viscous on joint 2", "Fp2 = ", "to confirm", "rivals", "written to"}) {
    EXPECT_THAT(run.out, HasSubstr(part));
  }
}

// idim_validate computes the effects anew from estimate.json; with a stop in the motion that it must see as the loop
// did, with velocity zero.
TEST_F(IdimCloseLoop, FinalErrorsAreThoseOfIdimValidate) {
  testing::ReplaceOnce("big, seed: 3,\n     trajectory: {type: fourier, frequency: 0.2, duration: 10}}",
                       "big, seed: 3,\n     trajectory: {type: point_to_point, random: 6, dwell: 0.6}}",
                       &simulated_.scenario_text);
  testing::ReplaceOnce("position: 1.0e-6", "position: 1.0e-5", &simulated_.scenario_text);
  Make(
      "effects:\n  - {id: power_viscous, joints: [2], coefficient: 4.0, exponent: 0.4}\n"
      "  - {id: load_friction, joints: [1], mu: 0.1}\n");
  ASSERT_EQ(Run().exit_code, 0);
  const Json loop = Loop(), final = loop.at("final");
  ASSERT_GE(loop.at("steps").size(), 2u) << loop.at("steps");
  const auto validated = [&](const std::string& estimate) {
    const testing::ProgramRun run = testing::RunProgram(
        "idim_validate", folder() / "study.yaml" + " --estimate=" + estimate + " --output=" + folder() / "validated");
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return testing::ReadJson(folder() / "validated/validation.json").at("estimates").at(0).at("recordings").at(0);
  };
  const Json judged = validated(folder() / "out/estimate.json");
  Json estimate = testing::ReadJson(folder() / "out/estimate.json");
  for (int j = 0; j < 3; ++j) {
    const double error = final.at("per_joint").at("validation").at(j).get<double>();
    EXPECT_NEAR(judged.at("relative_error_percent").at(j).get<double>(), error, 1e-6 * error) << "joint " << j + 1;
    EXPECT_NEAR(estimate.at("recordings").at(2).at("relative_error_percent").at(j).get<double>(), error, 1e-6 * error);
  }
  const double all = final.at("validation_error_percent").get<double>();
  EXPECT_NEAR(judged.at("relative_error_percent_all").get<double>(), all, 1e-6 * all);
  EXPECT_NEAR(judged.at("mass").get<double>(), 3.0, 0.1);
  // Without the statement it is another model: the motion does stop.
  ASSERT_EQ(estimate.at("velocity_zero_at_rest"), true);
  estimate.erase("velocity_zero_at_rest");
  const Json other = validated(folder().Write("other.json", estimate.dump()));
  EXPECT_GT(std::abs(other.at("relative_error_percent_all").get<double>() - all), 1e-4 * all);
}

// What the study declares is in the model that the loop begins from: it is neither found nor dropped.
TEST_F(IdimCloseLoop, BeginsFromDeclaredEffects) {
  Make(kPowerViscous);
  ASSERT_EQ(Run().exit_code, 0);
  const Json found = Loop();
  simulated_.folder.Write("study.yaml", simulated_.study_text + "effects: [{id: power_viscous, joints: [2]}]\n");
  const testing::ProgramRun run = Run();
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const Json declared = Loop();
  EXPECT_TRUE(declared.at("steps").empty()) << declared.at("steps");
  for (const char* model : {"declared", "final"}) {
    EXPECT_NEAR(declared.at(model).at("validation_error_percent").get<double>(),
                found.at("final").at("validation_error_percent").get<double>(), 1e-3)
        << model;
  }
  const Json estimate = testing::ReadJson(folder() / "out/estimate.json");
  EXPECT_NEAR(testing::FindParameter(estimate, "power_viscous_a_2").at("value").get<double>(),
              found.at("steps").at(0).at("parameters").at(1).at("value").get<double>(), 1e-3);
  ASSERT_EQ(estimate.at("effects").size(), 1u);
  EXPECT_EQ(estimate.at("effects").at(0).at("id"), "power_viscous");
  EXPECT_THAT(estimate.at("effects").at(0).at("joints"), ElementsAre(2));
  EXPECT_EQ(estimate.at("effects").at(0).at("shape").at("a"),
            testing::FindParameter(estimate, "power_viscous_a_2").at("value"));
}

// A declared effect that is not there is not the loop's to drop.
TEST_F(IdimCloseLoop, KeepsWhatIsDeclared) {
  Make(kPowerViscous);
  simulated_.folder.Write("study.yaml", simulated_.study_text + "effects: [{id: joint_spring, joints: [3]}]\n");
  const testing::ProgramRun run = Run();
  ASSERT_EQ(run.exit_code, 0) << run.err;
  ASSERT_EQ(Loop().at("steps").size(), 1u);
  EXPECT_EQ(Loop().at("steps").at(0).at("effect"), "power_viscous");
  const Json estimate = testing::ReadJson(folder() / "out/estimate.json");
  ASSERT_EQ(estimate.at("effects").size(), 2u);
  EXPECT_EQ(estimate.at("effects").at(0).at("id"), "joint_spring");
}

TEST_F(IdimCloseLoop, NothingUndeclaredNothingFound) {
  Make("");
  const testing::ProgramRun run = Run();
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const Json loop = Loop();
  EXPECT_TRUE(loop.at("steps").empty()) << loop.at("steps");
  EXPECT_EQ(loop.at("declared").at("validation_error_percent"), loop.at("final").at("validation_error_percent"));
  EXPECT_THAT(run.out, HasSubstr("No effect was found"));
}

// An effect that is found by default is not where one of the three options asks for more than it can show.
TEST_F(IdimCloseLoop, EveryOptionHasItsEffect) {
  Make(kPowerViscous);
  for (const char* flag : {"--max_effects=0", "--significance=1e-250", "--margin=0.95"}) {
    const testing::ProgramRun run = Run(flag);
    ASSERT_EQ(run.exit_code, 0) << run.err;
    EXPECT_TRUE(Loop().at("steps").empty()) << flag;
  }
}

TEST_F(IdimCloseLoop, SameBytesTwiceAndOnAnyNumberOfThreads) {
  Make(kPowerViscous);
  std::vector<std::string> first;
  for (const char* threads : {"1", "1", "2"}) {
    const testing::ProgramRun run = Run(std::string("--threads=") + threads);
    ASSERT_EQ(run.exit_code, 0) << run.err;
    Json loop = Loop(), estimate = testing::ReadJson(folder() / "out/estimate.json");
    for (Json* json : {&loop, &estimate}) {
      EXPECT_GT(json->at("seconds").get<double>(), 0.0);
      json->erase("seconds");  // the one thing that is measured anew
    }
    const std::vector<std::string> now = {loop.dump(), estimate.dump(), run.out,
                                          testing::ReadText(folder() / "out/report.html"),
                                          testing::ReadText(folder() / "out/residuals.csv")};
    if (first.empty()) first = now;
    for (size_t k = 0; k < now.size(); ++k) EXPECT_TRUE(now[k] == first[k]) << k << " with --threads=" << threads;
  }
}

TEST_F(IdimCloseLoop, ReportIsDrawnWholeInABrowser) {
  const auto chromium = testing::FindChromium();
  if (!chromium) GTEST_SKIP() << "skipped: no Chromium here";
  Make(kPowerViscous);
  ASSERT_EQ(Run().exit_code, 0);
  const auto drawn = testing::OpenReport(*chromium, folder() / "out/report.html");
  ASSERT_TRUE(drawn.ok()) << drawn.status().message();
  // Errors on two sets of data; ranking, friction curve, added parameters; velocity, position,
  // time in three recordings.
  EXPECT_GE(drawn->figures_expected, 2 + 3 + 5 * 3);
  EXPECT_TRUE(drawn->AllDrawn()) << drawn->figures_drawn << " of " << drawn->figures_expected << " drawn, "
                                 << drawn->script_errors << " errors";
}

TEST_F(IdimCloseLoop, BadInputIsOneMessageAndNoFile) {
  testing::SmallStudy study;
  const struct {
    std::string flags;
    std::vector<std::string> message;
  } table[] = {{"--threads=0", {"--threads=0", "at least 1"}},
               {"--significance=0", {"--significance=0", "between 0 and 1"}},
               {"--significance=nan", {"--significance=", "between 0 and 1"}},
               {"--margin=1", {"--margin=1", "between 0 and 1"}},
               {"--margin=-0.1", {"--margin=-0.1", "between 0 and 1"}},
               {"--max_effects=-1", {"--max_effects=-1", "at least 0"}}};
  for (const auto& row : table) {
    study.flags = row.flags;
    const testing::ProgramRun run = testing::RunProgram("idim_close_loop", study.Arguments());
    EXPECT_EQ(run.exit_code, 1) << run.err;
    for (const std::string& part : row.message) EXPECT_THAT(run.err, HasSubstr(part));
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
    EXPECT_EQ(run.out, "");
    EXPECT_FALSE(study.OutputExists());
  }
  testing::Replace("cutoff_hz", "cutof_hz", &study.study);
  study.flags = "";
  const testing::ProgramRun run = testing::RunProgram("idim_close_loop", study.Arguments());
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.err, HasSubstr("cutof_hz"));
  EXPECT_FALSE(study.OutputExists());
}

// A declared model that cannot be fitted: exit code 2, and the files say so.
TEST_F(IdimCloseLoop, NothingToTrust) {
  testing::SmallStudy study;
  testing::Replace("name: a,", "name: a, payload: p,", &study.study);
  study.study += "payloads: {p: {M: 1.0}}\n";
  const testing::ProgramRun run = testing::RunProgram("idim_close_loop", study.Arguments());
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("not identifiable"));
  for (const char* file : {"loop.json", "estimate.json"}) {
    const Json json = testing::ReadJson(study.folder / "out/" + file);
    EXPECT_EQ(json.at("status"), "untrusted") << file;
    EXPECT_THAT(json.at("message").get<std::string>(), HasSubstr("not identifiable")) << file;
  }
  EXPECT_NE(testing::ReadText(study.folder / "out/report.html").find("Not to be trusted"), std::string::npos);
}

}  // namespace
}  // namespace idim::idim_close_loop_test
