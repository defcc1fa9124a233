// Inverse dynamics against routes that share no code with it: its own regressor, the energy balance by poses and
// pseudo-inertias, the textbook 2R arm.

#include "core/dynamics/rigid_body_dynamics.h"

#include <gtest/gtest.h>

#include <string>

#include "tests/support/random_arm.h"

namespace idim::rigid_body_dynamics_test {
namespace {

using Eigen::VectorXd;
using testing::RandomArm;
using testing::RandomBody;

class Arms : public ::testing::TestWithParam<std::string> {};

INSTANTIATE_TEST_SUITE_P(OneToTwelve, Arms,
                         ::testing::Values("R", "P", "RR", "RP", "PR", "PPP", "RRR", "RPR", "RRRRRR", "RRPRRR",
                                           "PRRPRR", "RRRRRRR", "RPRPRPRPRPRP", "RRRRRRRRRRRR"));

TEST_P(Arms, RegressorTimesParametersIsTheRecursion) {
  Random random(17);
  for (int trial = 0; trial < 20; ++trial) {
    const Robot robot = RandomArm(GetParam(), &random);
    const int n = robot.dof();
    RigidBodyDynamics<double> dynamics(robot);
    std::vector<InertialVector> bodies;
    VectorXd chi(10 * n);
    for (int j = 0; j < n; ++j) {
      bodies.push_back(RandomBody(&random));
      chi.segment<10>(10 * j) = bodies.back();
    }
    const VectorXd q = random.Vector(n, M_PI), dq = random.Vector(n, 3.0), ddq = random.Vector(n, 10.0);
    VectorXd tau(n);
    dynamics.InverseDynamics(q.data(), dq.data(), ddq.data(), bodies.data(), tau.data());
    Eigen::Matrix<double, -1, -1, Eigen::RowMajor> w =
        Eigen::MatrixXd::Constant(n, 10 * n, std::numeric_limits<double>::quiet_NaN());
    dynamics.Regressor(q.data(), dq.data(), ddq.data(), w.data());
    ASSERT_TRUE(w.allFinite());
    EXPECT_LT((w * chi - tau).norm(), 1e-12 * tau.norm());
  }
}

// Kinetic energy 1/2 tr(dT P dT') and potential energy -g . (T P e4) by poses alone.
double Energy(const Robot& robot, const std::vector<InertialVector>& bodies, const VectorXd& q, const VectorXd& dq) {
  const double h = 1e-4;
  double energy = 0.0;
  for (int j = 0; j < robot.dof(); ++j) {
    const auto pose = [&](double s) -> Eigen::Matrix4d { return testing::Pose(robot, q + s * h * dq, j); };
    // Sixth-order central difference: error of order h^6.
    const Eigen::Matrix4d rate =
        (45.0 * (pose(1) - pose(-1)) - 9.0 * (pose(2) - pose(-2)) + (pose(3) - pose(-3))) / (60.0 * h);
    const Eigen::Matrix4d pseudo = PseudoInertia(bodies[j]);
    energy += 0.5 * (rate * pseudo * rate.transpose()).trace();
    energy -= robot.gravity.dot((pose(0) * pseudo.col(3)).head<3>());
  }
  return energy;
}

TEST_P(Arms, PowerIsTheRateOfEnergy) {
  Random random(23);
  const Robot robot = RandomArm(GetParam(), &random);
  const int n = robot.dof();
  RigidBodyDynamics<double> dynamics(robot);
  std::vector<InertialVector> bodies;
  for (int j = 0; j < n; ++j) bodies.push_back(RandomBody(&random));
  for (int trial = 0; trial < 5; ++trial) {
    const VectorXd q = random.Vector(n, M_PI), dq = random.Vector(n, 1.0), ddq = random.Vector(n, 2.0);
    VectorXd tau(n);
    dynamics.InverseDynamics(q.data(), dq.data(), ddq.data(), bodies.data(), tau.data());
    const auto energy = [&](double t) { return Energy(robot, bodies, q + t * dq + 0.5 * t * t * ddq, dq + t * ddq); };
    const double h = 1e-3;
    const double rate =
        (45.0 * (energy(h) - energy(-h)) - 9.0 * (energy(2 * h) - energy(-2 * h)) + (energy(3 * h) - energy(-3 * h))) /
        (60.0 * h);
    // Rounding of the nested differences, 1e-16 * E / (1e-4 * 1e-3), bounds what this route can resolve.
    EXPECT_NEAR(dq.dot(tau), rate, 1e-7 * (std::abs(energy(0.0)) + std::abs(rate) + 1.0));
  }
}

// The planar 2R arm in the vertical plane, e.g. Khalil & Dombre (2002), example 9.1, or any textbook.
TEST(TwoLinkArm, TextbookClosedForm) {
  const double length = 0.7, m1 = 3.0, m2 = 2.0, c1 = 0.3, c2 = 0.25, j1 = 0.05, j2 = 0.04, g = 9.81;
  Robot robot;
  robot.joints.push_back(JointFromModifiedDh(JointType::kRevolute, 0, 0, 0, 0));
  robot.joints.push_back(JointFromModifiedDh(JointType::kRevolute, 0, length, 0, 0));
  robot.gravity = Eigen::Vector3d(0.0, -g, 0.0);
  const auto body = [](double mass, double x, double izz) {
    return InertialFromCentreOfMass(mass, Eigen::Vector3d(x, 0, 0), Eigen::Vector3d(0.1, 0.2, izz).asDiagonal());
  };
  const std::vector<InertialVector> bodies = {body(m1, c1, j1), body(m2, c2, j2)};
  RigidBodyDynamics<double> dynamics(robot);
  Random random(5);
  for (int trial = 0; trial < 20; ++trial) {
    const VectorXd q = random.Vector(2, M_PI), dq = random.Vector(2, 3.0), ddq = random.Vector(2, 10.0);
    const double a = j1 + m1 * c1 * c1 + j2 + m2 * (length * length + c2 * c2);
    const double b = m2 * length * c2;
    const double d = j2 + m2 * c2 * c2;
    const double cos2 = std::cos(q[1]), sin2 = std::sin(q[1]);
    const double tau1 = (a + 2 * b * cos2) * ddq[0] + (d + b * cos2) * ddq[1] -
                        b * sin2 * (2 * dq[0] * dq[1] + dq[1] * dq[1]) +
                        g * ((m1 * c1 + m2 * length) * std::cos(q[0]) + m2 * c2 * std::cos(q[0] + q[1]));
    const double tau2 =
        (d + b * cos2) * ddq[0] + d * ddq[1] + b * sin2 * dq[0] * dq[0] + g * m2 * c2 * std::cos(q[0] + q[1]);
    VectorXd tau(2);
    dynamics.InverseDynamics(q.data(), dq.data(), ddq.data(), bodies.data(), tau.data());
    EXPECT_NEAR(tau[0], tau1, 1e-12 * (1 + std::abs(tau1)));
    EXPECT_NEAR(tau[1], tau2, 1e-12 * (1 + std::abs(tau2)));
  }
}

}  // namespace
}  // namespace idim::rigid_body_dynamics_test
