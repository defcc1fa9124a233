// The real UR10e with a weighed payload: what each estimator of gains makes of it, and whether it knows.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cstdio>

#include "core/model/model.h"
#include "solvers/linear/exogeneity.h"
#include "solvers/linear/gain_identification.h"
#include "solvers/linear/sequential_gains.h"
#include "tests/support/shared_recordings.h"

namespace idim::ur10e_gains_test {
namespace {

using Eigen::VectorXd;
using ::testing::HasSubstr;

TEST(Ur10eGains, EveryEstimatorSaysHowFarToTrustIt) {
  IDIM_SKIP_WITHOUT("ur10e/load_14.csv");
  const Result<Study> study = ReadStudy(IDIM_SOURCE_DIR "/datasets/ur10e/study.yaml");
  ASSERT_TRUE(study.ok()) << study.status().message();
  const Result<PreparedStudy> prepared = PrepareStudy(*study);
  ASSERT_TRUE(prepared.ok()) << prepared.status().message();
  const Result<GainSystem> system = BuildGainSystem(*prepared);
  ASSERT_TRUE(system.ok()) << system.status().message();

  // From a nonlinear fit in units of the current, whose noise can bias nothing (other code, same recordings).
  const VectorXd reference{{10.5, 12.4, 9.9, 10.4, 10.3, 10.4}};
  constexpr GainEstimator kEstimators[] = {GainEstimator::kLs,   GainEstimator::kWls,  GainEstimator::kTls,
                                           GainEstimator::kWtls, GainEstimator::kGtls, GainEstimator::kWgtls};
  GainSummary last;
  double g1[6];
  std::printf("%-10s %8s %8s %8s %8s %8s %8s  (relative standard deviation, %%)\n", "N.m/A", "g1", "g2", "g3", "g4",
              "g5", "g6");
  for (const GainEstimator estimator : kEstimators) {
    GainOptions options;
    options.estimator = estimator;
    const GainSummary summary = SolveGains(*system, options);
    ASSERT_EQ(summary.verdicts.size(), 6u);
    std::printf("%-10s", GainEstimatorName(estimator));
    for (int j = 0; j < 6; ++j) std::printf(" %8.3f", summary.values[j]);
    std::printf("  (");
    for (int j = 0; j < 6; ++j) std::printf(" %.1f", summary.RelativeSigmaPercent(j));
    std::printf(" ) residual %.1f %% %s\n", 100.0 * summary.relative_residual,
                summary.status.ok() ? "" : "NOT TO BE TRUSTED");
    if (estimator == GainEstimator::kGtls || estimator == GainEstimator::kWgtls) {
      EXPECT_TRUE(summary.IsSolutionUsable()) << summary.status.message();
      for (int j = 0; j < 6; ++j) EXPECT_NEAR(summary.values[j] / reference[j], 1.0, 0.15) << j + 1;
    } else {
      EXPECT_EQ(summary.status.code(), StatusCode::kUntrusted);
      EXPECT_THAT(summary.status.message(), HasSubstr("g1 = "));
      EXPECT_THAT(summary.status.message(), HasSubstr("gravity of the known payload puts no torque on joint 1"));
    }
    last = summary;
    g1[static_cast<int>(estimator)] = summary.values[0];
  }
  EXPECT_LT(g1[static_cast<int>(GainEstimator::kLs)], 0.5 * reference[0]);
  EXPECT_GT(g1[static_cast<int>(GainEstimator::kTls)], 3.0 * reference[0]);
  const SequentialGains sequential = SolveSequentialGains(*system);
  std::printf("%-10s", "sequential");
  for (int j = 0; j < 6; ++j) std::printf(" %8.3f", sequential.gains[j]);
  std::printf("\n");
  for (const GainVerdict& verdict : last.verdicts) {
    std::printf("%s\n", verdict.sentence.c_str());
    EXPECT_GE(verdict.reliability, last.verdicts[0].reliability) << verdict.name;
  }
  EXPECT_EQ(last.verdicts[0].strength, GainStrength::kWeak);

  // Least squares is biased on these data, and the declared friction model is too poor for instruments to mend it.
  const Result<LaggedSystem> lagged = BuildLaggedSystem(*prepared, LaggedOptions());
  ASSERT_TRUE(lagged.ok());
  const ExogeneityTest test = TestAllExogeneity(*lagged, last.joint_sigma);
  ASSERT_TRUE(test.status.ok()) << test.status.message();
  std::printf("Durbin-Wu-Hausman, all joints: F(%d, %ld) = %.3g, p = %.2g; Sargan p = %.2g\n", test.numerator,
              static_cast<long>(test.denominator), test.f, test.p_value, test.sargan_p);
  EXPECT_TRUE(test.biased);
  EXPECT_LT(test.sargan_p, 0.01);
}

}  // namespace
}  // namespace idim::ur10e_gains_test
