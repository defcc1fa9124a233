// Effects that need the torque of the arm, against physics computed from all standard parameters, whose regrouping the
// effects see only the result of.

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <atomic>
#include <thread>

#include "core/base/decompositions.h"
#include "tests/effects/effect_arm.h"

namespace idim::testing::arm_effects_test {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

const EffectArm& Arm() {
  static const auto* const arm = new EffectArm(Tx40());
  return *arm;
}

// Largest difference over the inner instants, relative to the largest entry of the expected column.
double Deviation(const MatrixXd& column, const MatrixXd& expected, int edge) {
  const Eigen::Index inner = column.rows() - 2 * edge;
  return (column - expected).middleRows(edge, inner).cwiseAbs().maxCoeff() / expected.cwiseAbs().maxCoeff();
}

TEST(EffectMotionTest, TorquesAreThoseOfTheStandardParameters) {
  const EffectMotion motion = Arm().Motion(0.0, 0.02, 60, 3);
  EXPECT_EQ(motion.recording, 3);
  for (int i = 0; i < motion.t().size(); ++i) {
    const ArmState state = Arm().State(motion.t()[i]);
    const VectorXd torque = motion.torque.row(i), rigid = motion.rigid.row(i), link = motion.link.row(i);
    ASSERT_LT((torque - Arm().Torque(state)).norm(), 1e-9 * torque.norm());
    ASSERT_LT((rigid - Arm().Torque(state, FrictionStems())).norm(), 1e-9 * torque.norm());
    ASSERT_LT((link - Arm().Torque(state, {"Fv", "Fs", "off", "Ia"})).norm(), 1e-9 * torque.norm());
    const Vector3d& gravity = Arm().robot().gravity;
    ASSERT_EQ(rigid, motion.rigid_torque(state.q, state.dq, state.ddq, gravity));
    ASSERT_EQ(link, motion.link_torque(state.q, state.dq, state.ddq, gravity));
    // A body fixed to the last link: torque is linear in it.
    const InertialVector body = 0.3 * Arm().payload();
    const VectorXd with = Arm().Torque(Arm().robot(), state, Arm().payload() + body);
    ASSERT_LT((motion.body_columns(state.q, state.dq, state.ddq) * body - (with - Arm().Torque(state))).norm(),
              1e-9 * torque.norm());
  }
}

TEST(EffectMotionTest, AnyGravityOnAnArmThatGravityRegroupsNothingOf) {
  Random random(5);
  const EffectArm arm(RandomArm("RRPR", &random));
  const EffectMotion motion = arm.Motion(0.0, 0.05, 20);
  Robot turned = arm.robot();
  turned.gravity = Vector3d(3.0, -7.0, 4.0);
  for (int i = 0; i < motion.t().size(); ++i) {
    const ArmState state = arm.State(motion.t()[i]);
    const VectorXd expected = arm.Torque(turned, state, arm.payload(), FrictionStems());
    ASSERT_LT((motion.rigid_torque(state.q, state.dq, state.ddq, turned.gravity) - expected).norm(),
              1e-9 * expected.norm());
  }
}

// Long enough that without the lock two threads share a workspace, or the list of them breaks, in practice every time.
TEST(EffectMotionTest, ThreadsMayAskAtOnce) {
  const EffectMotion motion = Arm().Motion(0.0, 0.01, 400);
  std::atomic<int> wrong = 0, waiting = 4;
  std::vector<std::thread> threads;
  for (int k = 0; k < 4; ++k) {
    threads.emplace_back([&] {
      for (--waiting; waiting > 0;) std::this_thread::yield();
      for (int call = 0; call < 40000; ++call) {
        const int i = call % 400;
        const VectorXd rigid =
            motion.rigid_torque(motion.q().row(i), motion.dq().row(i), motion.ddq().row(i), motion.robot->gravity);
        wrong += rigid != VectorXd(motion.rigid.row(i));
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(wrong, 0);
}

// Base turned by +-0.01 rad: second-order terms cancel in half the difference, the third is 1e-4 / 6 of the column.
// On joint 1 the base parameters lack first moments, up to a cos q1 + b sin q1, which are fitted.
TEST(ArmEffectsTest, BaseTiltIsGravityTurned) {
  const EffectMotion motion = Arm().Motion(0.0, 0.02, 200);
  ASSERT_EQ(FindEffect("base_tilt")->Parameters(Arm().robot(), {}).size(), 4u);
  const double angle = 0.01;
  double largest_missing = 0.0;
  for (int axis = 0; axis < 2; ++axis) {
    const MatrixXd column = ColumnOf("base_tilt", motion, {}, {}, axis);
    MatrixXd expected(column.rows(), 6);
    for (int i = 0; i < motion.t().size(); ++i) {
      VectorXd side[2];
      for (const int s : {0, 1}) {
        Robot tilted = Arm().robot();
        const Eigen::AngleAxisd turn(s == 0 ? -angle : angle, Vector3d::Unit(axis));
        tilted.gravity = turn * tilted.gravity;
        side[s] = Arm().Torque(tilted, Arm().State(motion.t()[i]), Arm().payload());
      }
      expected.row(i) = (side[1] - side[0]) / (2.0 * angle);
    }
    EXPECT_LT(Deviation(column.rightCols(5), expected.rightCols(5), 0), 1e-4) << axis;
    MatrixXd moments(column.rows(), 2);
    for (int k = 0; k < 2; ++k) moments.col(k) = ColumnOf("base_tilt", motion, {}, {}, 2 + k).col(0);
    for (int k = 0; k < 2; ++k) EXPECT_EQ(ColumnOf("base_tilt", motion, {}, {}, 2 + k).rightCols(5).norm(), 0.0);
    const VectorXd missing = expected.col(0) - column.col(0);
    const VectorXd fit = moments.colPivHouseholderQr().solve(missing);
    EXPECT_LT((missing - moments * fit).cwiseAbs().maxCoeff(), 1e-4 * expected.col(0).cwiseAbs().maxCoeff());
    largest_missing = std::max(largest_missing, missing.norm() / expected.col(0).norm());
  }
  EXPECT_GT(largest_missing, 0.05);  // else the two columns more would not have been needed
}

TEST(ArmEffectsTest, TiltAxesAreThoseAcrossGravity) {
  Robot robot = Tx40();
  robot.gravity = Vector3d(9.81, 0.0, 0.0);  // on a wall: axis 1 is not along gravity
  const std::vector<Parameter> parameters = FindEffect("base_tilt")->Parameters(robot, {});
  ASSERT_EQ(parameters.size(), 2u);
  EXPECT_EQ(parameters[0].name, "tiltY");
  EXPECT_EQ(parameters[1].name, "tiltZ");
}

TEST(ArmEffectsTest, PayloadChangeIsABodyFromItsInstantOn) {
  const EffectMotion motion = Arm().Motion(5.0, 0.01, 101, 2);  // 1 s
  InertialVector body = InertialVector::Zero();
  body.segment<4>(kMX) << 0.1, -0.2, 0.3, 1.7;
  for (const double fraction : {0.0, 0.25}) {
    MatrixXd column = MatrixXd::Zero(101, 6);
    for (int k = 0; k < 4; ++k) column += body[kMX + k] * ColumnOf("payload_change", motion, {}, {2.0 + fraction}, k);
    for (int i = 0; i < 101; ++i) {
      const ArmState state = Arm().State(motion.t()[i]);
      const VectorXd torque = Arm().Torque(state);
      VectorXd change = Arm().Torque(Arm().robot(), state, Arm().payload() + body) - torque;
      if (motion.t()[i] < 5.0 + fraction - 1e-9) change.setZero();
      ASSERT_LT((column.row(i).transpose() - change).norm(), 1e-9 * torque.norm()) << i;
    }
  }
  for (const double elsewhere : {1.25, 3.0}) {
    EXPECT_TRUE(FindEffect("payload_change")->Columns(motion, {}, VectorXd::Constant(1, elsewhere)).empty());
  }
}

// Without Coulomb friction, whose step no derivative holds. Central differences over 1 ms of motions below 5 rad/s (and
// their products up to four of them: 20 rad/s): (20e-3)^2 / 6 = 7e-5.
TEST(ArmEffectsTest, TimeDelayIsTheTorqueOfAnEarlierInstant) {
  const EffectArm arm(Tx40(), 0.0);
  const EffectMotion motion = arm.Motion(0.0, 0.001, 800);
  const double delay = 1e-5;
  MatrixXd expected(800, 6), column(800, 6);
  for (int i = 0; i < 800; ++i) {
    const VectorXd late = arm.Torque(arm.State(motion.t()[i] - delay));
    expected.row(i) = (late - arm.Torque(arm.State(motion.t()[i]))) / delay;
  }
  for (int j = 0; j < 6; ++j) {
    const MatrixXd of_joint = ColumnOf("time_delay", motion, {j}, {});
    column.col(j) = of_joint.col(j);
    EXPECT_EQ(of_joint.norm(), of_joint.col(j).norm());
  }
  EXPECT_LT(Deviation(column, expected, 1), 5e-4);
}

TEST(ArmEffectsTest, GainSaturationIsTheCubeOfTheTorque) {
  const EffectMotion motion = Arm().Motion(0.0, 0.02, 100);
  for (int j = 0; j < 6; ++j) {
    const MatrixXd column = ColumnOf("gain_saturation", motion, {j}, {});
    for (int i = 0; i < 100; ++i) {
      const double torque = Arm().Torque(Arm().State(motion.t()[i]))[j];
      ASSERT_NEAR(column(i, j), torque * torque * torque, 1e-8 * column.cwiseAbs().maxCoeff());
    }
    EXPECT_EQ(column.norm(), column.col(j).norm());
  }
}

// The arm whose link stands at q + p d(t) less that at q, over p; d from the standard parameters at any instant.
// d(torque of the transmission) -> displacement for p = 1.
template <typename Displacement>
MatrixXd MovedLink(const EffectMotion& motion, int joint, double p, double h, Displacement&& displacement) {
  const std::vector<std::string> without = {"Fv", "Fs", "off", "Ia"};
  const auto at = [&](double t) { return displacement(Arm().Torque(Arm().State(t), without)[joint]); };
  MatrixXd column(motion.t().size(), 6);
  for (int i = 0; i < motion.t().size(); ++i) {
    const double t = motion.t()[i], before = at(t - h), now = at(t), after = at(t + h);
    const ArmState motor = Arm().State(t);
    ArmState link = motor;
    link.q[joint] += p * now;
    link.dq[joint] += p * (after - before) / (2.0 * h);
    link.ddq[joint] += p * (after - 2.0 * now + before) / (h * h);
    column.row(i) = (Arm().Torque(link, without) - Arm().Torque(motor, without)) / p;
  }
  return column;
}

// 1e-6 rad/Nm; second order in p below 1e-4 of the column.
TEST(ArmEffectsTest, ElasticityMovesTheLinkAgainstItsTorque) {
  const EffectMotion motion = Arm().Motion(0.0, 0.001, 500);
  for (const int j : {1, 4}) {
    const MatrixXd expected = MovedLink(motion, j, 1e-6, 1e-3, [](double torque) { return -torque; });
    EXPECT_LT(Deviation(ColumnOf("joint_elasticity", motion, {j}, {}), expected, 2), 2e-3) << j;
  }
}

// The link between its flanks, integrated in steps of 40 us from the torque of the standard parameters. While it flies
// the transmission carries nothing: tau + b column = 0 in the row of the joint, to first order in b and to the error of
// where the sampled flight begins (half a sample of 1 ms in 50 ms: 1 % of the torque at the end of the flight). In
// contact the links stand off by -+b, statically.
TEST(ArmEffectsTest, BacklashLetsTheLinkFlyBetweenItsFlanks) {
  const std::vector<std::string> without = {"Fv", "Fs", "off", "Ia"};
  const double gap = 1e-3, h = 4e-5;
  const int j = 4, substeps = 25;
  const EffectMotion motion = Arm().Motion(0.0, 1e-3, 2000);
  const MatrixXd column = ColumnOf("backlash", motion, {j}, {gap});
  enum Phase { kContact, kFlight };
  std::vector<Phase> phases;
  VectorXd place(motion.t().size());
  double r = 0.0, speed = 0.0;
  for (int i = 0; i < motion.t().size(); ++i) {
    bool flown = false, touched = false;
    for (int k = 0; k < substeps; ++k) {
      const double t = motion.t()[i] + (k - 0.5 * substeps) * h;
      const double torque = Arm().Torque(Arm().State(t), without)[j];
      if (i == 0 && k == 0) r = torque > 0.0 ? -gap : gap;
      const bool pressed = torque > 0.0 ? r == -gap : r == gap;
      if (!pressed) {
        ArmState pushed = Arm().State(t);
        pushed.ddq[j] += 1.0;
        const double inertia = Arm().Torque(pushed, without)[j] - torque;
        speed -= h * torque / inertia;
        r = std::max(-gap, std::min(gap, r + h * speed));
      }
      if (std::abs(r) == gap) speed = 0.0;
      (pressed ? touched : flown) = true;
    }
    phases.push_back(flown ? kFlight : kContact);
    place[i] = r;
  }
  const double rms = motion.link.col(j).norm() / std::sqrt(2000.0);
  double largest = 0.0;
  int in_flight = 0, in_contact = 0;
  for (int i = 4; i + 4 < motion.t().size(); ++i) {
    if (std::count(phases.begin() + i - 4, phases.begin() + i + 5, phases[i]) != 9) continue;
    if (phases[i] == kFlight) {
      EXPECT_NEAR(motion.link(i, j) + gap * column(i, j), 0.0, 0.01 * rms) << i;
      largest = std::max(largest, std::abs(motion.link(i, j)));
      ++in_flight;
    } else {
      ArmState moved = Arm().State(motion.t()[i]);
      const double side = place[i] / gap;
      moved.q[j] += 1e-4 * side;
      const VectorXd change = (Arm().Torque(moved, without) - Arm().Torque(Arm().State(motion.t()[i]), without)) / 1e-4;
      ASSERT_LT((column.row(i).transpose() - change).norm(), 1e-3 * (1.0 + change.norm())) << i;
      ++in_contact;
    }
  }
  EXPECT_GT(in_flight, 50);
  EXPECT_GT(largest, 0.1 * rms);
  EXPECT_GT(in_contact, 500);
}

// The drive inertias of joints 3 to 6 stay at the motor: their columns do not appear in the torque moved.
TEST(ArmEffectsTest, DriveInertiaStaysAtTheMotor) {
  const EffectMotion motion = Arm().Motion(0.0, 0.01, 50);
  const VectorXd difference = motion.rigid.col(3) - motion.link.col(3);
  const double inertia = difference.dot(motion.ddq().col(3)) / motion.ddq().col(3).squaredNorm();
  EXPECT_GT(inertia, 0.04);
  EXPECT_LT((difference - inertia * motion.ddq().col(3)).norm(), 1e-9 * difference.norm());
}

}  // namespace
}  // namespace idim::testing::arm_effects_test
