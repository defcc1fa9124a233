#include "solvers/identification.h"

#include <cmath>

#include "core/observation/observation_stream.h"
#include "solvers/payload_unknowns.h"

namespace idim {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Where the unknown parameters of each payload are among the unknowns of the linear system.
struct Unknowns {
  std::vector<Parameter> parameters;
  std::vector<std::array<int, kNumInertial>> payload_column;  // -1: known, or the payload is in no identification
};

Unknowns LayOut(const PreparedStudy& prepared) {
  Unknowns unknowns;
  unknowns.parameters = prepared.base.parameters();
  unknowns.payload_column = AppendPayloadUnknowns(prepared.study, &unknowns.parameters);
  return unknowns;
}

void AddRecording(const PreparedStudy& prepared, const PreparedRecording& recording, const Unknowns& unknowns,
                  LinearSystem* system) {
  const Study& study = prepared.study;
  const int n = study.robot.dof();
  const int payload = recording.entry.payload;
  const InertialVector known = KnownPayload(study, payload);
  const int columns = static_cast<int>(unknowns.parameters.size()) + 1;
  Observation::RowMajorMatrix rows = Observation::RowMajorMatrix::Zero(n, columns);
  StreamObservations(prepared.base, recording.states, recording.recording.signal, prepared.velocity_sigma,
                     recording.decimator, [&](const Observation& observation) {
                       rows.leftCols(prepared.base.size()) = observation.base;
                       for (int k = 0; payload >= 0 && k < kNumInertial; ++k) {
                         const int column = unknowns.payload_column[payload][k];
                         if (column >= 0) rows.col(column) = observation.payload.col(k);
                       }
                       const MatrixXd signal = observation.signal.transpose();
                       rows.col(columns - 1) = JointTorque(study, study.gains, signal).transpose();
                       rows.col(columns - 1) -= observation.payload * known;
                       for (int j = 0; j < n; ++j) system->joints[j].AddRow(rows.row(j));
                     });
}

// One whole recording predicted with the identified parameters.
RecordingSeries Predict(const PreparedStudy& prepared, const PreparedRecording& recording, const Unknowns& unknowns,
                        const VectorXd& values) {
  const Study& study = prepared.study;
  StandardModel model = prepared.base.model();
  VectorXd chi = VectorXd::Zero(model.columns());
  for (int k = 0; k < prepared.base.size(); ++k) chi[prepared.base.kept()[k]] = values[k];
  const int payload = recording.entry.payload;
  InertialVector body = KnownPayload(study, payload);
  for (int k = 0; payload >= 0 && k < kNumInertial; ++k) {
    const int column = unknowns.payload_column[payload][k];
    if (column >= 0) body[k] = values[column];
  }

  RecordingSeries series;
  series.name = recording.entry.name;
  series.use = recording.entry.use == Use::kIdentification ? "identification" : "validation";
  series.t = recording.recording.t;
  series.torque = JointTorque(study, study.gains, recording.recording.signal);
  series.model.resizeLike(series.torque);
  const JointStates& states = recording.states;
  VectorXd q, dq, ddq, tau(model.dof());
  for (Eigen::Index i = 0; i < series.t.size(); ++i) {
    q = states.q.row(i);
    dq = states.dq.row(i);
    ddq = states.ddq.row(i);
    model.Torque(q.data(), dq.data(), ddq.data(), prepared.velocity_sigma.data(), chi, body, tau.data());
    series.model.row(i) = tau;
  }
  series.decimated_t = recording.decimator.times();
  series.decimated_q = recording.decimator.Apply(states.q);
  series.decimated_dq = recording.decimator.Apply(states.dq);
  series.decimated_torque = recording.decimator.Apply(series.torque);
  series.decimated_model = recording.decimator.Apply(series.model);
  return series;
}

VectorXd ColumnRms(const MatrixXd& m) { return m.colwise().norm() / std::sqrt(static_cast<double>(m.rows())); }

RecordingFit Fit(const RecordingSeries& series) {
  RecordingFit fit;
  fit.name = series.name;
  fit.use = series.use;
  fit.samples = static_cast<int>(series.decimated_t.size());
  const MatrixXd residual = series.decimated_torque - series.decimated_model;
  fit.relative_error_percent =
      100.0 * residual.colwise().norm().cwiseQuotient(series.decimated_torque.colwise().norm());
  fit.relative_error_percent_all = 100.0 * residual.norm() / series.decimated_torque.norm();
  fit.rms_torque = ColumnRms(residual);
  fit.rms_torque_unfiltered = ColumnRms(series.torque - series.model);
  const Eigen::Index last = residual.rows() - 1;
  fit.residual_lag1 = (residual.topRows(last).cwiseProduct(residual.bottomRows(last)))
                          .colwise()
                          .sum()
                          .cwiseQuotient(residual.colwise().squaredNorm());
  return fit;
}

// Standard deviation of a logged signal about the model, in its own unit and on its own side.
VectorXd SignalNoise(const Study& study, const std::vector<RecordingSeries>& series) {
  const int n = study.robot.dof();
  // torque = map * signal, row by row.
  const MatrixXd map = JointTorque(study, study.gains, MatrixXd::Identity(n, n)).transpose();
  const Eigen::PartialPivLU<MatrixXd> inverse(map);
  VectorXd squares = VectorXd::Zero(n);
  double samples = 0.0;
  for (const RecordingSeries& s : series) {
    if (s.use != "identification") continue;
    squares += inverse.solve((s.torque - s.model).transpose()).rowwise().squaredNorm();
    samples += static_cast<double>(s.t.size());
  }
  return (squares / samples).cwiseSqrt();
}

Status CheckStudy(const Study& study) {
  if (study.gains_mode == GainsMode::kIdentify) {
    return Status::BadInput(
        study.path +
        ": key 'gains.mode': 'identify' asks for drive gains, which LS and WLS of the torque take as "
        "known; expected 'known' with values");
  }
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

}  // namespace

Result<Identification> IdentifyLinear(const PreparedStudy& prepared, const LinearOptions& options) {
  const Study& study = prepared.study;
  if (Status status = CheckStudy(study); !status.ok()) return status;
  const Unknowns unknowns = LayOut(prepared);
  LinearSystem system(unknowns.parameters, study.robot.dof());
  for (const PreparedRecording& recording : prepared.recordings) {
    if (recording.entry.use == Use::kIdentification) AddRecording(prepared, recording, unknowns, &system);
  }
  const LinearSummary summary = SolveLinear(system, options);

  Identification result;
  Estimate& estimate = result.estimate;
  estimate.status = summary.status;
  estimate.robot = study.robot.name;
  estimate.estimator = options.weighted ? "wls" : "ls";
  estimate.without_effect = prepared.base.without_effect();
  estimate.position_noise = prepared.position_noise;
  estimate.cutoff_hz = prepared.preprocessing.cutoff_hz;
  estimate.decimation = prepared.preprocessing.decimation;
  estimate.preprocessing = prepared.preprocessing.reason;
  if (!summary.IsSolutionUsable()) return result;

  std::vector<int> kept;
  for (int k = 0; k < static_cast<int>(unknowns.parameters.size()); ++k) {
    if (summary.covariance(k, k) == 0.0) continue;  // eliminated
    ParameterEstimate p;
    p.parameter = unknowns.parameters[k];
    p.value = summary.values[k];
    p.standard_deviation = std::sqrt(summary.covariance(k, k));
    SetInterval95(static_cast<double>(summary.degrees_of_freedom), &p);
    if (k < prepared.base.size()) p.regrouping = prepared.base.regroupings()[k];
    estimate.parameters.push_back(p);
    kept.push_back(k);
  }
  estimate.covariance.resize(kept.size(), kept.size());
  for (size_t a = 0; a < kept.size(); ++a) {
    for (size_t b = 0; b < kept.size(); ++b) estimate.covariance(a, b) = summary.covariance(kept[a], kept[b]);
  }
  estimate.eliminated = summary.eliminated;
  estimate.condition_number = summary.condition_number;
  estimate.condition_number_weighted = summary.condition_number_solved;
  double residual = 0.0, torque = 0.0;
  for (const PreparedRecording& recording : prepared.recordings) {
    result.series.push_back(Predict(prepared, recording, unknowns, summary.values));
    const RecordingSeries& series = result.series.back();
    estimate.recordings.push_back(Fit(series));
    if (recording.entry.use != Use::kIdentification) continue;
    residual += (series.decimated_torque - series.decimated_model).squaredNorm();
    torque += series.decimated_torque.squaredNorm();
  }
  estimate.relative_error_percent = 100.0 * std::sqrt(residual / torque);
  estimate.signal_noise = SignalNoise(study, result.series);
  return result;
}

}  // namespace idim
