// Candidates on a simulated arm of three joints whose undeclared effect comes by the simulator's own route.

#include "solvers/loop/effect_scan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>

#include "core/model/active_effects.h"
#include "solvers/loop/effect_fit.h"
#include "tests/support/simulated_study.h"

namespace idim::testing::effect_scan_test {
namespace {

struct Scanned {
  EffectFit fit;
  ResidualModel residual;
  EffectScan scan;
};

Scanned ScanArm(const std::string& effects, const ScanOptions& options = ScanOptions()) {
  SimulatedStudy study;
  if (!effects.empty()) ReplaceOnce("recordings:\n", "effects:\n" + effects + "recordings:\n", &study.scenario_text);
  study.Simulate();
  Result<EffectFit> fit = FitDeclared(study.Prepare());
  if (!fit.ok()) throw std::runtime_error(fit.status().message());
  ResidualModel residual(fit->prepared.base(), fit->data, fit->summary);
  EffectScan scan = ScanEffects(fit->prepared, residual, fit->Arm(), options);
  return {std::move(fit).value(), std::move(residual), std::move(scan)};
}

TEST(EffectScan, RanksTheTrueEffectFirstAtItsShape) {
  const Scanned arm = ScanArm("  - {id: torque_ripple, joints: [3], amplitude: 0.5, order: 11, phase: 0.4}\n");
  ASSERT_FALSE(arm.scan.candidates.empty());
  const EffectCandidate& best = arm.scan.candidates[0];
  EXPECT_EQ(EffectTitle(best.effect), "torque_ripple on joint 3");
  EXPECT_NEAR(best.effect.shape[0], 11.0, 0.1);
  EXPECT_EQ(best.parameters, 3);
  EXPECT_LT(best.p_value, 1e-6);
  for (const EffectCandidate& candidate : arm.scan.candidates) {
    EXPECT_LE(candidate.p_value, ScanOptions().significance);
    EXPECT_LE(candidate.held_out_gain.sum(), best.held_out_gain.sum());
  }
  // What it explains and holds out are those of its own columns.
  EXPECT_NEAR(best.explained, arm.residual.Explained(best.remainder), 1e-9 * best.explained);
  const double before = arm.residual.CrossValidate(Eigen::MatrixXd(best.remainder.rows(), 0)).squares.sum();
  const double after = arm.residual.CrossValidate(best.remainder).squares.sum();
  EXPECT_NEAR(best.held_out_gain.sum(), before - after, 1e-9 * before);
}

// Of effects, of the places of one, and of its shapes: at one joint alone fewer were tried, and the same finding
// is less likely to be chance.
TEST(EffectScan, PValueIsOfAllThatWasTried) {
  const std::string ripple = "  - {id: torque_ripple, joints: [3], amplitude: 0.2, order: 11, phase: 0.4}\n";
  ScanOptions options;
  options.significance = 1.0;
  const Scanned everywhere = ScanArm(ripple, options);
  options.only_joints = {2};
  const Scanned here = ScanArm(ripple, options);
  const auto find = [](const Scanned& arm) {
    for (const EffectCandidate& c : arm.scan.candidates) {
      if (EffectTitle(c.effect) == "torque_ripple on joint 3") return c;
    }
    throw std::runtime_error("no ripple");
  };
  const EffectCandidate of_all = find(everywhere), alone = find(here);
  EXPECT_EQ(of_all.score.p_value, alone.score.p_value);
  ASSERT_GT(alone.score.p_value, 1e-200);
  ASSERT_LT(of_all.p_value, 0.01);
  std::set<const Effect*> effects, effects_here;
  for (const EffectCandidate& c : everywhere.scan.candidates) effects.insert(c.effect.effect);
  for (const EffectCandidate& c : here.scan.candidates) effects_here.insert(c.effect.effect);
  const auto tries = [](const EffectCandidate& c) { return c.p_value / c.score.p_value; };
  const std::vector<ShapeParameter> shapes =
      of_all.effect.effect->Shapes(MotionsOf(here.fit.prepared, here.fit.Arm()), of_all.effect.joints);
  const auto grid = static_cast<double>(shapes[0].grid.size()), count = static_cast<double>(effects.size());
  EXPECT_GE(tries(of_all), 3.0 * count * grid * (1.0 - 1e-9));
  EXPECT_NEAR(tries(of_all) / tries(alone), 3.0 * count / static_cast<double>(effects_here.size()), 1e-9);
}

TEST(EffectScan, RefusesFrictionThatWouldDriveItsJoint) {
  const auto titles = [](const Scanned& arm) {
    std::vector<std::string> all;
    for (const EffectCandidate& candidate : arm.scan.candidates) all.push_back(EffectTitle(candidate.effect));
    return all;
  };
  const std::vector<std::string> positive = titles(ScanArm("  - {id: load_friction, joints: [2], mu: 0.05}\n"));
  const std::vector<std::string> negative = titles(ScanArm("  - {id: load_friction, joints: [2], mu: -0.05}\n"));
  const std::string title = "load_friction on joint 2";
  EXPECT_EQ(positive.at(0), title);
  EXPECT_EQ(std::count(negative.begin(), negative.end(), title), 0);
}

TEST(EffectScan, LooksAtOnePlaceAloneWhereAsked) {
  ScanOptions options;
  options.only_joints = {2};
  const Scanned arm = ScanArm("  - {id: torque_ripple, joints: [3], amplitude: 0.5, order: 11, phase: 0.4}\n", options);
  ASSERT_FALSE(arm.scan.candidates.empty());
  for (const EffectCandidate& candidate : arm.scan.candidates) {
    EXPECT_EQ(candidate.effect.joints, std::vector<int>({2})) << EffectTitle(candidate.effect);
  }
}

}  // namespace
}  // namespace idim::testing::effect_scan_test
