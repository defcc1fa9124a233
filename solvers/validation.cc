#include "solvers/validation.h"

#include <cmath>
#include <set>
#include <utility>

#include "core/base/text.h"
#include "core/observation/observation_stream.h"
#include "core/statistics/triangular_factor.h"
#include "solvers/gain_system.h"
#include "solvers/identification.h"
#include "solvers/least_squares.h"
#include "solvers/payload_unknowns.h"

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

double ConditionOf(const PreparedStudy& prepared, const PreparedRecording& recording) {
  TriangularFactor factor(prepared.num_columns());
  StreamObservations(prepared, recording, [&](const Observation& observation) { factor.AddRows(observation.columns); });
  return ConditionNumber(factor.R());
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

Result<ArmParameters> ParametersOf(const PreparedStudy& prepared, const Reference& estimate) {
  const Study& study = prepared.study;
  const int n = study.robot.dof();
  if (!estimate.robot.empty() && !study.robot.name.empty() && estimate.robot != study.robot.name) {
    return Status::BadInput("estimate '" + estimate.name + "' is of robot '" + estimate.robot + "', that of " +
                            study.path + " is '" + study.robot.name + "'; expected an estimate of the same robot");
  }
  ArmParameters arm;
  arm.gains = study.gains;
  const std::vector<Parameter> gains = GainParameters(n);
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
  arm.chi = VectorXd::Zero(prepared.num_columns());
  int found = 0;
  for (int k = 0; k < prepared.num_columns(); ++k) {
    const Reference::Entry* entry = estimate.Find(of_model[k].name);
    if (entry == nullptr) continue;
    arm.chi[k] = entry->value;
    ++found;
  }
  const std::string payload_link = std::to_string(n + 1);
  std::vector<std::string> names;
  for (const Parameter& p : of_model) names.push_back(p.name);
  for (const Reference::Entry& entry : estimate.parameters) {
    bool known = false;
    for (const std::string& name : names) known |= name == entry.name;
    for (const Parameter& gain : gains) known |= gain.name == entry.name;
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

Result<Validation> Validate(const PreparedStudy& prepared, const Reference& estimate) {
  const Result<ArmParameters> arm = ParametersOf(prepared, estimate);
  if (!arm.ok()) return arm.status();
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
      validation.series.push_back(Predict(prepared, recording, *arm));
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
