#include "solvers/judge/validation.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "core/base/text.h"
#include "core/model/active_effects.h"
#include "core/model/observation_stream.h"
#include "core/model/payload_unknowns.h"
#include "core/statistics/triangular_factor.h"
#include "solvers/estimators/closed_forms.h"
#include "solvers/linear/gain_system.h"
#include "solvers/linear/least_squares.h"

namespace idim {
namespace {

using Eigen::VectorXd;

// Whether a plain name of the estimate ("MX7") speaks of this payload: the only one, or the only one that the study's
// identification recordings carry.
bool IsTheEstimates(const Study& study, int payload) {
  std::set<int> carried;
  for (const RecordingEntry& entry : study.recordings) {
    if (entry.use == Use::kIdentification && entry.payload >= 0) carried.insert(entry.payload);
  }
  return study.payloads.size() == 1 || carried == std::set<int>{payload};
}

// The ten parameters of a payload: known to the study, else to the estimate, which leaves out what was not essential.
// None if the estimate has nothing of what the study leaves open.
std::optional<InertialVector> PayloadOf(const Study& study, int payload, const Reference& estimate) {
  InertialVector body = KnownPayload(study, payload);
  bool open = false, found = false;
  for (int k = 0; k < kNumInertial; ++k) {
    if (study.payloads[payload].known[k]) continue;
    open = true;
    const std::string name = kStandardNames[k] + std::to_string(study.robot.dof() + 1);
    const Reference::Entry* entry = estimate.Find(name + "_" + study.payloads[payload].name);
    if (entry == nullptr && IsTheEstimates(study, payload)) entry = estimate.Find(name);
    if (entry == nullptr) continue;
    body[k] = entry->value;
    found = true;
  }
  if (open && !found) return std::nullopt;
  return body;
}

// Without any torque, for columns of which only the names matter.
ArmParameters RestingArm(const PreparedStudy& prepared) {
  ArmParameters arm;
  arm.gains = VectorXd::Ones(prepared.study.robot.dof());
  arm.chi = VectorXd::Zero(prepared.num_columns());
  arm.payloads.assign(prepared.study.payloads.size(), InertialVector::Zero());
  return arm;
}

double ConditionOf(const PreparedStudy& prepared, const PreparedRecording& recording) {
  const int base = prepared.base.size();
  TriangularFactor factor(base);
  StreamObservations(prepared, recording,
                     [&](const Observation& observation) { factor.AddRows(observation.columns.leftCols(base)); });
  return ConditionNumber(factor.R());
}

// Effects that act in none of the recordings (a mass taken up in another one) have columns of zeros.
void DropIdleEffects(PreparedStudy* prepared) {
  const std::vector<int> first = FirstParameters(*prepared);
  std::vector<ActiveEffect> effects;
  std::vector<Parameter> parameters;
  std::vector<int> index(prepared->effect_parameters.size(), -1);
  for (size_t e = 0; e < prepared->effects.size(); ++e) {
    bool acts = false;
    for (const PreparedRecording& recording : prepared->recordings) {
      for (const EffectEntry& entry : recording.effects) {
        acts |= entry.parameter >= first[e] && entry.parameter < first[e + 1];
      }
    }
    if (!acts) continue;
    effects.push_back(prepared->effects[e]);
    for (int k = first[e]; k < first[e + 1]; ++k) {
      index[static_cast<size_t>(k)] = static_cast<int>(parameters.size());
      parameters.push_back(prepared->effect_parameters[static_cast<size_t>(k)]);
    }
  }
  for (PreparedRecording& recording : prepared->recordings) {
    for (EffectEntry& entry : recording.effects) entry.parameter = index[static_cast<size_t>(entry.parameter)];
  }
  prepared->effects = std::move(effects);
  prepared->effect_parameters = std::move(parameters);
}

std::optional<MassEstimate> EstimateMass(const PreparedStudy& prepared, const PreparedRecording& recording,
                                         const VectorXd& gains) {
  if (recording.entry.payload < 0) return std::nullopt;
  PreparedStudy both = prepared;
  both.recordings.clear();
  both.study.gains_mode = GainsMode::kKnown;
  both.study.gains = gains;
  both.study.payloads.assign(1, Payload());
  both.study.payloads[0].name = "payload";
  for (const PreparedRecording& r : prepared.recordings) {
    if (r.entry.use == Use::kIdentification && r.entry.payload < 0) both.recordings.push_back(r);
  }
  if (both.recordings.empty()) return std::nullopt;
  both.recordings.push_back(recording);
  both.recordings.back().entry.use = Use::kIdentification;
  both.recordings.back().entry.payload = 0;
  both.study.recordings.clear();
  for (const PreparedRecording& r : both.recordings) both.study.recordings.push_back(r.entry);
  DropIdleEffects(&both);
  const Result<Identification> identification = IdentifyLinear(both, LinearOptions());
  if (!identification.ok() || !identification->estimate.status.ok()) return std::nullopt;
  MassEstimate mass;
  const std::string name = kStandardNames[kM] + std::to_string(prepared.study.robot.dof() + 1);
  for (const ParameterEstimate& p : identification->estimate.parameters) {
    if (p.parameter.name != name) continue;
    mass.value = p.value;
    mass.standard_deviation = p.standard_deviation;
  }
  mass.weighed = prepared.study.payloads[recording.entry.payload].known[kM];
  return mass;
}

}  // namespace

std::optional<double> MassEstimate::ErrorPercent() const {
  if (!weighed) return std::nullopt;
  return 100.0 * std::abs(*weighed - value) / *weighed;
}

Result<PreparedStudy> WithEffectsOf(const PreparedStudy& prepared, const Reference& estimate) {
  PreparedStudy with = prepared;
  if (estimate.velocity_zero_at_rest && !with.velocity_zero_at_rest) SetVelocityZeroAtRest(&with);
  const int n = prepared.study.robot.dof();
  std::vector<ActiveEffect> effects;
  for (const EstimatedEffect& stated : estimate.effects) {
    const std::string where = "estimate '" + estimate.name + "': effect '" + stated.id + "'";
    ActiveEffect active{FindEffect(stated.id), stated.joints, VectorXd()};
    if (active.effect == nullptr || active.effect->in_standard_model()) {
      return Status::BadInput(where + ": no such effect; expected one of those that a study can declare");
    }
    const EffectSite site = active.effect->site();
    const size_t expected = site == EffectSite::kArm ? 0 : site == EffectSite::kJoint ? 1 : 2;
    const std::vector<int>& joints = stated.joints;
    if (joints.size() != expected || !std::is_sorted(joints.begin(), joints.end()) ||
        std::adjacent_find(joints.begin(), joints.end()) != joints.end() || (expected > 0 && joints.back() >= n)) {
      return Status::BadInput(where + ": key 'joints': expected " + std::to_string(expected) +
                              " increasing joints of the " + std::to_string(n) + " of " + prepared.study.path);
    }
    for (const ActiveEffect& other : effects) {
      if (SameEffect(other, active)) return Status::BadInput(where + ": given twice; expected once at a place");
    }
    const std::vector<ShapeParameter> shapes = ShapesAlong(prepared, *active.effect, joints);
    active.shape.resize(static_cast<Eigen::Index>(shapes.size()));
    for (size_t s = 0; s < shapes.size(); ++s) {
      const auto found = std::find_if(stated.shape.begin(), stated.shape.end(),
                                      [&](const auto& shape) { return shape.first == shapes[s].name; });
      // Limits are those of a motion, which need not be that of the estimate.
      const double value = found == stated.shape.end() ? -1.0 : found->second;
      if (!(value > 0.0 || (found != stated.shape.end() && value >= shapes[s].lower && value <= shapes[s].upper))) {
        return Status::BadInput(where + ": key 'shape." + shapes[s].name + "': expected a positive number, about " +
                                Format("%.3g to %.3g", shapes[s].lower, shapes[s].upper));
      }
      active.shape[static_cast<Eigen::Index>(s)] = value;
    }
    if (stated.shape.size() != shapes.size()) {
      return Status::BadInput(where + ": key 'shape': has " + std::to_string(stated.shape.size()) +
                              " numbers; expected " + std::to_string(shapes.size()));
    }
    effects.push_back(std::move(active));
  }
  SetEffects(effects, MotionsOf(prepared, RestingArm(prepared)), &with);
  return with;
}

Result<ArmParameters> ParametersOf(const PreparedStudy& prepared, const Reference& estimate) {
  const Study& study = prepared.study;
  const int n = study.robot.dof();
  if (!estimate.robot.empty() && !study.robot.name.empty() && estimate.robot != study.robot.name) {
    return Status::BadInput("estimate '" + estimate.name + "' is of robot '" + estimate.robot + "', that of " +
                            study.path + " is '" + study.robot.name + "'; expected an estimate of the same robot");
  }
  ArmParameters arm;
  arm.gains = study.gains;
  const std::vector<Parameter> gains = GainParameters(study.robot, study.signal_side);
  int gains_found = 0;
  for (const Parameter& gain : gains) gains_found += estimate.Find(gain.name) != nullptr;
  if (gains_found > 0 && gains_found < n) {
    return Status::BadInput("estimate '" + estimate.name + "' has " + std::to_string(gains_found) +
                            " drive gains; expected " + std::to_string(n) + " or none");
  }
  if (gains_found == n) {
    arm.gains.resize(n);
    for (int j = 0; j < n; ++j) arm.gains[j] = estimate.Find(gains[j].name)->value;
  } else if (study.gains_mode == GainsMode::kIdentify) {
    return Status::BadInput("estimate '" + estimate.name + "' has no drive gains and " + study.path +
                            " leaves them to be identified (key 'gains.mode'); expected gains in one of them");
  }
  const std::vector<Parameter> of_model = prepared.parameters();
  const VectorXd shapes = ShapeOffsets(prepared);
  arm.chi = VectorXd::Zero(prepared.num_columns());
  int found = 0;
  for (int k = 0; k < prepared.num_columns(); ++k) {
    const Reference::Entry* entry = estimate.Find(of_model[k].name);
    if (entry == nullptr) continue;
    const int effect = k - prepared.base.size();
    arm.chi[k] = entry->value - (effect >= 0 ? shapes[effect] : 0.0);
    ++found;
  }
  const std::string payload_link = std::to_string(n + 1);
  std::vector<std::string> names;
  for (const Parameter& p : of_model) names.push_back(p.name);
  for (const Reference::Entry& entry : estimate.parameters) {
    bool known = false;
    for (const std::string& name : names) known |= name == entry.name;
    for (const Parameter& gain : gains) known |= gain.name == entry.name;
    for (const EstimatedEffect& effect : estimate.effects) {
      for (const auto& shape : effect.shape) {
        known |= entry.name == ShapeParameterName(effect.id, shape.first, effect.joints);
      }
    }
    for (int k = 0; k < kNumInertial; ++k) {
      const std::string name = kStandardNames[k] + payload_link;
      known |= entry.name == name || entry.name.rfind(name + "_", 0) == 0;
    }
    if (!known) {
      return Status::BadInput("estimate '" + estimate.name + "' has a parameter '" + entry.name +
                              "' that the model of " + study.path + " does not have (nearest: '" +
                              NearestName(entry.name, names) +
                              "'); expected an estimate of the same robot and friction");
    }
  }
  if (found == 0) {
    return Status::BadInput("estimate '" + estimate.name + "' has none of the base parameters of " + study.path +
                            "; expected base parameters, such as '" + names[0] + "'");
  }
  for (int p = 0; p < static_cast<int>(study.payloads.size()); ++p) {
    arm.payloads.push_back(PayloadOf(study, p, estimate).value_or(InertialVector::Zero()));
  }
  return arm;
}

Result<Validation> Validate(const PreparedStudy& as_recorded, const Reference& estimate) {
  const Result<PreparedStudy> with_effects = WithEffectsOf(as_recorded, estimate);
  if (!with_effects.ok()) return with_effects.status();
  const Result<ArmParameters> arm = ParametersOf(*with_effects, estimate);
  if (!arm.ok()) return arm.status();
  const StatedModel stated = AsStated(*with_effects, *arm);
  const PreparedStudy& prepared = stated.prepared;
  Validation validation;
  validation.name = estimate.name;
  validation.warning = estimate.warning;
  validation.gains = arm->gains;
  for (const PreparedRecording& recording : prepared.recordings) {
    if (recording.entry.use != Use::kValidation) continue;
    ValidationOfRecording result;
    result.name = recording.entry.name;
    if (recording.entry.payload >= 0) result.payload = prepared.study.payloads[recording.entry.payload].name;
    if (result.payload.empty() || PayloadOf(prepared.study, recording.entry.payload, estimate)) {
      validation.series.push_back(Predict(prepared, recording, stated.arm));
      result.fit = FitOf(validation.series.back());
    }
    result.condition_number = ConditionOf(prepared, recording);
    result.mass = EstimateMass(prepared, recording, arm->gains);
    validation.recordings.push_back(std::move(result));
  }
  if (validation.recordings.empty()) {
    return Status::BadInput(prepared.study.path +
                            ": key 'recordings': no recording has use 'validation'; expected at least one");
  }
  return validation;
}

}  // namespace idim
