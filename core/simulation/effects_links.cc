#include "core/simulation/effects_links.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace idim::internal {
namespace {

Robot WithTurnedGravity(Robot robot, const ActingEffects& effects) {
  for (const SimulatedEffect* effect : effects) effect->equation->TurnGravity(*effect, &robot.gravity);
  return robot;
}

}  // namespace

ActingEffects EffectsIn(const Scenario& scenario, const ScenarioRecording& recording) {
  ActingEffects effects;
  for (const SimulatedEffect& effect : scenario.effects) {
    if (effect.recording.empty() || effect.recording == recording.name) effects.push_back(&effect);
  }
  return effects;
}

StandardParts Split(const StandardModel& model, const Eigen::VectorXd& chi) {
  const int n = model.dof();
  StandardParts parts;
  for (Eigen::VectorXd* part : {&parts.links, &parts.inertias, &parts.others}) part->setZero(chi.size());
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
      parts.others[c] = chi[c];
    }
  }
  return parts;
}

Links::Links(const Scenario& scenario, const ScenarioRecording& recording, const ActingEffects& effects)
    : effects_(effects),
      model_(WithTurnedGravity(scenario.robot, effects), FrictionModel()),
      chi_(Split(model_, scenario.chi).links),
      payload_(InertialVector::Zero()) {
  if (recording.payload >= 0) payload_ = scenario.payloads[recording.payload].inertial;
}

Eigen::VectorXd Links::Torque(double t, const JointState& state) {
  InertialVector payload = payload_;
  for (const SimulatedEffect* effect : effects_) effect->equation->AddPayload(*effect, t, &payload);
  Eigen::VectorXd torque(model_.dof());
  model_.Torque(state.q.data(), state.dq.data(), state.ddq.data(), nullptr, chi_, payload, torque.data());
  for (const SimulatedEffect* effect : effects_) effect->equation->AddLinkTorque(*effect, state, &torque);
  return torque;
}

Links BareLinks(const Scenario& scenario) {
  ScenarioRecording bare = scenario.recordings.front();
  bare.payload = -1;
  return Links(scenario, bare, {});
}

std::vector<FlexibleJoint> FlexibleJoints(const Scenario& scenario, const ActingEffects& effects) {
  Links links = BareLinks(scenario);
  const JointState start = scenario.recordings.front().trajectory->At(0.0);
  std::vector<FlexibleJoint> joints;
  for (int j = 0; j < scenario.robot.dof(); ++j) {
    ActingEffects flexible;
    for (const SimulatedEffect* effect : effects) {
      const bool of_joint = std::count(effect->joints.begin(), effect->joints.end(), j) > 0;
      if (of_joint && effect->equation->is_flexible()) flexible.push_back(effect);
    }
    if (flexible.empty()) continue;
    const double inertia = LinkInertia(
        {j}, [&](double t, const JointState& s) { return links.Torque(t, s); }, 0.0, start)(0, 0);
    double compliance = 0.0, ratio = 0.0, gap = 0.0;
    for (const SimulatedEffect* effect : flexible) {
      const Transmission one = effect->equation->TransmissionOf(*effect, inertia);
      compliance += one.compliance;
      ratio = std::max(ratio, one.damping_ratio);
      gap += one.gap;
    }
    joints.push_back({j, 1.0 / compliance, 2.0 * ratio * std::sqrt(inertia / compliance), gap / 2.0});
  }
  return joints;
}

}  // namespace idim::internal
