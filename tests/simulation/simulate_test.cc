#include "core/simulation/simulate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <cmath>

#include "core/base/random.h"

namespace idim::simulate_test {
namespace {

using RowMajorMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// Three joints, one of them prismatic, with a coupling of motor 3 to joints 2 and 3.
Robot TestRobot() {
  Robot robot;
  robot.joints = {JointFromModifiedDh(JointType::kRevolute, 0.0, 0.0, 0.3, 0.2),
                  JointFromModifiedDh(JointType::kPrismatic, -1.2, 0.1, 0.4, 0.3),
                  JointFromModifiedDh(JointType::kRevolute, 0.7, 0.25, 0.0, 0.0)};
  robot.transmission = Eigen::Matrix3d::Identity();
  robot.transmission.diagonal() = Eigen::Vector3d(50.0, -80.0, 32.0);
  robot.transmission(2, 1) = 16.0;
  Coupling coupling;
  coupling.motor = 2;
  coupling.joints = {1, 2};
  coupling.weights = {0.5, 1.0};
  robot.couplings = {coupling};
  return robot;
}

std::unique_ptr<Trajectory> TestTrajectory(double duration) {
  FourierOptions options;
  options.limits.lower = Eigen::Vector3d(-2, -0.5, -2);
  options.limits.upper = Eigen::Vector3d(2, 0.5, 2);
  options.limits.velocity = Eigen::Vector3d(3, 1, 4);
  options.limits.acceleration = Eigen::Vector3d(20, 5, 30);
  options.frequency = 0.25;
  options.duration = duration;
  options.seed = 11;
  return std::move(MakeFourier(3, options)).value();
}

struct TestArm {
  StandardModel model{TestRobot(), FrictionModel()};
  Eigen::VectorXd chi;
  InertialVector payload = InertialFromCentreOfMass(2.0, {0.02, -0.03, 0.1}, 0.01 * Eigen::Matrix3d::Identity());
  Eigen::VectorXd gains = Eigen::Vector3d(3.0, -2.0, 0.5);
  std::unique_ptr<Trajectory> trajectory;

  explicit TestArm(double duration) : trajectory(TestTrajectory(duration)) {
    Random random(4);
    chi.resize(model.columns());
    for (double& value : chi) value = random.Uniform(-1.0, 1.0);
  }

  Truth Simulate(const TruthOptions& options) {
    return SimulateTruth(&model, chi, payload, gains, *trajectory, options);
  }
};

TEST(SimulateTruth, TorqueIsRegressorTimesParametersAndTheStateIsTheTrajectorys) {
  TestArm arm(4.0);
  TruthOptions options;
  options.rate = 100.0;
  options.clock_jitter = 0.002;
  const Truth truth = arm.Simulate(options);
  ASSERT_EQ(truth.t.size(), 401);
  RowMajorMatrix w(3, arm.model.columns()), w_payload(3, kNumInertial);
  double jitter = 0.0;
  for (int k = 0; k < truth.t.size(); ++k) {
    const JointState state = arm.trajectory->At(truth.t[k]);
    EXPECT_EQ(Eigen::VectorXd(truth.q.row(k)), state.q);
    EXPECT_EQ(Eigen::VectorXd(truth.dq.row(k)), state.dq);
    EXPECT_EQ(Eigen::VectorXd(truth.ddq.row(k)), state.ddq);
    arm.model.Regressor(state.q.data(), state.dq.data(), state.ddq.data(), nullptr, w.data());
    arm.model.PayloadColumns(w_payload.data());
    const Eigen::VectorXd torque = w * arm.chi + w_payload * arm.payload;
    EXPECT_LT((torque - truth.torque.row(k).transpose()).norm(), 1e-12 * (1.0 + torque.norm()));
    EXPECT_NEAR(truth.t[k] * 1e6, std::round(truth.t[k] * 1e6), 1e-6);
    jitter = std::max(jitter, std::abs(truth.t[k] - k / options.rate));
  }
  EXPECT_LE(jitter, options.clock_jitter + kClockTick);
  EXPECT_GT(jitter, 0.9 * options.clock_jitter);
  EXPECT_GT((truth.t.tail(400) - truth.t.head(400)).minCoeff(), 0.0);
}

TEST(SimulateTruth, SignalGivesTheTorqueBackOnBothSides) {
  TestArm arm(2.0);
  TruthOptions options;
  const Truth joint = arm.Simulate(options);
  EXPECT_TRUE((joint.signal * arm.gains.asDiagonal()).isApprox(joint.torque, 1e-14));
  options.signal_side = Side::kMotor;
  const Truth motor = arm.Simulate(options);
  EXPECT_EQ(motor.torque, joint.torque);
  for (int k = 0; k < motor.t.size(); ++k) {
    const Eigen::VectorXd drives = arm.gains.cwiseProduct(motor.signal.row(k).transpose());
    const Eigen::VectorXd torque = arm.model.robot().transmission.transpose() * drives;
    EXPECT_TRUE(torque.isApprox(motor.torque.row(k).transpose(), 1e-12));
  }
}

// Power of the motors = rate of the arm's energy: with friction and offsets zero, the work along a closed motion
// (one period of the series) is zero; viscous friction alone takes the integral of Fv dq^2.
TEST(SimulateTruth, WorkOverAPeriodIsWhatFrictionTakes) {
  TestArm arm(4.0);
  double expected = 0.0;
  for (int c = 0; c < arm.model.columns(); ++c) {
    const std::string& name = arm.model.parameters()[c].name;
    if (name.rfind("Fs", 0) == 0 || name.rfind("off", 0) == 0 || name.rfind("Fvm", 0) == 0) arm.chi[c] = 0.0;
  }
  TruthOptions options;
  options.rate = 1000.0;
  const Truth truth = arm.Simulate(options);
  const int n = static_cast<int>(truth.t.size()) - 1;  // the last sample repeats the first
  for (int j = 0; j < 3; ++j) {
    const double fv = arm.chi[arm.model.Find("Fv" + std::to_string(j + 1))];
    expected += fv * truth.dq.col(j).head(n).squaredNorm() / options.rate;
  }
  // The trapezoidal rule is spectrally exact for a band-limited periodic integrand.
  const double work = (truth.torque.topRows(n).array() * truth.dq.topRows(n).array()).sum() / options.rate;
  const double traffic = (truth.torque.topRows(n).array() * truth.dq.topRows(n).array()).abs().sum() / options.rate;
  EXPECT_NEAR(work, expected, 1e-9 * traffic);
  EXPECT_GT(std::abs(expected), 0.01 * traffic);
}

class Noise : public ::testing::Test {
 protected:
  Noise() : arm_(80.0) {
    TruthOptions options;
    options.rate = 250.0;
    truth_ = arm_.Simulate(options);
  }

  // Errors that are white with the given standard deviation, free of each other. With N = 20001 each of the eleven
  // comparisons a call is 5 standard deviations wide: a false alarm in all calls together is rarer than 1e-4; an error
  // of 3 % in sigma is always seen.
  void ExpectWhite(const Eigen::MatrixXd& errors, const Eigen::VectorXd& sigma) const {
    const double n = static_cast<double>(errors.rows());
    for (int j = 0; j < errors.cols(); ++j) {
      const Eigen::VectorXd e = errors.col(j) / sigma[j];
      EXPECT_NEAR(e.mean(), 0.0, 5.0 / std::sqrt(n));
      EXPECT_NEAR(e.squaredNorm() / n, 1.0, 5.0 * std::sqrt(2.0 / n));
      EXPECT_NEAR(e.head(e.size() - 1).dot(e.tail(e.size() - 1)) / n, 0.0, 5.0 / std::sqrt(n));
      for (int i = 0; i < j; ++i) EXPECT_NEAR(e.dot(errors.col(i)) / sigma[i] / n, 0.0, 5.0 / std::sqrt(n));
    }
  }

  TestArm arm_;
  Truth truth_;
};

TEST_F(Noise, WithoutOptionsTheLogIsTheTruth) {
  const Recording log = AddNoise(truth_, arm_.model.robot(), NoiseOptions(), 1);
  EXPECT_EQ(log.t, truth_.t);
  EXPECT_EQ(log.q, truth_.q);
  EXPECT_EQ(log.signal, truth_.signal);
}

TEST_F(Noise, HasTheLevelsAskedFor) {
  NoiseOptions options;
  options.position = Eigen::Vector3d(1e-5, 3e-4, 2e-3);
  options.signal = Eigen::Vector3d(0.1, 0.0, 2.0);
  options.signal_percent = Eigen::Vector3d(5.0, 10.0, 0.0);
  const Recording log = AddNoise(truth_, arm_.model.robot(), options, 1);
  EXPECT_EQ(log.t, truth_.t);
  ExpectWhite(log.q - truth_.q, options.position);
  Eigen::VectorXd sigma(3);
  const auto rms = [&](int j) { return std::sqrt(truth_.signal.col(j).squaredNorm() / truth_.t.size()); };
  sigma << std::hypot(0.1, 0.05 * rms(0)), 0.1 * rms(1), 2.0;
  EXPECT_TRUE(AddedSignalNoise(truth_, options).isApprox(sigma, 1e-12));
  ExpectWhite(log.signal - truth_.signal, sigma);
  Eigen::MatrixXd both(truth_.t.size(), 2);  // position and signal noise are independent too
  both << (log.q - truth_.q).col(0), (log.signal - truth_.signal).col(0);
  ExpectWhite(both, Eigen::Vector2d(1e-5, sigma[0]));
}

TEST_F(Noise, QuantisationRoundsToTheNearestStep) {
  NoiseOptions options;
  options.position_step = Eigen::Vector3d(1e-4, 0.0, 3e-3);
  options.signal_step = Eigen::Vector3d(0.0, 0.01, 0.25);
  const Recording log = AddNoise(truth_, arm_.model.robot(), options, 1);
  const auto expect_steps = [](const Eigen::VectorXd& logged, const Eigen::VectorXd& truth, double step) {
    EXPECT_LE((logged - truth).cwiseAbs().maxCoeff(), step / 2 * (1 + 1e-9));
    const Eigen::ArrayXd steps = logged.array() / step;
    EXPECT_LT((steps - steps.round()).abs().maxCoeff(), 1e-6);
  };
  expect_steps(log.q.col(0), truth_.q.col(0), 1e-4);
  EXPECT_EQ(log.q.col(1), truth_.q.col(1));
  expect_steps(log.q.col(2), truth_.q.col(2), 3e-3);
  EXPECT_EQ(log.signal.col(0), truth_.signal.col(0));
  expect_steps(log.signal.col(1), truth_.signal.col(1), 0.01);
  expect_steps(log.signal.col(2), truth_.signal.col(2), 0.25);
}

TEST_F(Noise, EncodersOnTheMotorsCountMotorTurns) {
  NoiseOptions options;
  options.encoder_counts = Eigen::Vector3d(4096, 8192, 1000);
  const Eigen::MatrixXd& transmission = arm_.model.robot().transmission;
  const Recording log = AddNoise(truth_, arm_.model.robot(), options, 1);
  const Eigen::MatrixXd motor = log.q * transmission.transpose();
  const Eigen::MatrixXd exact = truth_.q * transmission.transpose();
  for (int m = 0; m < 3; ++m) {
    const double step = 2.0 * M_PI / options.encoder_counts[m];
    const Eigen::ArrayXd counts = motor.col(m).array() / step;
    EXPECT_LT((counts - counts.round()).abs().maxCoeff(), 1e-6);
    EXPECT_LE((motor - exact).col(m).cwiseAbs().maxCoeff(), step / 2 * (1 + 1e-9));
    EXPECT_GT((motor - exact).col(m).cwiseAbs().maxCoeff(), step / 2 * 0.9);
  }
}

TEST_F(Noise, SeedDecidesEveryDraw) {
  NoiseOptions options;
  options.position = Eigen::Vector3d::Constant(1e-4);
  options.signal = Eigen::Vector3d::Constant(0.1);
  const Recording first = AddNoise(truth_, arm_.model.robot(), options, 1);
  const Recording again = AddNoise(truth_, arm_.model.robot(), options, 1);
  const Recording other = AddNoise(truth_, arm_.model.robot(), options, 2);
  EXPECT_EQ(first.q, again.q);
  EXPECT_EQ(first.signal, again.signal);
  EXPECT_GT((first.q - other.q).cwiseAbs().minCoeff(), 0.0);
  EXPECT_GT((first.signal - other.signal).cwiseAbs().minCoeff(), 0.0);
}

TEST(NoiseOptions, NamesWhatIsWrong) {
  const auto error_of = [](NoiseOptions options) {
    std::string error;
    EXPECT_FALSE(options.IsValid(3, &error));
    return error;
  };
  NoiseOptions options;
  options.signal = Eigen::Vector2d(1.0, 1.0);
  EXPECT_NE(error_of(options).find("signal has 2 numbers, must have 3"), std::string::npos);
  options.signal = Eigen::Vector3d(1.0, -1.0, 0.0);
  EXPECT_NE(error_of(options).find("signal[1] = -1"), std::string::npos);
  options.signal.resize(0);
  options.encoder_counts = Eigen::Vector3d(0.0, 100.0, 100.0);
  EXPECT_NE(error_of(options).find("encoder_counts[0] = 0"), std::string::npos);
  options.encoder_counts[0] = 100.0;
  options.position_step = Eigen::Vector3d::Constant(1e-4);
  EXPECT_NE(error_of(options).find("only one"), std::string::npos);
}

// Kolmogorov & Smirnov: sup |F_N - F| stays below sqrt(-ln(a/2) / 2 / N) but for a share a = 1e-6 of the seeds.
TEST(Random, NormalAndUniformFollowTheirLaws) {
  constexpr int kDraws = 100000;
  const double bound = std::sqrt(-0.5 * std::log(0.5e-6) / kDraws);
  const auto distance = [](std::vector<double> values) {
    std::sort(values.begin(), values.end());
    double largest = 0.0;
    for (size_t k = 0; k < values.size(); ++k) {
      const double n = static_cast<double>(values.size());
      largest = std::max({largest, std::abs(values[k] - k / n), std::abs(values[k] - (k + 1) / n)});
    }
    return largest;
  };
  Random random(123);
  std::vector<double> uniform(kDraws), normal(kDraws);
  for (double& u : uniform) u = random.Uniform();
  for (double& u : normal) u = boost::math::cdf(boost::math::normal(), random.Normal());
  EXPECT_LT(distance(uniform), bound);
  EXPECT_LT(distance(normal), bound);
}

TEST(Random, StreamsDiffer) {
  Random a(1, 0), b(1, 1), c(std::uint64_t{1} << 32 | 1, 0);
  const double x = a.Uniform();
  EXPECT_NE(x, b.Uniform());
  EXPECT_NE(x, c.Uniform());
}

}  // namespace
}  // namespace idim::simulate_test
