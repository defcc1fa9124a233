// idim_validate as its user runs it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "tests/apps/comparison_study.h"
#include "tests/apps/small_study.h"
#include "tests/support/browser.h"

namespace idim::idim_validate_test {
namespace {

using ::testing::AllOf;
using testing::Dataset;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using Json = nlohmann::json;

class IdimValidate : public ::testing::Test {
 protected:
  void SetUp() override {
    study_ = testing::SyntheticStudy("gains: {mode: known, values: [33.9, 32.4, 24.2, -9.21, 16.3, 6.79]}");
    truth_ = testing::ReadJson(Dataset("tx40_synthetic/truth.json"));
  }
  testing::ProgramRun Run(const std::string& estimates) {
    return testing::RunProgram("idim_validate", folder_.Write("study.yaml", study_) + " --estimate=" + estimates +
                                                    " --output=" + folder_ / "out");
  }
  std::string Write(const std::string& name, const Json& estimate) { return folder_.Write(name, estimate.dump()); }
  Json Result() const { return testing::ReadJson(folder_ / "out/validation.json"); }

  TempFolder folder_;
  std::string study_;
  Json truth_;
};

TEST_F(IdimValidate, JudgesSeveralEstimatesOnTheSameRecordings) {
  Json wrong = truth_;
  wrong["name"] = "gains 10 % too large";
  for (Json& p : wrong["parameters"]) {
    if (p["name"].get<std::string>()[0] == 'g') p["value"] = 1.1 * p["value"].get<double>();
  }
  const testing::ProgramRun run = Run(Dataset("tx40_synthetic/truth.json") + "," + Write("wrong.json", wrong));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.err, "");
  EXPECT_THAT(testing::FilesIn(folder_ / "out"), ElementsAre("report.html", "validation.json"));
  const Json json = Result();
  EXPECT_EQ(json.at("schema"), "idim.validation.1");
  EXPECT_EQ(json.at("robot"), "staubli_tx40");
  ASSERT_EQ(json.at("estimates").size(), 2u);
  EXPECT_EQ(json.at("estimates").at(1).at("name"), "gains 10 % too large");
  for (size_t r = 0; r < 3; ++r) {
    const Json& good = json.at("estimates").at(0).at("recordings").at(r);
    const Json& bad = json.at("estimates").at(1).at("recordings").at(r);
    EXPECT_EQ(good.at("name"), "validation_" + std::to_string(r + 1));
    EXPECT_EQ(good.at("payload"), "calibrated");
    EXPECT_GT(good.at("condition_number").get<double>(), 1.0);
    EXPECT_EQ(good.at("condition_number"), bad.at("condition_number")) << "of the recording, not of the estimate";
    // README of the data set: the truth leaves 11.6 to 13.1 %.
    EXPECT_NEAR(good.at("relative_error_percent_all").get<double>(), 12.35, 0.85);
    EXPECT_EQ(good.at("relative_error_percent").size(), 6u);
    EXPECT_EQ(good.at("rms_torque").size(), 6u);
    EXPECT_EQ(good.at("rms_torque_unfiltered").size(), 6u);
    EXPECT_GT(bad.at("relative_error_percent_all").get<double>(),
              good.at("relative_error_percent_all").get<double>() + 0.2);
    EXPECT_EQ(good.at("mass_weighed"), 4.59);
    const double mass = good.at("mass"), sigma = good.at("mass_standard_deviation");
    // Four standard deviations, false alarm 6e-5 each; LS takes W for exact, which is nearly so here.
    EXPECT_NEAR(mass, 4.59, 4.0 * sigma);
    EXPECT_LT(sigma, 0.25);
    EXPECT_NEAR(good.at("mass_error_percent").get<double>(), 100.0 * std::abs(mass - 4.59) / 4.59, 1e-9);
    EXPECT_NEAR(bad.at("mass").get<double>(), 1.1 * mass, 1e-8);
  }
  for (const char* text :
       {"Table V)", "Table VI)", "Tables VII, VIII)", "validation_3, joint 6", "4.59", "written to"}) {
    EXPECT_THAT(run.out, HasSubstr(text));
  }
}

TEST_F(IdimValidate, SameInputSameBytes) {
  std::string first[2];
  for (int k = 0; k < 2; ++k) {
    ASSERT_EQ(Run(Dataset("tx40_synthetic/truth.json")).exit_code, 0);
    const std::string files[2] = {testing::ReadText(folder_ / "out/validation.json"),
                                  testing::ReadText(folder_ / "out/report.html")};
    for (int f = 0; f < 2; ++f) {
      if (k == 1) {
        EXPECT_TRUE(files[f] == first[f]) << f;
      }
      first[f] = files[f];
    }
  }
}

// Of estimates with the same name the file tells which.
TEST_F(IdimValidate, TheOutputOfIdimIdentifyIsJudged) {
  for (const std::string estimator : {"one", "two"}) {
    ASSERT_EQ(testing::RunProgram("idim_identify", folder_.Write("study.yaml", study_) +
                                                       " --estimator=wls --r_sigma=15 --output=" + folder_ / estimator)
                  .exit_code,
              0);
  }
  const std::string one = folder_ / "one/estimate.json", two = folder_ / "two/estimate.json";
  const testing::ProgramRun run = Run(one + "," + two);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const Json json = Result();
  EXPECT_EQ(json.at("estimates").at(0).at("name"), "wls (" + one + ")");
  EXPECT_EQ(json.at("estimates").at(1).at("name"), "wls (" + two + ")");
  // The same numbers as idim_identify gave for the recordings that it did not fit.
  const Json estimate = testing::ReadJson(one);
  int compared = 0;
  for (const Json& fit : estimate.at("recordings")) {
    for (const Json& judged : json.at("estimates").at(0).at("recordings")) {
      if (fit.at("name") != judged.at("name")) continue;
      EXPECT_NEAR(fit.at("relative_error_percent_all").get<double>(),
                  judged.at("relative_error_percent_all").get<double>(), 1e-9);
      ++compared;
    }
  }
  EXPECT_EQ(compared, 3);
}

TEST_F(IdimValidate, ReportIsDrawnWholeInABrowser) {
  const auto chromium = testing::FindChromium();
  if (!chromium) GTEST_SKIP() << "skipped: no Chromium here";
  ASSERT_EQ(Run(Dataset("tx40_synthetic/truth.json")).exit_code, 0);
  const auto drawn = testing::OpenReport(*chromium, folder_ / "out/report.html");
  ASSERT_TRUE(drawn.ok()) << drawn.status().message();
  EXPECT_EQ(drawn->figures_expected, 3 + 18) << "errors a recording, torque of a joint in a recording";
  EXPECT_TRUE(drawn->AllDrawn()) << drawn->figures_drawn << " drawn, " << drawn->script_errors << " errors";
}

TEST_F(IdimValidate, BadInputIsOneMessageAndNoFile) {
  const std::string good = Dataset("tx40_synthetic/truth.json");
  const auto spoilt = [&](const std::function<void(Json*)>& spoil) {
    Json json = truth_;
    spoil(&json);
    static int count = 0;
    return Write("spoilt_" + std::to_string(++count) + ".json", json);
  };
  const auto without_gains = [](Json* j) {
    Json kept = Json::array();
    for (const Json& p : j->at("parameters")) {
      if (p.at("name").get<std::string>()[0] != 'g') kept.push_back(p);
    }
    (*j)["parameters"] = kept;
  };
  const struct {
    std::string estimates;
    std::vector<std::string> message;
    std::function<void(std::string*)> study;
  } table[] = {
      {"", {"--estimate"}, nullptr},
      {"nowhere.json", {"nowhere.json"}, nullptr},
      {good + ",nowhere.json", {"nowhere.json"}, nullptr},
      {folder_.Write("text.json", "parameters: 3"), {"text.json", "JSON"}, nullptr},
      {folder_.Write("cut.json", truth_.dump().substr(0, 500)), {"cut.json", "JSON"}, nullptr},
      {folder_.Write("list.json", "[1, 2]"), {"list.json", "JSON object"}, nullptr},
      {spoilt([](Json* j) { j->erase("parameters"); }), {"'parameters'"}, nullptr},
      {spoilt([](Json* j) { (*j)["name"] = 5; }), {"'name'", "text"}, nullptr},
      {spoilt([](Json* j) { (*j)["parameters"][3]["value"] = nullptr; }), {"parameters[3]", "'value'"}, nullptr},
      {spoilt([](Json* j) { (*j)["parameters"][3].erase("name"); }), {"parameters[3]", "'name'"}, nullptr},
      {spoilt([](Json* j) { (*j)["parameters"][3] = (*j)["parameters"][2]; }), {"parameters[3]", "twice"}, nullptr},
      {spoilt([](Json* j) { (*j)["robot"] = "ur10e"; }), {"'ur10e'", "'staubli_tx40'"}, nullptr},
      {spoilt([](Json* j) {
         j->erase("robot");
         (*j)["parameters"][20]["name"] = "Fv7";
       }),
       {"'Fv7'", "nearest"},
       nullptr},
      {spoilt([](Json* j) {
         *j = {{"schema", "idim.estimate.1"},
               {"status", "untrusted"},
               {"message", "not identifiable: Fv3"},
               {"estimator", "ls"},
               {"parameters", Json::array()}};
       }),
       {"untrusted", "not identifiable: Fv3"},
       nullptr},
      {good,
       {"validation"},
       [](std::string* s) {
         for (int k = 0; k < 3; ++k) testing::Replace("use: validation", "use: identification", s);
       }},
      {spoilt(without_gains),
       {"no drive gains", "gains.mode"},
       [](std::string* s) { testing::Replace("mode: known", "mode: identify", s); }},
  };
  const std::string study = study_;
  for (const auto& row : table) {
    study_ = study;
    if (row.study) row.study(&study_);
    const testing::ProgramRun run = Run(row.estimates);
    EXPECT_EQ(run.exit_code, 1) << row.estimates << run.err;
    for (const std::string& part : row.message) EXPECT_THAT(run.err, HasSubstr(part));
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
    EXPECT_EQ(run.out, "");
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out")) << row.estimates;
  }
}

// An estimate that says of itself that it is not to be trusted is judged, and the tables say so.
TEST_F(IdimValidate, AnUntrustedEstimateIsJudgedWithAWarning) {
  truth_["status"] = "untrusted";
  truth_["message"] = "g1 is weak";
  const testing::ProgramRun run = Run(Write("doubtful.json", truth_));
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("not to be trusted: g1 is weak"));
  EXPECT_EQ(Result().at("estimates").at(0).at("warning"), "g1 is weak");
  EXPECT_THAT(testing::ReadText(folder_ / "out/report.html"), HasSubstr("not to be trusted: g1 is weak"));
}

}  // namespace
}  // namespace idim::idim_validate_test
