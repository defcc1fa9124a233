// The key `effects` of a scenario: what is read, refused, written; sizes of effects and effects together.

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "core/effects/simulated_effects.h"
#include "core/simulation/effects_truth.h"
#include "core/simulation/scenario.h"
#include "core/simulation/simulate_scenario.h"
#include "tests/support/temp_folder.h"

namespace idim::effects_scenario_test {
namespace {

const char kScenario[] = R"(robot: robot.yaml
parameters:
  - {XX: 0.1, YY: 0.1, ZZ: 0.5, Ia: 0.3, Fv: 7, Fs: 5, off: 0.3}
  - {XX: 0.2, YY: 0.5, ZZ: 0.5, MX: 0.5, MY: 0.1, M: 4, Ia: 0.3, Fv: 4, Fs: 0}
  - {XX: 0.0, YY: 0.0, ZZ: 0.0, M: 0, Ia: 0.1, Fv: 1, Fs: 2}
gains: {values: [30, -20, 10]}
rate: 200
limits: {lower: -1.5, upper: 1.5, velocity: [3, 3, 4], acceleration: 20, jerk: 400}
effects:
  - {id: stribeck, joints: [3], Fst: 2.0, vs: 0.1}
recordings:
  - {name: free, seed: 1, duration: 2, trajectory: {type: point_to_point, random: 8}}
  - {name: other, seed: 2, duration: 1, trajectory: {type: point_to_point, random: 8}}
)";

const char kRobot[] = R"(name: three
joints:
  - {type: revolute, alpha: 0.0, d: 0.0, theta: 0.0, r: 0.0}
  - {type: revolute, alpha: -1.57, d: 0.1, theta: 0.0, r: 0.0}
  - {type: revolute, alpha: 0.3, d: 0.3, theta: 0.0, r: 0.1}
)";

constexpr char kEffect[] = "{id: stribeck, joints: [3], Fst: 2.0, vs: 0.1}";

Result<Scenario> Read(const TempFolder& folder, const std::string& effect) {
  folder.Write("robot.yaml", kRobot);
  std::string text = kScenario;
  text.replace(text.find(kEffect), sizeof(kEffect) - 1, effect);
  return ReadScenario(folder.Write("scenario.yaml", text), EffectEquations());
}

TEST(ScenarioEffects, AreReadSimulatedAndWrittenToTheTruthAlone) {
  TempFolder folder;
  const std::string two =
      std::string(kEffect) + "\n  - {id: torque_ripple, joints: [1, 2], amplitude: 0.5, order: 8, recording: other}";
  const Result<Scenario> scenario = Read(folder, two);
  ASSERT_TRUE(scenario.ok()) << scenario.status().message();
  ASSERT_EQ(scenario->effects.size(), 2u);
  EXPECT_EQ(scenario->effects[0].joints, std::vector<int>({2}));
  EXPECT_EQ(scenario->effects[1].joints, std::vector<int>({0, 1}));
  EXPECT_EQ(scenario->effects[1].recording, "other");
  Scenario bare = *scenario;
  bare.effects.clear();
  const auto changed = [&](int recording, int joint) {
    const ScenarioRecording& r = scenario->recordings[recording];
    return (SimulateTruth(*scenario, r).torque - SimulateTruth(bare, r).torque).col(joint).cwiseAbs().maxCoeff();
  };
  EXPECT_GT(changed(0, 2), 1.0);
  EXPECT_GT(changed(1, 2), 1.0);
  EXPECT_LT(changed(0, 0), 1e-12);
  EXPECT_NEAR(changed(1, 0), 0.5, 0.01);

  const auto with = RenderScenario(*scenario), without = RenderScenario(bare);
  ASSERT_TRUE(with.ok() && without.ok());
  ASSERT_EQ(with->size(), without->size());
  for (size_t k = 0; k < with->size(); ++k) {
    const std::string& name = (*with)[k].name;
    EXPECT_EQ((*with)[k].content == (*without)[k].content, name == "robot.yaml" || name == "study.yaml") << name;
    if (name != "truth.json") continue;
    EXPECT_EQ(nlohmann::json::parse((*without)[k].content).count("effects"), 0u);
    const nlohmann::json effects = nlohmann::json::parse((*with)[k].content)["effects"];
    ASSERT_EQ(effects.size(), 2u);
    EXPECT_EQ(effects[0],
              nlohmann::json::parse(R"({"effect": "stribeck", "joints": [3], "values": {"Fst": 2.0, "vs": 0.1}})"));
    EXPECT_EQ(effects[1], nlohmann::json::parse(
                              R"({"effect": "torque_ripple", "joints": [1, 2], "recording": "other",
                                  "values": {"amplitude": 0.5, "order": 8.0, "phase": 0.0}})"));
  }
}

struct BadEffect {
  const char* name;
  const char* effect;
  const char* key;
  const char* word;
};

class BadEffects : public ::testing::TestWithParam<BadEffect> {};

TEST_P(BadEffects, AreRefusedByFileLineAndKey) {
  TempFolder folder;
  const Result<Scenario> scenario = Read(folder, GetParam().effect);
  ASSERT_FALSE(scenario.ok());
  const std::string& message = scenario.status().message();
  EXPECT_NE(message.find(std::string("scenario.yaml:10: key '") + GetParam().key), std::string::npos) << message;
  EXPECT_NE(message.find(GetParam().word), std::string::npos) << message;
}

INSTANTIATE_TEST_SUITE_P(
    Table, BadEffects,
    ::testing::Values(
        BadEffect{"unknown_id", "{id: stribek, joints: [3], Fst: 1, vs: 1}", "effects[1].id", "stribeck"},
        BadEffect{"no_id", "{joints: [3], Fst: 1, vs: 1}", "effects[1].id", "missing"},
        BadEffect{"not_a_mapping", "stribeck", "effects[1]", "not a mapping"},
        BadEffect{"unknown_key", "{id: stribeck, joints: [3], Fst: 1, vt: 1}", "effects[1].vt", "vs"},
        BadEffect{"missing_value", "{id: stribeck, joints: [3], Fst: 1}", "effects[1]", "vs is missing"},
        BadEffect{"text_value", "{id: stribeck, joints: [3], Fst: much, vs: 1}", "effects[1].Fst", "not a number"},
        BadEffect{"no_velocity", "{id: stribeck, joints: [3], Fst: 1, vs: 0}", "effects[1]", "vs = 0, must be above 0"},
        BadEffect{"joint_zero", "{id: stribeck, joints: [0], Fst: 1, vs: 1}", "effects[1].joints[1]", "1"},
        BadEffect{"joint_out_of_range", "{id: stribeck, joints: [4], Fst: 1, vs: 1}", "effects[1].joints[1]", "3"},
        BadEffect{"no_joints", "{id: stribeck, Fst: 1, vs: 1}", "effects[1].joints", "missing"},
        BadEffect{"joints_empty", "{id: stribeck, joints: [], Fst: 1, vs: 1}", "effects[1]", "at least one"},
        BadEffect{"joint_twice", "{id: stribeck, joints: [1, 1], Fst: 1, vs: 1}", "effects[1]", "twice"},
        BadEffect{"one_joint_of_two", "{id: motor_coupling, joints: [1], inertia: 1}", "effects[1]", "must have two"},
        BadEffect{"joints_of_the_arm", "{id: base_tilt, joints: [1], angle_1: 1}", "effects[1].joints", "unknown"},
        BadEffect{"nothing_given", "{id: base_tilt}", "effects[1]", "angle_1, angle_2"},
        BadEffect{"two_orders", "{id: torque_ripple, joints: [1], amplitude: 1, order: 1, motor_order: 1}",
                  "effects[1]", "only one"},
        BadEffect{"delay_in_ms", "{id: time_delay, joints: [1], delay: 4}", "effects[1]", "0.1"},
        BadEffect{"no_recording", "{id: time_delay, joints: [1], delay: 0.01, recording: free_2}",
                  "effects[1].recording", "free"},
        BadEffect{"no_coulomb", "{id: presliding, joints: [2], displacement: 0.01}", "effects[1]", "Fs2"},
        BadEffect{"no_link", "{id: joint_elasticity, joints: [3], stiffness: 1000}", "effects[1]", "inertia"}),
    [](const auto& test) { return test.param.name; });

TEST(ScenarioEffects, ThatCannotActTwiceDoNot) {
  TempFolder folder;
  const std::string one = "{id: time_delay, joints: [1], delay: 0.01, recording: free}\n  - ";
  EXPECT_TRUE(Read(folder, one + "{id: time_delay, joints: [1], delay: 0.01, recording: other}").ok());
  EXPECT_TRUE(Read(folder, one + "{id: time_delay, joints: [2], delay: 0.01}").ok());
  const auto bad = Read(folder, one + "{id: time_delay, joints: [2, 1], delay: 0.01}");
  ASSERT_FALSE(bad.ok());
  EXPECT_NE(bad.status().message().find("effects[2]': time_delay acts on joint 1 already by effects[1]"),
            std::string::npos)
      << bad.status().message();
}

// The other recording has no flexible joint.
TEST(ScenarioEffects, AFlexibleJointOfOneRecordingLeavesTheOthers) {
  TempFolder folder;
  const Result<Scenario> scenario = Read(folder, "{id: backlash, joints: [2], gap: 0.01, recording: free}");
  ASSERT_TRUE(scenario.ok()) << scenario.status().message();
  Scenario bare = *scenario;
  bare.effects.clear();
  const auto changed = [&](int recording) {
    const ScenarioRecording& r = scenario->recordings[recording];
    return (SimulateTruth(*scenario, r).torque - SimulateTruth(bare, r).torque).cwiseAbs().maxCoeff();
  };
  EXPECT_GT(changed(0), 0.1);
  EXPECT_EQ(changed(1), 0.0);
}

// To first order in their sizes effects add up.
TEST(ScenarioEffects, TogetherAddUpWhereTheyAreSmall) {
  TempFolder folder;
  const std::vector<std::string> single = {"{id: power_viscous, joints: [1], coefficient: 0.05, exponent: 0.5}",
                                           "{id: joint_spring, joints: [1], stiffness: 0.1, rest: 0.1}",
                                           "{id: thermal_drift, joints: [1], viscous_share: -0.01, time_constant: 1}",
                                           "{id: base_tilt, angle_1: 0.01, angle_2: 0.01}",
                                           "{id: payload_change, M: 0.03, x: 0.1}",
                                           "{id: gain_saturation, joints: [1], loss: 0.01, signal: 1}",
                                           "{id: presliding, joints: [1], displacement: 0.001}",
                                           "{id: joint_elasticity, joints: [2], stiffness: 1e5}"};
  const auto signal = [&](const std::string& effects) {
    const Result<Scenario> scenario = Read(folder, effects);
    EXPECT_TRUE(scenario.ok()) << scenario.status().message();
    return SimulateTruth(*scenario, scenario->recordings[1]).signal;
  };
  const Eigen::MatrixXd bare = signal("{id: torque_ripple, joints: [1], amplitude: 0, order: 1}");
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(bare.rows(), 3);
  std::string together;
  for (const std::string& effect : single) {
    sum += signal(effect) - bare;
    together += (together.empty() ? "" : "\n  - ") + effect;
  }
  EXPECT_LT((signal(together) - bare - sum).norm(), 0.02 * sum.norm());
}

TEST(EffectSize, ShareIsThatOfTheSignalAndIsReachedByScaling) {
  TempFolder folder;
  for (const char* effect :
       {"{id: joint_spring, joints: [2], stiffness: 3}", "{id: payload_change, M: 0.5, x: 0.1}",
        "{id: time_delay, joints: [2], delay: 0.02}", "{id: joint_elasticity, joints: [2], stiffness: 5000}",
        "{id: presliding, joints: [3], displacement: 0.01}"}) {
    Result<Scenario> scenario = Read(folder, effect);
    ASSERT_TRUE(scenario.ok()) << scenario.status().message();
    const Status status = ScaleEffect(&*scenario, 0, 0.03);
    ASSERT_TRUE(status.ok()) << status.message();
    double changed = 0.0, all = 0.0, largest = 0.0;
    Scenario bare = *scenario;
    bare.effects.clear();
    for (int j = 0; j < 3; ++j) {
      changed = all = 0.0;
      for (const ScenarioRecording& r : scenario->recordings) {
        const Eigen::VectorXd without = SimulateTruth(bare, r).signal.col(j);
        changed += (SimulateTruth(*scenario, r).signal.col(j) - without).squaredNorm();
        all += without.squaredNorm();
      }
      largest = std::max(largest, std::sqrt(changed / all));
    }
    EXPECT_NEAR(largest, 0.03, 0.03 * 0.0201) << effect;
  }
  // Presliding can take no more than the Coulomb friction itself.
  Result<Scenario> scenario = Read(folder, "{id: presliding, joints: [3], displacement: 0.01}");
  ASSERT_TRUE(scenario.ok());
  EXPECT_EQ(ScaleEffect(&*scenario, 0, 5.0).code(), StatusCode::kUntrusted);
  EXPECT_EQ(scenario->effects[0].Value("displacement"), 0.01);
}

}  // namespace
}  // namespace idim::effects_scenario_test
