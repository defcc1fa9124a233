// Every simulated effect against a second route to the same physics: another robot, a closed form, an energy.

#include "core/effects/simulated_effects.h"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <cmath>

#include "core/base/decompositions.h"
#include "core/simulation/effects_truth.h"
#include "core/simulation/scenario.h"
#include "core/simulation/simulate_scenario.h"
#include "tests/support/given_effects.h"

namespace idim::simulated_effects_test {
namespace {

using testing::GivenEffect;
using testing::Simulated;

Robot ThreeJoints() {
  Robot robot;
  robot.joints = {JointFromModifiedDh(JointType::kRevolute, 0.0, 0.0, 0.3, 0.2),
                  JointFromModifiedDh(JointType::kRevolute, -1.2, 0.1, 0.4, 0.3),
                  JointFromModifiedDh(JointType::kRevolute, 0.7, 0.25, 0.0, 0.0)};
  robot.transmission = Eigen::Matrix3d::Identity();
  robot.transmission.diagonal() = Eigen::Vector3d(50.0, -80.0, 32.0);
  robot.transmission(2, 1) = 16.0;
  return robot;
}

std::shared_ptr<const Trajectory> Motion(double duration, std::uint64_t seed) {
  FourierOptions options;
  options.limits.lower = Eigen::Vector3d(-2, -1.5, -2);
  options.limits.upper = Eigen::Vector3d(2, 1.5, 2);
  options.limits.velocity = Eigen::Vector3d(3, 2, 4);
  options.limits.acceleration = Eigen::Vector3d(20, 15, 30);
  options.frequency = 0.5;
  options.duration = duration;
  options.seed = seed;
  return std::move(MakeFourier(3, options)).value();
}

void Set(Scenario* scenario, const std::string& name, double value) {
  const StandardModel model(scenario->robot, FrictionModel());
  ASSERT_GE(model.Find(name), 0) << name;
  scenario->chi[model.Find(name)] = value;
}

Scenario ThreeJointArm(const Robot& robot = ThreeJoints()) {
  Scenario s;
  s.robot = robot;
  const StandardModel model(robot, FrictionModel());
  s.chi.setZero(model.columns());
  const Eigen::Vector3d centres[] = {{0.02, 0.01, 0.1}, {0.15, -0.02, 0.03}, {0.01, 0.05, 0.12}};
  for (int j = 0; j < 3; ++j) {
    const InertialVector body =
        InertialFromCentreOfMass(6.0 - 1.5 * j, centres[j], (0.05 - 0.01 * j) * Eigen::Matrix3d::Identity());
    const std::string number = std::to_string(j + 1);
    for (int k = 0; k < kNumInertial; ++k) Set(&s, kStandardNames[k] + number, body[k]);
    Set(&s, "Ia" + number, 0.3 - 0.08 * j);
    Set(&s, "Fv" + number, 4.0 - j);
    Set(&s, "Fs" + number, 3.0 - 0.5 * j);
    Set(&s, "off" + number, 0.2 * j - 0.1);
  }
  s.gains = Eigen::Vector3d(3.0, -2.0, 0.5);
  s.truth.rate = 250.0;
  ScenarioRecording free, other;
  free.name = "free";
  free.trajectory = Motion(2.0, 11);
  other.name = "other";
  other.trajectory = Motion(1.0, 12);
  s.recordings = {free, other};
  return s;
}

Scenario With(Scenario scenario, const std::vector<GivenEffect>& effects) {
  scenario.effects = Simulated(effects);
  const Status status = CheckEffects(scenario);
  EXPECT_TRUE(status.ok()) << status.message();
  return scenario;
}

Truth Simulate(const Scenario& scenario, int recording = 0) {
  return SimulateTruth(scenario, scenario.recordings[recording]);
}

Eigen::MatrixXd Extra(const Scenario& scenario, const std::vector<GivenEffect>& effects, int recording = 0) {
  return Simulate(With(scenario, effects), recording).torque - Simulate(scenario, recording).torque;
}

double Largest(const Eigen::MatrixXd& m) { return m.cwiseAbs().maxCoeff(); }

// One of each id on joint 2 (of 1 and 2, of the arm), of a size that is seen.
std::vector<GivenEffect> OneOfEach() {
  return {{"stribeck", {1}, {{"Fst", 2.0}, {"vs", 0.3}}, ""},
          {"power_viscous", {1}, {{"coefficient", 3.0}, {"exponent", 0.5}}, ""},
          {"asymmetric_friction", {1}, {{"viscous_difference", 1.0}, {"coulomb_difference", 0.7}}, ""},
          {"load_friction", {1}, {{"mu", 0.1}}, ""},
          {"presliding", {1}, {{"displacement", 0.02}}, ""},
          {"thermal_drift", {1}, {{"viscous_share", -0.4}, {"coulomb_share", -0.2}, {"time_constant", 1.0}}, ""},
          {"torque_ripple", {1}, {{"amplitude", 1.0}, {"order", 12.0}, {"phase", 0.3}}, ""},
          {"joint_spring", {1}, {{"stiffness", 5.0}, {"rest", 0.2}}, ""},
          {"motor_coupling", {0, 1}, {{"inertia", 0.1}, {"viscous", 0.5}, {"coulomb", 0.3}}, ""},
          {"base_tilt", {}, {{"angle_1", 0.05}, {"angle_2", -0.03}}, ""},
          {"payload_change", {}, {{"M", 0.5}, {"z", 0.1}}, ""},
          {"time_delay", {1}, {{"delay", 0.003}}, ""},
          {"gain_saturation", {1}, {{"loss", 0.1}, {"signal", 10.0}}, ""},
          {"joint_elasticity", {1}, {{"stiffness", 3000.0}}, ""},
          {"backlash", {1}, {{"gap", 0.004}}, ""}};
}

TEST(SimulatedEffects, AreThoseOfTheContractAndEachChangesTheSignalOfItsJoint) {
  const std::vector<GivenEffect> all = OneOfEach();
  ASSERT_EQ(EffectEquations().size(), all.size());
  for (size_t k = 0; k < all.size(); ++k) {
    EXPECT_EQ(EffectEquations()[k]->id(), all[k].id);
    const Scenario scenario = With(ThreeJointArm(), {all[k]});
    EXPECT_GT(EffectShare(scenario, 0), 1e-3) << all[k].id;
    // Positions are logged as without it.
    EXPECT_EQ(Simulate(scenario).q, Simulate(ThreeJointArm()).q) << all[k].id;
  }
}

TEST(SimulatedEffects, OfSizeZeroLeaveTheTorque) {
  const Scenario bare = ThreeJointArm();
  for (GivenEffect effect : OneOfEach()) {
    if (effect.id == "presliding" || effect.id == "joint_elasticity" || effect.id == "backlash") continue;
    for (const EffectKey& key : Simulated(effect).equation->keys()) {
      if (key.size_power == 1 && effect.values.count(key.name) > 0) effect.values[key.name] = 0.0;
    }
    EXPECT_LT(Largest(Simulate(With(bare, {effect})).signal - Simulate(bare).signal), 1e-12) << effect.id;
  }
}

TEST(FrictionEffects, StribeckIsHalfWhereItsEquationSaysAndDissipates) {
  const Scenario bare = ThreeJointArm();
  const Truth truth = Simulate(bare);
  const Eigen::MatrixXd extra = Extra(bare, {{"stribeck", {2}, {{"Fst", 2.0}, {"vs", 0.5}}, ""}});
  const double half = 0.5 * std::sqrt(std::log(2.0));  // |dq| at which it is Fst / 2
  int slower = 0, faster = 0;
  for (int k = 0; k < truth.t.size(); ++k) {
    const double dq = truth.dq(k, 2), torque = extra(k, 2);
    EXPECT_GE(torque * dq, -1e-12);
    EXPECT_EQ(std::abs(torque) > 1.0, std::abs(dq) < half);
    ++(std::abs(dq) < half ? slower : faster);
  }
  EXPECT_GT(slower, 20);
  EXPECT_GT(faster, 20);
  EXPECT_LT(Largest(extra.leftCols(2)), 1e-12);
}

TEST(FrictionEffects, PowerLawOfExponentOneIsMoreViscousFriction) {
  Scenario other = ThreeJointArm();
  Set(&other, "Fv1", 4.0 + 1.5);
  const Scenario effect =
      With(ThreeJointArm(), {{"power_viscous", {0}, {{"coefficient", 1.5}, {"exponent", 1.0}}, ""}});
  EXPECT_LT(Largest(Simulate(effect).torque - Simulate(other).torque), 1e-12);
  // With the exponent one half its square is proportional to speed.
  const Eigen::MatrixXd root =
      Extra(ThreeJointArm(), {{"power_viscous", {0}, {{"coefficient", 1.5}, {"exponent", 0.5}}, ""}});
  const Truth truth = Simulate(ThreeJointArm());
  EXPECT_LT(Largest(root.col(0).cwiseAbs2() - 2.25 * truth.dq.col(0).cwiseAbs()), 1e-10);
  EXPECT_GE((root.col(0).array() * truth.dq.col(0).array()).minCoeff(), -1e-12);
}

TEST(FrictionEffects, AsymmetryIsOneFrictionForwardsAndAnotherBackwards) {
  Scenario forwards = ThreeJointArm(), backwards = ThreeJointArm();
  Set(&forwards, "Fv2", 3.0 + 0.4);
  Set(&forwards, "Fs2", 2.5 + 0.3);
  Set(&backwards, "Fv2", 3.0 - 0.4);
  Set(&backwards, "Fs2", 2.5 - 0.3);
  const Truth truth = Simulate(With(
      ThreeJointArm(), {{"asymmetric_friction", {1}, {{"viscous_difference", 0.8}, {"coulomb_difference", 0.6}}, ""}}));
  const Truth up = Simulate(forwards), down = Simulate(backwards);
  for (int k = 0; k < truth.t.size(); ++k) {
    EXPECT_NEAR(truth.torque(k, 1), (truth.dq(k, 1) > 0.0 ? up : down).torque(k, 1), 1e-12);
  }
}

TEST(FrictionEffects, LoadFrictionIsAShareOfTheTorqueOfAnArmWithoutFriction) {
  Scenario smooth = ThreeJointArm();
  for (const char* name : {"Fv1", "Fv2", "Fv3", "Fs1", "Fs2", "Fs3", "off1", "off2", "off3"}) Set(&smooth, name, 0.0);
  const Truth rigid = Simulate(smooth);
  const Eigen::MatrixXd extra = Extra(ThreeJointArm(), {{"load_friction", {1}, {{"mu", 0.2}}, ""}});
  EXPECT_LT(Largest(extra.col(1).cwiseAbs() - 0.2 * rigid.torque.col(1).cwiseAbs()), 1e-12);
  EXPECT_GE((extra.col(1).array() * rigid.dq.col(1).array()).minCoeff(), -1e-12);
}

TEST(FrictionEffects, WarmFrictionIsThatOfAnotherArm) {
  const Scenario cold = ThreeJointArm();
  Scenario warm = cold;
  Set(&warm, "Fv1", 4.0 * 0.6);
  Set(&warm, "Fs1", 3.0 * 0.9);
  const auto drift = [](double time) {
    return GivenEffect{
        "thermal_drift", {0}, {{"viscous_share", -0.4}, {"coulomb_share", -0.1}, {"time_constant", time}}, ""};
  };
  const Truth fast = Simulate(With(cold, {drift(0.01)}));
  const Truth slow = Simulate(With(cold, {drift(1e5)}));
  const Truth end = Simulate(warm), begin = Simulate(cold);
  EXPECT_LT(Largest((fast.torque - end.torque).bottomRows(400)), 1e-12);
  EXPECT_LT(Largest(slow.torque - begin.torque), 1e-3);
  // Halfway after time constant times log 2.
  const Truth half = Simulate(With(cold, {drift(1.0 / std::log(2.0))}));
  EXPECT_NEAR(half.torque(250, 0), 0.5 * (begin.torque(250, 0) + end.torque(250, 0)), 1e-12);
}

TEST(TorqueEffects, CouplingIsThatOfARobotWhichDeclaresIt) {
  Robot coupled = ThreeJoints();
  coupled.couplings = {{2, {0, 2}, {1.0, 1.0}}};
  Scenario declared = ThreeJointArm(coupled);
  Set(&declared, "Iam3", 0.2);
  Set(&declared, "Fvm3", 0.6);
  Set(&declared, "Fsm3", 0.4);
  const Scenario effect =
      With(ThreeJointArm(), {{"motor_coupling", {0, 2}, {{"inertia", 0.2}, {"viscous", 0.6}, {"coulomb", 0.4}}, ""}});
  EXPECT_LT(Largest(Simulate(effect).torque - Simulate(declared).torque), 1e-12);
}

TEST(TorqueEffects, TiltIsARobotWithOtherGravity) {
  for (const bool first : {true, false}) {
    Robot tilted = ThreeJoints();
    // About x by 0.1, (0, 0, -1) becomes (0, sin, -cos); about y (-sin, 0, -cos).
    tilted.gravity = 9.81 * (first ? Eigen::Vector3d(0.0, std::sin(0.1), -std::cos(0.1))
                                   : Eigen::Vector3d(-std::sin(0.1), 0.0, -std::cos(0.1)));
    const Scenario effect = With(ThreeJointArm(), {{"base_tilt", {}, {{first ? "angle_1" : "angle_2", 0.1}}, ""}});
    EXPECT_LT(Largest(Simulate(effect).torque - Simulate(ThreeJointArm(tilted)).torque), 1e-12);
  }
}

TEST(TorqueEffects, PayloadChangeIsADeclaredPayloadFromItsInstantOnInItsRecording) {
  Scenario declared = ThreeJointArm();
  const Eigen::Vector3d centre(0.02, -0.05, 0.1);
  ScenarioPayload payload;
  payload.inertial = InertialFromCentreOfMass(0.7, centre, Eigen::Matrix3d::Zero());
  declared.payloads = {payload};
  declared.recordings[0].payload = 0;
  const Scenario effect =
      With(ThreeJointArm(),
           {{"payload_change", {}, {{"M", 0.7}, {"x", 0.02}, {"y", -0.05}, {"z", 0.1}, {"from", 0.8}}, "free"}});
  const Truth with = Simulate(declared), without = Simulate(ThreeJointArm()), truth = Simulate(effect);
  EXPECT_LT(Largest((truth.torque - without.torque).topRows(200)), 1e-12);
  EXPECT_LT(Largest((truth.torque - with.torque).bottomRows(301)), 1e-12);
  EXPECT_GT(Largest((with.torque - without.torque).row(200)), 0.01);
  EXPECT_EQ(Simulate(effect, 1).torque, Simulate(ThreeJointArm(), 1).torque);
}

TEST(TorqueEffects, SpringDoesTheWorkOfItsEnergy) {
  const Truth truth = Simulate(ThreeJointArm());
  const Eigen::MatrixXd extra =
      Extra(ThreeJointArm(), {{"joint_spring", {1}, {{"stiffness", 8.0}, {"rest", 0.3}}, ""}});
  double work = 0.0;
  for (int k = 1; k < truth.t.size(); ++k) {
    work += 0.5 * (extra(k, 1) + extra(k - 1, 1)) * (truth.q(k, 1) - truth.q(k - 1, 1));
    EXPECT_NEAR(work, 4.0 * (std::pow(truth.q(k, 1) - 0.3, 2) - std::pow(truth.q(0, 1) - 0.3, 2)), 1e-9);
  }
}

// The spectrum over position has one line.
TEST(TorqueEffects, RippleHasOneLineInItsSpectrumOverPosition) {
  const Truth truth = Simulate(ThreeJointArm());
  for (const bool motor : {false, true}) {
    const Eigen::MatrixXd extra = Extra(
        ThreeJointArm(),
        {{"torque_ripple", {2}, {{"amplitude", 0.8}, {motor ? "motor_order" : "order", 2.0}, {"phase", 0.5}}, ""}});
    const Eigen::VectorXd position =
        motor ? Eigen::VectorXd(32.0 * truth.q.col(2) + 16.0 * truth.q.col(1)) : Eigen::VectorXd(truth.q.col(2));
    Eigen::MatrixXd lines(truth.t.size(), 6);
    for (int order = 1; order <= 3; ++order) {
      lines.col(2 * order - 2) = (order * position).array().cos();
      lines.col(2 * order - 1) = (order * position).array().sin();
    }
    const Eigen::VectorXd found = lines.colPivHouseholderQr().solve(extra.col(2));
    Eigen::VectorXd expected = Eigen::VectorXd::Zero(6);
    expected[2] = 0.8 * std::cos(0.5);
    expected[3] = -0.8 * std::sin(0.5);
    EXPECT_LT(Largest(found - expected), 1e-9);
  }
}

TEST(SignalEffects, DelayShiftsTheSignalAgainstPosition) {
  const Scenario bare = ThreeJointArm();
  for (const int shift : {3, -2}) {
    const Truth truth = Simulate(With(bare, {{"time_delay", {1}, {{"delay", shift / 250.0}}, ""}}));
    const Truth prompt = Simulate(bare);
    for (int k = 5; k < truth.t.size() - 5; ++k) {
      EXPECT_NEAR(truth.signal(k, 1), prompt.signal(k - shift, 1), 1e-9);
      EXPECT_NEAR(truth.signal(k, 0), prompt.signal(k, 0), 1e-12);
    }
    EXPECT_EQ(truth.q, prompt.q);
  }
}

TEST(SignalEffects, SaturatedGainStillDeliversTheTorque) {
  for (const Side side : {Side::kJoint, Side::kMotor}) {
    Scenario bare = ThreeJointArm();
    bare.truth.signal_side = side;
    const double reference = 0.5 * Largest(Simulate(bare).signal.col(1));
    const Truth truth = Simulate(With(bare, {{"gain_saturation", {1}, {{"loss", 0.3}, {"signal", reference}}, ""}}));
    Eigen::VectorXd v = truth.signal.col(1);
    EXPECT_GT(Largest(v), 1.2 * 2.0 * reference);
    const Eigen::ArrayXd delivered = v.array() * (1.0 + 0.9 * (v.array() / reference).square()).pow(-1.0 / 3.0);
    EXPECT_LT(Largest(delivered.matrix() - Simulate(bare).signal.col(1)), 1e-11 * reference);
  }
}

// To first order in compliance the links are where the torque of the rigid arm twists them to: q - tau / k, its
// velocity and acceleration by central differences. Mass coupling, weight and velocity terms of all joints are in it.
TEST(FlexibleEffects, LinksOfAStiffArmAreTwistedByTheTorqueOfTheRigidOne) {
  const Scenario bare = ThreeJointArm();
  const Eigen::Array3d stiffness(8e4, 6e4, 4e4);
  std::vector<GivenEffect> effects;
  for (int j = 0; j < 3; ++j) {
    effects.push_back({"joint_elasticity", {j}, {{"stiffness", stiffness[j]}, {"damping_ratio", 0.1}}, ""});
  }
  StandardModel model(bare.robot, FrictionModel());
  Eigen::VectorXd links = bare.chi;
  for (const Parameter& p : model.parameters()) {
    if (p.kind != ParameterKind::kBase) links[model.Find(p.name)] = 0.0;
  }
  const auto torque = [&](const Eigen::Vector3d& q, const Eigen::Vector3d& dq, const Eigen::Vector3d& ddq) {
    Eigen::Vector3d tau;
    model.Torque(q.data(), dq.data(), ddq.data(), nullptr, links, InertialVector::Zero(), tau.data());
    return tau;
  };
  const auto twist = [&](double t) {
    const JointState s = bare.recordings[0].trajectory->At(t);
    return Eigen::Vector3d(-(torque(s.q, s.dq, s.ddq).array() / stiffness).matrix());
  };
  const Truth truth = Simulate(bare);
  const Eigen::MatrixXd extra = Extra(bare, effects);
  Eigen::MatrixXd expected = extra;
  constexpr double h = 1e-4;
  for (int k = 0; k < truth.t.size(); ++k) {
    const Eigen::Vector3d q = truth.q.row(k), dq = truth.dq.row(k), ddq = truth.ddq.row(k);
    const double t = truth.t[k];
    const Eigen::Vector3d e = twist(t), after = twist(t + h), before = twist(t - h);
    expected.row(k) =
        torque(q + e, dq + (after - before) / (2 * h), ddq + (after - 2.0 * e + before) / (h * h)) - torque(q, dq, ddq);
  }
  for (int j = 0; j < 3; ++j) {
    EXPECT_LT((extra - expected).col(j).norm(), 0.05 * expected.col(j).norm()) << j;
    EXPECT_GT(expected.col(j).norm(), 0.0);
  }
}

// Drives move with the motor: their inertia and friction are as without elasticity.
TEST(FlexibleEffects, DrivesAreThoseOfTheRigidArm) {
  Scenario heavier = ThreeJointArm();
  Set(&heavier, "Ia2", 1.0);
  Set(&heavier, "Fv2", 9.0);
  const std::vector<GivenEffect> effect = {{"joint_elasticity", {1}, {{"stiffness", 2000.0}}, ""},
                                           {"backlash", {2}, {{"gap", 0.004}}, ""}};
  EXPECT_LT(Largest(Extra(heavier, effect) - Extra(ThreeJointArm(), effect)), 1e-9);
}

}  // namespace
}  // namespace idim::simulated_effects_test
