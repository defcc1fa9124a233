// The errors-in-variables bundle on the real UR10e: gains repeat, and samples at rest or at velocity
// reversal do no harm.

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <cstdio>
#include <functional>

#include "core/model/model.h"
#include "solvers/estimators/eiv_identification.h"
#include "solvers/linear/gain_identification.h"
#include "tests/support/shared_recordings.h"

namespace idim::ur10e_eiv_test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// The study with `free` as its unloaded recording for identification.
PreparedStudy PrepareWith(const std::string& free) {
  Result<Study> study = ReadStudy(IDIM_SOURCE_DIR "/datasets/ur10e/study.yaml");
  EXPECT_TRUE(study.ok()) << study.status().message();
  for (RecordingEntry& entry : study->recordings) {
    const bool fit = entry.name == free || entry.name == "load_14";
    entry.use = fit ? Use::kIdentification : Use::kValidation;
  }
  Result<PreparedStudy> prepared = PrepareStudy(*study);
  EXPECT_TRUE(prepared.ok()) << prepared.status().message();
  return std::move(prepared).value();
}

void Print(const char* what, const VectorXd& gains, const MatrixXd& covariance) {
  std::printf("%-26s", what);
  for (int j = 0; j < 6; ++j) std::printf(" %7.3f (%.3f)", gains[j], std::sqrt(covariance(j, j)));
  std::printf("\n");
}

TEST(Ur10eEiv, GainsRepeatWithAnotherUnloadedRecording) {
  IDIM_SKIP_WITHOUT("ur10e/free_12.csv");
  VectorXd gains[2];
  MatrixXd covariance[2];
  for (int k = 0; k < 2; ++k) {
    const PreparedStudy prepared = PrepareWith(k == 0 ? "free_14" : "free_12");
    const Result<GainSystem> system = BuildGainSystem(prepared);
    ASSERT_TRUE(system.ok()) << system.status().message();
    const Result<Identification> result = IdentifyEiv(prepared, &*system, EivOptions());
    ASSERT_TRUE(result.ok()) << result.status().message();
    const Estimate& e = result->estimate;
    ASSERT_TRUE(e.status.ok()) << e.status.message();
    gains[k].resize(6);
    for (int j = 0; j < 6; ++j) gains[k][j] = e.parameters[j].value;
    covariance[k] = e.covariance.topLeftCorner(6, 6);
    Print(k == 0 ? "free_14 + load_14" : "free_12 + load_14", gains[k], covariance[k]);
  }
  const VectorXd difference = gains[1] - gains[0];
  const MatrixXd both = covariance[0] + covariance[1];
  // load_14 is in both, so that the difference is less uncertain than this; the bound is the looser for it.
  const double distance = difference.dot(both.ldlt().solve(difference));
  std::printf("chi-square of the difference, 6 degrees: %.2f, p = %.3f\n", distance,
              boost::math::cdf(boost::math::complement(boost::math::chi_squared(6), distance)));
  EXPECT_LT(distance, boost::math::quantile(boost::math::chi_squared(6), 0.95));
  for (int j = 0; j < 6; ++j) EXPECT_LT(std::abs(difference[j]), 1.96 * std::sqrt(both(j, j))) << "g" << j + 1;
}

// The recordings begin and end at rest and reverse every joint some forty times. Left out or not, such samples do not
// move a gain by its standard deviation: where the sign is unknown the Coulomb column is zero and says nothing.
TEST(Ur10eEiv, SamplesAtRestAndAtReversalDoNoHarm) {
  IDIM_SKIP_WITHOUT("ur10e/free_12.csv");
  const PreparedStudy prepared = PrepareWith("free_14");
  const Result<GainSystem> system = BuildGainSystem(prepared);
  const Result<BundleData> data = BuildBundleData(prepared);
  ASSERT_TRUE(system.ok() && data.ok());
  GainOptions closed;
  closed.estimator = GainEstimator::kWgtls;
  const VectorXd start = SolveGains(*system, closed).values;
  const BundleSummary all = SolveBundle(prepared.base(), *data, start);
  ASSERT_TRUE(all.IsSolutionUsable()) << all.status.message();
  Print("all samples", all.values, all.robust_covariance);
  const auto without = [&](const char* what, const std::function<bool(const VectorXd& speed)>& drop) {
    BundleData fewer = *data;
    std::vector<BundleSample> kept;
    for (const BundleSample& sample : data->samples()) {
      if (!drop(sample.state.segment(6, 6).cwiseAbs())) kept.push_back(sample);
    }
    fewer.SetSamples(kept);
    EXPECT_LT(kept.size(), 0.95 * data->samples().size()) << "there are such samples";
    const BundleSummary summary = SolveBundle(prepared.base(), fewer, start);
    ASSERT_TRUE(summary.IsSolutionUsable()) << summary.status.message();
    Print(what, summary.values, summary.robust_covariance);
    for (int j = 0; j < 6; ++j) {
      EXPECT_LT(std::abs(summary.values[j] - all.values[j]), std::sqrt(all.robust_covariance(j, j))) << j + 1;
    }
  };
  without("without rest", [](const VectorXd& speed) { return speed.maxCoeff() < 0.02; });
  without("every |dq| > 0.005 rad/s", [](const VectorXd& speed) { return speed.minCoeff() < 0.005; });
  without("every |dq| > 0.02 rad/s", [](const VectorXd& speed) { return speed.minCoeff() < 0.02; });
}

}  // namespace
}  // namespace idim::ur10e_eiv_test
