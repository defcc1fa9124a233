#include "core/dynamics/standard_model.h"

#include <gtest/gtest.h>

#include "tests/support/random_arm.h"

namespace idim::standard_model_test {
namespace {

using Eigen::VectorXd;
using RowMajorMatrix = Eigen::Matrix<double, -1, -1, Eigen::RowMajor>;

TEST(StandardModel, ColumnsTimesParametersIsTheRecursionWithDrivesCouplingsAndPayload) {
  Random random(3);
  const Robot robot = testing::Tx40();
  for (const FrictionModel friction :
       {FrictionModel{true, true, true}, FrictionModel{true, false, true}, FrictionModel{false, false, false}}) {
    StandardModel model(robot, friction);
    const VectorXd chi = random.Vector(model.columns(), 1.0);
    const InertialVector payload = testing::RandomBody(&random);
    const VectorXd sigma = VectorXd::Constant(6, 0.3);
    const VectorXd q = random.Vector(6, M_PI), dq = random.Vector(6, 0.5), ddq = random.Vector(6, 10.0);
    RowMajorMatrix w(6, model.columns()), w_payload(6, 10);
    VectorXd tau(6);
    model.Regressor(q.data(), dq.data(), ddq.data(), sigma.data(), w.data());
    model.PayloadColumns(w_payload.data());
    model.Torque(q.data(), dq.data(), ddq.data(), sigma.data(), chi, payload, tau.data());
    EXPECT_LT((w * chi + w_payload * payload - tau).norm(), 1e-12 * tau.norm());
  }
}

// Eq. (25), written out.
TEST(StandardModel, CouplingIsThePapers) {
  StandardModel model(testing::Tx40(), FrictionModel{});
  VectorXd chi = VectorXd::Zero(model.columns());
  const double ia = 0.3, fv = 0.7, fs = 1.1;
  chi[model.Find("Iam6")] = ia;
  chi[model.Find("Fvm6")] = fv;
  chi[model.Find("Fsm6")] = fs;
  VectorXd q = VectorXd::Zero(6), dq = VectorXd::Zero(6), ddq = VectorXd::Zero(6), tau(6);
  dq[4] = -0.5;
  dq[5] = 0.2;
  ddq[4] = 3.0;
  ddq[5] = -2.0;
  model.Torque(q.data(), dq.data(), ddq.data(), nullptr, chi, InertialVector::Zero(), tau.data());
  EXPECT_DOUBLE_EQ(tau[4], ia * ddq[5] + fv * dq[5] - fs);
  EXPECT_DOUBLE_EQ(tau[5], ia * ddq[4] + fv * dq[4] - fs);
  EXPECT_EQ(tau.head(4).norm(), 0.0);
}

// With the motor on the joint's far side (weights c) the drive's power must be that of friction on the motor's speed:
// the work of Fv on all joints together, Fv_j = c_j^2 f and Fvm = f, is f u^2.
TEST(StandardModel, WeightedCouplingDissipatesOnTheMotorsSpeed) {
  Robot robot = testing::Tx40();
  robot.couplings[0].weights = {-0.7, 1.0};
  StandardModel model(robot, FrictionModel{});
  const double f = 0.9, s = 0.4;
  VectorXd chi = VectorXd::Zero(model.columns());
  chi[model.Find("Fvm6")] = f;
  chi[model.Find("Fv5")] = 0.49 * f;
  chi[model.Find("Fv6")] = f;
  chi[model.Find("Fsm6")] = s;
  Random random(8);
  for (int trial = 0; trial < 10; ++trial) {
    const VectorXd q = random.Vector(6, 1.0), dq = random.Vector(6, 1.0), ddq = VectorXd::Zero(6);
    VectorXd tau(6);
    model.Torque(q.data(), dq.data(), ddq.data(), nullptr, chi, InertialVector::Zero(), tau.data());
    const double u = -0.7 * dq[4] + dq[5];
    EXPECT_NEAR(dq.dot(tau), f * u * u + s * std::abs(u), 1e-12);
  }
}

// The sign column is the expectation of sign(dq + noise): compared with its Monte-Carlo mean.
TEST(StandardModel, ExpectedSignIsTheMeanOfNoisySigns) {
  EXPECT_EQ(ExpectedSign(0.1, 0.0), 1.0);
  EXPECT_EQ(ExpectedSign(-0.1, 0.0), -1.0);
  EXPECT_EQ(ExpectedSign(0.0, 0.0), 0.0);
  std::mt19937_64 generator(4);
  std::normal_distribution<double> normal;
  const int runs = 100000;
  for (const double dq : {-0.02, 0.0, 0.005, 0.03}) {
    double sum = 0.0;
    for (int k = 0; k < runs; ++k) sum += dq + 0.01 * normal(generator) > 0.0 ? 1.0 : -1.0;
    // Standard deviation of the mean of +-1 at most 1/sqrt(runs); 4.5 of them: false alarm 7e-6 each.
    EXPECT_NEAR(ExpectedSign(dq, 0.01), sum / runs, 4.5 / std::sqrt(runs));
  }
}

}  // namespace
}  // namespace idim::standard_model_test
