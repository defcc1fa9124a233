#include "core/model/prediction.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/simulated_study.h"

namespace idim::prediction_test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

class PredictionTest : public ::testing::Test {
 protected:
  void SetUp() override {
    simulated_.Simulate();
    truth_.gains = simulated_.scenario.gains;
  }

  ArmParameters Truth(const PreparedStudy& prepared) const {
    return {simulated_.scenario.gains,
            prepared.base().projection() * simulated_.scenario.chi,
            {simulated_.scenario.payloads[0].inertial}};
  }

  testing::SimulatedStudy simulated_;
  ArmParameters truth_;
};

// Base parameters against the standard ones they were regrouped from, through the same recursion.
TEST_F(PredictionTest, BaseParametersGiveTheTorqueOfTheStandardOnes) {
  const PreparedStudy prepared = simulated_.Prepare();
  ASSERT_LT(prepared.base().size(), prepared.base().model().columns());
  for (int r = 0; r < 3; ++r) {
    const MeasuredRecording& recording = prepared.data->recordings[static_cast<size_t>(r)];
    const RecordingSeries series = Predict(prepared, r, Truth(prepared));
    StandardModel model = prepared.base().model();
    const InertialVector payload =
        recording.entry.payload < 0 ? InertialVector(InertialVector::Zero()) : simulated_.scenario.payloads[0].inertial;
    VectorXd q, dq, ddq, tau(3);
    for (Eigen::Index i = 0; i < series.t.size(); i += 7) {
      q = recording.states->q.row(i), dq = recording.states->dq.row(i), ddq = recording.states->ddq.row(i);
      model.Torque(q.data(), dq.data(), ddq.data(), prepared.data->velocity_sigma.data(), simulated_.scenario.chi,
                   payload, tau.data());
      ASSERT_LT((series.model.row(i).transpose() - tau).cwiseAbs().maxCoeff(), 1e-9 * tau.norm()) << i;
    }
  }
}

// The truth leaves nothing but the noise that the simulator added, which is known.
TEST_F(PredictionTest, TruthLeavesTheNoiseOfTheSignals) {
  const PreparedStudy prepared = simulated_.Prepare();
  std::vector<RecordingSeries> all;
  for (size_t r = 0; r < prepared.data->recordings.size(); ++r) {
    all.push_back(Predict(prepared, static_cast<int>(r), Truth(prepared)));
    const RecordingSeries& series = all.back();
    const idim::Truth exact = SimulateTruth(simulated_.scenario, simulated_.scenario.recordings[r]);
    ASSERT_EQ(series.t.size(), exact.t.size());
    EXPECT_EQ(series.use, r == 2 ? "validation" : "identification");
    // The filter's ends and a sample about each reversal apart: 1e-6 rad through 20 Hz are 5e-3 rad/s^2 or so.
    const Eigen::Index inner = series.t.size() - 100;
    const MatrixXd error = (series.model - exact.torque).middleRows(50, inner);
    for (int j = 0; j < 3; ++j) {
      EXPECT_GT((error.col(j).array().abs() < 0.05).count(), inner * 0.97) << j;
      EXPECT_LT((series.torque - exact.torque).col(j).norm() / std::sqrt(double(exact.t.size())),
                1.2 * std::abs(truth_.gains[j]) * simulated_.scenario.noise.signal[j]);
    }
    const RecordingFit fit = FitOf(series);
    EXPECT_EQ(fit.samples, prepared.data->recordings[r].decimator->outputs());
    // White noise stays nearly white through the decimator (its outputs are as far apart as its bandwidth asks for).
    EXPECT_LT(fit.residual_lag1.cwiseAbs().maxCoeff(), 0.35) << fit.residual_lag1.transpose();
  }
  // 4000 samples: a standard deviation is known to 1 / sqrt(8000) = 1.1 %; five of them, and 3 % for the reversals.
  const VectorXd deviation = SignalDeviation(prepared.data->drive, truth_.gains, all);
  for (int j = 0; j < 3; ++j) {
    EXPECT_NEAR(deviation[j] / simulated_.scenario.noise.signal[j], 1.0, 0.056 + 0.03) << j;
  }
}

// Where the signal is that of motors, a deviation is theirs: torque = T' diag(g) v.
TEST_F(PredictionTest, SignalDeviationIsOnTheSideOfTheSignal) {
  Robot robot;
  robot.joints.resize(2);
  robot.transmission.resize(2, 2);
  robot.transmission << 30.0, 0.0, 20.0, -40.0;
  const DriveMap drive(robot, Side::kMotor);
  const VectorXd gains = (VectorXd(2) << 0.5, 2.0).finished();
  // Root mean squares 1 and sqrt(2) between the decimated instants; what the filter made of the ends does not count.
  MatrixXd noise(6, 2);
  noise << 50, -80, 1, 0, -1, 2, 1, -2, -1, 0, 70, 30;
  RecordingSeries series;
  series.use = "identification";
  series.t = VectorXd::LinSpaced(6, 0.0, 5.0);
  series.decimated_t = VectorXd::LinSpaced(2, 1.0, 4.0);
  series.model = MatrixXd::Random(6, 2);
  series.torque = series.model;
  for (int i = 0; i < 6; ++i) {
    series.torque(i, 0) += 30.0 * 0.5 * noise(i, 0) + 20.0 * 2.0 * noise(i, 1);
    series.torque(i, 1) += -40.0 * 2.0 * noise(i, 1);
  }
  RecordingSeries unseen = series;
  unseen.use = "validation";
  unseen.torque *= 7.0;
  const VectorXd deviation = SignalDeviation(drive, gains, {series, unseen});
  EXPECT_NEAR(deviation[0], 1.0, 1e-12);
  EXPECT_NEAR(deviation[1], std::sqrt(2.0), 1e-12);
}

// By hand: joint 1 torque (2, 1, 2), residual (1, -1, 1); joint 2 torque (0, 3, 4), residual 0.
TEST(FitOf, IsWhatAHandComputes) {
  RecordingSeries series;
  series.name = "a";
  series.use = "identification";
  // The first and the last sample are before and after the decimated ones.
  series.t = VectorXd::LinSpaced(4, -0.5, 2.5);
  series.torque = MatrixXd::Constant(4, 2, 5.0);
  series.model.resize(4, 2);
  series.model << 99.0, 0.0, 2.0, 5.0, 1.0, 6.0, -50.0, 7.0;  // residuals (3, 4) and (0, -1)
  series.decimated_t = VectorXd::LinSpaced(3, 0.0, 2.0);
  series.decimated_torque.resize(3, 2);
  series.decimated_torque << 2, 0, 1, 3, 2, 4;
  series.decimated_model.resize(3, 2);
  series.decimated_model << 1, 0, 2, 3, 1, 4;
  const RecordingFit fit = FitOf(series);
  EXPECT_EQ(fit.name, "a");
  EXPECT_EQ(fit.samples, 3);
  EXPECT_NEAR(fit.relative_error_percent[0], 100.0 * std::sqrt(3.0) / 3.0, 1e-12);
  EXPECT_EQ(fit.relative_error_percent[1], 0.0);
  EXPECT_NEAR(fit.relative_error_percent_all, 100.0 * std::sqrt(3.0 / 34.0), 1e-12);
  EXPECT_NEAR(fit.rms_torque[0], 1.0, 1e-15);
  EXPECT_NEAR(fit.rms_torque_unfiltered[0], 5.0 / std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(fit.rms_torque_unfiltered[1], 1.0 / std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(fit.residual_lag1[0], -2.0 / 3.0, 1e-15);
  EXPECT_EQ(fit.residual_lag1[1], 0.0);

  // Of both recordings together, not their mean; validation recordings do not count.
  RecordingSeries other = series;
  other.decimated_model = other.decimated_torque;
  RecordingSeries unseen = series;
  unseen.use = "validation";
  EXPECT_NEAR(RelativeErrorPercent({series, other, unseen}), 100.0 * std::sqrt(3.0 / 68.0), 1e-12);
}

}  // namespace
}  // namespace idim::prediction_test
