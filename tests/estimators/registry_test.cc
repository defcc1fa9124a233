#include "solvers/estimators/registry.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace idim::registry_test {
namespace {

using ::testing::ElementsAre;

TEST(EstimatorRegistry, NamesWhatAStudyCanBeAsked) {
  EXPECT_THAT(EstimatorNames(GainsMode::kKnown), ElementsAre("ls", "wls", "eiv"));
  EXPECT_THAT(EstimatorNames(GainsMode::kIdentify), ElementsAre("ls", "wls", "tls", "wtls", "gtls", "wgtls", "eiv"));
}

TEST(EstimatorRegistry, FindsByNameAndMode) {
  for (const Estimator* estimator : AllEstimators()) {
    for (const GainsMode mode : {GainsMode::kKnown, GainsMode::kIdentify}) {
      EXPECT_EQ(FindEstimator(estimator->name(), mode), estimator->Takes(mode) ? estimator : nullptr);
    }
    EXPECT_EQ(estimator->has_robust_loss(), estimator->name() == "eiv");
    std::string error;
    EXPECT_TRUE(estimator->IsValid(EstimatorOptions(), &error)) << error;
    EstimatorOptions bad;
    bad.essential_ratio = 0.5;
    EXPECT_FALSE(estimator->IsValid(bad, &error)) << estimator->name();
  }
  EXPECT_EQ(FindEstimator("mle", GainsMode::kKnown), nullptr);
}

}  // namespace
}  // namespace idim::registry_test
