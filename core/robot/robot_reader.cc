#include "core/robot/robot_reader.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "core/base/decompositions.h"
#include "core/base/file.h"
#include "core/base/text.h"
#include "core/base/yaml.h"

namespace idim {

namespace {

constexpr double kSmallestReciprocalCondition = 1e-10;

std::vector<Joint> ReadMdhJoints(YamlFile* file, const YAML::Node& list) {
  std::vector<Joint> joints;
  if (!file->List(list, "joints", "a list of joints, {type: revolute, alpha: .., d: .., theta: .., r: ..} each")) {
    return joints;
  }
  if (list.size() == 0) file->Fail(list, "joints", "the list is empty", "at least one joint");
  for (size_t j = 0; j < list.size() && file->ok(); ++j) {
    const YAML::Node& node = list[j];
    const std::string key = KeyPath("joints", j);
    if (!file->Map(node, key, {"type", "alpha", "d", "theta", "r"})) break;
    double value[4] = {};
    constexpr const char* kNames[4] = {"alpha", "d", "theta", "r"};
    if (!file->Require(node, key, "type", "revolute or prismatic")) break;
    const int type = file->Choice(node["type"], KeyPath(key, "type"), {"revolute", "prismatic"});
    for (int i = 0; i < 4; ++i) {
      if (!file->Require(node, key, kNames[i], "a number (alpha, theta in rad; d, r in m)")) break;
      value[i] = file->Number(node[kNames[i]], KeyPath(key, kNames[i]));
    }
    if (!file->ok()) break;
    joints.push_back(JointFromModifiedDh(type == 0 ? JointType::kRevolute : JointType::kPrismatic, value[0], value[1],
                                         value[2], value[3]));
    joints.back().name = std::to_string(j + 1);
  }
  return joints;
}

Eigen::MatrixXd ReadTransmission(YamlFile* file, const YAML::Node& node, int n) {
  Eigen::MatrixXd transmission = Eigen::MatrixXd::Identity(n, n);
  const std::string size = std::to_string(n) + " x " + std::to_string(n);
  const std::string expected = size + " numbers, a list of " + std::to_string(n) + " rows";
  if (!file->List(node, "transmission", expected)) return transmission;
  if (static_cast<int>(node.size()) != n) {
    file->Fail(node, "transmission", "has " + std::to_string(node.size()) + " rows", expected);
    return transmission;
  }
  for (int i = 0; i < n; ++i) {
    transmission.row(i) = file->Numbers(node[i], KeyPath("transmission", i), n, "a row of a " + size + " matrix");
  }
  if (!file->ok()) return transmission;
  const Eigen::VectorXd singular = Eigen::JacobiSVD<Eigen::MatrixXd>(transmission).singularValues();
  const double reciprocal = singular[0] > 0.0 ? singular[n - 1] / singular[0] : 0.0;
  if (!(reciprocal >= kSmallestReciprocalCondition)) {
    char text[32];
    std::snprintf(text, sizeof(text), "%.3g", reciprocal);
    file->Fail(node, "transmission", std::string("the matrix is singular (reciprocal condition number ") + text + ")",
               "an invertible matrix, motor position = transmission * joint position");
  }
  return transmission;
}

// `transmission` is null when the file declares none: then motors turn with the plain sum of the joint velocities.
std::vector<Coupling> ReadCouplings(YamlFile* file, const YAML::Node& list, int n,
                                    const Eigen::MatrixXd* transmission) {
  std::vector<Coupling> couplings;
  if (!file->List(list, "couplings", "a list of couplings, {motor: 6, joints: [5, 6]} each")) return couplings;
  for (size_t i = 0; i < list.size() && file->ok(); ++i) {
    const YAML::Node& node = list[i];
    const std::string key = KeyPath("couplings", i);
    if (!file->Map(node, key, {"motor", "joints"}) ||
        !file->Require(node, key, "motor", "the number of a motor, from 1") ||
        !file->Require(node, key, "joints", "the joints that turn this motor, the motor's own among them") ||
        !file->List(node["joints"], KeyPath(key, "joints"), "a list of joint numbers")) {
      break;
    }
    Coupling coupling;
    coupling.motor = file->Integer(node["motor"], KeyPath(key, "motor"), 1, n) - 1;
    const YAML::Node& joints = node["joints"];
    for (size_t k = 0; k < joints.size() && file->ok(); ++k) {
      const std::string joint_key = KeyPath(KeyPath(key, "joints"), k);
      const int joint = file->Integer(joints[k], joint_key, 1, n) - 1;
      if (std::count(coupling.joints.begin(), coupling.joints.end(), joint) != 0) {
        file->Fail(joints[k], joint_key, "joint " + std::to_string(joint + 1) + " is listed twice", "distinct joints");
      }
      coupling.joints.push_back(joint);
    }
    if (!file->ok()) break;
    const std::string motor = std::to_string(coupling.motor + 1);
    if (coupling.joints.size() < 2 || std::count(coupling.joints.begin(), coupling.joints.end(), coupling.motor) == 0) {
      file->Fail(joints, KeyPath(key, "joints"), "does not couple motor " + motor + " with another joint",
                 "at least two joints, joint " + motor + " among them");
    }
    for (const Coupling& other : couplings) {
      if (other.motor == coupling.motor) {
        file->Fail(node, KeyPath(key, "motor"), "motor " + motor + " has a coupling already", "one coupling a motor");
      }
    }
    for (const int joint : coupling.joints) {
      const double ratio = transmission == nullptr ? 1.0 : (*transmission)(coupling.motor, joint);
      if (ratio == 0.0) {
        file->Fail(node, KeyPath(key, "joints"),
                   "joint " + std::to_string(joint + 1) + " does not turn motor " + motor + ": transmission[" + motor +
                       "][" + std::to_string(joint + 1) + "] is 0",
                   "a transmission that couples them");
        break;
      }
      const double own = transmission == nullptr ? 1.0 : (*transmission)(coupling.motor, coupling.motor);
      coupling.weights.push_back(ratio / own);
    }
    couplings.push_back(std::move(coupling));
  }
  return couplings;
}

}  // namespace

Result<Robot> ReadRobot(const std::string& yaml_path) {
  YamlFile file(yaml_path);
  const YAML::Node& root = file.root();
  if (!file.Map(root, "", {"name", "gravity", "joints", "urdf", "transmission", "couplings"})) return file.status();
  const bool has_joints = root["joints"].IsDefined();
  const bool has_urdf = root["urdf"].IsDefined();
  if (has_joints && has_urdf) {
    file.Fail(root["urdf"], "urdf", "given together with 'joints'", "exactly one of 'joints' and 'urdf'");
  } else if (!has_joints && !has_urdf) {
    file.Fail(root, "joints", "missing", "exactly one of 'joints' and 'urdf'");
  }

  Robot robot;
  if (has_urdf) {
    const std::string urdf = file.Text(root["urdf"], "urdf", "the path of a URDF file");
    IDIM_RETURN_IF_ERROR(file);
    const std::string urdf_path = ResolvePath(FolderOf(yaml_path), urdf);
    if (!IsRegularFile(urdf_path)) file.Fail(root["urdf"], "urdf", "no such file '" + urdf_path + "'", "a URDF file");
    IDIM_RETURN_IF_ERROR(file);
    Result<Robot> read = ReadUrdf(urdf_path);
    IDIM_RETURN_IF_ERROR(read);
    robot = *std::move(read);
  } else if (file.ok()) {
    robot.name = std::filesystem::path(yaml_path).stem().string();
    robot.joints = ReadMdhJoints(&file, root["joints"]);
  }
  IDIM_RETURN_IF_ERROR(file);

  const int n = robot.dof();
  if (root["name"].IsDefined()) robot.name = file.Text(root["name"], "name", "a name");
  if (root["gravity"].IsDefined()) {
    robot.gravity = file.Numbers(root["gravity"], "gravity", 3, "m/s^2 in the base frame");
  }
  robot.transmission = Eigen::MatrixXd::Identity(n, n);
  const bool has_transmission = root["transmission"].IsDefined();
  if (has_transmission) robot.transmission = ReadTransmission(&file, root["transmission"], n);
  if (root["couplings"].IsDefined()) {
    robot.couplings = ReadCouplings(&file, root["couplings"], n, has_transmission ? &robot.transmission : nullptr);
  }
  IDIM_RETURN_IF_ERROR(file);
  return robot;
}

}  // namespace idim
