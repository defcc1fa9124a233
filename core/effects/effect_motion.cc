#include "core/effects/effect_motion.h"

#include <glog/logging.h>

#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace idim {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr FrictionModel kNoFriction = {false, false, false};

// Links, drives and payload of the model so far. A StandardModel holds the workspace of one evaluation, so that each
// thread takes one of its own while it computes.
class RigidArm {
 public:
  RigidArm(const BaseParameters& base, const VectorXd& chi, const InertialVector& payload)
      : robot_(base.model().robot()), payload_(payload) {
    const StandardModel model(robot_, kNoFriction);
    links_and_drives_ = VectorXd::Zero(model.columns());
    links_ = links_and_drives_;
    for (int k = 0; k < base.size(); ++k) {
      const Parameter& parameter = base.model().parameters()[base.kept()[k]];
      const int column = model.Find(parameter.name);
      if (column < 0) continue;  // friction
      links_and_drives_[column] = chi[k];
      if (parameter.kind != ParameterKind::kDriveInertia) links_[column] = chi[k];
    }
  }

  VectorXd Torque(const VectorXd& q, const VectorXd& dq, const VectorXd& ddq, const Vector3d& gravity, bool drives) {
    CheckState(q, dq, ddq);
    const VectorXd& chi = drives ? links_and_drives_ : links_;
    std::unique_ptr<Workspace> work = Take();
    VectorXd tau(robot_.dof());
    work->models[0].Torque(q.data(), dq.data(), ddq.data(), nullptr, chi, payload_, tau.data());
    const Vector3d change = gravity - robot_.gravity;
    if (!change.isZero(0.0)) {
      const VectorXd zero = VectorXd::Zero(robot_.dof());
      VectorXd unit(robot_.dof());
      for (int k = 0; k < 3; ++k) {
        work->models[k + 1].Torque(q.data(), zero.data(), zero.data(), nullptr, chi, payload_, unit.data());
        tau += change[k] * unit;
      }
    }
    Return(std::move(work));
    return tau;
  }

  MatrixXd BodyColumns(const VectorXd& q, const VectorXd& dq, const VectorXd& ddq) {
    CheckState(q, dq, ddq);
    std::unique_ptr<Workspace> work = Take();
    StandardModel& model = work->models[0];
    work->regressor.resize(static_cast<size_t>(model.dof()) * model.columns());
    model.Regressor(q.data(), dq.data(), ddq.data(), nullptr, work->regressor.data());
    Eigen::Matrix<double, Eigen::Dynamic, kNumInertial, Eigen::RowMajor> columns(model.dof(), kNumInertial);
    model.PayloadColumns(columns.data());
    Return(std::move(work));
    return columns;
  }

 private:
  struct Workspace {
    std::vector<StandardModel> models;  // the robot's gravity, then unit gravity along x, y and z of the base
    std::vector<double> regressor;
  };

  void CheckState(const VectorXd& q, const VectorXd& dq, const VectorXd& ddq) const {
    CHECK_EQ(q.size(), robot_.dof());
    CHECK_EQ(dq.size(), robot_.dof());
    CHECK_EQ(ddq.size(), robot_.dof());
  }

  std::unique_ptr<Workspace> Take() {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      if (!idle_.empty()) {
        std::unique_ptr<Workspace> work = std::move(idle_.back());
        idle_.pop_back();
        return work;
      }
    }
    auto work = std::make_unique<Workspace>();
    work->models.emplace_back(robot_, kNoFriction);
    for (int k = 0; k < 3; ++k) {
      Robot robot = robot_;
      robot.gravity = Vector3d::Unit(k);
      work->models.emplace_back(robot, kNoFriction);
    }
    return work;
  }

  void Return(std::unique_ptr<Workspace> work) {
    const std::lock_guard<std::mutex> lock(mutex_);
    idle_.push_back(std::move(work));
  }

  Robot robot_;
  InertialVector payload_;
  VectorXd links_and_drives_, links_;  // parameters of a model without friction
  std::mutex mutex_;
  std::vector<std::unique_ptr<Workspace>> idle_;
};

}  // namespace

EffectMotion MakeEffectMotion(const BaseParameters& base, std::shared_ptr<const JointStates> shared_states,
                              int recording, const VectorXd& velocity_sigma, const VectorXd& chi,
                              const InertialVector& payload, const VectorXd& position_sigma) {
  const JointStates& states = *shared_states;
  StandardModel model = base.model();
  const int n = model.dof();
  const Index count = states.t.size();
  CHECK_EQ(chi.size(), base.size());
  CHECK_EQ(velocity_sigma.size(), n);
  CHECK(position_sigma.size() == 0 || position_sigma.size() == n);
  for (const MatrixXd* part : {&states.q, &states.dq, &states.ddq}) {
    CHECK_EQ(part->rows(), count);
    CHECK_EQ(part->cols(), n);
  }

  EffectMotion motion;
  motion.robot = &base.model().robot();
  motion.recording = recording;
  motion.states = std::move(shared_states);
  motion.velocity_sigma = velocity_sigma;
  motion.position_sigma = position_sigma;
  const auto arm = std::make_shared<RigidArm>(base, chi, payload);
  motion.rigid_torque = [arm](const VectorXd& q, const VectorXd& dq, const VectorXd& ddq, const Vector3d& gravity) {
    return arm->Torque(q, dq, ddq, gravity, true);
  };
  motion.link_torque = [arm](const VectorXd& q, const VectorXd& dq, const VectorXd& ddq, const Vector3d& gravity) {
    return arm->Torque(q, dq, ddq, gravity, false);
  };
  motion.body_columns = [arm](const VectorXd& q, const VectorXd& dq, const VectorXd& ddq) {
    return arm->BodyColumns(q, dq, ddq);
  };

  VectorXd standard = VectorXd::Zero(model.columns());
  for (int k = 0; k < base.size(); ++k) standard[base.kept()[k]] = chi[k];
  for (MatrixXd* torque : {&motion.torque, &motion.rigid, &motion.link}) torque->resize(count, n);
  const Vector3d& gravity = motion.robot->gravity;
  VectorXd q, dq, ddq, tau(n);
  for (Index i = 0; i < count; ++i) {
    q = states.q.row(i);
    dq = states.dq.row(i);
    ddq = states.ddq.row(i);
    model.Torque(q.data(), dq.data(), ddq.data(), velocity_sigma.data(), standard, payload, tau.data());
    motion.torque.row(i) = tau;
    motion.rigid.row(i) = motion.rigid_torque(q, dq, ddq, gravity);
    motion.link.row(i) = motion.link_torque(q, dq, ddq, gravity);
  }
  return motion;
}

}  // namespace idim
