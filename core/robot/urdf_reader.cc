// ReadUrdf, by urdfdom: the parsing is the ecosystem's own; here the tree becomes a chain with z along the joints.

#include <console_bridge/console.h>
#include <urdf_model/model.h>
#include <urdf_parser/urdf_parser.h>

#include <Eigen/Geometry>
#include <cmath>
#include <mutex>
#include <set>

#include "core/base/file.h"
#include "core/base/text.h"
#include "core/robot/robot_reader.h"

namespace idim {

namespace {

// urdfdom reports through a global logger: what it says belongs in our message, not on the user's terminal.
class CapturedLog : public console_bridge::OutputHandler {
 public:
  CapturedLog() : lock_(Mutex()) { console_bridge::useOutputHandler(this); }
  ~CapturedLog() override { console_bridge::restorePreviousOutputHandler(); }
  CapturedLog(const CapturedLog&) = delete;
  CapturedLog& operator=(const CapturedLog&) = delete;

  void log(const std::string& text, console_bridge::LogLevel level, const char*, int) override {
    if (level >= console_bridge::CONSOLE_BRIDGE_LOG_ERROR) errors_.push_back(text);
  }
  std::string Errors() const { return Join(errors_, ", "); }

 private:
  static std::mutex& Mutex() {
    static std::mutex mutex;
    return mutex;
  }

  std::lock_guard<std::mutex> lock_;
  std::vector<std::string> errors_;
};

Eigen::Vector3d ToEigen(const urdf::Vector3& v) { return {v.x, v.y, v.z}; }

Eigen::Isometry3d ToEigen(const urdf::Pose& pose) {
  Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
  const urdf::Rotation& r = pose.rotation;
  out.linear() = Eigen::Quaterniond(r.w, r.x, r.y, r.z).normalized().toRotationMatrix();
  out.translation() = ToEigen(pose.position);
  return out;
}

// The shortest rotation that takes z onto a unit axis; by pi about x for -z, where no shortest one is singled out.
Eigen::Matrix3d RotationFromZ(const Eigen::Vector3d& axis) {
  if (axis.z() > 1.0 - 1e-12 && axis.head<2>().isZero()) return Eigen::Matrix3d::Identity();
  const Eigen::Vector3d cross = Eigen::Vector3d::UnitZ().cross(axis);
  if (cross.norm() < 1e-12 && axis.z() < 0.0) return Eigen::Vector3d(1.0, -1.0, -1.0).asDiagonal();
  return Eigen::AngleAxisd(std::atan2(cross.norm(), axis.z()), cross.normalized()).toRotationMatrix();
}

const char* TypeName(int type) {
  switch (type) {
    case urdf::Joint::FLOATING:
      return "floating";
    case urdf::Joint::PLANAR:
      return "planar";
    default:
      return "of unknown type";
  }
}

// A moving joint on a rigid body, with the pose of its frame in the frame of that body.
struct MovingJoint {
  urdf::JointConstSharedPtr joint;
  Eigen::Isometry3d pose;
};

class ChainBuilder {
 public:
  explicit ChainBuilder(std::string path) : path_(std::move(path)) {}

  Status Build(const urdf::ModelInterface& model, Robot* robot) {
    std::string parent = model.getRoot()->name;
    Eigen::Isometry3d frame_in_link = Eigen::Isometry3d::Identity();  // of the internal frame; the base is not turned
    InertialVector base_inertial = InertialVector::Zero();
    std::vector<MovingJoint> moving;
    Status status = Collect(*model.getRoot(), Eigen::Isometry3d::Identity(), &base_inertial, &moving);
    while (status.ok() && !moving.empty()) {
      if (moving.size() > 1) {
        return Status::BadInput(path_ + ": joint '" + moving[1].joint->name + "': the tree branches, link '" + parent +
                                "' carries joint '" + moving[0].joint->name +
                                "' too; expected one moving joint a link");
      }
      const MovingJoint current = moving[0];
      const urdf::Joint& urdf_joint = *current.joint;
      const Eigen::Vector3d axis = ToEigen(urdf_joint.axis);
      if (!axis.allFinite() || axis.norm() < 1e-9) {
        return Status::BadInput(path_ + ": joint '" + urdf_joint.name +
                                "': the axis has length zero; expected a direction, e.g. <axis xyz=\"0 0 1\"/>");
      }
      Eigen::Isometry3d child_frame = Eigen::Isometry3d::Identity();  // in the frame of the child link
      child_frame.linear() = RotationFromZ(axis.normalized());
      const Eigen::Isometry3d pose = frame_in_link.inverse() * current.pose * child_frame;
      Joint joint;
      joint.type = urdf_joint.type == urdf::Joint::PRISMATIC ? JointType::kPrismatic : JointType::kRevolute;
      joint.name = urdf_joint.name;
      joint.rotation = pose.linear();
      joint.translation = pose.translation();
      robot->joints.push_back(joint);

      const urdf::LinkConstSharedPtr link = model.getLink(urdf_joint.child_link_name);
      parent = link->name;
      frame_in_link = child_frame;
      InertialVector inertial = InertialVector::Zero();
      moving.clear();
      status = Collect(*link, Eigen::Isometry3d::Identity(), &inertial, &moving);
      const Eigen::Isometry3d link_in_frame = child_frame.inverse();
      robot->declared_inertials.push_back(
          TransformInertial(inertial, link_in_frame.linear(), link_in_frame.translation()));
    }
    IDIM_RETURN_IF_ERROR(status);
    if (visited_.size() != model.links_.size()) {
      for (const auto& [name, link] : model.links_) {
        if (visited_.count(name) == 0) {
          return Status::BadInput(path_ + ": link '" + name + "' cannot be reached from the base link '" +
                                  model.getRoot()->name + "': the joints close a loop; expected a serial chain");
        }
      }
    }
    if (robot->joints.empty()) {
      return Status::BadInput(path_ + ": no moving joint; expected at least one revolute, continuous or prismatic one");
    }
    return Status::Ok();
  }

 private:
  // The rigid body made of `link` and all that is fixed to it. `pose`: of the link in the frame of the body.
  Status Collect(const urdf::Link& link, const Eigen::Isometry3d& pose, InertialVector* inertial,
                 std::vector<MovingJoint>* moving) {
    if (!visited_.insert(link.name).second) {
      return Status::BadInput(path_ + ": link '" + link.name + "' is the child of two joints; expected a serial chain");
    }
    if (link.inertial != nullptr) {
      const urdf::Inertial& given = *link.inertial;
      const Eigen::Isometry3d centre = pose * ToEigen(given.origin);
      Eigen::Matrix3d tensor;
      tensor << given.ixx, given.ixy, given.ixz, given.ixy, given.iyy, given.iyz, given.ixz, given.iyz, given.izz;
      tensor = (centre.linear() * tensor * centre.linear().transpose()).eval();
      const InertialVector added = InertialFromCentreOfMass(given.mass, centre.translation(), tensor);
      if (!added.allFinite() || added.cwiseAbs().maxCoeff() > kLargestInput || given.mass < 0.0) {
        return Status::BadInput(path_ + ": link '" + link.name + "': the inertial is not usable (mass " +
                                FormatNumber(given.mass) + "); expected finite values and a mass of at least 0");
      }
      *inertial += added;
    }
    for (const urdf::JointSharedPtr& joint : link.child_joints) {
      const std::string name = path_ + ": joint '" + joint->name + "': ";
      const Eigen::Isometry3d joint_pose = pose * ToEigen(joint->parent_to_joint_origin_transform);
      if (!joint_pose.matrix().allFinite() || joint_pose.matrix().cwiseAbs().maxCoeff() > kLargestInput) {
        return Status::BadInput(name + "the origin is not finite or beyond 1e12; expected metres and radians");
      }
      if (joint->mimic != nullptr) {
        return Status::BadInput(name + "mimics joint '" + joint->mimic->joint_name +
                                "'; expected joints that move independently of each other");
      }
      switch (joint->type) {
        case urdf::Joint::REVOLUTE:
        case urdf::Joint::CONTINUOUS:
        case urdf::Joint::PRISMATIC:
          moving->push_back({joint, joint_pose});
          break;
        case urdf::Joint::FIXED: {
          IDIM_RETURN_IF_ERROR(Collect(*ChildOf(link, *joint), joint_pose, inertial, moving));
          break;
        }
        default:
          return Status::BadInput(name + "is " + TypeName(joint->type) +
                                  "; expected revolute, continuous, prismatic or fixed");
      }
    }
    return Status::Ok();
  }

  static const urdf::Link* ChildOf(const urdf::Link& link, const urdf::Joint& joint) {
    for (const urdf::LinkSharedPtr& child : link.child_links) {
      if (child->name == joint.child_link_name) return child.get();
    }
    return nullptr;  // urdfdom fills both lists together
  }

  std::string path_;
  std::set<std::string> visited_;
};

}  // namespace

Result<Robot> ReadUrdf(const std::string& urdf_path) {
  const Result<std::string> text = ReadFile(urdf_path);
  IDIM_RETURN_IF_ERROR(text);
  urdf::ModelInterfaceSharedPtr model;
  std::string problem;
  {
    CapturedLog log;
    try {
      model = urdf::parseURDF(*text);
      problem = log.Errors();
    } catch (const std::exception& error) {
      problem = error.what();
      model.reset();
    }
  }
  if (model == nullptr || model->getRoot() == nullptr || !problem.empty()) {
    return Status::BadInput(urdf_path + ": not a usable URDF: " + (problem.empty() ? std::string("no link") : problem) +
                            "; expected a well-formed <robot> of links and joints");
  }
  Robot robot;
  robot.name = model->getName();
  const Status status = ChainBuilder(urdf_path).Build(*model, &robot);
  // Links own their children: a closed loop of them would never be freed.
  for (const auto& [name, link] : model->links_) link->child_links.clear();
  IDIM_RETURN_IF_ERROR(status);
  robot.transmission = Eigen::MatrixXd::Identity(robot.dof(), robot.dof());
  return robot;
}

}  // namespace idim
