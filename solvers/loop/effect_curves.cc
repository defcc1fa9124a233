#include "solvers/loop/effect_curves.h"

#include <algorithm>
#include <cmath>

#include "core/base/text.h"
#include "core/dynamics/standard_model.h"
#include "core/model/active_effects.h"

namespace idim {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

bool IsFriction(const Effect& effect) { return effect.domain() == EffectDomain::kVelocity; }

double ValueOf(const Estimate& estimate, const std::string& name) {
  const ParameterEstimate* p = estimate.Find(name);
  return p == nullptr ? 0.0 : p->value;
}

// Viscous, Coulomb and offset by an estimate, at the recorded instants.
VectorXd DeclaredFriction(const Data& data, const MeasuredRecording& recording, const Estimate& estimate, int joint) {
  const std::string number = std::to_string(joint + 1);
  const double sigma = data.velocity_sigma[joint];
  const double viscous = ValueOf(estimate, "Fv" + number), coulomb = ValueOf(estimate, "Fs" + number);
  const double offset = ValueOf(estimate, "off" + number);
  return recording.states->dq.col(joint).unaryExpr(
      [&](double dq) { return viscous * dq + coulomb * ExpectedSign(dq, sigma) + offset; });
}

// By the linear parameters; the columns of shapes, whose values are steps that are done, do not count.
VectorXd EffectTorque(const LoopResult& result, const Unknowns& unknowns, size_t recording, int joint, bool friction) {
  const Model& model = result.prepared.model;
  VectorXd torque = VectorXd::Zero(result.prepared.data->recordings[recording].states->q.rows());
  for (const EffectEntry& entry : model.columns->of_recording[recording]) {
    if (entry.joint != joint) continue;
    const int unknown = unknowns.first_effect() + entry.parameter;
    size_t e = 0;
    while (unknown >= unknowns.effect(e).end()) ++e;
    const Effect& effect = *model.effects[e].effect;
    if (unknown - unknowns.effect(e).at >= unknowns.effect(e).linear || IsFriction(effect) != friction) continue;
    if (effect.site() == EffectSite::kArm) continue;
    torque += ValueOf(result.after.estimate, unknowns[unknown].name) * entry.torque;
  }
  return torque;
}

double DrivingShare(const VectorXd& velocity, const VectorXd& friction) {
  const Eigen::ArrayXd speed = velocity.array().abs();
  const auto moving = speed > 0.1 * speed.maxCoeff();
  const auto count = static_cast<double>(moving.count());
  if (count == 0.0) return 0.0;
  return static_cast<double>((moving && velocity.array() * friction.array() < 0.0).count()) / count;
}

EffectCurve Curve(const LoopResult& result, const Unknowns& unknowns, int joint, bool friction) {
  EffectCurve curve;
  curve.joint = joint;
  std::vector<std::string> ids;
  bool of_position = true;
  for (const ActiveEffect& active : result.prepared.model.effects) {
    const bool here = std::find(active.joints.begin(), active.joints.end(), joint) != active.joints.end();
    if (!here || IsFriction(*active.effect) != friction) continue;
    ids.push_back(active.effect->id());
    of_position &= active.effect->domain() == EffectDomain::kPosition;
  }
  curve.effects = Join(ids, ", ");
  if (ids.empty()) return curve;
  curve.over = friction      ? EffectCurve::Over::kVelocity
               : of_position ? EffectCurve::Over::kPosition
                             : EffectCurve::Over::kModel;
  std::vector<VectorXd> abscissa, data, model, declared;
  Index count = 0;
  for (size_t r = 0; r < result.prepared.data->recordings.size(); ++r) {
    const Data& measured = *result.prepared.data;
    const MeasuredRecording& recording = measured.recordings[r];
    const RecordingSeries& series = result.after.series[r];
    VectorXd torque = EffectTorque(result, unknowns, r, joint, friction);
    if (friction) {
      torque += DeclaredFriction(measured, recording, result.after.estimate, joint);
      declared.push_back(
          recording.decimator->Apply(DeclaredFriction(measured, recording, result.before.estimate, joint)).col(0));
    }
    model.push_back(recording.decimator->Apply(torque).col(0));
    data.push_back(model.back() + series.decimated_torque.col(joint) - series.decimated_model.col(joint));
    abscissa.push_back(friction      ? VectorXd(series.decimated_dq.col(joint))
                       : of_position ? VectorXd(series.decimated_q.col(joint))
                                     : model.back());
    count += series.decimated_t.size();
  }
  const auto joined = [&](const std::vector<VectorXd>& parts) {
    VectorXd all(parts.empty() ? 0 : count);
    Index at = 0;
    for (const VectorXd& part : parts) {
      all.segment(at, part.size()) = part;
      at += part.size();
    }
    return all;
  };
  curve.abscissa = joined(abscissa), curve.data = joined(data);
  curve.model = joined(model), curve.declared = joined(declared);
  if (friction) {
    const double offset = ValueOf(result.after.estimate, "off" + std::to_string(joint + 1));
    curve.driving_share = DrivingShare(curve.abscissa, curve.model.array() - offset);
  }
  return curve;
}

}  // namespace

std::vector<EffectCurve> EffectCurves(const LoopResult& result) {
  std::vector<EffectCurve> curves;
  if (result.after.series.empty()) return curves;
  const Unknowns unknowns(result.prepared.model, UncertainPayload::kExact);
  for (const bool friction : {true, false}) {
    for (int j = 0; j < result.prepared.robot().dof(); ++j) {
      EffectCurve curve = Curve(result, unknowns, j, friction);
      if (!curve.effects.empty()) curves.push_back(std::move(curve));
    }
  }
  return curves;
}

}  // namespace idim
