// The registry's equations and the columns beside them: one effect, seen from both sides; and the lists for people.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <regex>
#include <string>
#include <vector>

#include "core/base/file.h"
#include "core/effects/simulated_effects.h"
#include "core/simulation/scenario.h"
#include "tests/effects/effect_arm.h"

namespace idim::effect_equations_test {
namespace {

using ::testing::ElementsAreArray;

// What has an equation: all but the friction that the standard model has.
std::vector<const Effect*> Simulated() {
  std::vector<const Effect*> effects;
  for (const Effect* effect : AllEffects()) {
    if (!effect->in_standard_model()) effects.push_back(effect);
  }
  return effects;
}

std::vector<std::string> Ids(const std::vector<const Effect*>& effects) {
  std::vector<std::string> ids;
  for (const Effect* effect : effects) ids.push_back(effect->id());
  return ids;
}

std::vector<int> JointsOf(const EffectEquation& equation) {
  switch (equation.joints()) {
    case EffectJoints::kOneOrMore:
      return {1};
    case EffectJoints::kTwo:
      return {1, 2};
    case EffectJoints::kNone:
      break;
  }
  return {};
}

TEST(EffectEquations, AreThoseOfTheRegistryUnderTheSameIdsAndSites) {
  const EffectEquationList& equations = EffectEquations();
  ASSERT_EQ(equations.size(), Simulated().size());
  for (size_t k = 0; k < equations.size(); ++k) {
    const Effect& effect = *Simulated()[k];
    EXPECT_EQ(effect.equation(), equations[k]);
    EXPECT_EQ(equations[k]->id(), effect.id());
    const size_t joints = effect.site() == EffectSite::kArm ? 0 : effect.site() == EffectSite::kJoint ? 1 : 2;
    EXPECT_EQ(JointsOf(*equations[k]).size(), joints) << effect.id();
  }
  for (const Effect* effect : AllEffects()) EXPECT_EQ(effect->equation() == nullptr, effect->in_standard_model());
}

// What a trial draws is valid, has a size to be scaled, and a true shape within a wide range of what the columns take.
TEST(EffectEquations, DrawValidValuesForWhichTheColumnsHaveAShape) {
  const testing::EffectArm arm(testing::Tx40());
  const std::vector<EffectMotion> motions = {arm.Motion(0.0, 0.01, 1001, 0), arm.Motion(3.0, 0.01, 1001, 1)};
  Scenario scenario;
  scenario.robot = arm.robot();
  scenario.recordings.resize(2);
  for (int r : {0, 1}) {
    scenario.recordings[r].name = std::string(1, "ab"[r]);
    scenario.recordings[r].duration = 10.0;
  }
  Random random(1);
  for (const Effect* effect : Simulated()) {
    const EffectEquation& equation = *effect->equation();
    const auto& keys = equation.keys();
    EXPECT_TRUE(std::any_of(keys.begin(), keys.end(), [](const EffectKey& k) { return k.size_power != 0; }))
        << effect->id();
    for (int draw = 0; draw < 20; ++draw) {
      SimulatedEffect simulated{&equation, JointsOf(equation), equation.DrawValues(10.0, &random), ""};
      std::string error;
      EXPECT_TRUE(simulated.IsValid(scenario.robot, &error)) << error;
      if (effect->shapes_count_recordings()) simulated.recording = "b";
      const Eigen::VectorXd shape = effect->TrueShape(simulated, scenario);
      const std::vector<ShapeParameter> shapes = effect->Shapes(motions, simulated.joints);
      ASSERT_EQ(static_cast<size_t>(shape.size()), shapes.size()) << effect->id();
      for (size_t k = 0; k < shapes.size(); ++k) {
        const double value = shape[static_cast<Eigen::Index>(k)];
        EXPECT_GT(value, 0.1 * shapes[k].lower) << effect->id();
        EXPECT_LT(value, 10.0 * shapes[k].upper) << effect->id();
      }
    }
  }
}

SimulatedEffect SimulatedOf(const std::string& id, std::map<std::string, double> values, const std::string& recording) {
  const EffectEquation& equation = *FindEffect(id)->equation();
  return {&equation, JointsOf(equation), std::move(values), recording};
}

TEST(EffectEquations, TrueShapesAreInTheUnitsOfTheColumns) {
  Scenario scenario;
  scenario.robot.transmission = Eigen::Matrix3d::Identity();
  scenario.robot.transmission(1, 1) = -40.0;
  scenario.recordings.resize(2);
  scenario.recordings[0].name = "a";
  scenario.recordings[1].name = "b";
  scenario.recordings[1].duration = 8.0;
  const auto shape = [&](const std::string& id, const std::map<std::string, double>& values,
                         const std::string& recording = "") {
    return FindEffect(id)->TrueShape(SimulatedOf(id, values, recording), scenario)[0];
  };
  EXPECT_EQ(shape("stribeck", {{"vs", 0.3}}), 0.3);
  EXPECT_EQ(shape("power_viscous", {{"exponent", 0.4}}), 0.4);
  EXPECT_EQ(shape("presliding", {{"displacement", 0.02}}), 0.02);
  EXPECT_EQ(shape("thermal_drift", {{"time_constant", 7.0}}), 7.0);
  EXPECT_EQ(shape("torque_ripple", {{"order", 6.0}}), 6.0);
  EXPECT_EQ(shape("torque_ripple", {{"motor_order", 2.0}}), 80.0);
  EXPECT_EQ(shape("backlash", {{"gap", 0.004}}), 0.002);
  EXPECT_EQ(shape("payload_change", {{"from", 2.0}}, "b"), 1.25);
}

// Backticked names of the paragraph that begins so, up to the end of its first sentence.
std::vector<std::string> Listed(const std::string& text, const std::string& beginning) {
  const size_t begin = text.find(beginning);
  if (begin == std::string::npos) return {};
  const std::string list = text.substr(begin + beginning.size(), text.find(". ", begin) - begin - beginning.size());
  static const std::regex name("`([a-z_]+)`");
  std::vector<std::string> names;
  for (std::sregex_iterator it(list.begin(), list.end(), name); it != std::sregex_iterator(); ++it) {
    names.push_back((*it)[1]);
  }
  return names;
}

TEST(EffectEquations, ReadmeListsAllThatAStudyOrAScenarioMayDeclare) {
  const std::string page = ReadFile(std::string(IDIM_SOURCE_DIR) + "/docs/files.md").value();
  EXPECT_THAT(Listed(page, "Ids under `effects`: "), ElementsAreArray(Ids(Simulated())));
}

}  // namespace
}  // namespace idim::effect_equations_test
