#include "core/simulation/effects_truth.h"

#include <glog/logging.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/base/decompositions.h"
#include "core/simulation/effects_drive_train.h"

namespace idim {
namespace {

using internal::DriveTrain;
using internal::FlexibleJoint;

constexpr double kLead = 0.5;  // [s] of simulation before the first instant

double Sign(double x) { return static_cast<double>((x > 0.0) - (x < 0.0)); }

using Effects = std::vector<const SimulatedEffect*>;

Effects EffectsIn(const Scenario& scenario, const ScenarioRecording& recording) {
  Effects effects;
  for (const SimulatedEffect& effect : scenario.effects) {
    if (effect.recording.empty() || effect.recording == recording.name) effects.push_back(&effect);
  }
  return effects;
}

double Duration(const ScenarioRecording& recording) {
  return recording.duration > 0.0 ? recording.duration : recording.trajectory->duration();
}

Robot Tilted(Robot robot, const Effects& effects) {
  for (const SimulatedEffect* effect : effects) {
    if (effect->id != "base_tilt") continue;
    const Eigen::Vector3d down = robot.gravity.normalized();
    const Eigen::Vector3d start = std::abs(down.x()) < 0.9 ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitY();
    const Eigen::Vector3d e1 = (start - start.dot(down) * down).normalized();
    const Eigen::Vector3d turn = effect->Value("angle_1") * e1 + effect->Value("angle_2") * e1.cross(down);
    if (!turn.isZero(0.0)) robot.gravity = Eigen::AngleAxisd(turn.norm(), turn.normalized()) * robot.gravity;
  }
  return robot;
}

// Parameters of the standard model apart: links; drive inertias; friction of the couplings and offsets. Fv and Fs of
// the joints are what effects change.
struct Parts {
  Eigen::VectorXd links, inertias, rest, fv, fs;
};

Parts Split(const StandardModel& model, const Eigen::VectorXd& chi) {
  const int n = model.dof();
  Parts parts;
  for (Eigen::VectorXd* part : {&parts.links, &parts.inertias, &parts.rest}) part->setZero(chi.size());
  parts.fv.setZero(n);
  parts.fs.setZero(n);
  for (int c = 0; c < model.columns(); ++c) {
    const Parameter& parameter = model.parameters()[c];
    const std::string number = std::to_string(parameter.joint);
    if (parameter.kind == ParameterKind::kBase) {
      parts.links[c] = chi[c];
    } else if (parameter.kind == ParameterKind::kDriveInertia) {
      parts.inertias[c] = chi[c];
    } else if (parameter.name == "Fv" + number) {
      parts.fv[parameter.joint - 1] = chi[c];
    } else if (parameter.name == "Fs" + number) {
      parts.fs[parameter.joint - 1] = chi[c];
    } else {
      parts.rest[c] = chi[c];
    }
  }
  return parts;
}

// Links, payloads and springs of one recording.
class Links {
 public:
  Links(const Scenario& scenario, const ScenarioRecording& recording, const Effects& effects)
      : effects_(effects),
        model_(Tilted(scenario.robot, effects), FrictionModel()),
        chi_(Split(model_, scenario.chi).links),
        payload_(InertialVector::Zero()) {
    if (recording.payload >= 0) payload_ = scenario.payloads[recording.payload].inertial;
  }

  Eigen::VectorXd Torque(double t, const JointState& state) {
    InertialVector payload = payload_;
    for (const SimulatedEffect* effect : effects_) {
      if (effect->id != "payload_change" || t < effect->Value("from")) continue;
      payload += InertialFromCentreOfMass(
          effect->Value("M"), {effect->Value("x"), effect->Value("y"), effect->Value("z")}, Eigen::Matrix3d::Zero());
    }
    Eigen::VectorXd torque(model_.dof());
    model_.Torque(state.q.data(), state.dq.data(), state.ddq.data(), nullptr, chi_, payload, torque.data());
    for (const SimulatedEffect* effect : effects_) {
      if (effect->id != "joint_spring") continue;
      for (int j : effect->joints) torque[j] += effect->Value("stiffness") * (state.q[j] - effect->Value("rest"));
    }
    return torque;
  }

 private:
  Effects effects_;
  StandardModel model_;
  Eigen::VectorXd chi_;
  InertialVector payload_;
};

std::vector<FlexibleJoint> FlexibleJoints(const Scenario& scenario, const Effects& effects) {
  const ScenarioRecording& first = scenario.recordings.front();
  ScenarioRecording bare = first;
  bare.payload = -1;
  Links links(scenario, bare, {});
  const JointState start = first.trajectory->At(0.0);
  std::vector<FlexibleJoint> joints;
  for (int j = 0; j < scenario.robot.dof(); ++j) {
    double compliance = 0.0, ratio = 0.0, gap = 0.0;
    const auto inertia = [&] {
      return internal::LinkInertia(
          {j}, [&](double t, const JointState& s) { return links.Torque(t, s); }, 0.0, start)(0, 0);
    };
    for (const SimulatedEffect* effect : effects) {
      const bool elastic = effect->id == "joint_elasticity", backlash = effect->id == "backlash";
      if (!(elastic || backlash) || std::count(effect->joints.begin(), effect->joints.end(), j) == 0) continue;
      ratio = std::max(ratio, effect->Value("damping_ratio"));
      if (elastic) {
        compliance += 1.0 / effect->Value("stiffness");
      } else {
        compliance += 1.0 / (inertia() * std::pow(2.0 * M_PI * effect->Value("contact_frequency"), 2));
        gap = effect->Value("gap");
      }
    }
    if (compliance == 0.0) continue;
    joints.push_back({j, 1.0 / compliance, 2.0 * ratio * std::sqrt(inertia() / compliance), gap / 2.0});
  }
  return joints;
}

class Simulator {
 public:
  Simulator(const Scenario& scenario, const ScenarioRecording& recording)
      : effects_(EffectsIn(scenario, recording)),
        trajectory_(*recording.trajectory),
        step_(scenario.effect_step),
        model_(scenario.robot, FrictionModel()),
        parts_(Split(model_, scenario.chi)),
        links_(scenario, recording, effects_),
        displacement_(Eigen::VectorXd::Zero(model_.dof())) {
    for (const SimulatedEffect* effect : effects_) {
      if (effect->id != "presliding") continue;
      for (int j : effect->joints) displacement_[j] = effect->Value("displacement");
    }
    std::vector<FlexibleJoint> flexible = FlexibleJoints(scenario, effects_);
    if (!flexible.empty()) {
      train_ = std::make_unique<DriveTrain>(
          std::move(flexible), [this](double t, const JointState& s) { return links_.Torque(t, s); }, trajectory_, 0.0,
          Duration(recording));
    }
  }
  Simulator(const Simulator&) = delete;
  Simulator& operator=(const Simulator&) = delete;

  // Torque of the drives on the joint side, a row an instant; t increasing, above -kLead.
  Eigen::MatrixXd Torque(const Eigen::VectorXd& t) {
    Eigen::MatrixXd torque(t.size(), model_.dof());
    State state = Start();
    std::int64_t done = 0;  // steps from -kLead on: what is found at an instant depends on no other instant
    const bool has_memory = train_ != nullptr || displacement_.any();
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
    if (displacement_.any()) {
      const Eigen::VectorXd way = trajectory_.At(t + h).q - trajectory_.At(t).q;
      for (Eigen::Index j = 0; j < way.size(); ++j) {
        // Dahl's equation solved for a way in one direction.
        if (displacement_[j] == 0.0 || way[j] == 0.0) continue;
        const double end = Sign(way[j]);
        state->bristle[j] = end + (state->bristle[j] - end) * std::exp(-std::abs(way[j]) / displacement_[j]);
      }
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
    Eigen::VectorXd direction = motor.dq.unaryExpr(&Sign);
    for (Eigen::Index j = 0; j < direction.size(); ++j) {
      if (displacement_[j] > 0.0) direction[j] = state.bristle[j];
    }
    Eigen::VectorXd viscous = parts_.fv.cwiseProduct(motor.dq);
    Eigen::VectorXd dry = parts_.fs.cwiseProduct(direction);
    Eigen::VectorXd other = rigid + Drives(parts_.rest, motor);
    for (const SimulatedEffect* effect : effects_) {
      for (int j : effect->joints) AddFriction(*effect, motor.dq[j], direction[j], rigid[j], &viscous[j], &dry[j]);
      AddOther(*effect, motor, &other);
    }
    for (const SimulatedEffect* effect : effects_) {
      if (effect->id != "thermal_drift") continue;
      const double warm = 1.0 - std::exp(-std::max(t, 0.0) / effect->Value("time_constant"));
      for (int j : effect->joints) {
        viscous[j] *= 1.0 + effect->Value("viscous_share") * warm;
        dry[j] *= 1.0 + effect->Value("coulomb_share") * warm;
      }
    }
    return other + viscous + dry;
  }

  static void AddFriction(const SimulatedEffect& effect, double dq, double direction, double rigid, double* viscous,
                          double* dry) {
    if (effect.id == "stribeck") {
      *dry += direction * effect.Value("Fst") * std::exp(-std::pow(dq / effect.Value("vs"), 2));
    } else if (effect.id == "power_viscous") {
      *viscous += Sign(dq) * effect.Value("coefficient") * std::pow(std::abs(dq), effect.Value("exponent"));
    } else if (effect.id == "asymmetric_friction") {
      *viscous += 0.5 * effect.Value("viscous_difference") * std::abs(dq);
      *dry += 0.5 * effect.Value("coulomb_difference") * std::abs(direction);
    } else if (effect.id == "load_friction") {
      *dry += direction * effect.Value("mu") * std::abs(rigid);
    }
  }

  void AddOther(const SimulatedEffect& effect, const JointState& motor, Eigen::VectorXd* torque) const {
    if (effect.id == "torque_ripple") {
      const bool of_motor = effect.values.count("motor_order") > 0;
      const Eigen::VectorXd turns = of_motor ? Eigen::VectorXd(model_.robot().transmission * motor.q) : motor.q;
      const double order = effect.Value(of_motor ? "motor_order" : "order");
      for (int j : effect.joints) {
        (*torque)[j] += effect.Value("amplitude") * std::cos(order * turns[j] + effect.Value("phase"));
      }
    } else if (effect.id == "motor_coupling") {
      const int a = effect.joints[0], b = effect.joints[1];
      const double dry = effect.Value("coulomb") * Sign(motor.dq[a] + motor.dq[b]);
      const double inertia = effect.Value("inertia"), viscous = effect.Value("viscous");
      (*torque)[a] += inertia * motor.ddq[b] + viscous * motor.dq[b] + dry;
      (*torque)[b] += inertia * motor.ddq[a] + viscous * motor.dq[a] + dry;
    }
  }

  const Effects effects_;
  const Trajectory& trajectory_;
  const double step_;
  StandardModel model_;
  const Parts parts_;
  Links links_;
  Eigen::VectorXd displacement_;  // n, of the bristles; 0: none
  std::unique_ptr<DriveTrain> train_;
};

// v of linear = v (1 + 3 loss (v / reference)^2)^(-1/3), linear = tau / g. The right-hand side is increasing and, for
// v > 0, concave, so that Newton's method comes from below.
double Saturated(double linear, double loss, double reference) {
  double v = std::abs(linear);
  for (int iteration = 0; iteration < 100; ++iteration) {
    const double x = 3.0 * loss * std::pow(v / reference, 2);
    const double law = std::pow(1.0 + x, -1.0 / 3.0);
    const double step = (std::abs(linear) - v * law) / (law * (1.0 - 2.0 / 3.0 * x / (1.0 + x)));
    v += step;
    if (std::abs(step) <= 1e-14 * v) break;
  }
  return std::copysign(v, linear);
}

std::string Name(size_t k) { return "effects[" + std::to_string(k + 1) + "]"; }

// "" if it can be simulated in this recording.
std::string ProblemInRecording(const Scenario& scenario, const ScenarioRecording& recording,
                               const SimulatedEffect& effect) {
  if (effect.id != "joint_elasticity" && effect.id != "backlash") return "";
  // The joints that are flexible together, first of all alone where their stiffness comes from.
  Links links(scenario, recording, EffectsIn(scenario, recording));
  const auto torque = [&](double t, const JointState& s) { return links.Torque(t, s); };
  ScenarioRecording bare = scenario.recordings.front();
  bare.payload = -1;
  Links bare_links(scenario, bare, {});
  const auto bare_torque = [&](double t, const JointState& s) { return bare_links.Torque(t, s); };
  std::set<int> together;
  for (const SimulatedEffect* other : EffectsIn(scenario, recording)) {
    if (other->id == "joint_elasticity" || other->id == "backlash") {
      together.insert(other->joints.begin(), other->joints.end());
    }
  }
  const std::vector<int> joints(together.begin(), together.end());
  for (int j : joints) {
    if (!internal::InertiaIsPositive({j}, bare_torque, *bare.trajectory, 0.0, 0.0)) {
      return "link " + std::to_string(j + 1) + " has no inertia about its joint";
    }
  }
  if (!internal::InertiaIsPositive(joints, torque, *recording.trajectory, 0.0, Duration(recording))) {
    return "the links have no positive inertia about the flexible joints in recording " + recording.name;
  }
  return "";
}

}  // namespace

Status CheckEffects(const Scenario& scenario) {
  const Eigen::VectorXd fs = Split(StandardModel(scenario.robot, FrictionModel()), scenario.chi).fs;
  for (size_t k = 0; k < scenario.effects.size(); ++k) {
    const SimulatedEffect& effect = scenario.effects[k];
    const auto bad = [&](const std::string& problem) { return Status::BadInput(Name(k) + ": " + problem); };
    std::string error;
    if (!effect.IsValid(scenario.robot, &error)) return bad(error);
    const bool known = std::any_of(scenario.recordings.begin(), scenario.recordings.end(),
                                   [&](const ScenarioRecording& r) { return r.name == effect.recording; });
    if (!effect.recording.empty() && !known) return bad("there is no recording '" + effect.recording + "'");
    static const std::set<std::string> once = {"presliding", "time_delay", "gain_saturation", "joint_elasticity",
                                               "backlash"};
    for (size_t other = 0; other < k && once.count(effect.id) > 0; ++other) {
      const SimulatedEffect& before = scenario.effects[other];
      if (before.id != effect.id ||
          !(before.recording == effect.recording || before.recording.empty() || effect.recording.empty())) {
        continue;
      }
      for (int j : effect.joints) {
        if (std::count(before.joints.begin(), before.joints.end(), j) == 0) continue;
        return bad(effect.id + " acts on joint " + std::to_string(j + 1) + " already by " + Name(other));
      }
    }
    for (int j : effect.joints) {
      if (effect.id != "presliding" || fs[j] > 0.0) continue;
      return bad("presliding needs a Coulomb friction Fs" + std::to_string(j + 1) + " above 0");
    }
  }
  for (size_t k = 0; k < scenario.effects.size(); ++k) {
    for (const ScenarioRecording& recording : scenario.recordings) {
      const std::string problem = ProblemInRecording(scenario, recording, scenario.effects[k]);
      if (!problem.empty()) return Status::BadInput(Name(k) + ": " + scenario.effects[k].id + ": " + problem);
    }
  }
  return Status::Ok();
}

namespace internal {

void ApplyEffects(const Scenario& scenario, const ScenarioRecording& recording, Truth* truth) {
  const Effects effects = EffectsIn(scenario, recording);
  if (effects.empty()) return;
  const Status status = CheckEffects(scenario);
  CHECK(status.ok()) << status.message();
  CHECK(scenario.effect_step > 0.0);
  const int n = scenario.robot.dof();
  Eigen::VectorXd delays = Eigen::VectorXd::Zero(n);
  for (const SimulatedEffect* effect : effects) {
    if (effect->id != "time_delay") continue;
    for (int j : effect->joints) delays[j] += effect->Value("delay");
  }
  Simulator simulator(scenario, recording);
  // Gains and sides as in SimulateTruth() without effects.
  const auto linear_signal = [&](Eigen::MatrixXd torque) {
    if (scenario.truth.signal_side == Side::kMotor) torque *= scenario.robot.transmission.inverse();
    return Eigen::MatrixXd(torque * scenario.gains.cwiseInverse().asDiagonal());
  };
  truth->torque = simulator.Torque(truth->t);
  truth->signal = linear_signal(truth->torque);
  for (double delay : std::set<double>(delays.begin(), delays.end())) {
    if (delay == 0.0) continue;
    const Eigen::MatrixXd late = linear_signal(simulator.Torque(truth->t.array() - delay));
    for (int j = 0; j < n; ++j) {
      if (delays[j] == delay) truth->signal.col(j) = late.col(j);
    }
  }
  for (const SimulatedEffect* effect : effects) {
    if (effect->id != "gain_saturation") continue;
    for (int j : effect->joints) {
      for (double& v : truth->signal.col(j)) v = Saturated(v, effect->Value("loss"), effect->Value("signal"));
    }
  }
}

}  // namespace internal

}  // namespace idim
