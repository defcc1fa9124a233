#include "solvers/linear/gain_verdict.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <string>

#include "core/base/decompositions.h"
#include "core/base/text.h"
#include "solvers/linear/signal_noise.h"
#include "tests/support/gain_study.h"

namespace idim::gain_verdict_test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using testing::GainScenario;
using testing::GainStudy;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

GainSystem Build(const GainStudy& study) {
  Result<GainSystem> system = BuildGainSystem(study.prepared);
  EXPECT_TRUE(system.ok()) << system.status().message();
  return std::move(system).value();
}

// The paper's arm moving gently, its first axis upright, then the same arm on a wall: one motion, one noise,
// other gravity.
std::vector<GainVerdict> Judge(const Eigen::Vector3d& gravity) {
  GainScenario scenario = testing::Tx40Gains();
  scenario.robot.gravity = gravity;
  scenario.signal_noise = 0.2;
  scenario.speed = 0.15;  // gravity outweighs inertia
  scenario.amplitude = 0.8;
  scenario.samples = 10000;
  return JudgeGains(Build(MakeGainStudy(scenario)), 1e-10);
}

TEST(GainVerdict, AVerticalFirstAxisIsTheWeakOneAndGravityIsNamed) {
  const std::vector<GainVerdict> upright = Judge({0.0, 0.0, -9.81});
  ASSERT_EQ(upright.size(), 6u);
  for (int j = 0; j < 6; ++j) {
    EXPECT_EQ(upright[j].name, "g" + std::to_string(j + 1));
    EXPECT_EQ(upright[j].joint, j + 1);
    EXPECT_THAT(upright[j].sentence, StartsWith(upright[j].name + " is "));
  }
  // A share is said to two digits below a tenth, in whole per cent above.
  ASSERT_LT(upright[0].payload_torque_share, 0.0995);
  EXPECT_THAT(upright[0].sentence,
              HasSubstr(", " + Format("%.2g %%", 100.0 * upright[0].payload_torque_share) + " of its torque"));
  ASSERT_GT(upright[1].independent, 0.0995);
  EXPECT_THAT(upright[1].sentence, HasSubstr("imitate " + Format("%.0f %%", 100.0 * upright[1].independent) + " of"));
  EXPECT_NE(upright[0].strength, GainStrength::kStrong);
  for (int j = 1; j < 6; ++j) {
    EXPECT_LT(upright[0].reliability, 0.5 * upright[j].reliability) << j;
    EXPECT_EQ(upright[j].strength, GainStrength::kStrong) << j;
  }
  EXPECT_LT(upright[0].payload_gravity_share, 1e-10);
  EXPECT_GT(upright[0].payload_torque_share, 0.0);
  EXPECT_THAT(upright[0].sentence, HasSubstr("gravity of the known payload puts no torque on joint 1"));
  EXPECT_THAT(upright[1].sentence, Not(HasSubstr("puts no torque")));
  EXPECT_GT(upright[1].payload_gravity_share, 0.01);
  // The mass is about the point where the wrist's axes meet.
  for (int j = 3; j < 6; ++j) {
    EXPECT_LT(upright[j].payload_torque_share, 1e-10);
    EXPECT_THAT(upright[j].sentence, HasSubstr("hangs on parameters shared with other joints"));
  }
  const std::vector<GainVerdict> wall = Judge({9.81, 0.0, 0.0});
  EXPECT_THAT(wall[0].sentence, Not(HasSubstr("puts no torque")));
  EXPECT_GT(wall[0].reliability, 2.0 * upright[0].reliability);
  EXPECT_EQ(wall[0].strength, GainStrength::kStrong);
  EXPECT_GT(wall[0].payload_gravity_share, 0.01);
}

TEST(ReasonsAgainstGains, NameTheGainItsSignAndItsDeviation) {
  const VectorXd gains{{2.0, -3.0, 40.0}};
  const MatrixXd covariance = VectorXd{{0.01, 0.04, 36.0}}.asDiagonal();  // 5, 6.7 and 15 %
  EXPECT_EQ(ReasonsAgainstGains(gains, covariance, VectorXd(), 15.5), "");
  EXPECT_EQ(ReasonsAgainstGains(gains, covariance, VectorXd(), 14.5),
            "g3 = 40 has a relative standard deviation of 15 %, above 14.5 %");
  // An a priori value of 0 says nothing of the sign.
  EXPECT_EQ(ReasonsAgainstGains(gains, covariance, VectorXd{{1.0, -1.0, 0.0}}, 15.5), "");
  EXPECT_EQ(
      ReasonsAgainstGains(gains, covariance, VectorXd{{-1.5, 2.5, 1.0}}, 6.0),
      "g1 = 2 has the opposite sign of its a priori value -1.5; g2 = -3 has the opposite sign of its a priori "
      "value 2.5; g2 = -3 has a relative standard deviation of 6.67 %, above 6 %; g3 = 40 has a relative standard "
      "deviation of 15 %, above 6 %");
  EXPECT_THAT(ReasonsAgainstGains(VectorXd{{0.0}}, MatrixXd::Identity(1, 1), VectorXd(), 50.0), HasSubstr("g1 = 0"));
  EXPECT_THAT(ReasonsAgainstGains(VectorXd{{1.0}}, MatrixXd::Constant(1, 1, NAN), VectorXd(), 50.0),
              HasSubstr("relative standard deviation of"));
}

// Definitions with dense matrices: projections of the columns of W_tot themselves.
TEST(GainVerdict, NumbersAreThoseOfTheDefinitions) {
  GainScenario scenario = testing::Tx40Gains();
  scenario.signal_noise = 0.2;
  const GainStudy study = MakeGainStudy(scenario);
  const GainSystem system = Build(study);
  const std::vector<GainVerdict> verdicts = JudgeGains(system, 1e-10);
  const Result<GainRows> rows = GainRows::Create(study.prepared);
  ASSERT_TRUE(rows.ok());
  const Eigen::Index c = study.truth.size() + 1;
  const Eigen::Index each = system.joints[0].rows();
  MatrixXd w(6 * each, c);  // joint by joint
  Eigen::Index sample = 0;
  for (const int recording : {0, 1}) {
    rows->Stream(recording, [&](const GainRows::RowMajorMatrix& all) {
      for (int j = 0; j < 6; ++j) w.row(j * each + sample) = all.row(j);
      ++sample;
    });
  }
  const auto left = [](const MatrixXd& others, const VectorXd& x) {
    return VectorXd(x - others * others.householderQr().solve(x));
  };
  for (const int j : {0, 4}) {
    const GainVerdict& v = verdicts[j];
    MatrixXd others(w.rows(), c - 2);
    others << w.leftCols(j), w.middleCols(j + 1, c - 2 - j);
    const VectorXd signal = left(others, w.col(j)), known = left(others, w.col(c - 1));
    EXPECT_NEAR(v.independent, signal.norm() / w.col(j).norm(), 1e-8);
    const VectorXd remainder = signal - known * known.dot(signal) / known.squaredNorm();
    EXPECT_NEAR(v.unexplained, remainder.norm() / w.col(j).norm(), 1e-8);
    EXPECT_NEAR(v.known_share, 1.0 - remainder.squaredNorm() / signal.squaredNorm(), 1e-8);
    EXPECT_NEAR(v.least_squares, -signal.dot(known) / signal.squaredNorm(), 1e-7);
    EXPECT_NEAR(v.reliability, 1.0 - v.noise * v.noise / (v.independent * v.independent), 1e-10);
    // All gains' signals scatter by 20 % of their rms a recorded sample; the decimator leaves the sum of squares of
    // its taps.
    const std::vector<double>& taps = study.prepared.data->recordings[0].decimator->Taps();
    double squares = 0.0;
    for (const double tap : taps) squares += tap * tap;
    const MatrixXd noise = SignalNoise(system, 1e-10);
    const double rms = std::sqrt(0.5 *
                                 (study.prepared.data->recordings[0].recording->signal.col(j).squaredNorm() +
                                  study.prepared.data->recordings[1].recording->signal.col(j).squaredNorm()) /
                                 4000.0 / 1.04);
    // 800 rows less 40 parameters: 2.6 %; the two recordings differ in rms.
    EXPECT_NEAR(noise(j, j), 0.2 * rms * std::sqrt(squares), 0.13 * noise(j, j));
    EXPECT_EQ(noise(j, (j + 1) % 6), 0.0);
  }
}

// On the motor side the noise of motor 6 is in the rows of joints 5 and 6 alike, and its own rows tell how large it is.
TEST(SignalNoise, MotorSideNoiseGoesThroughTheTransmission) {
  GainScenario scenario = testing::Tx40Gains();
  scenario.robot.transmission = VectorXd{{32, 32, 45, -48, 45, 32}}.asDiagonal();
  scenario.robot.transmission(5, 4) = 16.0;
  scenario.gains = VectorXd{{1.06, 1.01, 0.54, 0.19, 0.36, 0.21}};
  scenario.signal_noise = 0.2;
  const GainStudy study = MakeGainStudy(scenario);
  const MatrixXd noise = SignalNoise(Build(study), 1e-10);
  EXPECT_NEAR(noise(4, 5), 0.5 * noise(5, 5), 1e-9 * noise(5, 5));
  EXPECT_EQ(noise(5, 4), 0.0);
  const std::vector<double>& taps = study.prepared.data->recordings[0].decimator->Taps();
  double squares = 0.0;
  for (const double tap : taps) squares += tap * tap;
  const MatrixXd& signal = study.prepared.data->recordings[0].recording->signal;
  // As above, for both recordings' sake.
  const double rms = signal.col(5).norm() / std::sqrt(4000.0 * 1.04);
  EXPECT_NEAR(noise(5, 5), 32.0 * 0.2 * rms * std::sqrt(squares), 0.3 * noise(5, 5));
}

}  // namespace
}  // namespace idim::gain_verdict_test
