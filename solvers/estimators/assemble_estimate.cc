#include "solvers/estimators/assemble_estimate.h"

#include <algorithm>
#include <cmath>

#include "core/model/active_effects.h"
#include "core/model/payload_unknowns.h"
#include "core/model/prediction.h"

namespace idim {

using Eigen::MatrixXd;
using Eigen::VectorXd;

Status CheckValidationPayloads(const Study& study) {
  for (const RecordingEntry& entry : study.recordings) {
    if (entry.use == Use::kIdentification || entry.payload < 0) continue;
    bool carried = false, known = true;
    for (const RecordingEntry& other : study.recordings) {
      carried |= other.use == Use::kIdentification && other.payload == entry.payload;
    }
    for (const auto& value : study.payloads[entry.payload].known) known &= value.has_value();
    if (carried || known) continue;
    return Status::BadInput(study.path + ": recording '" + entry.name + "' is for validation and carries payload '" +
                            study.payloads[entry.payload].name +
                            "', whose unknown parameters no identification recording can tell; expected an "
                            "identification recording with it, or all ten parameters known");
  }
  return Status::Ok();
}

Estimate BeginEstimate(const PreparedStudy& prepared, const Status& status, const std::string& estimator) {
  Estimate estimate;
  estimate.status = status;
  estimate.robot = prepared.study.robot.name;
  estimate.estimator = estimator;
  estimate.without_effect = prepared.base.without_effect();
  estimate.velocity_zero_at_rest = prepared.velocity_zero_at_rest;
  estimate.position_noise = prepared.position_noise;
  estimate.cutoff_hz = prepared.preprocessing.cutoff_hz;
  estimate.decimation = prepared.preprocessing.decimation;
  estimate.preprocessing = prepared.preprocessing.reason;
  return estimate;
}

void SetParameters(const PreparedStudy& prepared, const std::vector<Parameter>& unknowns, const VectorXd& values,
                   const MatrixXd& covariance, double degrees_of_freedom, int first_base,
                   const std::vector<std::string>& eliminated, Estimate* estimate) {
  const VectorXd shapes = ShapeOffsets(prepared);
  std::vector<int> kept;
  for (int k = 0; k < static_cast<int>(unknowns.size()); ++k) {
    if (std::find(eliminated.begin(), eliminated.end(), unknowns[k].name) != eliminated.end()) continue;
    ParameterEstimate p;
    p.parameter = unknowns[k];
    const int effect = k - first_base - prepared.base.size();
    p.value = values[k] + (effect >= 0 && effect < shapes.size() ? shapes[effect] : 0.0);
    p.standard_deviation = std::sqrt(covariance(k, k));
    SetInterval95(degrees_of_freedom, &p);
    const int base = k - first_base;
    if (base >= 0 && base < prepared.base.size()) p.regrouping = prepared.base.regroupings()[base];
    estimate->parameters.push_back(p);
    kept.push_back(k);
  }
  estimate->covariance.resize(kept.size(), kept.size());
  for (size_t a = 0; a < kept.size(); ++a) {
    for (size_t b = 0; b < kept.size(); ++b) estimate->covariance(a, b) = covariance(kept[a], kept[b]);
  }
}

ArmParameters ArmOf(const PreparedStudy& prepared, const Study& study, const VectorXd& gains, const VectorXd& values,
                    int first_base, const PayloadColumns& columns) {
  ArmParameters arm;
  arm.gains = gains;
  arm.chi = values.segment(first_base, prepared.num_columns());
  for (int p = 0; p < static_cast<int>(study.payloads.size()); ++p) {
    InertialVector body = KnownPayload(study, p);
    for (int k = 0; k < kNumInertial; ++k) {
      if (columns[p][k] >= 0) body[k] = values[columns[p][k]];
    }
    arm.payloads.push_back(body);
  }
  return arm;
}

void PredictAll(const PreparedStudy& prepared, const ArmParameters& arm, Identification* result) {
  const StatedModel stated = AsStated(prepared, arm);
  for (const ActiveEffect& active : stated.prepared.effects) {
    EstimatedEffect effect{active.effect->id(), active.joints};
    const std::vector<ShapeParameter> shapes = ShapesAlong(prepared, *active.effect, active.joints);
    for (size_t s = 0; s < shapes.size(); ++s) {
      effect.shape.emplace_back(shapes[s].name, active.shape[static_cast<Eigen::Index>(s)]);
    }
    result->estimate.effects.push_back(std::move(effect));
  }
  for (const PreparedRecording& recording : stated.prepared.recordings) {
    result->series.push_back(Predict(stated.prepared, recording, stated.arm));
    result->estimate.recordings.push_back(FitOf(result->series.back()));
  }
  result->estimate.relative_error_percent = RelativeErrorPercent(result->series);
  result->estimate.signal_noise = SignalDeviation(prepared.study, arm.gains, result->series);
}

void SetModelCovariance(const std::vector<Parameter>& unknowns, const MatrixXd& covariance, Estimate* estimate) {
  std::vector<int> kept;
  for (ParameterEstimate& p : estimate->parameters) {
    for (int k = 0; k < static_cast<int>(unknowns.size()); ++k) {
      if (unknowns[k].name != p.parameter.name) continue;
      kept.push_back(k);
      p.model_standard_deviation = std::sqrt(covariance(k, k));
    }
  }
  estimate->model_covariance = covariance(kept, kept);
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
