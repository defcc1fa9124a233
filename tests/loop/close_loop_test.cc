// The loop on a simulated arm of three joints whose undeclared effects come by the simulator's own route.

#include "solvers/loop/close_loop.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>
#include <string>

#include "core/model/active_effects.h"
#include "tests/support/simulated_study.h"

namespace idim::testing::close_loop_test {
namespace {

PreparedStudy StudyWith(const std::string& effects) {
  SimulatedStudy study;
  if (!effects.empty()) {
    ReplaceOnce("recordings:\n", "effects:\n" + effects + "recordings:\n", &study.scenario_text);
  }
  study.Simulate();
  return study.Prepare();
}

LoopResult Close(const PreparedStudy& prepared, const LoopOptions& options = LoopOptions()) {
  Result<LoopResult> result = CloseLoop(prepared, options);
  if (!result.ok()) throw std::runtime_error(result.status().message());
  EXPECT_TRUE(result->status.ok()) << result->status.message();
  return std::move(result).value();
}

std::set<std::string> Titles(const LoopResult& result) {
  std::set<std::string> titles;
  for (const ActiveEffect& effect : result.prepared.model.effects) titles.insert(EffectTitle(effect));
  return titles;
}

using Names = std::set<std::string>;

TEST(CloseLoop, StaysSilentWhereNothingIsMissing) {
  const LoopResult result = Close(StudyWith(""));
  EXPECT_EQ(Titles(result), Names());
  EXPECT_TRUE(result.steps.empty());
  EXPECT_TRUE(result.unexplained.empty());
  EXPECT_EQ(result.final.validation, result.declared.validation);
}

TEST(CloseLoop, FindsOneEffectWithItsShape) {
  const LoopResult result = Close(StudyWith("  - {id: power_viscous, joints: [2], coefficient: 4.0, exponent: 0.4}\n"));
  ASSERT_EQ(Titles(result), Names({"power_viscous on joint 2"}));
  ASSERT_EQ(result.steps.size(), 1u);
  const LoopStep& step = result.steps[0];
  EXPECT_EQ(step.threshold, LoopOptions().significance);
  EXPECT_LT(step.candidate.p_value, step.threshold);
  EXPECT_LT(result.final.validation_per_joint[1], 0.8 * result.declared.validation_per_joint[1]);
  // Other joints neither gain nor lose.
  EXPECT_NEAR(result.final.validation_per_joint[2], result.declared.validation_per_joint[2],
              0.05 * result.declared.validation_per_joint[2]);
  // The value and the exponent within 4.5 of their standard deviations, and these say something.
  int seen = 0;
  for (const ParameterEstimate& p : result.after.estimate.parameters) {
    const double truth = p.parameter.name == "Fp2" ? 4.0 : p.parameter.name == "power_viscous_a_2" ? 0.4 : NAN;
    if (std::isnan(truth)) continue;
    ++seen;
    EXPECT_NEAR(p.value, truth, 4.5 * p.standard_deviation) << p.parameter.name;
    EXPECT_LT(p.standard_deviation, 0.3 * truth) << p.parameter.name;
    EXPECT_LT(p.interval95[0], truth + 3.0 * p.standard_deviation);
    EXPECT_GT(p.interval95[1], truth - 3.0 * p.standard_deviation);
  }
  EXPECT_EQ(seen, 2);
}

// The parameters that left their 95 % interval, from the estimates before and after the only step.
TEST(CloseLoop, SaysWhatTheEffectMoved) {
  const LoopResult result = Close(StudyWith("  - {id: power_viscous, joints: [2], coefficient: 4.0, exponent: 0.4}\n"));
  ASSERT_EQ(result.steps.size(), 1u);
  std::map<std::string, const MovedParameter*> moved;
  for (const MovedParameter& m : result.steps[0].moved) moved[m.parameter.name] = &m;
  size_t seen = 0, compared = 0;
  for (const ParameterEstimate& before : result.before.estimate.parameters) {
    for (const ParameterEstimate& after : result.after.estimate.parameters) {
      if (after.parameter.name != before.parameter.name) continue;
      ++compared;
      const bool left = after.value < before.interval95[0] || after.value > before.interval95[1];
      ASSERT_EQ(moved.count(before.parameter.name), left ? 1u : 0u) << before.parameter.name;
      if (!left) continue;
      ++seen;
      EXPECT_EQ(moved[before.parameter.name]->before, before.value);
      EXPECT_NEAR(moved[before.parameter.name]->after, after.value, 1e-6 * std::abs(after.value));
    }
  }
  EXPECT_EQ(seen, moved.size());
  EXPECT_GT(seen, 0u) << "the case says nothing";
  EXPECT_LT(seen, compared) << "the case says nothing";
}

TEST(CloseLoop, SaysWhatIsLeftWhereNothingMayBeAdded) {
  LoopOptions options;
  options.max_effects = 0;
  const LoopResult result =
      Close(StudyWith("  - {id: joint_spring, joints: [1], stiffness: 20.0, rest: 0.3}\n"), options);
  EXPECT_TRUE(result.steps.empty());
  ASSERT_FALSE(result.unexplained.empty());
  EXPECT_EQ(result.unexplained[0].joint, 0);
  EXPECT_EQ(result.given.max_effects, 0);
}

TEST(CloseLoop, FindsTwoEffectsWhateverTheThreads) {
  const PreparedStudy prepared = StudyWith(
      "  - {id: torque_ripple, joints: [3], amplitude: 0.4, order: 11, phase: 0.5}\n"
      "  - {id: joint_spring, joints: [1], stiffness: 2.0, rest: 0.3}\n");
  LoopOptions threads;
  threads.threads = 2;
  const LoopResult one = Close(prepared), two = Close(prepared, threads);
  EXPECT_EQ(Titles(one), Names({"torque_ripple on joint 3", "joint_spring on joint 1"}));
  EXPECT_EQ(Titles(two), Titles(one));
  EXPECT_EQ(two.final.validation, one.final.validation);
  EXPECT_LT(one.final.validation, one.declared.validation);
}

// A ripple of 0.1 N m under a noise of 0.5 N m a sample: p = 9e-5 (corrected), 5.4 % of the squares held out.
constexpr char kWeakRipple[] = "  - {id: torque_ripple, joints: [3], amplitude: 0.1, order: 11, phase: 0.5}\n";

TEST(CloseLoop, RefusesByTheScoreTestAlone) {
  const PreparedStudy prepared = StudyWith(kWeakRipple);
  const LoopResult found = Close(prepared);
  ASSERT_EQ(Titles(found), Names({"torque_ripple on joint 3"}));
  const EffectCandidate& ripple = found.steps[0].candidate;
  EXPECT_GT(ripple.p_value, 1e-6);
  LoopOptions strict;
  strict.significance = 0.9 * ripple.p_value;
  EXPECT_EQ(Titles(Close(prepared, strict)), Names());
  strict.significance = 1.1 * ripple.p_value;
  EXPECT_EQ(Titles(Close(prepared, strict)), Titles(found));
}

TEST(CloseLoop, RefusesByTheHeldOutErrorAlone) {
  const PreparedStudy prepared = StudyWith(kWeakRipple);
  LoopOptions strict;
  strict.margin = 0.04;  // of the error, 7.8 % of its square
  const LoopResult refused = Close(prepared, strict);
  EXPECT_EQ(Titles(refused), Names());
  EXPECT_TRUE(refused.dropped.empty());
  EXPECT_EQ(refused.final.validation, refused.declared.validation);
}

// At the second step: once hysteresis is in the model, dry friction that falls with speed and viscous friction that
// grows less than proportionally are much the same.
TEST(CloseLoop, ListsARivalThatTheDataCannotTellApart) {
  const LoopResult result =
      Close(StudyWith("  - {id: presliding, joints: [2], displacement: 0.03}\n"
                      "  - {id: stribeck, joints: [2], Fst: 2, vs: 0.2}\n"));
  ASSERT_EQ(Titles(result), Names({"presliding on joint 2", "stribeck on joint 2"}));
  ASSERT_EQ(result.steps.size(), 2u);
  EXPECT_TRUE(result.steps[0].confusable_with.empty());
  ASSERT_EQ(result.steps[1].confusable_with.size(), 1u);
  const LoopRival& rival = result.steps[1].confusable_with[0];
  EXPECT_EQ(EffectTitle(rival.effect), "power_viscous on joint 2");
  // Of held-out blocks, so not less than the final error of the blocks that were fitted, and hardly more: as good.
  EXPECT_GT(rival.held_out_error_percent, 0.95 * result.final.identification);
  EXPECT_LT(rival.held_out_error_percent, 1.25 * result.final.identification);
}

TEST(LoopOptions, NameWhatIsWrong) {
  std::string error;
  LoopOptions options;
  EXPECT_TRUE(options.IsValid(&error));
  options.margin = 0.0;
  EXPECT_FALSE(options.IsValid(&error));
  EXPECT_NE(error.find("margin is 0"), std::string::npos) << error;
}

}  // namespace
}  // namespace idim::testing::close_loop_test
