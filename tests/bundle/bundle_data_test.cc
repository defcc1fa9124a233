// The samples of the bundle and their derivatives, against StandardModel.

#include "solvers/bundle/bundle_data.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <string>

#include "tests/support/bundle_study.h"

namespace idim::bundle_data_test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using testing::BundleStudy;
using testing::GainScenario;
using testing::GainStudy;
using testing::MakeBundleStudy;
using testing::MakeGainStudy;

// A revolute, a prismatic and a revolute joint, gear and coupling of 3 motors: signals on the motor side.
GainScenario CoupledRpr() {
  Random random(11);
  GainScenario scenario;
  scenario.robot = testing::RandomArm("RPR", &random);
  scenario.robot.transmission = MatrixXd{{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.4, 1.0}};
  scenario.robot.couplings.push_back({2, {1, 2}, {0.4, 1.0}});
  scenario.gains = VectorXd{{33.9, -24.2, 6.79}};
  return scenario;
}

class StateDerivativesTest : public ::testing::TestWithParam<const char*> {
 protected:
  StateDerivativesTest() : study_(MakeBundleStudy(Scenario(), 1e-4, 0.03)) {}

  static GainScenario Scenario() {
    GainScenario scenario = std::string(GetParam()) == "tx40" ? testing::Tx40Gains() : CoupledRpr();
    scenario.samples = 1000;
    scenario.decimation = 50;
    return scenario;
  }

  // Torque of the smooth parameters, by recursion.
  VectorXd Torque(const VectorXd& state, int recording, const VectorXd& chi) {
    const int n = study_.data.dof;
    VectorXd tau(n);
    StandardModel model = study_.prepared.base().model();
    model.Torque(state.data(), state.data() + n, state.data() + 2 * n, nullptr,
                 testing::SmoothStandardParameters(study_.prepared.base(), chi),
                 testing::CarriedPayload(study_.data, recording, chi), tau.data());
    return tau;
  }

  // The columns of the unknown parameters, zero for those of Coulomb friction.
  MatrixXd SmoothColumns(const VectorXd& state, int recording) {
    const int n = study_.data.dof;
    const BaseParameters& base = study_.prepared.base();
    StandardModel model = base.model();
    StateDerivatives::RowMajorMatrix w(n, model.columns()), payload(n, kNumInertial);
    model.Regressor(state.data(), state.data() + n, state.data() + 2 * n, nullptr, w.data());
    model.PayloadColumns(payload.data());
    MatrixXd columns = MatrixXd::Zero(n, study_.data.num_columns());
    for (int k = 0; k < base.size(); ++k) {
      if (model.parameters()[base.kept()[k]].name.rfind("Fs", 0) != 0) columns.col(k) = w.col(base.kept()[k]);
    }
    const int carried = study_.data.payload_of_recording[recording];
    for (int k = 0; carried >= 0 && k < kNumInertial; ++k) {
      const int column = study_.data.payload_column(carried, k);
      if (column >= 0) columns.col(column) = payload.col(k);
    }
    return columns;
  }

  // One of each recording.
  std::vector<const BundleSample*> Samples() const {
    return {&study_.data.samples()[3], &study_.data.samples()[study_.data.samples().size() - 4]};
  }

  BundleStudy study_;
};

// Central differences of step h are off by h^2/6 of the third derivative and by rounding / h: 1e-8 of the largest.
TEST_P(StateDerivativesTest, TorqueIsTheNumericDerivative) {
  const BundleData& data = study_.data;
  StateDerivatives derivatives(study_.prepared.base(), data);
  const VectorXd chi = study_.truth.tail(data.num_columns());
  for (const BundleSample* sample : Samples()) {
    MatrixXd d, numeric(data.dof, 3 * data.dof);
    derivatives.Torque(*sample, chi, &d);
    constexpr double kStep = 1e-5;
    for (int s = 0; s < 3 * data.dof; ++s) {
      const VectorXd step = kStep * VectorXd::Unit(3 * data.dof, s);
      numeric.col(s) = (Torque(sample->state + step, sample->recording, chi) -
                        Torque(sample->state - step, sample->recording, chi)) /
                       (2.0 * kStep);
    }
    ASSERT_GT(numeric.cwiseAbs().colwise().maxCoeff().tail(2 * data.dof).minCoeff(), 0.0);
    EXPECT_LT((d - numeric).cwiseAbs().maxCoeff(), 1e-8 * numeric.cwiseAbs().maxCoeff());
  }
}

TEST_P(StateDerivativesTest, ColumnsAreTheNumericDerivativeAlongADeviation) {
  const BundleData& data = study_.data;
  StateDerivatives derivatives(study_.prepared.base(), data);
  Random random(5);
  for (const BundleSample* sample : Samples()) {
    const VectorXd deviation = random.Vector(3 * data.dof, 1.0);
    StateDerivatives::RowMajorMatrix change;
    derivatives.Columns(*sample, deviation, &change);
    constexpr double kStep = 1e-5;
    const MatrixXd numeric = (SmoothColumns(sample->state + kStep * deviation, sample->recording) -
                              SmoothColumns(sample->state - kStep * deviation, sample->recording)) /
                             (2.0 * kStep);
    ASSERT_GT(numeric.cwiseAbs().maxCoeff(), 0.1);
    EXPECT_LT((change - numeric).cwiseAbs().maxCoeff(), 1e-8 * numeric.cwiseAbs().maxCoeff());
  }
}

// D(chi) d = D(0) d + (dW d) chi: recursion against regressor, to rounding.
TEST_P(StateDerivativesTest, TorqueAndColumnsAreTheSameDerivative) {
  const BundleData& data = study_.data;
  StateDerivatives derivatives(study_.prepared.base(), data);
  Random random(6);
  for (const BundleSample* sample : Samples()) {
    const VectorXd chi = random.Vector(data.num_columns(), 2.0), deviation = random.Vector(3 * data.dof, 1.0);
    MatrixXd d, of_known;
    StateDerivatives::RowMajorMatrix change;
    derivatives.Torque(*sample, chi, &d);
    derivatives.Torque(*sample, VectorXd::Zero(chi.size()), &of_known);
    derivatives.Columns(*sample, deviation, &change);
    const VectorXd expected = d * deviation;
    EXPECT_LT((of_known * deviation + change * chi - expected).norm(), 1e-12 * expected.norm());
    EXPECT_EQ(of_known.isZero(), data.payload_of_recording[sample->recording] < 0);
  }
}

INSTANTIATE_TEST_SUITE_P(Arms, StateDerivativesTest, ::testing::Values("tx40", "coupled_rpr"),
                         [](const auto& arm) { return std::string(arm.param); });

// v = diag(1/g) M^-1 (W chi + known) without noise, on either side of the transmission.
TEST(BundleData, NoiseFreeSamplesFulfilTheModelAtTheTruth) {
  for (GainScenario scenario : {testing::Tx40Gains(), CoupledRpr()}) {
    scenario.samples = 1000;
    const GainStudy study = MakeGainStudy(scenario);
    const Result<BundleData> data = BuildBundleData(study.prepared);
    ASSERT_TRUE(data.ok()) << data.status().message();
    ASSERT_GT(data->samples().size(), 100u);
    ASSERT_EQ(data->num_unknowns(), study.truth.size());
    for (const BundleSample& sample : data->samples()) {
      const VectorXd torque = sample.columns * study.truth.tail(data->num_columns()) + sample.known;
      const VectorXd signal = (data->inverse_drive * torque).cwiseQuotient(scenario.gains);
      ASSERT_LT((signal - sample.signal).norm(), 1e-10 * sample.signal.norm());
    }
  }
}

}  // namespace
}  // namespace idim::bundle_data_test
