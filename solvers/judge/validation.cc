#include "solvers/judge/validation.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/text.h"
#include "core/model/active_effects.h"
#include "core/model/prediction.h"
#include "core/model/sample_stream.h"
#include "core/model/unknowns.h"
#include "core/statistics/triangular_factor.h"
#include "solvers/estimators/closed_forms.h"
#include "solvers/linear/gain_system.h"
#include "solvers/linear/least_squares.h"

namespace idim {
namespace {

using Eigen::VectorXd;

// Whether a plain name of the estimate ("MX7") speaks of this payload: the only one, or the only one that the study's
// identification recordings carry.
bool IsTheEstimates(const Model& model, int payload) {
  if (model.payloads.size() == 1) return true;
  for (int p = 0; p < static_cast<int>(model.payloads.size()); ++p) {
    if (model.IsCarried(p) != (p == payload)) return false;
  }
  return true;
}

// The ten parameters of a payload: known to the study, else to the estimate, which leaves out what was not essential.
// None if the estimate has nothing of what the study leaves open.
std::optional<InertialVector> PayloadOf(const Model& model, int payload, const Reference& estimate) {
  InertialVector body = KnownPayload(model, payload);
  bool open = false, found = false;
  for (int k = 0; k < kNumInertial; ++k) {
    if (model.payloads[static_cast<size_t>(payload)].known[k]) continue;
    open = true;
    const std::string name = kStandardNames[k] + std::to_string(model.base().model().dof() + 1);
    const Reference::Entry* entry = estimate.Find(name + "_" + model.payloads[static_cast<size_t>(payload)].name);
    if (entry == nullptr && IsTheEstimates(model, payload)) entry = estimate.Find(name);
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
  arm.gains = VectorXd::Ones(prepared.robot().dof());
  arm.chi = VectorXd::Zero(prepared.base().size() + static_cast<int>(prepared.model.columns->parameters.size()));
  arm.payloads.assign(prepared.model.payloads.size(), InertialVector::Zero());
  return arm;
}

double ConditionOf(const PreparedStudy& prepared, int recording) {
  const int base = prepared.base().size();
  TriangularFactor factor(base);
  StreamObservations(prepared, recording,
                     [&](const Observation& observation) { factor.AddRows(observation.columns.leftCols(base)); });
  return ConditionNumber(factor.R());
}

// By least squares from a loaded recording and those without a payload, as if nothing were known of the
// payload.
std::optional<MassEstimate> EstimateMass(const PreparedStudy& prepared, int recording, const VectorXd& gains) {
  const Model& model = prepared.model;
  const int carried = model.roles[static_cast<size_t>(recording)].payload;
  if (carried < 0) return std::nullopt;
  std::vector<int> used;
  for (const int r : model.RecordingsFor(Use::kIdentification)) {
    if (model.roles[static_cast<size_t>(r)].payload < 0) used.push_back(r);
  }
  if (used.empty()) return std::nullopt;
  used.push_back(recording);
  std::vector<RecordingRole> roles;
  for (const int r : used) roles.push_back({Use::kIdentification, r == recording ? 0 : -1});
  PreparedStudy both{SomeRecordings(*prepared.data, used), ForRecordings(model, used, roles)};
  both.model.gains_mode = GainsMode::kKnown;
  both.model.gains = gains;
  both.model.payloads.assign(1, Payload());
  both.model.payloads[0].name = "payload";
  const Result<Identification> identification = IdentifyLinear(both, LinearOptions());
  if (!identification.ok() || !identification->estimate.status.ok()) return std::nullopt;
  MassEstimate mass;
  const std::string name = kStandardNames[kM] + std::to_string(prepared.robot().dof() + 1);
  for (const ParameterEstimate& p : identification->estimate.parameters) {
    if (p.parameter.name != name) continue;
    mass.value = p.value;
    mass.standard_deviation = p.standard_deviation;
  }
  mass.weighed = model.payloads[static_cast<size_t>(carried)].known[kM];
  return mass;
}

}  // namespace

std::optional<double> MassEstimate::ErrorPercent() const {
  if (!weighed) return std::nullopt;
  return 100.0 * std::abs(*weighed - value) / *weighed;
}

Result<PreparedStudy> PreparedWithEffectsOf(const PreparedStudy& prepared, const Reference& estimate) {
  PreparedStudy with = prepared;
  if (estimate.velocity_zero_at_rest && !with.data->velocity_zero_at_rest) {
    with.data = WithVelocityZeroAtRest(*with.data);
  }
  const int n = prepared.robot().dof();
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
                              " increasing joints of the " + std::to_string(n) + " of " + prepared.path());
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
  with.model = WithEffects(with, effects, MotionsOf(prepared, RestingArm(prepared)));
  return with;
}

Result<ArmParameters> ArmParametersOf(const PreparedStudy& prepared, const Reference& estimate) {
  const Model& model = prepared.model;
  const Robot& robot = prepared.robot();
  const int n = robot.dof();
  if (!estimate.robot.empty() && !robot.name.empty() && estimate.robot != robot.name) {
    return Status::BadInput("estimate '" + estimate.name + "' is of robot '" + estimate.robot + "', that of " +
                            prepared.path() + " is '" + robot.name + "'; expected an estimate of the same robot");
  }
  ArmParameters arm;
  arm.gains = model.gains;
  const std::vector<Parameter> gains = GainParameters(robot, model.signal_side);
  int gains_found = 0;
  for (const Parameter& gain : gains) gains_found += estimate.Find(gain.name) != nullptr;
  if (gains_found > 0 && gains_found < n) {
    return Status::BadInput("estimate '" + estimate.name + "' has " + std::to_string(gains_found) +
                            " drive gains; expected " + std::to_string(n) + " or none");
  }
  if (gains_found == n) {
    arm.gains.resize(n);
    for (int j = 0; j < n; ++j) arm.gains[j] = estimate.Find(gains[j].name)->value;
  } else if (model.IdentifiesGains()) {
    return Status::BadInput("estimate '" + estimate.name + "' has no drive gains and " + prepared.path() +
                            " leaves them to be identified (key 'gains.mode'); expected gains in one of them");
  }
  const Unknowns unknowns(model, UncertainPayload::kExact);
  const int columns = unknowns.num_base() + unknowns.num_effect_parameters();
  arm.chi = VectorXd::Zero(columns);
  int found = 0;
  std::vector<std::string> names;
  for (int k = 0; k < columns; ++k) {
    const int unknown = unknowns.first_base() + k;
    names.push_back(unknowns[unknown].name);
    const Reference::Entry* entry = estimate.Find(names.back());
    if (entry == nullptr) continue;
    arm.chi[k] = entry->value - unknowns.Offset(unknown);
    ++found;
  }
  const std::string payload_link = std::to_string(n + 1);
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
                              "' that the model of " + prepared.path() + " does not have (nearest: '" +
                              NearestName(entry.name, names) +
                              "'); expected an estimate of the same robot and friction");
    }
  }
  if (found == 0) {
    return Status::BadInput("estimate '" + estimate.name + "' has none of the base parameters of " + prepared.path() +
                            "; expected base parameters, such as '" + names[0] + "'");
  }
  for (int p = 0; p < static_cast<int>(model.payloads.size()); ++p) {
    arm.payloads.push_back(PayloadOf(model, p, estimate).value_or(InertialVector::Zero()));
  }
  return arm;
}

Result<Validation> Validate(const PreparedStudy& as_recorded, const Reference& estimate) {
  const Result<PreparedStudy> with_effects = PreparedWithEffectsOf(as_recorded, estimate);
  IDIM_RETURN_IF_ERROR(with_effects);
  const Result<ArmParameters> arm = ArmParametersOf(*with_effects, estimate);
  IDIM_RETURN_IF_ERROR(arm);
  const StatedModel stated = AsStated(*with_effects, *arm);
  const PreparedStudy& prepared = stated.prepared;
  Validation validation;
  validation.name = estimate.name;
  validation.warning = estimate.warning;
  validation.gains = arm->gains;
  for (const int r : prepared.model.RecordingsFor(Use::kValidation)) {
    const int payload = prepared.model.roles[static_cast<size_t>(r)].payload;
    ValidationOfRecording result;
    result.name = prepared.data->recordings[static_cast<size_t>(r)].entry.name;
    if (payload >= 0) result.payload = prepared.model.payloads[static_cast<size_t>(payload)].name;
    if (result.payload.empty() || PayloadOf(prepared.model, payload, estimate)) {
      validation.series.push_back(Predict(prepared, r, stated.arm));
      result.fit = FitOf(validation.series.back());
    }
    result.condition_number = ConditionOf(prepared, r);
    result.mass = EstimateMass(prepared, r, arm->gains);
    validation.recordings.push_back(std::move(result));
  }
  if (validation.recordings.empty()) {
    return Status::BadInput(prepared.path() +
                            ": key 'recordings': no recording has use 'validation'; expected at least one");
  }
  return validation;
}

}  // namespace idim
