// One arm in two descriptions: the UR10e as URDF and as modified DH rows must need the same torques.

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "core/dynamics/base_parameters.h"
#include "core/robot/robot_reader.h"
#include "tests/support/random_arm.h"

namespace idim::ur10e_torque_test {
namespace {

using Eigen::VectorXd;

// Frames of the two descriptions are fixed to the same links, so their relative pose is a constant, found here from the
// kinematics alone at one configuration and checked at another.
TEST(Ur10e, UrdfAndModifiedDhNeedTheSameTorques) {
  const Result<Robot> dh = ReadRobot(IDIM_SOURCE_DIR "/datasets/ur10e/robot.yaml");
  const Result<Robot> urdf = ReadRobot(IDIM_SOURCE_DIR "/datasets/ur10e/robot_urdf.yaml");
  ASSERT_TRUE(dh.ok()) << dh.status().message();
  ASSERT_TRUE(urdf.ok()) << urdf.status().message();
  ASSERT_EQ(dh->dof(), 6);
  ASSERT_EQ(urdf->dof(), 6);
  Random random(12);
  const VectorXd q0 = random.Vector(6, M_PI), q1 = random.Vector(6, M_PI);
  std::vector<InertialVector> urdf_bodies, dh_bodies;
  for (int j = 0; j < 6; ++j) {
    const auto relative = [&](const VectorXd& q) -> Eigen::Matrix4d {
      return testing::Pose(*dh, q, j).inverse() * testing::Pose(*urdf, q, j);
    };
    const Eigen::Matrix4d pose = relative(q0);
    ASSERT_LT((pose - relative(q1)).norm(), 1e-12) << "joint " << j + 1;
    urdf_bodies.push_back(testing::RandomBody(&random));
    dh_bodies.push_back(TransformInertial(urdf_bodies.back(), pose.topLeftCorner<3, 3>(), pose.topRightCorner<3, 1>()));
  }
  RigidBodyDynamics<double> dh_dynamics(*dh), urdf_dynamics(*urdf);
  for (int trial = 0; trial < 50; ++trial) {
    const VectorXd q = random.Vector(6, M_PI), dq = random.Vector(6, 3.0), ddq = random.Vector(6, 10.0);
    VectorXd a(6), b(6);
    dh_dynamics.InverseDynamics(q.data(), dq.data(), ddq.data(), dh_bodies.data(), a.data());
    urdf_dynamics.InverseDynamics(q.data(), dq.data(), ddq.data(), urdf_bodies.data(), b.data());
    EXPECT_LT((a - b).norm(), 1e-12 * a.norm());
  }
}

// Frames differ, so the parameters do; how many can be identified is a property of the arm.
TEST(Ur10e, BothDescriptionsHaveAsManyBaseParameters) {
  const Result<Robot> dh = ReadRobot(IDIM_SOURCE_DIR "/datasets/ur10e/robot.yaml");
  const Result<Robot> urdf = ReadRobot(IDIM_SOURCE_DIR "/datasets/ur10e/robot_urdf.yaml");
  ASSERT_TRUE(dh.ok() && urdf.ok());
  const BaseParameters a{StandardModel(*dh, FrictionModel{})}, b{StandardModel(*urdf, FrictionModel{})};
  EXPECT_EQ(a.size(), b.size());
  EXPECT_GT(a.smallest_kept(), 1e3 * a.largest_dropped());
}

}  // namespace
}  // namespace idim::ur10e_torque_test
