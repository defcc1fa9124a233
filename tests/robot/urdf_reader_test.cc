#include <gmock/gmock.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <random>

#include "core/robot/robot_reader.h"
#include "tests/support/forward_kinematics.h"
#include "tests/support/temp_folder.h"

namespace idim::urdf_reader_test {
namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using ::testing::HasSubstr;

std::string Link(const std::string& name, const std::string& inside = "") {
  return "<link name=\"" + name + "\">" + inside + "</link>\n";
}

std::string JointXml(const std::string& name, const std::string& type, const std::string& parent,
                     const std::string& child, const std::string& inside = "") {
  return "<joint name=\"" + name + "\" type=\"" + type + "\"><parent link=\"" + parent + "\"/><child link=\"" + child +
         "\"/>" + inside + "<limit lower=\"-1\" upper=\"1\" effort=\"1\" velocity=\"1\"/></joint>\n";
}

std::string RobotXml(const std::string& inside) {
  return "<?xml version=\"1.0\"?>\n<robot name=\"arm\">\n" + inside + "</robot>\n";
}

Result<Robot> ReadText(const std::string& text) {
  const TempFolder folder;
  return ReadUrdf(folder.Write("arm.urdf", text));
}

const char kInertialA[] =
    "<inertial><origin xyz=\"0.1 -0.2 0.3\" rpy=\"0.4 0.5 -0.6\"/><mass value=\"2.5\"/>"
    "<inertia ixx=\"0.11\" ixy=\"0.01\" ixz=\"-0.02\" iyy=\"0.12\" iyz=\"0.015\" izz=\"0.13\"/></inertial>";
const char kInertialB[] =
    "<inertial><origin xyz=\"-0.05 0.02 0.01\" rpy=\"0 0.1 0\"/><mass value=\"0.75\"/>"
    "<inertia ixx=\"0.02\" ixy=\"0\" ixz=\"0.001\" iyy=\"0.03\" iyz=\"0\" izz=\"0.025\"/></inertial>";

// Extrinsic x, y, z, as URDF defines roll, pitch and yaw.
Matrix3d FromRpy(double roll, double pitch, double yaw) {
  return (AngleAxisd(yaw, Vector3d::UnitZ()) * AngleAxisd(pitch, Vector3d::UnitY()) *
          AngleAxisd(roll, Vector3d::UnitX()))
      .toRotationMatrix();
}

Isometry3d Pose(const Matrix3d& rotation, const Vector3d& translation) {
  Isometry3d pose = Isometry3d::Identity();
  pose.linear() = rotation;
  pose.translation() = translation;
  return pose;
}

// Six point masses of the same mass, centre and tensor as an inertial: a body without any frame formula in it.
// Second moments about the centre: S = tr(I)/2 - I = sum m p p'. Pairs at +-c_i along the eigenvectors of S.
struct PointMasses {
  std::vector<Vector3d> points;
  std::vector<double> masses;

  void Add(const Matrix3d& tensor, double mass, const Isometry3d& pose) {
    const Matrix3d second = 0.5 * tensor.trace() * Matrix3d::Identity() - tensor;
    const Eigen::SelfAdjointEigenSolver<Matrix3d> eigen(second);
    for (int i = 0; i < 3; ++i) {
      const double share = mass / 6.0;
      const Vector3d arm = std::sqrt(eigen.eigenvalues()[i] / (2.0 * share)) * eigen.eigenvectors().col(i);
      for (const double sign : {1.0, -1.0}) {
        points.push_back(pose * (sign * arm));
        masses.push_back(share);
      }
    }
  }
  // About the origin of a frame given in the frame of the points.
  InertialVector About(const Isometry3d& frame) const {
    Matrix3d tensor = Matrix3d::Zero();
    Vector3d first = Vector3d::Zero();
    double mass = 0.0;
    for (size_t i = 0; i < points.size(); ++i) {
      const Vector3d p = frame.inverse() * points[i];
      tensor += masses[i] * (p.squaredNorm() * Matrix3d::Identity() - p * p.transpose());
      first += masses[i] * p;
      mass += masses[i];
    }
    InertialVector out;
    out << tensor(0, 0), tensor(0, 1), tensor(0, 2), tensor(1, 1), tensor(1, 2), tensor(2, 2), first, mass;
    return out;
  }
};

Matrix3d TensorA() {
  Matrix3d tensor;
  tensor << 0.11, 0.01, -0.02, 0.01, 0.12, 0.015, -0.02, 0.015, 0.13;
  return tensor;
}
Matrix3d TensorB() {
  Matrix3d tensor;
  tensor << 0.02, 0.0, 0.001, 0.0, 0.03, 0.0, 0.001, 0.0, 0.025;
  return tensor;
}

TEST(ReadUrdf, FixedJointsAreMergedWithTheirInertials) {
  // base -fixed- foot -revolute about y- arm -fixed- plate -fixed- tool
  const Result<Robot> robot = ReadText(RobotXml(
      Link("base", kInertialA) + Link("foot") + Link("arm", kInertialA) + Link("plate") + Link("tool", kInertialB) +
      JointXml("mount", "fixed", "base", "foot", "<origin xyz=\"0 0 0.4\" rpy=\"0 0 1\"/>") +
      JointXml("turn", "revolute", "foot", "arm", "<origin xyz=\"0.1 0 0\" rpy=\"0.2 0 0\"/><axis xyz=\"0 2 0\"/>") +
      JointXml("f1", "fixed", "arm", "plate", "<origin xyz=\"0 0.3 0\" rpy=\"0 -0.3 0\"/>") +
      JointXml("f2", "fixed", "plate", "tool", "<origin xyz=\"0.2 0 0.1\" rpy=\"0.7 0 0.5\"/>")));
  ASSERT_TRUE(robot.ok()) << robot.status().message();
  EXPECT_EQ(robot->name, "arm");
  ASSERT_EQ(robot->dof(), 1);
  EXPECT_EQ(robot->joints[0].name, "turn");
  EXPECT_EQ(robot->joints[0].type, JointType::kRevolute);
  ASSERT_EQ(robot->declared_inertials.size(), 1u);

  PointMasses body;  // in the URDF frame of link arm
  body.Add(TensorA(), 2.5, Pose(FromRpy(0.4, 0.5, -0.6), Vector3d(0.1, -0.2, 0.3)));
  const Isometry3d tool =
      Pose(FromRpy(0, -0.3, 0), Vector3d(0, 0.3, 0)) * Pose(FromRpy(0.7, 0, 0.5), Vector3d(0.2, 0, 0.1));
  body.Add(TensorB(), 0.75, tool * Pose(FromRpy(0, 0.1, 0), Vector3d(-0.05, 0.02, 0.01)));
  // z onto y by the shortest way: by -pi/2 about x.
  const Isometry3d frame = Pose(FromRpy(-1.5707963267948966, 0, 0), Vector3d::Zero());
  EXPECT_LT((robot->declared_inertials[0] - body.About(frame)).cwiseAbs().maxCoeff(), 1e-12);

  // The fixed way from the base is in joint 1.
  const double q = 0.6;
  const Isometry3d by_hand = Pose(FromRpy(0, 0, 1), Vector3d(0, 0, 0.4)) *
                             Pose(FromRpy(0.2, 0, 0), Vector3d(0.1, 0, 0)) * Pose(FromRpy(0, q, 0), Vector3d::Zero()) *
                             frame;
  EXPECT_LT((ForwardKinematics(*robot, Eigen::VectorXd::Constant(1, q)).matrix() - by_hand.matrix()).norm(), 1e-12);
}

TEST(ReadUrdf, AnyAxisAndPrismatic) {
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<Vector3d> axes = {{0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {-1, 0, 0}, {0, -1, 0}, {1e-9, 0, -1}, {1e-9, 0, 1}};
  for (int i = 0; i < 20; ++i) axes.emplace_back(uniform(generator), uniform(generator), uniform(generator));
  for (const Vector3d& axis : axes) {
    std::ostringstream xyz;
    xyz.precision(17);
    xyz << "<axis xyz=\"" << axis.x() << " " << axis.y() << " " << axis.z() << "\"/>";
    const Result<Robot> robot = ReadText(
        RobotXml(Link("base") + Link("a") + Link("b", kInertialA) +
                 JointXml("one", "continuous", "base", "a", "<origin xyz=\"1 2 3\" rpy=\"0.1 0.2 0.3\"/>" + xyz.str()) +
                 JointXml("two", "prismatic", "a", "b", "<origin xyz=\"-1 0.5 0\" rpy=\"0 -0.4 0\"/>" + xyz.str())));
    ASSERT_TRUE(robot.ok()) << robot.status().message();
    ASSERT_EQ(robot->dof(), 2);
    EXPECT_EQ(robot->joints[1].type, JointType::kPrismatic);
    EXPECT_EQ(robot->declared_inertials[0], InertialVector::Zero());
    const Vector3d unit = axis.normalized();
    for (const Joint& joint : robot->joints) {
      EXPECT_LT((joint.rotation * joint.rotation.transpose() - Matrix3d::Identity()).norm(), 1e-12);
      EXPECT_NEAR(joint.rotation.determinant(), 1.0, 1e-12);
    }
    const Eigen::Vector2d q(uniform(generator), uniform(generator));
    // Moved in URDF frames; the internal frame has the same origin and its z along the axis.
    const Isometry3d urdf = Pose(FromRpy(0.1, 0.2, 0.3), Vector3d(1, 2, 3)) *
                            Pose(AngleAxisd(q[0], unit).toRotationMatrix(), Vector3d::Zero()) *
                            Pose(FromRpy(0, -0.4, 0), Vector3d(-1, 0.5, 0)) * Pose(Matrix3d::Identity(), q[1] * unit);
    const Isometry3d pose = ForwardKinematics(*robot, q);
    EXPECT_LT((pose.translation() - urdf.translation()).norm(), 1e-12) << axis.transpose();
    EXPECT_LT((pose.linear().col(2) - urdf.linear() * unit).norm(), 1e-12) << axis.transpose();
    // The shortest turn: by the angle between z and the axis, no more.
    const Matrix3d turn = urdf.linear().transpose() * pose.linear();
    EXPECT_NEAR(AngleAxisd(turn).angle(), std::acos(std::clamp(unit.z(), -1.0, 1.0)), 1e-7) << axis.transpose();
    // The inertial belongs to the body, not to the frame.
    PointMasses body;
    body.Add(TensorA(), 2.5, Pose(FromRpy(0.4, 0.5, -0.6), Vector3d(0.1, -0.2, 0.3)));
    EXPECT_LT((robot->declared_inertials[1] - body.About(Pose(turn, Vector3d::Zero()))).cwiseAbs().maxCoeff(), 1e-12);
  }
}

TEST(ReadUrdf, AxisAlongMinusZIsTurnedByPiAboutX) {
  const Result<Robot> robot =
      ReadText(RobotXml(Link("base") + Link("a") + JointXml("one", "revolute", "base", "a", "<axis xyz=\"0 0 -1\"/>")));
  ASSERT_TRUE(robot.ok()) << robot.status().message();
  EXPECT_EQ(robot->joints[0].rotation, Matrix3d(Vector3d(1, -1, -1).asDiagonal()));
}

TEST(ReadUrdf, PathIsRelativeToTheRobotFile) {
  const TempFolder folder;
  folder.Write("description/arm.urdf", RobotXml(Link("base") + Link("a") + JointXml("one", "revolute", "base", "a")));
  const Result<Robot> robot =
      ReadRobot(folder.Write("robots/robot.yaml", "urdf: ../description/arm.urdf\ntransmission: [[50]]\n"));
  ASSERT_TRUE(robot.ok()) << robot.status().message();
  EXPECT_EQ(robot->name, "arm");
  EXPECT_EQ(robot->transmission(0, 0), 50.0);
}

struct BadUrdf {
  const char* name;
  std::string text;
  std::vector<std::string> message;
};

void PrintTo(const BadUrdf& test, std::ostream* out) { *out << test.name; }

class BadUrdfTest : public ::testing::TestWithParam<BadUrdf> {};

TEST_P(BadUrdfTest, IsRefusedWithAClearMessageAndNothingPrinted) {
  ::testing::internal::CaptureStderr();
  ::testing::internal::CaptureStdout();
  const Result<Robot> robot = ReadText(GetParam().text);
  EXPECT_EQ(::testing::internal::GetCapturedStderr() + ::testing::internal::GetCapturedStdout(), "");
  ASSERT_FALSE(robot.ok());
  EXPECT_EQ(robot.status().code(), StatusCode::kBadInput);
  EXPECT_THAT(robot.status().message(), HasSubstr("arm.urdf: "));
  EXPECT_THAT(robot.status().message(), HasSubstr("; expected "));
  for (const std::string& part : GetParam().message) EXPECT_THAT(robot.status().message(), HasSubstr(part));
}

const std::string kBase = Link("base") + Link("a");
const std::string kTwo = kBase + Link("b");
const std::string kFirst = JointXml("one", "revolute", "base", "a");

INSTANTIATE_TEST_SUITE_P(
    Table, BadUrdfTest,
    ::testing::Values(
        BadUrdf{"empty", "", {"not a usable URDF"}}, BadUrdf{"not_xml", "hello", {"not a usable URDF"}},
        BadUrdf{"cut_off", RobotXml(kBase + kFirst).substr(0, 150), {"not a usable URDF"}},
        BadUrdf{"other_root", "<sdf/>", {"not a usable URDF"}}, BadUrdf{"no_link", RobotXml(""), {"not a usable URDF"}},
        BadUrdf{"missing_link", RobotXml(Link("base") + kFirst), {"not a usable URDF", "a"}},
        BadUrdf{"text_number",
                RobotXml(kBase + JointXml("one", "revolute", "base", "a", "<origin xyz=\"0 0 x\"/>")),
                {"not a usable URDF"}},
        BadUrdf{
            "nan_number", RobotXml(kBase + JointXml("one", "revolute", "base", "a", "<origin xyz=\"0 0 nan\"/>")), {}},
        BadUrdf{"huge_number",
                RobotXml(kBase + JointXml("one", "revolute", "base", "a", "<origin xyz=\"0 0 1e300\"/>")),
                {"joint 'one'", "1e12"}},
        BadUrdf{"mimic",
                RobotXml(kTwo + kFirst + JointXml("two", "revolute", "a", "b", "<mimic joint=\"one\"/>")),
                {"joint 'two'", "mimics joint 'one'"}},
        BadUrdf{"fixed_mimic",
                RobotXml(kTwo + kFirst + JointXml("two", "fixed", "a", "b", "<mimic joint=\"one\"/>")),
                {"joint 'two'", "mimics"}},
        BadUrdf{"floating",
                RobotXml(kTwo + kFirst + JointXml("two", "floating", "a", "b")),
                {"joint 'two'", "is floating", "expected revolute"}},
        BadUrdf{"planar", RobotXml(kTwo + kFirst + JointXml("two", "planar", "a", "b")), {"joint 'two'", "is planar"}},
        BadUrdf{"branch",
                RobotXml(kTwo + kFirst + JointXml("two", "revolute", "base", "b")),
                {"joint 'two'", "branches", "joint 'one'", "link 'base'"}},
        BadUrdf{"branch_behind_fixed",
                RobotXml(kTwo + Link("c") + kFirst + JointXml("fix", "fixed", "base", "b") +
                         JointXml("two", "revolute", "b", "c")),
                {"branches"}},
        BadUrdf{"nothing_moves", RobotXml(kBase + JointXml("one", "fixed", "base", "a")), {"no moving joint"}},
        BadUrdf{"single_link", RobotXml(Link("base")), {"no moving joint"}},
        BadUrdf{"zero_axis",
                RobotXml(kBase + JointXml("one", "revolute", "base", "a", "<axis xyz=\"0 0 0\"/>")),
                {"joint 'one'", "axis has length zero"}},
        BadUrdf{"negative_mass",
                RobotXml(Link("base") +
                         Link("a",
                              "<inertial><mass value=\"-1\"/><inertia ixx=\"1\" ixy=\"0\" ixz=\"0\""
                              " iyy=\"1\" iyz=\"0\" izz=\"1\"/></inertial>") +
                         kFirst),
                {"link 'a'", "mass -1"}},
        BadUrdf{"loop",
                RobotXml(kTwo + Link("c") + kFirst + JointXml("two", "revolute", "b", "c") +
                         JointXml("three", "revolute", "c", "b")),
                {"loop"}},
        BadUrdf{
            "two_parents",
            RobotXml(kTwo + kFirst + JointXml("two", "revolute", "a", "b") + JointXml("three", "fixed", "base", "b")),
            {"link 'b'", "two joints"}}),
    [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace idim::urdf_reader_test
