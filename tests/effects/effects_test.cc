#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

#include "tests/effects/effect_arm.h"

namespace idim::testing::effects_test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using ::testing::Contains;
using ::testing::DoubleNear;
using ::testing::ElementsAre;

const EffectArm& Arm() {
  static const auto* const arm = new EffectArm(Tx40());
  return *arm;
}

const EffectMotion& Motion() {
  static const auto* const motion = new EffectMotion(Arm().Motion(3.0, 0.002, 1500));
  return *motion;
}

VectorXd FirstShape(const Effect& effect, const std::vector<EffectMotion>& motions, const std::vector<int>& joints) {
  const std::vector<ShapeParameter> shapes = effect.Shapes(motions, joints);
  VectorXd values(shapes.size());
  for (size_t s = 0; s < shapes.size(); ++s) values[s] = shapes[s].grid[shapes[s].grid.size() / 2];
  return values;
}

// The smooth sign, written out.
double Sign(double dq, double sigma) { return std::erf(dq / (std::sqrt(2.0) * sigma)); }

TEST(EffectsTest, RegistryHoldsTheContractInItsOrder) {
  std::vector<std::string> ids;
  for (const Effect* effect : AllEffects()) {
    ids.push_back(effect->id());
    EXPECT_EQ(FindEffect(effect->id()), effect);
    for (const std::string& line : {effect->physics(), effect->how_to_confirm()}) {
      EXPECT_GT(line.size(), 40u) << effect->id();
      EXPECT_EQ(line.find('\n'), std::string::npos) << effect->id();
      EXPECT_EQ(line.back(), '.') << effect->id();
    }
  }
  EXPECT_THAT(ids, ElementsAre("viscous", "coulomb", "offset", "stribeck", "power_viscous", "asymmetric_friction",
                               "load_friction", "presliding", "thermal_drift", "torque_ripple", "joint_spring",
                               "motor_coupling", "base_tilt", "payload_change", "time_delay", "gain_saturation",
                               "joint_elasticity", "backlash"));
  EXPECT_EQ(FindEffect("no_such_effect"), nullptr);
}

TEST(EffectsTest, ParameterNamesAreUniqueOverEffectsJointsAndTheModel) {
  std::set<std::string> names;
  const std::set<std::string> declared = {"viscous", "coulomb", "offset"};
  for (const Parameter& parameter : Arm().model().parameters()) names.insert(parameter.name);
  for (const Parameter& parameter : Arm().base().parameters()) names.insert(parameter.name);
  for (const Effect* effect : AllEffects()) {
    for (const std::vector<int>& joints : SitesOf(*effect, 6)) {
      for (const Parameter& parameter : effect->Parameters(Arm().robot(), joints)) {
        EXPECT_EQ(parameter.kind, ParameterKind::kEffect);
        EXPECT_EQ(parameter.joint, joints.empty() ? 0 : joints[0] + 1) << parameter.name;
        EXPECT_FALSE(parameter.unit.empty()) << parameter.name;
        EXPECT_EQ(names.insert(parameter.name).second, declared.count(effect->id()) == 0) << parameter.name;
      }
    }
  }
}

TEST(EffectsTest, EntriesAreWellFormedAndLargeForAMovingArmFiniteForOneAtRest) {
  EffectMotion still = Arm().Motion(0.0, 0.002, 50);
  {
    JointStates states;
    states.t = still.t();
    states.q = still.q().row(0).replicate(50, 1);
    states.dq = states.ddq = MatrixXd::Zero(50, 6);
    still = MakeEffectMotion(Arm().base(), std::make_shared<const JointStates>(states), 0, VectorXd::Zero(6),
                             VectorXd::Ones(Arm().base().size()), InertialVector::Zero());
  }
  for (const EffectMotion* motion : {&Motion(), static_cast<const EffectMotion*>(&still)}) {
    const std::vector<EffectMotion> motions = {*motion};
    for (const Effect* effect : AllEffects()) {
      for (const std::vector<int>& joints : SitesOf(*effect, 6)) {
        const size_t count = effect->Parameters(Arm().robot(), joints).size();
        VectorXd power = VectorXd::Zero(count);
        for (const EffectEntry& entry : effect->Columns(*motion, joints, FirstShape(*effect, motions, joints))) {
          ASSERT_GE(entry.parameter, 0);
          ASSERT_LT(entry.parameter, static_cast<int>(count)) << effect->id();
          ASSERT_GE(entry.joint, 0);
          ASSERT_LT(entry.joint, 6);
          ASSERT_EQ(entry.torque.size(), motion->t().size()) << effect->id();
          EXPECT_TRUE(entry.torque.allFinite()) << effect->id();
          power[entry.parameter] += entry.torque.squaredNorm();
        }
        if (motion == &Motion()) {
          EXPECT_GT(power.minCoeff(), 0.0) << effect->id();
        }
      }
    }
  }
}

TEST(EffectsTest, ShapeGridsIncreaseWithinTheirLimits) {
  Robot robot = Tx40();
  robot.transmission = VectorXd::Constant(6, 32.0).asDiagonal();
  robot.joints[3].type = JointType::kPrismatic;
  const EffectArm arm(robot);
  const std::vector<EffectMotion> motions = {arm.Motion(0.0, 0.002, 1000, 0), arm.Motion(9.0, 0.002, 1500, 2)};
  for (const Effect* effect : AllEffects()) {
    for (const std::vector<int>& joints : SitesOf(*effect, 6)) {
      for (const ShapeParameter& shape : effect->Shapes(motions, joints)) {
        ASSERT_FALSE(shape.grid.empty()) << effect->id();
        EXPECT_FALSE(shape.name.empty());
        EXPECT_FALSE(shape.unit.empty());
        EXPECT_LT(shape.lower, shape.upper) << effect->id();
        EXPECT_GE(shape.grid.front(), shape.lower) << effect->id();
        EXPECT_LE(shape.grid.back(), shape.upper) << effect->id();
        for (size_t k = 1; k < shape.grid.size(); ++k) EXPECT_LT(shape.grid[k - 1], shape.grid[k]) << effect->id();
        for (const double value : shape.grid) EXPECT_EQ(shape.Within(value, value), value) << effect->id();
      }
    }
  }
  const auto grid = [&](const std::string& id, const std::vector<int>& joints) {
    return FindEffect(id)->Shapes(motions, joints)[0].grid;
  };
  const auto extreme = [&](auto&& value) { return std::max(value(motions[0]), value(motions[1])); };
  const double speed = extreme([](const EffectMotion& m) { return m.dq().col(1).cwiseAbs().maxCoeff(); });
  EXPECT_NEAR(grid("stribeck", {1}).front(), 2.0 * arm.sigma()[1], 1e-12);
  EXPECT_NEAR(grid("stribeck", {1}).back(), 0.5 * speed, 1e-12);
  EXPECT_NEAR(grid("thermal_drift", {1}).front(), 0.1 * 2.998, 1e-9);
  EXPECT_NEAR(grid("thermal_drift", {1}).back(), 3.0 * 2.998, 1e-9);
  for (const double a : grid("power_viscous", {1})) EXPECT_GT(std::abs(a - 1.0), 0.05);
  const std::vector<double> instants = grid("payload_change", {});
  EXPECT_EQ(instants.size(), 16u);
  EXPECT_THAT(instants, Contains(0.0));
  EXPECT_THAT(instants, Contains(2.0));
  EXPECT_THAT(instants, Contains(2.875));

  const double range = extreme([](const EffectMotion& m) { return m.q().col(1).maxCoeff(); }) +
                       extreme([](const EffectMotion& m) { return -m.q().col(1).minCoeff(); });
  const std::vector<double> orders = grid("torque_ripple", {1});
  EXPECT_NEAR(orders.front() * range, 2.0 * 2.0 * M_PI, 1e-9);
  for (size_t k = 1; k < orders.size(); ++k) EXPECT_LE(orders[k] - orders[k - 1], 0.5 * M_PI / range + 1e-9);
  EXPECT_LT(orders.back() * speed, M_PI * 500.0);
  EXPECT_GT(orders.back(), 0.99 * std::min(300.0, M_PI * 500.0 / speed));
  // A slow clock ends the grid at the order that would alias at the largest speed, transmission or not.
  const std::vector<EffectMotion> slow = {arm.Motion(0.0, 0.025, 100)};
  const std::vector<double> few = FindEffect("torque_ripple")->Shapes(slow, {1})[0].grid;
  const double slow_speed = slow[0].dq().col(1).cwiseAbs().maxCoeff();
  EXPECT_NEAR(few.back(), M_PI * 40.0 / slow_speed, 1e-6 * few.back());
  EXPECT_GT(32.0 * 4.0, few.back());
  for (const double multiple : {1.0, 2.0, 4.0}) EXPECT_THAT(orders, Contains(DoubleNear(32.0 * multiple, 1e-9)));
}

TEST(ShapeParameterTest, StopsAtItsLimitsAndBeforeItsGap) {
  const ShapeParameter shape = {"a", "1", 0.1, 2.5, {0.5, 2.0}, 0.8, 1.25};
  EXPECT_EQ(shape.Within(0.5, 0.7), 0.7);
  EXPECT_EQ(shape.Within(0.5, -1.0), 0.1);
  EXPECT_EQ(shape.Within(0.5, 2.0), 0.8);
  EXPECT_EQ(shape.Within(0.8, 1.0), 0.8);
  EXPECT_EQ(shape.Within(1.25, 0.5), 1.25);
  EXPECT_EQ(shape.Within(2.0, 3.0), 2.5);
  const ShapeParameter plain = {"k", "1", 1.0, 9.0, {3.0}};
  EXPECT_EQ(plain.Within(3.0, 7.0), 7.0);
  EXPECT_EQ(plain.Within(3.0, 0.0), 1.0);
}

TEST(EffectsTest, DeclaredFrictionIsThatOfTheStandardModel) {
  StandardModel model(Tx40(), FrictionModel());
  std::vector<double> w(6 * model.columns());
  const char* const ids[] = {"viscous", "coulomb", "offset"};
  const char* const stems[] = {"Fv", "Fs", "off"};
  for (int j = 0; j < 6; ++j) {
    for (int e = 0; e < 3; ++e) {
      const MatrixXd column = ColumnOf(ids[e], Motion(), {j}, {});
      const int index = model.Find(stems[e] + std::to_string(j + 1));
      const Parameter parameter = FindEffect(ids[e])->Parameters(Arm().robot(), {j})[0];
      EXPECT_EQ(parameter.name, model.parameters()[index].name);
      EXPECT_EQ(parameter.unit, model.parameters()[index].unit);
      for (int i = 0; i < Motion().t().size(); ++i) {
        const VectorXd q = Motion().q().row(i), dq = Motion().dq().row(i), ddq = Motion().ddq().row(i);
        model.Regressor(q.data(), dq.data(), ddq.data(), Arm().sigma().data(), w.data());
        for (int row = 0; row < 6; ++row) ASSERT_EQ(column(i, row), w[row * model.columns() + index]) << ids[e];
      }
    }
  }
}

TEST(EffectsTest, FrictionColumnsFollowTheirFormulas) {
  const EffectMotion& motion = Motion();
  for (const int j : {0, 4}) {
    const MatrixXd stribeck = ColumnOf("stribeck", motion, {j}, {0.3});
    const MatrixXd power = ColumnOf("power_viscous", motion, {j}, {0.4});
    const MatrixXd viscous = ColumnOf("asymmetric_friction", motion, {j}, {}, 0);
    const MatrixXd dry = ColumnOf("asymmetric_friction", motion, {j}, {}, 1);
    const MatrixXd load = ColumnOf("load_friction", motion, {j}, {});
    const MatrixXd warm_viscous = ColumnOf("thermal_drift", motion, {j}, {1.7}, 0);
    const MatrixXd warm_dry = ColumnOf("thermal_drift", motion, {j}, {1.7}, 1);
    for (int i = 0; i < motion.t().size(); ++i) {
      const ArmState state = Arm().State(motion.t()[i]);
      const double dq = state.dq[j], sign = Sign(dq, Arm().sigma()[j]);
      const double warm = 1.0 - std::exp(-(motion.t()[i] - 3.0) / 1.7);
      ASSERT_NEAR(stribeck(i, j), sign * std::exp(-dq * dq / 0.09), 1e-8);
      ASSERT_NEAR(power(i, j), sign * std::pow(std::abs(dq), 0.4), 1e-8);
      ASSERT_NEAR(viscous(i, j), std::abs(dq), 1e-12);
      ASSERT_NEAR(dry(i, j), std::abs(sign), 1e-8);
      ASSERT_NEAR(load(i, j), sign * std::abs(Arm().Torque(state, FrictionStems())[j]), 1e-6);
      ASSERT_NEAR(warm_viscous(i, j), dq * warm, 1e-9);
      ASSERT_NEAR(warm_dry(i, j), sign * warm, 1e-8);
    }
    for (const MatrixXd* column : {&stribeck, &power, &viscous, &dry, &load, &warm_viscous, &warm_dry}) {
      EXPECT_EQ(column->norm(), column->col(j).norm());  // no other joint is loaded
    }
  }
}

// dz/dt = (sign(dq) - z) |dq| / x_s in 400 Euler steps a sample: its own error is about dq dt / (800 x_s) = 1e-4.
TEST(EffectsTest, PreslidingIsTheDahlModelIntegratedInTime) {
  const EffectMotion& motion = Motion();
  const int j = 2, substeps = 400;
  const double xs = 0.02;
  const MatrixXd column = ColumnOf("presliding", motion, {j}, {xs});
  double z = motion.dq()(0, j) > 0.0 ? 1.0 : -1.0;
  ASSERT_GT(std::abs(motion.dq()(0, j)), 6.0 * Arm().sigma()[j]);  // it comes slipping
  for (int i = 0; i + 1 < motion.t().size(); ++i) {
    ASSERT_NEAR(column(i, j), z, 2e-3) << i;
    const double h = (motion.t()[i + 1] - motion.t()[i]) / substeps;
    for (int k = 0; k < substeps; ++k) {
      // Only this joint's speed, by Hermite's cubic between the samples: the states of all joints cost more.
      const double s = (k + 0.5) / substeps, d = motion.t()[i + 1] - motion.t()[i];
      const double dq = (6.0 * s * s - 6.0 * s) * (motion.q()(i, j) - motion.q()(i + 1, j)) / d +
                        (3.0 * s * s - 4.0 * s + 1.0) * motion.dq()(i, j) +
                        (3.0 * s * s - 2.0 * s) * motion.dq()(i + 1, j);
      z += h * ((dq > 0.0) - (dq < 0.0) - z) * std::abs(dq) / xs;
    }
  }
  // It has turned at least twice, else there is no hysteresis to see.
  int reversals = 0;
  for (int i = 1; i < motion.t().size(); ++i) reversals += motion.dq()(i, j) * motion.dq()(i - 1, j) < 0.0;
  EXPECT_GE(reversals, 2);
}

// After a slide of 10 x_s the joint rests for 20 000 noisy samples, whose path length is 20 x_s: without play z is
// forgotten, with it z stays (the largest of 20 000 normal deviates is about 4 sigma, so that the follower creeps by
// one or two sigma, 1 % of x_s).
TEST(EffectsTest, PreslidingDoesNotForgetAtRestBecauseOfEncoderNoise) {
  const double xs = 1e-3, sigma = 1e-6 * std::sqrt(M_PI) / 2.0;
  std::mt19937_64 generator(1);
  std::normal_distribution<double> normal(0.0, sigma);
  const int slide = 100, pause = 20000;
  const auto states = std::make_shared<JointStates>();
  EffectMotion motion;
  const Robot robot = Tx40();
  motion.robot = &robot;
  motion.states = states;
  states->t = VectorXd::LinSpaced(slide + pause, 0.0, 1.0);
  states->q = states->dq = MatrixXd::Zero(slide + pause, 6);
  motion.velocity_sigma = VectorXd::Zero(6);
  for (int i = 0; i < slide + pause; ++i) states->q(i, 0) = 1e-4 * std::min(i, slide) + normal(generator);
  const double worn = ColumnOf("presliding", motion, {0}, {xs})(slide + pause - 1, 0);
  motion.position_sigma = VectorXd::Constant(6, sigma);
  const double kept = ColumnOf("presliding", motion, {0}, {xs})(slide + pause - 1, 0);
  states->dq(0, 0) = 1.0;  // a start in motion is remembered until a slide of a few x_s
  EXPECT_NEAR(ColumnOf("presliding", motion, {0}, {1e3})(0, 0), 1.0, 1e-6);
  states->dq(0, 0) = -1.0;
  EXPECT_NEAR(ColumnOf("presliding", motion, {0}, {1e3})(0, 0), -1.0, 1e-6);
  EXPECT_LT(std::abs(worn), 0.1);
  EXPECT_GT(kept, 0.95);
}

TEST(EffectsTest, RippleSpringAndCouplingFollowTheirFormulas) {
  const EffectMotion& motion = Motion();
  const MatrixXd cosine = ColumnOf("torque_ripple", motion, {3}, {17.5}, 0);
  const MatrixXd sine = ColumnOf("torque_ripple", motion, {3}, {17.5}, 1);
  const MatrixXd spring = ColumnOf("joint_spring", motion, {3}, {});
  const MatrixXd inertia = ColumnOf("motor_coupling", motion, {1, 3}, {}, 0);
  const MatrixXd viscous = ColumnOf("motor_coupling", motion, {1, 3}, {}, 1);
  for (int i = 0; i < motion.t().size(); ++i) {
    const ArmState state = Arm().State(motion.t()[i]);
    ASSERT_NEAR(cosine(i, 3), std::cos(17.5 * state.q[3]), 1e-10);
    ASSERT_NEAR(sine(i, 3), std::sin(17.5 * state.q[3]), 1e-10);
    ASSERT_NEAR(spring(i, 3), state.q[3], 1e-12);
    ASSERT_NEAR(inertia(i, 1), state.ddq[3], 1e-10);
    ASSERT_NEAR(inertia(i, 3), state.ddq[1], 1e-10);
    ASSERT_NEAR(viscous(i, 1), state.dq[3], 1e-10);
    ASSERT_NEAR(viscous(i, 3), state.dq[1], 1e-10);
  }
  // The pair 5-6 is the coupling that the TX-40 declares, whose columns StandardModel has.
  StandardModel model(Tx40(), FrictionModel());
  std::vector<double> w(6 * model.columns());
  const VectorXd q = motion.q().row(9), dq = motion.dq().row(9), ddq = motion.ddq().row(9);
  model.Regressor(q.data(), dq.data(), ddq.data(), Arm().sigma().data(), w.data());
  for (int row = 0; row < 6; ++row) {
    EXPECT_NEAR(ColumnOf("motor_coupling", motion, {4, 5}, {}, 0)(9, row),
                w[row * model.columns() + model.Find("Iam6")], 1e-12);
    EXPECT_NEAR(ColumnOf("motor_coupling", motion, {4, 5}, {}, 1)(9, row),
                w[row * model.columns() + model.Find("Fvm6")], 1e-12);
    EXPECT_NEAR(ColumnOf("motor_coupling", motion, {4, 5}, {}, 2)(9, row),
                w[row * model.columns() + model.Find("Fsm6")], 1e-12);
  }
  for (const MatrixXd* column : {&cosine, &sine, &spring}) EXPECT_EQ(column->norm(), column->col(3).norm());
}

TEST(EffectsTest, UnitsOfAPrismaticJoint) {
  Random random(3);
  const Robot robot = RandomArm("RP", &random);
  const auto unit = [&](const std::string& id, const std::vector<int>& joints, int parameter = 0) {
    return FindEffect(id)->Parameters(robot, joints)[parameter].unit;
  };
  EXPECT_EQ(unit("viscous", {1}), "N.s/m");
  EXPECT_EQ(unit("stribeck", {0}), "N.m");
  EXPECT_EQ(unit("stribeck", {1}), "N");
  EXPECT_EQ(unit("power_viscous", {1}), "N.(s/m)^a");
  EXPECT_EQ(unit("thermal_drift", {1}), "N.s/m");
  EXPECT_EQ(unit("joint_spring", {1}), "N/m");
  EXPECT_EQ(unit("motor_coupling", {0, 1}, 0), "kg.m");
  EXPECT_EQ(unit("motor_coupling", {0, 1}, 1), "N.s/rad");
  EXPECT_EQ(unit("gain_saturation", {1}), "1/N^2");
  EXPECT_EQ(unit("joint_elasticity", {1}), "m/N");
  EXPECT_EQ(unit("backlash", {1}), "m");
}

}  // namespace
}  // namespace idim::testing::effects_test
