// idim_compare as its user runs it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <map>
#include <sstream>

#include "tests/apps/comparison_study.h"
#include "tests/apps/small_study.h"
#include "tests/support/browser.h"
#include "tests/support/shared_recordings.h"

namespace idim::idim_compare_test {
namespace {

using testing::Dataset;
using ::testing::ElementsAre;
using testing::FilesIn;
using testing::FindParameter;
using ::testing::HasSubstr;
using ::testing::Not;
using Json = nlohmann::json;

std::vector<std::string> Names(const Json& comparison) {
  std::vector<std::string> names;
  for (const Json& e : comparison.at("estimates")) names.push_back(e.at("estimator"));
  return names;
}

class IdimCompare : public ::testing::Test {
 protected:
  testing::ProgramRun Run(const std::string& study, const std::string& flags = "") {
    return testing::RunProgram("idim_compare",
                               folder_.Write("study.yaml", study) + " --output=" + folder_ / "out" + " " + flags);
  }
  Json Comparison() const { return testing::ReadJson(folder_ / "out/comparison.json"); }

  TempFolder folder_;
};

TEST_F(IdimCompare, WritesTheContract) {
  const testing::ProgramRun run = Run(testing::SyntheticStudy(testing::kIdentifyGains));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.err, "");
  EXPECT_THAT(FilesIn(folder_ / "out"), ElementsAre("comparison.json", "report.html"));
  const Json comparison = Comparison();
  EXPECT_EQ(comparison.at("schema"), "idim.comparison.1");
  EXPECT_THAT(Names(comparison), ElementsAre("ls", "wls", "tls", "wtls", "gtls", "wgtls", "eiv"));
  for (const Json& e : comparison.at("estimates")) {
    EXPECT_EQ(e.at("schema"), "idim.estimate.1");
    EXPECT_EQ(e.at("robot"), "staubli_tx40");
    for (const char* key : {"status", "message", "parameters", "covariance", "noise", "recordings", "condition_number",
                            "seconds", "gain_diagnoses"}) {
      EXPECT_TRUE(e.contains(key)) << key;
    }
    EXPECT_EQ(e.at("status") == "ok", e.at("message") == "") << e.at("message");
    EXPECT_EQ(e.at("recordings").size(), 5u);
    EXPECT_EQ(e.at("gain_diagnoses").size(), 6u);
    const size_t c = e.at("parameters").size();
    EXPECT_EQ(c, 6u + 61u + 9u);
    ASSERT_EQ(e.at("covariance").size(), c);
    for (size_t k = 0; k < c; ++k) {
      const Json& p = e.at("parameters").at(k);
      for (const char* key : {"name", "kind", "joint", "value", "standard_deviation", "interval95", "unit"}) {
        EXPECT_TRUE(p.contains(key)) << key;
      }
      EXPECT_EQ(p.at("kind") == "drive_gain", k < 6) << p;
      EXPECT_NEAR(std::sqrt(e.at("covariance").at(k).at(k).get<double>()), p.at("standard_deviation").get<double>(),
                  1e-12 + 1e-9 * p.at("standard_deviation").get<double>());
    }
    EXPECT_EQ(e.contains("singular_values"), e.at("estimator").get<std::string>().find("tls") != std::string::npos);
  }
  // The baseline has gains alone; the bias of LS is tested in each joint's equations and in all of them.
  EXPECT_EQ(comparison.at("sequential").at("estimator"), "sequential");
  for (const Json& p : comparison.at("sequential").at("parameters")) EXPECT_EQ(p.at("kind"), "drive_gain");
  EXPECT_EQ(comparison.at("bias_tests").size(), 7u);
  EXPECT_EQ(comparison.at("bias_tests").back().at("equations"), "all joints");
  for (const char* name : {"IDIM-LS", "IDIM-WGTLS", "g6", "ZZ1R", "written to"}) EXPECT_THAT(run.out, HasSubstr(name));

  // One column of the table starts where the one above it does.
  std::istringstream lines(run.out.substr(run.out.find("parameter ")));
  std::string header, line;
  std::getline(lines, header);
  for (std::getline(lines, line); line.rfind("g", 0) == 0; std::getline(lines, line)) {
    EXPECT_EQ(line.size(), header.size()) << line << "\n" << header;
  }
}

// The truth is known here. LS and WLS take the noise of the signals for motion and come out too small (paper Table II,
// design 3); scaled weighted TLS is at the truth within a few per cent.
TEST_F(IdimCompare, LsShrinksGainsAndScaledTlsDoesNot) {
  ASSERT_NE(Run(testing::SyntheticStudy(testing::kIdentifyGains)).exit_code, 1);
  std::map<std::string, double> mean;
  const double truth[] = {33.9, 32.4, 24.2, -9.21, 16.3, 6.79};
  const Json comparison = Comparison();
  for (const Json& e : comparison.at("estimates")) {
    double sum = 0.0, worst = 0.0;
    for (int j = 0; j < 6; ++j) {
      const double error = FindParameter(e, "g" + std::to_string(j + 1)).at("value").get<double>() / truth[j] - 1.0;
      sum += error / 6.0;
      worst = std::max(worst, std::abs(error));
    }
    mean[e.at("estimator")] = sum;
    if (e.at("estimator") == "wgtls") {
      EXPECT_LT(worst, 0.1);
    }
    if (e.at("estimator") == "eiv") {
      EXPECT_LT(worst, 0.05);
    }
  }
  EXPECT_LT(mean["ls"], -0.1);
  EXPECT_LT(mean["wls"], -0.1);
  EXPECT_LT(std::abs(mean["wgtls"]), 0.05);
  EXPECT_LT(std::abs(mean["eiv"]), 0.02);
}

TEST_F(IdimCompare, SameInputSameBytes) {
  std::string first[3];
  for (int k = 0; k < 2; ++k) {
    const testing::ProgramRun run = Run(testing::SyntheticStudy(testing::kIdentifyGains));
    Json json = Comparison();
    for (Json& e : json.at("estimates")) {
      EXPECT_GT(e.at("seconds").get<double>(), 0.0);
      e.erase("seconds");  // the one thing that is measured anew
    }
    const std::string files[3] = {json.dump(), testing::ReadText(folder_ / "out/report.html"), run.out};
    for (int f = 0; f < 3; ++f) {
      if (k == 1) {
        EXPECT_TRUE(files[f] == first[f]) << f;
      }
      first[f] = files[f];
    }
  }
}

// Without "seconds", the one thing that is measured anew.
Json WithoutSeconds(Json comparison) {
  for (Json& e : comparison.at("estimates")) e.erase("seconds");
  return comparison;
}

TEST_F(IdimCompare, MonteCarloSameSeedSameBytesOnAnyNumberOfThreads) {
  const std::string study = testing::SyntheticStudy(testing::kIdentifyGains);
  std::string json, report, out;
  for (const char* threads : {"1", "2"}) {
    const testing::ProgramRun run = Run(study, std::string("--monte_carlo=4 --seed=3 --threads=") + threads);
    ASSERT_EQ(run.exit_code, 0) << run.err;
    EXPECT_EQ(run.err, "") << "progress is for terminals";
    const std::string again[3] = {WithoutSeconds(Comparison()).dump(), testing::ReadText(folder_ / "out/report.html"),
                                  run.out};
    if (*threads == '1') {
      json = again[0], report = again[1], out = again[2];
      continue;
    }
    EXPECT_TRUE(json == again[0]);
    EXPECT_TRUE(report == again[1]);
    EXPECT_TRUE(out == again[2]);
  }
  const Json comparison = Comparison();
  const Json& monte_carlo = comparison.at("monte_carlo");
  EXPECT_EQ(monte_carlo.at("runs"), 4);
  EXPECT_EQ(monte_carlo.at("seed"), 3);
  // The truth is the last estimate that can be trusted.
  const std::string reference = monte_carlo.at("reference");
  std::string last;
  for (const Json& e : comparison.at("estimates")) {
    if (e.at("status") == "ok") last = e.at("estimator");
  }
  EXPECT_EQ(reference, last);
  const std::vector<std::string> names = Names(comparison);
  ASSERT_EQ(monte_carlo.at("estimators").size(), names.size());
  for (size_t k = 0; k < names.size(); ++k) {
    const Json& e = monte_carlo.at("estimators").at(k);
    EXPECT_EQ(e.at("estimator"), names[k]);
    EXPECT_TRUE(e.at("failures").is_number_integer());
    ASSERT_EQ(e.at("parameters").size(), 76u);
    for (const Json& p : e.at("parameters")) {
      for (const char* key : {"name", "truth", "bias", "standard_deviation", "rmse", "coverage95"}) {
        EXPECT_TRUE(p.contains(key)) << key;
      }
    }
    for (const Json& estimate : comparison.at("estimates")) {
      if (estimate.at("estimator") != reference) continue;
      EXPECT_EQ(e.at("parameters").at(0).at("truth"), estimate.at("parameters").at(0).at("value"));
    }
  }
  // LS shrinks every gain on such data, whatever the seed.
  const Json& g1 = monte_carlo.at("estimators").at(0).at("parameters").at(0);
  EXPECT_LT(g1.at("bias").get<double>(), -0.1 * g1.at("truth").get<double>());
  EXPECT_THAT(out, HasSubstr("Monte Carlo: 4 runs, seed 3"));

  ASSERT_EQ(Run(study, "--monte_carlo=4 --seed=4").exit_code, 0);
  EXPECT_NE(Comparison().at("monte_carlo").at("estimators").at(0).at("parameters").at(0).at("bias"), g1.at("bias"));
}

TEST_F(IdimCompare, MonteCarloWithKnownGains) {
  testing::SmallStudy study;
  study.flags = "--monte_carlo=3";
  const testing::ProgramRun run = testing::RunProgram("idim_compare", study.Arguments());
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const Json comparison = testing::ReadJson(study.folder / "out/comparison.json");
  EXPECT_EQ(comparison.at("monte_carlo").at("estimators").size(), 3u);
  EXPECT_EQ(comparison.at("monte_carlo").at("reference"), "eiv");
  EXPECT_TRUE(comparison.at("monte_carlo").at("estimators").at(0).at("nees_gains").is_null());
  EXPECT_THAT(run.out, HasSubstr("Monte Carlo: 3 runs, seed 1"));
}

// Nothing to simulate from: the comparison is written, without it, and the exit code says why.
TEST_F(IdimCompare, MonteCarloWithoutAnEstimateToTrust) {
  testing::SmallStudy study;
  study.csv = testing::SmallCsv();
  study.flags = "--monte_carlo=3";
  // One joint's worth of data cannot tell the parameters of two: three rows.
  study.csv = study.csv.substr(0, study.csv.find("0.300,"));
  const testing::ProgramRun run = testing::RunProgram("idim_compare", study.Arguments());
  EXPECT_EQ(run.exit_code, 2) << run.err;
  EXPECT_THAT(run.err, HasSubstr("--monte_carlo: no estimator gives an estimate that can be trusted"));
  EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
  EXPECT_FALSE(testing::ReadJson(study.folder / "out/comparison.json").contains("monte_carlo"));
}

TEST_F(IdimCompare, KnownGainsHaveThreeEstimators) {
  testing::SmallStudy study;
  const testing::ProgramRun run = testing::RunProgram("idim_compare", study.Arguments());
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(Names(testing::ReadJson(study.folder / "out/comparison.json")), ElementsAre("ls", "wls", "eiv"));
  EXPECT_THAT(run.out, Not(HasSubstr("g1")));
}

// What no estimator can tell: exit code 2, and both files say so.
TEST_F(IdimCompare, NothingToTrust) {
  testing::SmallStudy study;
  testing::Replace("name: a,", "name: a, payload: p,", &study.study);
  study.study += "payloads: {p: {M: 1.0}}\n";
  const testing::ProgramRun run = testing::RunProgram("idim_compare", study.Arguments());
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("not identifiable"));
  EXPECT_THAT(run.out, HasSubstr("IDIM-WLS: no estimate; not to be trusted: not identifiable"));
  const Json comparison = testing::ReadJson(study.folder / "out/comparison.json");
  EXPECT_EQ(comparison.at("estimates").size(), 3u);
  for (const Json& e : comparison.at("estimates")) {
    EXPECT_EQ(e.at("status"), "untrusted");
    EXPECT_THAT(e.at("message").get<std::string>(), HasSubstr("not identifiable"));
  }
  EXPECT_THAT(testing::ReadText(study.folder / "out/report.html"), HasSubstr("not to be trusted: not identifiable"));
}

TEST_F(IdimCompare, BadInputIsOneMessageAndNoFile) {
  const struct {
    std::string study, flags;
    std::vector<std::string> message;
  } table[] = {
      {testing::SyntheticStudy("gains: {mode: guess}"), "", {"gains.mode", "identify"}},
      {testing::SyntheticStudy("gains: {mode: identify}\npayload: 3"), "", {"payload", "payloads"}},
      {testing::SyntheticStudy(testing::kIdentifyGains), "--r_sigma=0.3", {"--r_sigma", "0.3"}},
      {testing::SyntheticStudy(testing::kIdentifyGains), "--reference=nowhere.json", {"nowhere.json"}},
      {testing::SyntheticStudy(testing::kIdentifyGains), "--monte_carlo=1", {"--monte_carlo=1", "at least 2"}},
      {testing::SyntheticStudy(testing::kIdentifyGains), "--monte_carlo=-5", {"--monte_carlo=-5", "at least 2"}},
      {testing::SyntheticStudy(testing::kIdentifyGains), "--seed=-1", {"--seed=-1", "at least 0"}},
      {testing::SyntheticStudy(testing::kIdentifyGains), "--monte_carlo=4 --threads=0", {"--threads=0", "at least 1"}},
  };
  for (const auto& row : table) {
    const testing::ProgramRun run = Run(row.study, row.flags);
    EXPECT_EQ(run.exit_code, 1) << run.err;
    for (const std::string& part : row.message) EXPECT_THAT(run.err, HasSubstr(part));
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
    EXPECT_EQ(run.out, "");
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
  }
  // No known payload: gains have no scale.
  std::string study = testing::SyntheticStudy(testing::kIdentifyGains);
  testing::Replace("{M: 4.59}", "{}", &study);
  const testing::ProgramRun run = Run(study);
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.err, ::testing::AllOf(HasSubstr("payloads"), HasSubstr("scale"), HasSubstr("{M: 4.59}")));
}

TEST_F(IdimCompare, ReportIsDrawnWholeInABrowser) {
  const auto chromium = testing::FindChromium();
  if (!chromium) GTEST_SKIP() << "skipped: no Chromium here";
  ASSERT_NE(Run(testing::SyntheticStudy(testing::kIdentifyGains), "--reference=" + Dataset("tx40_synthetic/truth.json"))
                .exit_code,
            1);
  const auto drawn = testing::OpenReport(*chromium, folder_ / "out/report.html");
  ASSERT_TRUE(drawn.ok()) << drawn.status().message();
  EXPECT_EQ(drawn->figures_expected, 6 + 1 + 4) << "a gain each, parameters, singular values of four estimators";
  EXPECT_TRUE(drawn->AllDrawn()) << drawn->figures_drawn << " drawn, " << drawn->script_errors << " errors";

  ASSERT_EQ(Run(testing::SyntheticStudy(testing::kIdentifyGains), "--monte_carlo=3").exit_code, 0);
  const auto simulated = testing::OpenReport(*chromium, folder_ / "out/report.html");
  ASSERT_TRUE(simulated.ok()) << simulated.status().message();
  EXPECT_EQ(simulated->figures_expected, 11 + 4 + 6) << "bias and spread, coverage, errors, scores; a histogram a gain";
  EXPECT_TRUE(simulated->AllDrawn()) << simulated->figures_drawn << " drawn, " << simulated->script_errors << " errors";
}

// Plain LS and TLS were found useless on this arm by others (datasets/README of the recordings): 2.9 and 56 N m/A for
// gain 1. Fitting the current in its own units, an independent route, gave the values below.
TEST_F(IdimCompare, RealUr10e) {
  IDIM_SKIP_WITHOUT("ur10e/load_14.csv");
  const testing::ProgramRun run =
      testing::RunProgram("idim_compare", Dataset("ur10e/study.yaml") + " --output=" + folder_ / "out");
  EXPECT_NE(run.exit_code, 1) << run.err;
  const double by_current[] = {10.5, 12.4, 9.9, 10.4, 10.3, 10.4};
  int seen = 0;
  const Json comparison = Comparison();
  for (const Json& e : comparison.at("estimates")) {
    const std::string name = e.at("estimator");
    const Json g1 = FindParameter(e, "g1");
    const bool ok = e.at("status") == "ok";
    seen += name == "ls" || name == "tls" || name == "wgtls" || name == "eiv";
    if (name == "ls") {
      EXPECT_LT(g1.at("value").get<double>(), 5.0);
    }
    if (name == "tls") {
      EXPECT_TRUE(!ok || g1.at("value").get<double>() > 30.0) << g1;
    }
    if (name == "eiv") {
      EXPECT_TRUE(ok) << e.at("message");
    }
    if (name != "wgtls" && name != "eiv") continue;
    for (int j = 0; j < 6; ++j) {
      const Json g = FindParameter(e, "g" + std::to_string(j + 1));
      EXPECT_NEAR(g.at("value").get<double>(), by_current[j], 0.15 * by_current[j]) << g;
    }
    const Json& verdict = e.at("gain_diagnoses").at(0);
    EXPECT_EQ(verdict.at("name"), "g1");
    EXPECT_NE(verdict.at("strength"), "strong");
    EXPECT_THAT(verdict.at("sentence").get<std::string>(), HasSubstr("gravity of the known payload puts no torque"));
    EXPECT_THAT(e.at("gain_diagnoses").at(1).at("sentence").get<std::string>(), HasSubstr("gravity alone"));
  }
  EXPECT_EQ(seen, 4);
}

}  // namespace
}  // namespace idim::idim_compare_test
