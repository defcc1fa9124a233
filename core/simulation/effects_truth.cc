#include "core/simulation/effects_truth.h"

#include <glog/logging.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include "core/base/decompositions.h"
#include "core/simulation/effects_drive_train.h"
#include "core/simulation/effects_links.h"

namespace idim::internal {
namespace {

constexpr double kLead = 0.5;  // [s] of simulation before the first instant

// One recording's drives, and what their torque remembers.
class DriveSimulation {
 public:
  DriveSimulation(const Scenario& scenario, const ScenarioRecording& recording)
      : effects_(EffectsIn(scenario, recording)),
        trajectory_(*recording.trajectory),
        step_(scenario.effect_step),
        model_(scenario.robot, FrictionModel()),
        parts_(Split(model_, scenario.chi)),
        links_(scenario, recording, effects_),
        bristles_(static_cast<size_t>(model_.dof()), nullptr) {
    for (const SimulatedEffect* effect : effects_) {
      if (!effect->equation->has_bristle()) continue;
      has_bristle_ = true;
      for (int j : effect->joints) bristles_[static_cast<size_t>(j)] = effect;
    }
    std::vector<FlexibleJoint> flexible = FlexibleJoints(scenario, effects_);
    if (!flexible.empty()) {
      train_ = std::make_unique<DriveTrain>(
          std::move(flexible), [this](double t, const JointState& s) { return links_.Torque(t, s); }, trajectory_, 0.0,
          DurationOf(recording));
    }
  }
  DriveSimulation(const DriveSimulation&) = delete;
  DriveSimulation& operator=(const DriveSimulation&) = delete;

  // Torque of the drives on the joint side, a row an instant; t increasing, above -kLead.
  Eigen::MatrixXd Torque(const Eigen::VectorXd& t) {
    Eigen::MatrixXd torque(t.size(), model_.dof());
    State state = Start();
    const bool has_memory = has_bristle_ || train_ != nullptr;
    std::int64_t done = 0;  // steps from -kLead on: what is found at an instant depends on no other instant
    for (Eigen::Index k = 0; k < t.size(); ++k) {
      if (!has_memory) {
        torque.row(k) = TorqueAt(state, t[k]);
        continue;
      }
      for (; - kLead + (done + 1) * step_ <= t[k]; ++done) Advance(-kLead + done * step_, step_, &state);
      State now = state;
      const double from = -kLead + done * step_;
      if (t[k] > from) Advance(from, t[k] - from, &now);
      torque.row(k) = TorqueAt(now, t[k]);
    }
    return torque;
  }

 private:
  struct State {
    Eigen::VectorXd bristle;  // n
    DriveTrain::State twist;
  };

  State Start() const {
    State state;
    state.bristle.setZero(model_.dof());
    if (train_ != nullptr) state.twist = train_->Equilibrium(-kLead);
    return state;
  }

  void Advance(double t, double h, State* state) const {
    const Eigen::VectorXd way = has_bristle_ ? trajectory_.At(t + h).q - trajectory_.At(t).q : Eigen::VectorXd();
    for (Eigen::Index j = 0; j < way.size(); ++j) {
      const SimulatedEffect* const effect = bristles_[static_cast<size_t>(j)];
      if (effect == nullptr || way[j] == 0.0) continue;
      state->bristle[j] = effect->equation->MoveBristle(*effect, state->bristle[j], way[j]);
    }
    if (train_ != nullptr) state->twist = train_->Step(state->twist, t, h);
  }

  Eigen::VectorXd Drives(const Eigen::VectorXd& chi, const JointState& s) {
    Eigen::VectorXd torque(model_.dof());
    model_.Torque(s.q.data(), s.dq.data(), s.ddq.data(), nullptr, chi, InertialVector::Zero(), torque.data());
    return torque;
  }

  Eigen::VectorXd TorqueAt(const State& state, double t) {
    const JointState motor = trajectory_.At(t);
    const Eigen::VectorXd rigid =
        links_.Torque(t, train_ != nullptr ? train_->Links(state.twist, t) : motor) + Drives(parts_.inertias, motor);
    Eigen::VectorXd direction = motor.dq.unaryExpr(&SignOf);
    for (Eigen::Index j = 0; j < direction.size(); ++j) {
      if (bristles_[static_cast<size_t>(j)] != nullptr) direction[j] = state.bristle[j];
    }
    Eigen::VectorXd viscous = parts_.fv.cwiseProduct(motor.dq);
    Eigen::VectorXd dry = parts_.fs.cwiseProduct(direction);
    Eigen::VectorXd other = rigid + Drives(parts_.others, motor);
    for (const SimulatedEffect* effect : effects_) {
      for (int j : effect->joints) {
        effect->equation->AddFriction(*effect, {motor.dq[j], direction[j], rigid[j]}, &viscous[j], &dry[j]);
      }
      effect->equation->AddMotorTorque(*effect, model_.robot(), motor, &other);
    }
    for (const SimulatedEffect* effect : effects_) {
      for (int j : effect->joints) effect->equation->ScaleFriction(*effect, std::max(t, 0.0), &viscous[j], &dry[j]);
    }
    return other + viscous + dry;
  }

  const ActingEffects effects_;
  const Trajectory& trajectory_;
  const double step_;
  StandardModel model_;
  const StandardParts parts_;
  Links links_;
  bool has_bristle_ = false;
  std::vector<const SimulatedEffect*> bristles_;  // n, the effect whose bristle it is; nullptr: none
  std::unique_ptr<DriveTrain> train_;
};

}  // namespace

void ApplyEffects(const Scenario& scenario, const ScenarioRecording& recording, Truth* truth) {
  const ActingEffects effects = EffectsIn(scenario, recording);
  if (effects.empty()) return;
  const Status status = CheckEffects(scenario);
  CHECK(status.ok()) << status.message();
  CHECK(scenario.effect_step > 0.0);
  const int n = scenario.robot.dof();
  Eigen::VectorXd delays = Eigen::VectorXd::Zero(n);
  for (const SimulatedEffect* effect : effects) {
    for (int j : effect->joints) delays[j] += effect->equation->DelayOf(*effect);
  }
  DriveSimulation drives(scenario, recording);
  // Gains and sides as in SimulateTruth() without effects.
  const auto linear_signal = [&](Eigen::MatrixXd torque) {
    if (scenario.truth.signal_side == Side::kMotor) torque *= scenario.robot.transmission.inverse();
    return Eigen::MatrixXd(torque * scenario.gains.cwiseInverse().asDiagonal());
  };
  truth->torque = drives.Torque(truth->t);
  truth->signal = linear_signal(truth->torque);
  for (double delay : std::set<double>(delays.begin(), delays.end())) {
    if (delay == 0.0) continue;
    const Eigen::MatrixXd late = linear_signal(drives.Torque(truth->t.array() - delay));
    for (int j = 0; j < n; ++j) {
      if (delays[j] == delay) truth->signal.col(j) = late.col(j);
    }
  }
  for (const SimulatedEffect* effect : effects) {
    for (int j : effect->joints) {
      for (double& v : truth->signal.col(j)) v = effect->equation->SignalOf(*effect, v);
    }
  }
}

}  // namespace idim::internal
