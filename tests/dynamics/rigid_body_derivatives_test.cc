// Derivatives in closed form against automatic differentiation of the recursion that knows nothing of them.

#include "core/dynamics/rigid_body_derivatives.h"

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include "core/dynamics/rigid_body_dynamics.h"
#include "tests/support/random_arm.h"

namespace idim::rigid_body_derivatives_test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using testing::RandomArm;
using Jet = ceres::Jet<double, 1>;

// (q, dq, ddq) moving along `direction`.
std::vector<Jet> Along(const VectorXd& state, const VectorXd& direction) {
  std::vector<Jet> jets(state.size());
  for (Eigen::Index s = 0; s < state.size(); ++s) {
    jets[s] = Jet(state[s]);
    jets[s].v[0] = direction[s];
  }
  return jets;
}

VectorXd RandomState(int n, Random* random) {
  VectorXd state(3 * n);
  state << random->Vector(n, M_PI), random->Vector(n, 3.0), random->Vector(n, 10.0);
  return state;
}

class Derivatives : public ::testing::TestWithParam<std::string> {};

INSTANTIATE_TEST_SUITE_P(OneToTwelve, Derivatives,
                         ::testing::Values("R", "P", "RR", "RP", "PR", "PP", "RPR", "PRP", "RRRRRR", "RRPRRR", "PRRPRR",
                                           "RRRRRRR", "RPRPRPRPRPRP", "RRRRRRRRRRRR"));

// Parameters of no physical meaning, as base parameters in place of standard ones are.
TEST_P(Derivatives, OfTheTorqueAreThoseOfTheRecursion) {
  Random random(23);
  for (int trial = 0; trial < 20; ++trial) {
    const Robot robot = RandomArm(GetParam(), &random);
    const int n = robot.dof();
    RigidBodyDerivatives derivatives(robot);
    RigidBodyDynamics<Jet> dynamics(robot);
    std::vector<InertialVector> bodies;
    for (int j = 0; j < n; ++j) bodies.push_back(random.Vector(kNumInertial, 2.0));
    const VectorXd state = RandomState(n, &random);
    MatrixXd d = MatrixXd::Constant(n, 3 * n, std::numeric_limits<double>::quiet_NaN()), expected(n, 3 * n);
    derivatives.InverseDynamics(state.data(), bodies.data(), d.data());
    for (int s = 0; s < 3 * n; ++s) {
      std::vector<Jet> x = Along(state, VectorXd::Unit(3 * n, s)), tau(n);
      dynamics.InverseDynamics(&x[0], &x[n], &x[2 * n], bodies.data(), tau.data());
      for (int i = 0; i < n; ++i) expected(i, s) = tau[i].v[0];
    }
    ASSERT_TRUE(d.allFinite());
    for (int kind = 0; kind < 3; ++kind) {  // by q, dq, ddq, each on its own scale
      const MatrixXd error = d.middleCols(kind * n, n) - expected.middleCols(kind * n, n);
      // Of one revolute joint no torque depends on the velocity.
      const double scale = std::max(expected.middleCols(kind * n, n).norm(), 1e-2 * expected.norm());
      EXPECT_LE(error.norm(), 1e-12 * scale) << kind;
    }
  }
}

TEST_P(Derivatives, OfTheRegressorAreThoseOfTheRecursion) {
  Random random(29);
  for (int trial = 0; trial < 20; ++trial) {
    const Robot robot = RandomArm(GetParam(), &random);
    const int n = robot.dof();
    RigidBodyDerivatives derivatives(robot);
    RigidBodyDynamics<Jet> dynamics(robot);
    const VectorXd state = RandomState(n, &random);
    VectorXd direction = random.Vector(3 * n, 1.0);
    // One of the three kinds alone, then all of them.
    for (int kind = 0; kind < 3 && trial % 4 < 3; ++kind) {
      if (kind != trial % 4) direction.segment(kind * n, n).setZero();
    }
    std::vector<double> change(10 * n * n, 0.0);
    derivatives.Regressor(state.data(), direction.data(), change.data());
    std::vector<Jet> x = Along(state, direction), regressor(10 * n * n);
    dynamics.Regressor(&x[0], &x[n], &x[2 * n], regressor.data());
    double error = 0.0, largest = 0.0;
    for (int k = 0; k < 10 * n * n; ++k) {
      error = std::max(error, std::abs(change[k] - regressor[k].v[0]));
      largest = std::max(largest, std::abs(regressor[k].v[0]));
    }
    EXPECT_LE(error, 1e-12 * largest);
  }
}

}  // namespace
}  // namespace idim::rigid_body_derivatives_test
