// Simulated effects with memory: presliding, elasticity, backlash, on one joint against closed forms.

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "core/simulation/effects_truth.h"
#include "core/simulation/scenario.h"
#include "core/simulation/simulate_scenario.h"
#include "tests/support/given_effects.h"

namespace idim::effects_memory_test {
namespace {

using testing::GivenEffect;
using testing::Simulated;

constexpr double kOmega = 2.0 * M_PI;  // [rad/s] of the sinusoids

// q = amplitude sin(omega t), for all times.
std::shared_ptr<const Trajectory> Sinusoid(double amplitude, double omega, double duration) {
  FourierOptions options;
  options.frequency = omega / (2.0 * M_PI);
  options.duration = duration;
  options.centre = Eigen::VectorXd::Zero(1);
  options.sine = Eigen::MatrixXd::Constant(1, 1, amplitude * omega);
  options.cosine = Eigen::MatrixXd::Zero(1, 1);
  return std::move(MakeFourier(1, options)).value();
}

// From 0 to `way` [rad], resting 0.5 s before and after.
std::shared_ptr<const Trajectory> OneMove(double way) {
  PointToPointOptions options;
  options.limits.velocity = Eigen::VectorXd::Constant(1, 1.0);
  options.limits.acceleration = Eigen::VectorXd::Constant(1, 10.0);
  options.limits.jerk = Eigen::VectorXd::Constant(1, 500.0);
  options.via = {Eigen::VectorXd::Zero(1), Eigen::VectorXd::Constant(1, way)};
  options.dwell = 0.5;
  return std::move(MakePointToPoint(1, options)).value();
}

constexpr double kInertia = 0.5, kMoment = 0.8;  // ZZ [kg m^2], MX [kg m]

// One link about z; its weight acts where gravity is normal to z.
Scenario OneJoint(std::shared_ptr<const Trajectory> trajectory, const Eigen::Vector3d& gravity, double coulomb) {
  Scenario s;
  s.robot.joints = {JointFromModifiedDh(JointType::kRevolute, 0.0, 0.0, 0.0, 0.0)};
  s.robot.transmission = Eigen::MatrixXd::Identity(1, 1);
  s.robot.gravity = gravity;
  const StandardModel model(s.robot, FrictionModel());
  s.chi.setZero(model.columns());
  s.chi[model.Find("ZZ1")] = kInertia;
  s.chi[model.Find("MX1")] = kMoment;
  s.chi[model.Find("Fs1")] = coulomb;
  s.gains = Eigen::VectorXd::Ones(1);
  s.truth.rate = 2000.0;
  s.recordings.resize(1);
  s.recordings[0].name = "a";
  s.recordings[0].trajectory = std::move(trajectory);
  return s;
}

const Eigen::Vector3d kNone(0.0, 0.0, -9.81), kAcross(0.0, -9.81, 0.0);

Truth Simulate(Scenario scenario, const std::vector<GivenEffect>& effects) {
  scenario.effects = Simulated(effects);
  const Status status = CheckEffects(scenario);
  EXPECT_TRUE(status.ok()) << status.message();
  return SimulateTruth(scenario, scenario.recordings[0]);
}

// In a cycle of amplitude A, y = 1 - (1 + Y) exp(-s / x) on the way s forwards and its mirror image backwards, with
// Y = tanh(A / x) so that it closes: the friction takes 4 Fs (A - x Y) a cycle.
TEST(Presliding, LosesTheEnergyOfItsHysteresisLoop) {
  constexpr double kFs = 2.0, kAmplitude = 0.05;
  for (const double x : {0.001, 0.02, 0.5}) {
    Scenario scenario = OneJoint(Sinusoid(kAmplitude, kOmega, 21.0), kNone, kFs);
    const Truth bristle = Simulate(scenario, {{"presliding", {0}, {{"displacement", x}}, ""}});
    scenario.chi[StandardModel(scenario.robot, FrictionModel()).Find("Fs1")] = 0.0;
    const Eigen::VectorXd friction = (bristle.torque - Simulate(scenario, {}).torque).col(0);
    const double tolerance = x == 0.5 ? 2e-2 : 1e-4;  // the cycle closes slowly where the way is short beside x
    double loss = 0.0;
    const Eigen::Index end = friction.size() - 1;
    for (Eigen::Index k = end - 2000; k < end; ++k) {
      loss += 0.5 * (friction[k] + friction[k + 1]) * (bristle.q(k + 1, 0) - bristle.q(k, 0));
    }
    const double expected = 4.0 * kFs * (kAmplitude - x * std::tanh(kAmplitude / x));
    EXPECT_NEAR(loss, expected, tolerance * expected + 2e-5 * 4.0 * kFs * kAmplitude) << x;
    EXPECT_LE(friction.cwiseAbs().maxCoeff(), kFs * (1.0 + 1e-12));
    // With x much below the way it is Coulomb friction at full speed, that is at q = 0.
    if (x == 0.001) {
      EXPECT_NEAR(friction[end - 2000], kFs, 1e-9);
    }
  }
}

TEST(Presliding, RemembersAtRestAndIsAStiffnessForASmallReturn) {
  constexpr double kFs = 2.0, x = 0.01;
  const Truth moved = Simulate(OneJoint(OneMove(0.5), kNone, kFs), {{"presliding", {0}, {{"displacement", x}}, ""}});
  EXPECT_EQ(moved.torque(0, 0), 0.0);                           // bristles at rest
  EXPECT_NEAR(moved.torque(moved.t.size() - 1, 0), kFs, 1e-9);  // still bent after the move: memory, not velocity
  EXPECT_EQ(moved.dq(moved.t.size() - 1, 0), 0.0);
  // From y = 0 over a way much smaller than x, torque = Fs / x way.
  const Truth small =
      Simulate(OneJoint(OneMove(1e-2 * x), kNone, kFs), {{"presliding", {0}, {{"displacement", x}}, ""}});
  EXPECT_NEAR(small.torque(small.t.size() - 1, 0), kFs * 1e-2, 1e-4 * kFs);
}

// Other dry friction of the joint bends the same bristle.
TEST(Presliding, CarriesStribeckFrictionToo) {
  const std::vector<GivenEffect> both = {{"stribeck", {0}, {{"Fst", 1.0}, {"vs", 0.1}}, ""},
                                         {"presliding", {0}, {{"displacement", 0.01}}, ""}};
  const Truth truth = Simulate(OneJoint(OneMove(0.5), kNone, 2.0), both);
  EXPECT_EQ(truth.torque(0, 0), 0.0);
  EXPECT_NEAR(truth.torque(truth.t.size() - 1, 0), 3.0, 1e-9);  // Fs + Fst at rest after motion
}

// Linear theory: the link answers the motor by (k + i w d) / (k - w^2 I + i w d).
TEST(Elasticity, AnswersASinusoidAsLinearTheorySays) {
  const double k = 800.0, w = 2.0 * kOmega, amplitude = 0.1;
  for (const double ratio : {0.1, 0.5}) {
    const Truth truth = Simulate(OneJoint(Sinusoid(amplitude, w, 4.0), kNone, 0.0),
                                 {{"joint_elasticity", {0}, {{"stiffness", k}, {"damping_ratio", ratio}}, ""}});
    const std::complex<double> spring(k, w * 2.0 * ratio * std::sqrt(k * kInertia));
    const std::complex<double> torque = amplitude * spring * (-w * w * kInertia) / (spring - w * w * kInertia);
    double largest = 0.0;
    for (Eigen::Index s = truth.t.size() - 2000; s < truth.t.size(); ++s) {
      const double expected = (torque * std::polar(1.0, w * truth.t[s])).imag();
      largest = std::max(largest, std::abs(truth.torque(s, 0) - expected));
    }
    // The transient has decayed by exp(-ratio 40 3.5) = 1e-6 or less.
    EXPECT_LT(largest, 1e-5 * std::abs(torque)) << ratio;
  }
}

TEST(Elasticity, OfAHangingLinkAtRestIsASpringUnderItsWeight) {
  const double k = 300.0;
  const Truth truth = Simulate(OneJoint(OneMove(0.5), kAcross, 0.0),
                               {{"joint_elasticity", {0}, {{"stiffness", k}, {"damping_ratio", 1.0}}, ""}});
  for (const Eigen::Index s : {Eigen::Index{0}, truth.t.size() - 1}) {
    const double tau = truth.torque(s, 0);
    const double twisted = 9.81 * kMoment * std::cos(truth.q(s, 0) - tau / k);
    EXPECT_NEAR(tau, twisted, s == 0 ? 1e-6 : 0.02);  // at the end half a second after the move
    EXPECT_GT(std::abs(tau - 9.81 * kMoment * std::cos(truth.q(s, 0))), s == 0 ? 1e-3 : 0.08);
  }
}

TEST(Elasticity, GoesToTheRigidArmAsOneOverStiffness) {
  const Scenario scenario = OneJoint(Sinusoid(0.3, kOmega, 1.0), kAcross, 1.0);
  const Truth rigid = Simulate(scenario, {});
  const auto error = [&](double k) {
    return (Simulate(scenario, {{"joint_elasticity", {0}, {{"stiffness", k}}, ""}}).torque - rigid.torque).norm();
  };
  const double soft = error(2e4), stiff = error(8e4);
  EXPECT_LT(stiff, 1e-3 * rigid.torque.norm());
  EXPECT_NEAR(soft / stiff, 4.0, 0.05);
}

TEST(Backlash, WithoutGapIsTheElasticContact) {
  const Scenario scenario = OneJoint(Sinusoid(0.3, kOmega, 0.5), kAcross, 1.0);
  const Truth closed =
      Simulate(scenario, {{"backlash", {0}, {{"gap", 0.0}, {"contact_frequency", 30.0}, {"damping_ratio", 0.3}}, ""}});
  const double stiffness = kInertia * std::pow(2.0 * M_PI * 30.0, 2);
  const Truth elastic =
      Simulate(scenario, {{"joint_elasticity", {0}, {{"stiffness", stiffness}, {"damping_ratio", 0.3}}, ""}});
  EXPECT_LT((closed.torque - elastic.torque).cwiseAbs().maxCoeff(), 1e-9);
}

// The link leans on one side of the gap under its weight.
TEST(Backlash, LeavesALoadedLinkBehindByHalfTheGap) {
  const double gap = 0.1, contact = 100.0;
  for (const double sign : {1.0, -1.0}) {
    const Truth truth = Simulate(OneJoint(OneMove(0.5), sign * kAcross, 0.0),
                                 {{"backlash", {0}, {{"gap", gap}, {"contact_frequency", contact}}, ""}});
    const double tau = truth.torque(0, 0);
    const double twist = sign * gap / 2.0 + tau / (kInertia * std::pow(2.0 * M_PI * contact, 2));
    EXPECT_NEAR(tau, sign * 9.81 * kMoment * std::cos(-twist), 1e-6);
    EXPECT_NEAR(tau, sign * 9.81 * kMoment * std::cos(0.05), 1e-4);
    EXPECT_NEAR(truth.torque(truth.t.size() - 1, 0), sign * 9.81 * kMoment * std::cos(0.5 - sign * gap / 2.0), 1e-2);
  }
}

// An unloaded link stays until the motor, then at constant speed v, has crossed half the gap. What the first contact
// gives it is that of a spring and damper which do not pull: I v (1 + e), e = exp(-2 z acos(z) / sqrt(1 - z^2)) with
// the damping ratio z.
TEST(Backlash, TransmitsNothingInTheGapAndTheMomentumOfAnImpact) {
  const double gap = 0.2;
  for (const double ratio : {0.05, 0.4}) {
    Scenario scenario = OneJoint(OneMove(1.0), kNone, 0.0);
    scenario.truth.rate = 20000.0;
    scenario.recordings[0].duration = 0.8;
    const Truth truth = Simulate(scenario, {{"backlash", {0}, {{"gap", gap}, {"damping_ratio", ratio}}, ""}});
    double impulse = 0.0, end = 0.0;
    for (Eigen::Index k = 1; k < truth.t.size(); ++k) {
      const double torque = truth.torque(k, 0);
      if (truth.q(k, 0) < gap / 2.0 - 1e-9) {
        EXPECT_NEAR(torque, 0.0, 1e-12);
      } else if (end == 0.0) {
        EXPECT_NEAR(truth.dq(k, 0), 1.0, 1e-12);
        impulse += torque / scenario.truth.rate;
        if (torque < 1e-9 && impulse > 0.1) end = truth.t[k];
      }
    }
    EXPECT_GT(end, 0.0);
    const double e = std::exp(-2.0 * ratio * std::acos(ratio) / std::sqrt(1.0 - ratio * ratio));
    EXPECT_NEAR(impulse, kInertia * (1.0 + e), 0.01 * kInertia) << ratio;
  }
}

TEST(Memory, HalfTheInternalStepChangesLittle) {
  const std::vector<GivenEffect> effects = {{"presliding", {0}, {{"displacement", 0.01}}, ""},
                                            {"joint_elasticity", {0}, {{"stiffness", 3000.0}}, ""},
                                            {"backlash", {0}, {{"gap", 0.01}}, ""}};
  for (const GivenEffect& effect : effects) {
    Scenario scenario = OneJoint(Sinusoid(0.3, kOmega, 2.0), kAcross, 1.0);
    const Truth bare = Simulate(scenario, {});
    const Truth whole = Simulate(scenario, {effect});
    scenario.effect_step /= 2.0;
    const Truth half = Simulate(scenario, {effect});
    EXPECT_LT((whole.torque - half.torque).norm(), 1e-3 * (whole.torque - bare.torque).norm()) << effect.id;
    EXPECT_GT((whole.torque - bare.torque).norm(), 0.0) << effect.id;
  }
}

// What is found at an instant does not depend on which others are asked for.
TEST(Memory, DoesNotDependOnTheRecordedRate) {
  Scenario scenario = OneJoint(Sinusoid(0.3, kOmega, 1.0), kAcross, 1.0);
  const std::vector<GivenEffect> effects = {{"presliding", {0}, {{"displacement", 0.01}}, ""},
                                            {"joint_elasticity", {0}, {{"stiffness", 3000.0}}, ""}};
  const Truth fast = Simulate(scenario, effects);
  scenario.truth.rate = 200.0;
  const Truth slow = Simulate(scenario, effects);
  for (Eigen::Index k = 0; k < slow.t.size(); ++k) EXPECT_EQ(slow.torque(k, 0), fast.torque(10 * k, 0));
}

}  // namespace
}  // namespace idim::effects_memory_test
