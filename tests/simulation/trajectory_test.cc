#include "core/simulation/trajectory.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace idim::trajectory_test {
namespace {

JointLimits TwoJointLimits() {
  JointLimits limits;
  limits.lower = Eigen::Vector2d(-3.0, -2.0);
  limits.upper = Eigen::Vector2d(3.0, 2.5);
  limits.velocity = Eigen::Vector2d(4.0, 5.0);
  limits.acceleration = Eigen::Vector2d(30.0, 40.0);
  limits.jerk = Eigen::Vector2d(600.0, 500.0);
  return limits;
}

PointToPointOptions RandomMotion() {
  PointToPointOptions options;
  options.limits = TwoJointLimits();
  options.random = 12;
  options.dwell = 0.05;
  options.speed_min = 0.3;
  options.seed = 5;
  return options;
}

std::unique_ptr<Trajectory> Make(const PointToPointOptions& options, int n = 2) {
  Result<std::unique_ptr<Trajectory>> made = MakePointToPoint(n, options);
  EXPECT_TRUE(made.ok()) << made.status().message();
  return std::move(made).value();
}

FourierOptions RandomSeries(double blend) {
  FourierOptions options;
  options.limits = TwoJointLimits();
  options.frequency = 0.2;
  options.duration = 10.0;
  options.blend = blend;
  options.harmonics = 4;
  options.seed = 3;
  return options;
}

std::unique_ptr<Trajectory> Make(const FourierOptions& options, int n = 2) {
  Result<std::unique_ptr<Trajectory>> made = MakeFourier(n, options);
  EXPECT_TRUE(made.ok()) << made.status().message();
  return std::move(made).value();
}

// Central differences of q and dq, exact to h^2/6 x jerk and, across a jump of the jerk, to h x jerk for ddq.
void ExpectDerivatives(const Trajectory& trajectory, double jerk) {
  constexpr double h = 1e-5;
  for (double t = 0.0; t < trajectory.duration(); t += 0.00317) {
    const JointState now = trajectory.At(t), before = trajectory.At(t - h), after = trajectory.At(t + h);
    EXPECT_LT(((after.q - before.q) / (2 * h) - now.dq).cwiseAbs().maxCoeff(), h * h * jerk + 1e-10) << t;
    EXPECT_LT(((after.dq - before.dq) / (2 * h) - now.ddq).cwiseAbs().maxCoeff(), h * jerk + 1e-9) << t;
  }
}

TEST(PointToPoint, DerivativesAreThoseOfThePosition) { ExpectDerivatives(*Make(RandomMotion()), 600.0); }

TEST(PointToPoint, KeepsItsLimitsAndItsAccelerationIsContinuous) {
  const PointToPointOptions options = RandomMotion();
  const auto trajectory = Make(options);
  constexpr double h = 1e-4;
  JointState last = trajectory->At(0.0);
  for (double t = h; t < trajectory->duration(); t += h) {
    const JointState now = trajectory->At(t);
    for (int j = 0; j < 2; ++j) {
      EXPECT_GE(now.q[j], options.limits.lower[j]);
      EXPECT_LE(now.q[j], options.limits.upper[j]);
      EXPECT_LE(std::abs(now.dq[j]), options.limits.velocity[j] * (1 + 1e-12));
      EXPECT_LE(std::abs(now.ddq[j]), options.limits.acceleration[j] * (1 + 1e-12));
      EXPECT_LE(std::abs(now.ddq[j] - last.ddq[j]), h * options.limits.jerk[j] * (1 + 1e-6));
    }
    last = now;
  }
}

struct Peaks {
  double velocity = 0.0, acceleration = 0.0, jerk = 0.0;
};

// One joint from 0 to `distance`.
Peaks PeaksOf(double distance, double velocity, double acceleration, double jerk, double* duration) {
  PointToPointOptions options;
  options.limits.velocity = Eigen::VectorXd::Constant(1, velocity);
  options.limits.acceleration = Eigen::VectorXd::Constant(1, acceleration);
  options.limits.jerk = Eigen::VectorXd::Constant(1, jerk);
  options.via = {Eigen::VectorXd::Zero(1), Eigen::VectorXd::Constant(1, distance)};
  const auto trajectory = Make(options, 1);
  *duration = trajectory->duration();
  Peaks peaks;
  const double h = *duration / 20000;
  for (int k = 0; k < 20000; ++k) {
    const JointState now = trajectory->At(k * h), next = trajectory->At((k + 1) * h);
    peaks.velocity = std::max(peaks.velocity, std::abs(now.dq[0]));
    peaks.acceleration = std::max(peaks.acceleration, std::abs(now.ddq[0]));
    peaks.jerk = std::max(peaks.jerk, std::abs(next.ddq[0] - now.ddq[0]) / h);
  }
  EXPECT_NEAR(trajectory->At(*duration).q[0], distance, 1e-12);
  EXPECT_EQ(trajectory->At(*duration).dq[0], 0.0);
  return peaks;
}

TEST(PointToPoint, ReachesEveryLimitThatTheDistanceAllows) {
  double duration = 0.0;
  // Long way: all three limits, and the textbook duration D/v + v/a + a/j.
  Peaks peaks = PeaksOf(10.0, 2.0, 10.0, 100.0, &duration);
  EXPECT_NEAR(duration, 10.0 / 2.0 + 2.0 / 10.0 + 10.0 / 100.0, 1e-12);
  EXPECT_NEAR(peaks.velocity, 2.0, 1e-9);
  EXPECT_NEAR(peaks.acceleration, 10.0, 1e-9);
  EXPECT_NEAR(peaks.jerk, 100.0, 1e-6);
  // Shorter: acceleration and jerk only. With flank f = a/j and phase p: a (p - f) p = D.
  peaks = PeaksOf(0.3, 2.0, 10.0, 100.0, &duration);
  EXPECT_NEAR(10.0 * (duration / 2 - 0.1) * duration / 2, 0.3, 1e-12);
  EXPECT_LT(peaks.velocity, 1.9);
  EXPECT_NEAR(peaks.acceleration, 10.0, 1e-9);
  // Very short: jerk only, four flanks f with 2 j f^3 = D.
  peaks = PeaksOf(0.01, 2.0, 10.0, 100.0, &duration);
  EXPECT_NEAR(2.0 * 100.0 * std::pow(duration / 4, 3), 0.01, 1e-12);
  EXPECT_LT(peaks.acceleration, 9.0);
  EXPECT_NEAR(peaks.jerk, 100.0, 1e-6);
  // Slow joint with much acceleration: velocity and jerk only, D/v + 2 sqrt(v/j).
  peaks = PeaksOf(10.0, 0.5, 10.0, 100.0, &duration);
  EXPECT_NEAR(duration, 10.0 / 0.5 + 2.0 * std::sqrt(0.5 / 100.0), 1e-12);
  EXPECT_NEAR(peaks.velocity, 0.5, 1e-9);
  EXPECT_LT(peaks.acceleration, 9.0);
}

TEST(PointToPoint, SpeedScalesTheVelocityLimitOnly) {
  PointToPointOptions options;
  options.limits = TwoJointLimits();
  options.via = {Eigen::Vector2d(-3.0, 0.0), Eigen::Vector2d(3.0, 0.0)};
  options.speed_min = options.speed_max = 0.4;
  const auto trajectory = Make(options);
  EXPECT_NEAR(trajectory->duration(), 6.0 / (0.4 * 4.0) + 0.4 * 4.0 / 30.0 + 30.0 / 600.0, 1e-12);
  EXPECT_NEAR(trajectory->At(trajectory->duration() / 2).dq[0], 0.4 * 4.0, 1e-12);
}

TEST(PointToPoint, SpeedsAreDrawnBetweenTheirBounds) {
  const auto duration = [](double speed_min, double speed_max) {
    PointToPointOptions options;
    options.limits = TwoJointLimits();
    for (int k = 0; k < 41; ++k) options.via.push_back(Eigen::Vector2d(k % 2 == 0 ? -3.0 : 3.0, 0.0));
    options.speed_min = speed_min;
    options.speed_max = speed_max;
    return Make(options)->duration();
  };
  const double fast = duration(1.0, 1.0), slow = duration(0.25, 0.25), mixed = duration(0.25, 1.0);
  // The mean of 1/s is (ln 4) / 0.75 = 1.85 between 1 and 4, its deviation over 40 motions 0.13.
  EXPECT_NEAR((mixed - fast) / (slow - fast), 0.85 / 3.0, 5.0 * 0.13 / 3.0);
}

TEST(PointToPoint, JointsAreSynchronisedAndStopAtEveryPoint) {
  PointToPointOptions options;
  options.limits = TwoJointLimits();
  const Eigen::Vector2d a(-1.0, 2.0), b(1.0, 1.5), c(1.0, -2.0);
  options.via = {a, b, b, c};
  options.dwell = 0.25;
  const auto trajectory = Make(options);
  EXPECT_EQ(trajectory->At(-1.0).q, a);
  EXPECT_EQ(trajectory->At(0.2).q, a);
  bool seen_b = false;
  for (double t = 0.25; t < trajectory->duration(); t += 0.001) {
    const JointState now = trajectory->At(t);
    if (now.q.isApprox(b, 1e-12)) seen_b = seen_b || now.dq.norm() == 0.0;
    if (seen_b) break;
    EXPECT_NEAR((now.q[0] - a[0]) / (b[0] - a[0]), (now.q[1] - a[1]) / (b[1] - a[1]), 1e-12);
  }
  EXPECT_TRUE(seen_b);
  EXPECT_TRUE(trajectory->At(trajectory->duration()).q.isApprox(c, 1e-14));
  EXPECT_EQ(trajectory->At(trajectory->duration() + 1.0).dq.norm(), 0.0);
}

TEST(PointToPoint, SeedDecides) {
  PointToPointOptions options = RandomMotion();
  const auto first = Make(options), again = Make(options);
  options.seed += 1;
  const auto other = Make(options);
  EXPECT_EQ(first->At(1.234).q, again->At(1.234).q);
  EXPECT_NE(first->At(1.234).q, other->At(1.234).q);
}

TEST(Fourier, DerivativesAreThoseOfThePosition) {
  ExpectDerivatives(*Make(RandomSeries(0.0)), 1000.0);
  ExpectDerivatives(*Make(RandomSeries(2.0)), 1000.0);
}

TEST(Fourier, FillsItsLimits) {
  for (double blend : {0.0, 2.0}) {
    const FourierOptions options = RandomSeries(blend);
    const auto trajectory = Make(options);
    Eigen::ArrayXd largest = Eigen::ArrayXd::Zero(2);
    for (double t = 0.0; t <= options.duration; t += 1e-4) {
      const JointState now = trajectory->At(t);
      const Eigen::ArrayXd middle = 0.5 * (options.limits.lower + options.limits.upper);
      const Eigen::ArrayXd half = 0.5 * (options.limits.upper - options.limits.lower);
      largest = largest.max((now.q.array() - middle).abs() / half)
                    .max(now.dq.array().abs() / options.limits.velocity.array())
                    .max(now.ddq.array().abs() / options.limits.acceleration.array());
    }
    for (int j = 0; j < 2; ++j) EXPECT_NEAR(largest[j], options.fill, 1e-3);
  }
}

TEST(Fourier, BlendStartsAndEndsAtRestAndWithoutItTheMotionIsPeriodic) {
  const auto blended = Make(RandomSeries(1.5));
  for (double t : {0.0, 10.0, -1.0, 11.0}) {
    EXPECT_LT(blended->At(t).dq.norm() + blended->At(t).ddq.norm(), 1e-12) << t;
  }
  EXPECT_GT(blended->At(5.0).dq.norm(), 0.01);
  const auto periodic = Make(RandomSeries(0.0));
  EXPECT_TRUE(periodic->At(1.7).q.isApprox(periodic->At(6.7).q, 1e-12));
}

TEST(Fourier, GivenCoefficients) {
  FourierOptions options;
  options.frequency = 0.5 / M_PI;  // w = 1
  options.duration = 3.0;
  options.centre = Eigen::VectorXd::Constant(1, 0.5);
  options.sine = Eigen::MatrixXd::Constant(1, 2, 0.0);
  options.sine(0, 1) = 2.0;
  options.cosine = Eigen::MatrixXd::Constant(1, 2, 0.0);
  options.cosine(0, 0) = 3.0;
  const auto trajectory = Make(options, 1);
  EXPECT_NEAR(trajectory->At(0.7).q[0], 0.5 + std::sin(1.4) - 3.0 * std::cos(0.7), 1e-14);
  EXPECT_NEAR(trajectory->At(0.7).dq[0], 2.0 * std::cos(1.4) + 3.0 * std::sin(0.7), 1e-14);
  EXPECT_NEAR(trajectory->At(0.7).ddq[0], -4.0 * std::sin(1.4) + 3.0 * std::cos(0.7), 1e-14);
  options.limits.velocity = Eigen::VectorXd::Constant(1, 2.0);
  const auto refused = MakeFourier(1, options);
  ASSERT_FALSE(refused.ok());
  EXPECT_NE(refused.status().message().find("velocity"), std::string::npos) << refused.status().message();
}

struct BadCase {
  const char* expected;
  void (*spoil)(PointToPointOptions*);
};

class BadPointToPoint : public ::testing::TestWithParam<BadCase> {};

TEST_P(BadPointToPoint, IsRefusedNamingTheField) {
  PointToPointOptions options = RandomMotion();
  GetParam().spoil(&options);
  const auto made = MakePointToPoint(2, options);
  ASSERT_FALSE(made.ok());
  EXPECT_EQ(made.status().code(), StatusCode::kBadInput);
  EXPECT_NE(made.status().message().find(GetParam().expected), std::string::npos) << made.status().message();
}

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

INSTANTIATE_TEST_SUITE_P(
    Table, BadPointToPoint,
    ::testing::Values(
        BadCase{"limits.velocity", [](PointToPointOptions* o) { o->limits.velocity.resize(0); }},
        BadCase{"limits.jerk[1] = 0", [](PointToPointOptions* o) { o->limits.jerk[1] = 0.0; }},
        BadCase{"limits.acceleration[0]", [](PointToPointOptions* o) { o->limits.acceleration[0] = kNan; }},
        BadCase{"limits.lower", [](PointToPointOptions* o) { o->limits.lower.resize(0); }},
        BadCase{"limits.lower[0]", [](PointToPointOptions* o) { o->limits.lower[0] = 4.0; }},
        BadCase{"at least 2", [](PointToPointOptions* o) { o->random = 1; }},
        BadCase{"dwell", [](PointToPointOptions* o) { o->dwell = -0.1; }},
        BadCase{"speed", [](PointToPointOptions* o) { o->speed_max = 1.1; }},
        BadCase{"via[0] has 3", [](PointToPointOptions* o) { o->via = {Eigen::Vector3d::Zero()}; }},
        BadCase{"via[0] puts joint 2", [](PointToPointOptions* o) { o->via = {Eigen::Vector2d(0.0, 2.6)}; }}));

}  // namespace
}  // namespace idim::trajectory_test
