#include "core/robot/robot_reader.h"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "tests/support/forward_kinematics.h"
#include "tests/support/temp_folder.h"

namespace idim::robot_reader_test {
namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Vector3d;
using ::testing::HasSubstr;

constexpr double kHalfPi = 1.5707963267948966;

std::string Joints(int n) {
  std::string text = "joints:\n";
  for (int j = 0; j < n; ++j) text += "  - {type: revolute, alpha: 0, d: 0.5, theta: 0, r: 0}\n";
  return text;
}

Result<Robot> ReadText(const std::string& text) {
  const TempFolder folder;
  return ReadRobot(folder.Write("robot.yaml", text));
}

TEST(JointFromModifiedDh, IsTheProductOfElementaryMatrices) {
  std::mt19937 generator(1);
  std::uniform_real_distribution<double> uniform(-3.0, 3.0);
  for (int trial = 0; trial < 100; ++trial) {
    const double alpha = uniform(generator), d = uniform(generator), theta = uniform(generator), r = uniform(generator),
                 q = uniform(generator);
    for (const JointType type : {JointType::kRevolute, JointType::kPrismatic}) {
      const bool revolute = type == JointType::kRevolute;
      // Written out entry by entry (Khalil & Dombre 2002, eq. (3.2)), no rotation class in between.
      const double ct = std::cos(theta + (revolute ? q : 0.0)), st = std::sin(theta + (revolute ? q : 0.0));
      const double ca = std::cos(alpha), sa = std::sin(alpha), z = r + (revolute ? 0.0 : q);
      Eigen::Matrix4d expected;
      expected << ct, -st, 0.0, d, ca * st, ca * ct, -sa, -z * sa, sa * st, sa * ct, ca, z * ca, 0.0, 0.0, 0.0, 1.0;
      const Isometry3d pose = JointPose(JointFromModifiedDh(type, alpha, d, theta, r), q);
      EXPECT_LT((pose.matrix() - expected).cwiseAbs().maxCoeff(), 1e-14);
    }
  }
}

TEST(ReadRobot, PlanarTwoLinkPoseByHand) {
  const Result<Robot> robot = ReadText(
      "name: planar\ngravity: [0, -9.81, 0]\njoints:\n"
      "  - {type: revolute, alpha: 0, d: 0, theta: 0.2, r: 0}\n"
      "  - {type: revolute, alpha: 0, d: 0.7, theta: 0, r: 0.1}\n");
  ASSERT_TRUE(robot.ok()) << robot.status().message();
  EXPECT_EQ(robot->name, "planar");
  EXPECT_EQ(robot->gravity, Vector3d(0.0, -9.81, 0.0));
  EXPECT_EQ(robot->transmission, Eigen::MatrixXd::Identity(2, 2));
  EXPECT_EQ(robot->joints[1].name, "2");
  EXPECT_TRUE(robot->declared_inertials.empty());
  const Isometry3d pose = ForwardKinematics(*robot, Eigen::Vector2d(0.3, -0.9));
  // Link 1 turned by 0.2 + 0.3, link 2 by a further -0.9 at its end, 0.1 up.
  EXPECT_TRUE(pose.translation().isApprox(Vector3d(0.7 * std::cos(0.5), 0.7 * std::sin(0.5), 0.1), 1e-14));
  EXPECT_TRUE(pose.linear().isApprox(AngleAxisd(-0.4, Vector3d::UnitZ()).toRotationMatrix(), 1e-14));
}

TEST(ReadRobot, OneToTwelveJointsAndDefaults) {
  for (const int n : {1, 2, 7, 12, 15}) {
    const Result<Robot> robot = ReadText(Joints(n));
    ASSERT_TRUE(robot.ok()) << robot.status().message();
    EXPECT_EQ(robot->dof(), n);
    EXPECT_EQ(robot->name, "robot");  // the file's
    EXPECT_EQ(robot->gravity, Vector3d(0.0, 0.0, -9.81));
    EXPECT_EQ(robot->transmission, Eigen::MatrixXd::Identity(n, n));
  }
}

TEST(ReadRobot, Tx40AsDocumented) {
  const Result<Robot> robot = ReadRobot(IDIM_SOURCE_DIR "/datasets/tx40/robot.yaml");
  ASSERT_TRUE(robot.ok()) << robot.status().message();
  EXPECT_EQ(robot->name, "staubli_tx40");
  ASSERT_EQ(robot->dof(), 6);
  Eigen::MatrixXd transmission =
      Eigen::VectorXd((Eigen::VectorXd(6) << 32, 32, 45, -48, 45, 32).finished()).asDiagonal();
  transmission(5, 4) = 32;
  EXPECT_EQ(robot->transmission, transmission);
  ASSERT_EQ(robot->couplings.size(), 1u);
  EXPECT_EQ(robot->couplings[0].motor, 5);
  EXPECT_THAT(robot->couplings[0].joints, ::testing::ElementsAre(4, 5));
  EXPECT_THAT(robot->couplings[0].weights, ::testing::ElementsAre(1.0, 1.0));
  // At q = 0 the arm stands upright: the wrist is the two links above the shoulder, 35 mm to the side.
  const Isometry3d pose = ForwardKinematics(*robot, Eigen::VectorXd::Zero(6));
  EXPECT_LT((pose.translation() - Vector3d(0.0, 0.035, 0.45)).norm(), 1e-12);
}

TEST(ReadRobot, CouplingWeightsAreRatiosOfTheTransmissionRow) {
  const Result<Robot> robot = ReadText(Joints(3) +
                                       "transmission: [[10, 0, 0], [0, -48, 12], [8, 4, 16]]\n"
                                       "couplings: [{motor: 3, joints: [3, 1, 2]}, {motor: 2, joints: [2, 3]}]\n");
  ASSERT_TRUE(robot.ok()) << robot.status().message();
  EXPECT_THAT(robot->couplings[0].joints, ::testing::ElementsAre(2, 0, 1));
  EXPECT_THAT(robot->couplings[0].weights, ::testing::ElementsAre(1.0, 0.5, 0.25));
  EXPECT_THAT(robot->couplings[1].weights, ::testing::ElementsAre(1.0, -0.25));
  // Without a transmission: the plain sum.
  const Result<Robot> plain = ReadText(Joints(2) + "couplings: [{motor: 2, joints: [1, 2]}]\n");
  ASSERT_TRUE(plain.ok()) << plain.status().message();
  EXPECT_THAT(plain->couplings[0].weights, ::testing::ElementsAre(1.0, 1.0));
}

TEST(ReadRobot, IllScaledButRegularTransmissionIsTaken) {
  const Result<Robot> robot = ReadText(Joints(2) + "transmission: [[1000, 0], [0, 0.001]]\n");
  EXPECT_TRUE(robot.ok()) << robot.status().message();
}

struct BadRobot {
  const char* name;
  std::string text;
  std::vector<std::string> message;  // substrings
};

void PrintTo(const BadRobot& test, std::ostream* out) { *out << test.name; }

class BadRobotTest : public ::testing::TestWithParam<BadRobot> {};

TEST_P(BadRobotTest, IsRefusedWithAClearMessage) {
  const Result<Robot> robot = ReadText(GetParam().text);
  ASSERT_FALSE(robot.ok());
  EXPECT_EQ(robot.status().code(), StatusCode::kBadInput);
  EXPECT_THAT(robot.status().message(), HasSubstr("robot.yaml"));
  for (const std::string& part : GetParam().message) EXPECT_THAT(robot.status().message(), HasSubstr(part));
}

std::string OneJoint(const std::string& joint) { return "name: x\njoints:\n  - " + joint + "\n"; }

const char kGood[] = "{type: revolute, alpha: 0, d: 0, theta: 0, r: 0}";

INSTANTIATE_TEST_SUITE_P(
    Table, BadRobotTest,
    ::testing::Values(
        BadRobot{"empty", "", {"robot.yaml:1:", "empty"}}, BadRobot{"comment_only", "# nothing\n", {"empty"}},
        BadRobot{"scalar", "hello\n", {":1:", "a single value", "expected a mapping"}},
        BadRobot{"not_yaml", "name: x\njoints: [1, {\n", {"not valid YAML", "expected"}},
        BadRobot{"tab", "name: x\njoints:\n\t- 1\n", {":3:", "not valid YAML"}},
        BadRobot{"two_documents", Joints(1) + "---\n" + Joints(1), {":3:", "more follows the first document"}},
        BadRobot{"no_document", ",ame: x\n" + Joints(1), {"robot.yaml:1:", "expected"}},
        BadRobot{"unknown_key", "name: x\ngravty: [0, 0, 0]\n", {":2:", "'gravty'", "unknown key", "'gravity'"}},
        BadRobot{"key_twice", Joints(1) + "name: a\nname: b\n", {":4:", "'name'", "twice"}},
        BadRobot{"no_joints", "name: x\n", {"'joints'", "missing", "exactly one of 'joints' and 'urdf'"}},
        BadRobot{"joints_and_urdf", Joints(1) + "urdf: a.urdf\n", {":3:", "'urdf'", "exactly one"}},
        BadRobot{"urdf_missing", "urdf: none.urdf\n", {":1:", "'urdf'", "no such file", "none.urdf"}},
        BadRobot{"empty_joints", "joints: []\n", {"'joints'", "empty", "at least one"}},
        BadRobot{"joints_scalar", "joints: 6\n", {"'joints'", "a single value", "expected a list"}},
        BadRobot{"joint_key",
                 OneJoint("{type: revolute, alpha: 0, a: 0, theta: 0, r: 0}"),
                 {":3:", "'joints[1].a'", "unknown key", "expected one of type, alpha, d, theta, r"}},
        BadRobot{"joint_value_missing",
                 OneJoint("{type: revolute, alpha: 0, d: 0, theta: 0}"),
                 {":3:", "'joints[1].r'", "missing", "expected a number"}},
        BadRobot{"joint_type",
                 OneJoint("{type: revolut, alpha: 0, d: 0, theta: 0, r: 0}"),
                 {":3:", "'joints[1].type'", "'revolut'", "revolute, prismatic"}},
        BadRobot{"text_number",
                 OneJoint("{type: revolute, alpha: pi/2, d: 0, theta: 0, r: 0}"),
                 {":3:", "'joints[1].alpha'", "'pi/2' is not a number", "expected a finite number"}},
        BadRobot{"quoted_number",
                 OneJoint("{type: revolute, alpha: '1.0', d: 0, theta: 0, r: 0}"),
                 {"'joints[1].alpha'", "is not a number"}},
        BadRobot{"nan_number",
                 OneJoint("{type: revolute, alpha: .nan, d: 0, theta: 0, r: 0}"),
                 {"'joints[1].alpha'", "'.nan' is not finite"}},
        BadRobot{"plain_nan", OneJoint("{type: revolute, alpha: nan, d: 0, theta: 0, r: 0}"), {"'nan' is not finite"}},
        BadRobot{"inf_number",
                 OneJoint("{type: revolute, alpha: 0, d: -.inf, theta: 0, r: 0}"),
                 {"'joints[1].d'", "is not finite"}},
        BadRobot{"huge_number",
                 OneJoint("{type: revolute, alpha: 0, d: 1e300, theta: 0, r: 0}"),
                 {"'joints[1].d'", "'1e300' is out of range"}},
        BadRobot{"null_number",
                 OneJoint("{type: revolute, alpha: 0, d: , theta: 0, r: 0}"),
                 {"'joints[1].d'", "expected a number"}},
        BadRobot{"gravity_length",
                 OneJoint(kGood) + "gravity: [0, -9.81]\n",
                 {":4:", "'gravity'", "has 2 values", "3 numbers"}},
        BadRobot{"gravity_text", OneJoint(kGood) + "gravity: [0, 0, down]\n", {"'gravity[3]'", "'down'"}},
        BadRobot{"transmission_rows",
                 Joints(2) + "transmission: [[1, 0]]\n",
                 {":4:", "'transmission'", "has 1 rows", "2 x 2"}},
        BadRobot{"transmission_columns",
                 Joints(2) + "transmission:\n  - [1, 0]\n  - [0, 1, 0]\n",
                 {":6:", "'transmission[2]'", "has 3 values", "2 numbers"}},
        BadRobot{"transmission_inf", Joints(1) + "transmission: [[.inf]]\n", {"'transmission[1][1]'", "not finite"}},
        BadRobot{"transmission_singular",
                 Joints(2) + "transmission: [[32, 16], [64, 32]]\n",
                 {":4:", "'transmission'", "singular", "reciprocal condition number", "invertible"}},
        BadRobot{"transmission_zero", Joints(1) + "transmission: [[0]]\n", {"singular", "condition number 0"}},
        BadRobot{
            "coupling_key", Joints(2) + "couplings: [{motr: 2, joints: [1, 2]}]\n", {"'couplings[1].motr'", "'motor'"}},
        BadRobot{"coupling_motor_range",
                 Joints(2) + "couplings: [{motor: 3, joints: [1, 2]}]\n",
                 {":4:", "'couplings[1].motor'", "out of range", "from 1 to 2"}},
        BadRobot{"coupling_motor_zero", Joints(2) + "couplings: [{motor: 0, joints: [1, 2]}]\n", {"from 1 to 2"}},
        BadRobot{"coupling_joint_half",
                 Joints(2) + "couplings: [{motor: 2, joints: [1.5, 2]}]\n",
                 {"'couplings[1].joints[1]'", "not an integer"}},
        BadRobot{"coupling_joint_range",
                 Joints(2) + "couplings: [{motor: 2, joints: [2, 5]}]\n",
                 {"'couplings[1].joints[2]'", "from 1 to 2"}},
        BadRobot{"coupling_without_motor",
                 Joints(3) + "couplings: [{motor: 3, joints: [1, 2]}]\n",
                 {"'couplings[1].joints'", "joint 3 among them"}},
        BadRobot{"coupling_alone", Joints(2) + "couplings: [{motor: 2, joints: [2]}]\n", {"at least two joints"}},
        BadRobot{"coupling_repeated_joint",
                 Joints(2) + "couplings: [{motor: 2, joints: [2, 2]}]\n",
                 {"joint 2 is listed twice"}},
        BadRobot{"coupling_repeated_motor",
                 Joints(3) + "couplings: [{motor: 2, joints: [1, 2]}, {motor: 2, joints: [2, 3]}]\n",
                 {"'couplings[2].motor'", "one coupling a motor"}},
        BadRobot{"coupling_not_coupled",
                 Joints(2) + "transmission: [[1, 0], [0, 1]]\n" + "couplings: [{motor: 2, joints: [1, 2]}]\n",
                 {"joint 1 does not turn motor 2", "transmission[2][1] is 0"}}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(ReadRobot, MissingFile) {
  const Result<Robot> robot = ReadRobot("/no/such/robot.yaml");
  ASSERT_FALSE(robot.ok());
  EXPECT_THAT(robot.status().message(), HasSubstr("/no/such/robot.yaml"));
}

TEST(ReadRobot, Ur10eFromUrdfAndMdhAgree) {
  const Result<Robot> mdh = ReadRobot(IDIM_SOURCE_DIR "/datasets/ur10e/robot.yaml");
  const Result<Robot> urdf = ReadRobot(IDIM_SOURCE_DIR "/datasets/ur10e/robot_urdf.yaml");
  ASSERT_TRUE(mdh.ok()) << mdh.status().message();
  ASSERT_TRUE(urdf.ok()) << urdf.status().message();
  ASSERT_EQ(urdf->dof(), 6);
  EXPECT_EQ(urdf->joints[2].name, "elbow_joint");
  std::mt19937 generator(2);
  std::uniform_real_distribution<double> uniform(-3.1, 3.1);
  // The URDF stops 0.117 m short of the flange, along the axis of joint 6; a turn about that axis remains between the
  // two last frames, the same for every q.
  Isometry3d last = Isometry3d::Identity();
  for (int trial = 0; trial < 50; ++trial) {
    Eigen::VectorXd q(6);
    for (double& x : q) x = uniform(generator);
    const Isometry3d a = ForwardKinematics(*urdf, q);
    const Isometry3d b = ForwardKinematics(*mdh, q);
    const Isometry3d between = a.inverse() * b;
    if (trial == 0) last = between;
    EXPECT_LT((between.matrix() - last.matrix()).cwiseAbs().maxCoeff(), 1e-12);
    EXPECT_LT((between.translation() - Vector3d(0.0, 0.0, 0.117)).norm(), 1e-12);
    EXPECT_LT((between.linear().col(2) - Vector3d::UnitZ()).norm(), 1e-12);
  }
}

}  // namespace
}  // namespace idim::robot_reader_test
