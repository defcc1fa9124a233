// An effect that no catalogue holds is named by its joint and signals.

#include "solvers/loop/unexplained.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "solvers/loop/close_loop.h"
#include "solvers/loop/effect_fit.h"
#include "tests/support/edit_data.h"
#include "tests/support/simulated_study.h"

namespace idim::testing::unexplained_test {
namespace {

PreparedStudy Arm(double strength) {
  SimulatedStudy study;
  study.Simulate();
  PreparedStudy prepared = study.Prepare();
  EditRecordings(&prepared, [&](Recording* recording, JointStates* states) {
    const Eigen::VectorXd torque = strength * states->q.col(1).cwiseProduct(states->dq.col(2));
    recording->signal.col(2) += torque / prepared.model.gains[2];
  });
  return prepared;
}

TEST(Unexplained, NamesJointAndSignalsOfATorqueThatNoEffectHas) {
  const Result<LoopResult> result = CloseLoop(Arm(3.0), LoopOptions());
  ASSERT_TRUE(result.ok() && result->status.ok());
  const auto found = std::find_if(result->unexplained.begin(), result->unexplained.end(),
                                  [](const Unexplained& u) { return u.joint == 2; });
  ASSERT_NE(found, result->unexplained.end());
  EXPECT_EQ(found->depends_on, (std::vector<std::string>{"q2", "dq3"}));
  EXPECT_GT(found->share_percent, 20.0);
  EXPECT_LE(found->p_value, 0.01);
  for (const LoopStep& step : result->steps) EXPECT_TRUE(step.effect.joints != std::vector<int>{2}) << "baptised";
}

// Six joints' tests of 1 % in all (two arms' worth): none is expected to speak; the seed is fixed.
TEST(Unexplained, IsSilentWhereTheModelIsTrue) {
  const Result<EffectFit> fit = FitDeclared(Arm(0.0));
  ASSERT_TRUE(fit.ok()) << fit.status().message();
  const ResidualModel residual(fit->prepared.base(), fit->data, fit->summary);
  EXPECT_TRUE(FindUnexplained(fit->prepared, residual, UnexplainedOptions()).empty());
}

}  // namespace
}  // namespace idim::testing::unexplained_test
