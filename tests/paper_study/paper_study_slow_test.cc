// The study of the paper on simulated recordings: the committed page is what the program makes, and what the page says
// of the estimators holds.

#include <gtest/gtest.h>

#include <cmath>

#include "apps/paper_study/page.h"
#include "core/base/file.h"
#include "core/effects/simulated_effects.h"
#include "tests/support/browser.h"
#include "tests/support/temp_folder.h"

namespace idim::paper_study_slow_test {
namespace {

const std::string kFolder = std::string(IDIM_SOURCE_DIR) + "/datasets/paper_study/";

Result<PaperStudy> Run() {
  const Result<Scenario> scenario = ReadScenario(kFolder + "scenario.yaml", EffectEquations());
  IDIM_RETURN_IF_ERROR(scenario);
  return RunPaperStudy(*scenario, kPaperRatio);
}

const Result<PaperStudy>& Committed() {
  static const auto* const paper = new Result<PaperStudy>(Run());
  return *paper;
}

Eigen::VectorXd GainSigma(const PaperCase& result) {
  Eigen::VectorXd sigma = Eigen::VectorXd::Constant(6, -1.0);
  for (const ParameterEstimate& p : result.estimate.parameters) {
    if (p.parameter.kind == ParameterKind::kDriveGain) sigma[p.parameter.joint - 1] = p.standard_deviation;
  }
  return sigma;
}

Variant Errors(const VariantOptions& options, int draws) {
  Result<Variant> variant = RunVariant(*Committed(), options, draws);
  EXPECT_TRUE(variant.ok()) << variant.status().message();
  return variant.ok() ? *variant : Variant();
}

const GainErrors& Of(const Variant& variant, const std::string& name) {
  for (const GainErrors& errors : variant.cases) {
    if (errors.name == name) return errors;
  }
  ADD_FAILURE() << name;
  return variant.cases.front();
}

TEST(PaperStudy, CommittedPageIsAByteExactProduct) {
  const Result<PaperStudy>& paper = Committed();
  ASSERT_TRUE(paper.ok()) << paper.status().message();
  const Result<PaperTables> tables = ReadPaperTables(kFolder + "paper");
  ASSERT_TRUE(tables.ok()) << tables.status().message();
  const Result<std::string> discussion = ReadFile(kFolder + "discussion.md");
  const Result<std::string> committed = ReadFile(kFolder + "README.md");
  ASSERT_TRUE(discussion.ok() && committed.ok());
  std::vector<Variant> variants;
  for (const VariantOptions& options : PaperVariants()) variants.push_back(Errors(options, kPaperDraws));
  EXPECT_TRUE(RenderPaperPage(*paper, variants, *tables, *discussion) == *committed)
      << "scripts/run_paper_study.sh makes datasets/paper_study/README.md again";
}

// The noise level that was asked for: 11 to 12 % where the estimate is right.
TEST(PaperStudy, NoiseIsThePapers) {
  ASSERT_TRUE(Committed().ok());
  for (int c : {kManufacturer, kCase3, kCase4, kScaled}) {
    const double error = Committed()->cases[c].estimate.relative_error_percent;
    EXPECT_GT(error, 11.0) << Committed()->cases[c].name;
    EXPECT_LT(error, 12.0) << Committed()->cases[c].name;
  }
}

// Scaled TLS within 4 of its own standard deviations of the true gains; each of the paper's four cases has a gain that
// is further off than that, so that the intervals of the closed forms do not hold the truth.
TEST(PaperStudy, ScaledTlsHoldsTheTruthAndThePapersCasesDoNot) {
  ASSERT_TRUE(Committed().ok());
  const Eigen::VectorXd truth = Committed()->scenario.gains;
  for (int c = kCase1; c < kNumPaperCases; ++c) {
    const PaperCase& result = Committed()->cases[c];
    const Eigen::VectorXd sigma = GainSigma(result);
    ASSERT_GT(sigma.minCoeff(), 0.0) << result.name;
    const double worst = (result.validation.gains - truth).cwiseQuotient(sigma).cwiseAbs().maxCoeff();
    if (c == kScaled) {
      EXPECT_LT(worst, 4.0) << result.name;
    } else {
      EXPECT_GT(worst, 4.0) << result.name;
    }
  }
}

// Without noise on the signals what is left is the filter (the model is evaluated from filtered positions, friction
// changes sign between samples) and steps of 0.001 in signals of about 0.3: 0.6 % of the torque, of which an
// errors-in-variables bias of its square remains in case 2 and less in the others.
TEST(PaperStudy, WithoutNoiseEveryEstimatorFindsTheGains) {
  ASSERT_TRUE(Committed().ok());
  VariantOptions clean;
  clean.size = 0.0;
  const Variant variant = Errors(clean, 2);
  ASSERT_FALSE(variant.cases.empty());
  for (const GainErrors& errors : variant.cases) {
    EXPECT_LT(errors.mean_percent.cwiseAbs().maxCoeff(), errors.name.rfind("Case 2", 0) == 0 ? 1.0 : 0.3)
        << errors.name;
    EXPECT_LT(errors.residual_percent, 1.0) << errors.name;
  }
}

// Least squares loses a share of the gains that grows with the square of the noise; halving it divides a loss L by
// about 4 (odds L / (1 - L) by exactly 4 for one gain alone). The least and the most that four draws
// show are far inside.
TEST(PaperStudy, LossOfLeastSquaresGrowsWithTheSquareOfTheNoise) {
  ASSERT_TRUE(Committed().ok());
  VariantOptions full, half;
  half.size = 0.5;
  const Variant a = Errors(full, 2), b = Errors(half, 2);
  ASSERT_FALSE(a.cases.empty() || b.cases.empty());
  for (const std::string name : {"Case 1", "Case 2"}) {
    const Eigen::ArrayXd large = -Of(a, name).mean_percent.array() / 100.0;
    const Eigen::ArrayXd small = -Of(b, name).mean_percent.array() / 100.0;
    EXPECT_GT(small.minCoeff(), 0.0) << name;
    const Eigen::ArrayXd ratio = (large / (1.0 - large)) / (small / (1.0 - small));
    EXPECT_GT(ratio.minCoeff(), 3.0) << name;
    EXPECT_LT(ratio.maxCoeff(), 7.0) << name;
  }
}

// What ten known parameters add to the mass, and what other parameters can imitate, come in the order they must.
TEST(PaperStudy, PayloadOnlyExplainsAsMuchAsItsTorqueAllows) {
  ASSERT_TRUE(Committed().ok());
  const Variant variant = Errors(VariantOptions(), 2);
  EXPECT_GT(variant.share_ten, variant.independent_ten);
  EXPECT_GT(variant.independent_ten, variant.independent_mass);
  EXPECT_GT(variant.share_mass, variant.independent_mass);
  EXPECT_GT(variant.independent_mass, 0.05);
  EXPECT_LT(variant.share_ten, 1.0);
}

TEST(PaperStudy, Figure2IsDrawnWholeInABrowser) {
  const auto chromium = testing::FindChromium();
  if (!chromium) GTEST_SKIP() << "skipped: no Chromium here";
  ASSERT_TRUE(Committed().ok());
  const TempFolder folder;
  ASSERT_TRUE(WriteFiles(folder / "out", {{"report.html", RenderPaperReport(*Committed())}}).ok());
  const auto drawn = testing::OpenReport(*chromium, folder / "out/report.html");
  ASSERT_TRUE(drawn.ok()) << drawn.status().message();
  EXPECT_EQ(drawn->figures_expected, 6 + 1);  // torques by joint, gains
  EXPECT_TRUE(drawn->AllDrawn());
}

// "What the paper's tables say about each other": friction and gain of a joint change alike from case to case, in TLS
// as printed, in WLS with the two halves of Table II exchanged. Printed values have three digits: a ratio of two is
// good to 1 %, and a product of ratios to 2 %.
TEST(PaperStudy, TableIIIsPrintedWithItsHalvesExchanged) {
  const Result<PaperTables> tables = ReadPaperTables(kFolder + "paper");
  ASSERT_TRUE(tables.ok()) << tables.status().message();
  const auto friction = [](const PaperTable& table, int j) {
    for (int r = 0; r < static_cast<int>(table.rows.size()); ++r) {
      if (table.Cell(r, "parameter") != "Fv" + std::to_string(j + 1)) continue;
      return table.Number(r, "mass_known_value") / table.Number(r, "ten_known_value");
    }
    return std::nan("");
  };
  for (int j = 0; j < 6; ++j) {
    const PaperTable& gains = tables->table_2_4;
    const double wls = gains.Number(j, "wls_mass_known") / gains.Number(j, "wls_ten_known");
    const double tls = gains.Number(j, "tls_mass_known") / gains.Number(j, "tls_ten_known");
    EXPECT_NEAR(friction(tables->table_3, j) / tls, 1.0, 0.02) << j;
    EXPECT_NEAR(friction(tables->table_1, j) * wls, 1.0, 0.02) << j;
    EXPECT_LT(friction(tables->table_1, j) / wls, 0.97) << j;
  }
}

}  // namespace
}  // namespace idim::paper_study_slow_test
