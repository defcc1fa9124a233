#include "solvers/estimators/assemble_estimate.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/model/active_effects.h"
#include "core/model/prediction.h"

namespace idim {
namespace {

// Those that are kept, with their covariances.
void SetParameters(const PreparedStudy& prepared, const FitSummary& fit, Estimate* estimate) {
  const Unknowns& unknowns = fit.unknowns;
  std::vector<int> kept;
  for (int k = 0; k < unknowns.size(); ++k) {
    const auto& eliminated = estimate->eliminated;
    if (std::find(eliminated.begin(), eliminated.end(), unknowns[k].name) != eliminated.end()) continue;
    ParameterEstimate p;
    p.parameter = unknowns[k];
    p.value = fit.values[k] + unknowns.Offset(k);
    p.standard_deviation = std::sqrt(fit.covariance(k, k));
    if (fit.model_covariance.size() > 0) p.model_standard_deviation = std::sqrt(fit.model_covariance(k, k));
    SetInterval95(fit.degrees_of_freedom, &p, fit.interval_factor);
    const int base = k - unknowns.first_base();
    if (base >= 0 && base < unknowns.num_base()) {
      p.regrouping = prepared.base().regroupings()[static_cast<size_t>(base)];
    }
    estimate->parameters.push_back(p);
    kept.push_back(k);
  }
  estimate->covariance = fit.covariance(kept, kept);
  if (fit.model_covariance.size() > 0) estimate->model_covariance = fit.model_covariance(kept, kept);
}

void PredictAll(const PreparedStudy& prepared, const ArmParameters& arm, Identification* result) {
  const StatedModel stated = AsStated(prepared, arm);
  for (const ActiveEffect& active : stated.prepared.model.effects) {
    EstimatedEffect effect{active.effect->id(), active.joints};
    const std::vector<ShapeParameter> shapes = ShapesAlong(prepared, *active.effect, active.joints);
    for (size_t s = 0; s < shapes.size(); ++s) {
      effect.shape.emplace_back(shapes[s].name, active.shape[static_cast<Eigen::Index>(s)]);
    }
    result->estimate.effects.push_back(std::move(effect));
  }
  for (int r = 0; r < static_cast<int>(prepared.data->recordings.size()); ++r) {
    result->series.push_back(Predict(stated.prepared, r, stated.arm));
    result->estimate.recordings.push_back(FitOf(result->series.back()));
  }
  result->estimate.relative_error_percent = RelativeErrorPercent(result->series);
  result->estimate.signal_noise = SignalDeviation(prepared.data->drive, arm.gains, result->series);
}

}  // namespace

Status CheckValidationPayloads(const PreparedStudy& prepared) {
  const Model& model = prepared.model;
  for (const int r : model.RecordingsFor(Use::kValidation)) {
    const int carried = model.roles[static_cast<size_t>(r)].payload;
    if (carried < 0 || model.IsCarried(carried)) continue;
    const Payload& payload = model.payloads[static_cast<size_t>(carried)];
    bool known = true;
    for (const auto& value : payload.known) known &= value.has_value();
    if (known) continue;
    return Status::BadInput(prepared.path() + ": recording '" +
                            prepared.data->recordings[static_cast<size_t>(r)].entry.name +
                            "' is for validation and carries payload '" + payload.name +
                            "', whose unknown parameters no identification recording can tell; expected an "
                            "identification recording with it, or all ten parameters known");
  }
  return Status::Ok();
}

Estimate BeginEstimate(const PreparedStudy& prepared, const Status& status, const std::string& estimator) {
  const Data& data = *prepared.data;
  Estimate estimate;
  estimate.status = status;
  estimate.robot = data.robot().name;
  estimate.estimator = estimator;
  estimate.without_effect = prepared.base().without_effect();
  estimate.velocity_zero_at_rest = data.velocity_zero_at_rest;
  estimate.position_noise = data.position_noise;
  estimate.cutoff_hz = data.preprocessing.cutoff_hz;
  estimate.decimation = data.preprocessing.decimation;
  estimate.preprocessing = data.preprocessing.reason;
  return estimate;
}

Identification ToIdentification(const PreparedStudy& prepared, const FitSummary& fit) {
  Identification result;
  result.estimate = fit.header;
  if (fit.values.size() == 0) return result;
  SetParameters(prepared, fit, &result.estimate);
  PredictAll(prepared, fit.unknowns.Arm(fit.values), &result);
  return result;
}

GainDiagnosis DescribeGain(const GainVerdict& verdict) {
  static constexpr const char* kStrength[] = {"strong", "weak", "none"};
  return {verdict.name,
          kStrength[static_cast<int>(verdict.strength)],
          verdict.reliability,
          verdict.independent,
          verdict.known_share,
          verdict.payload_torque_share,
          verdict.payload_gravity_share,
          verdict.sentence};
}

}  // namespace idim
