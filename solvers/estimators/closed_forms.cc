#include "solvers/estimators/closed_forms.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/model/observation_stream.h"
#include "core/model/payload_unknowns.h"
#include "solvers/estimators/assemble_estimate.h"

namespace idim {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

void AddRecording(const PreparedStudy& prepared, const PreparedRecording& recording, const PayloadColumns& columns,
                  LinearSystem* system) {
  const Study& study = prepared.study;
  const int n = study.robot.dof();
  const int payload = recording.entry.payload;
  const InertialVector known = KnownPayload(study, payload);
  const int torque = static_cast<int>(system->unknowns.size());
  Observation::RowMajorMatrix rows = Observation::RowMajorMatrix::Zero(n, torque + 1);
  StreamObservations(prepared, recording, [&](const Observation& observation) {
    rows.leftCols(prepared.num_columns()) = observation.columns;
    for (int k = 0; payload >= 0 && k < kNumInertial; ++k) {
      const int column = columns[payload][k];
      if (column >= 0) rows.col(column) = observation.payload.col(k);
    }
    const MatrixXd signal = observation.signal.transpose();
    rows.col(torque) = JointTorque(study, study.gains, signal).transpose();
    rows.col(torque) -= observation.payload * known;
    for (int j = 0; j < n; ++j) system->joints[j].AddRow(rows.row(j));
  });
}

// n x n: torque of the joints = map * signal of the drives.
MatrixXd TorqueOfSignal(const Study& study, const VectorXd& gains) {
  const int n = study.robot.dof();
  return JointTorque(study, gains, MatrixXd::Identity(n, n)).transpose();
}

// Standard deviation of each joint's torque by the a priori noise of the signals, at the recorded rate; empty where
// the study has none. Decimation divides that of all joints by the same number, and only ratios count as weights.
VectorXd APrioriSigma(const Study& study) {
  if (study.signal_noise.size() == 0) return VectorXd();
  return (TorqueOfSignal(study, study.gains).cwiseAbs2() * study.signal_noise.cwiseAbs2()).cwiseSqrt();
}

// n x columns: the same for each column of a GainSystem, of which the signals' alone are noisy.
// Again only ratios count.
MatrixXd APrioriColumnNoise(const Study& study, size_t columns) {
  if (study.signal_noise.size() == 0) return MatrixXd();
  const int n = study.robot.dof();
  MatrixXd noise = MatrixXd::Zero(n, static_cast<Eigen::Index>(columns));
  noise.leftCols(n) = TorqueOfSignal(study, VectorXd::Ones(n)).cwiseAbs() * study.signal_noise.asDiagonal();
  return noise;
}

}  // namespace

LinearFit FitLinear(const PreparedStudy& prepared, const LinearOptions& options) {
  LinearFit fit;
  fit.unknowns = prepared.parameters();
  fit.payload_columns = AppendPayloadUnknowns(prepared.study, &fit.unknowns);
  LinearSystem system(fit.unknowns, prepared.study.robot.dof());
  for (const PreparedRecording& recording : prepared.recordings) {
    if (recording.entry.use == Use::kIdentification) AddRecording(prepared, recording, fit.payload_columns, &system);
  }
  LinearOptions used = options;
  if (used.a_priori_sigma.size() == 0) used.a_priori_sigma = APrioriSigma(prepared.study);
  fit.summary = SolveLinear(system, used);
  return fit;
}

Result<Identification> IdentifyLinear(const PreparedStudy& prepared, const LinearOptions& options) {
  const Study& study = prepared.study;
  if (study.gains_mode == GainsMode::kIdentify) {
    return Status::BadInput(study.path +
                            ": key 'gains.mode': 'identify' asks for drive gains, which this estimator "
                            "takes as known; expected 'known' with values");
  }
  if (Status status = CheckValidationPayloads(study); !status.ok()) return status;
  const auto [unknowns, columns, summary] = FitLinear(prepared, options);

  Identification result;
  Estimate& estimate = result.estimate;
  estimate = BeginEstimate(prepared, summary.status, options.weighted ? "wls" : "ls");
  if (!summary.IsSolutionUsable()) return result;
  SetParameters(prepared, unknowns, summary.values, summary.covariance, static_cast<double>(summary.degrees_of_freedom),
                0, summary.eliminated, &estimate);
  estimate.eliminated = summary.eliminated;
  estimate.condition_number = summary.condition_number;
  estimate.condition_number_weighted = summary.condition_number_solved;
  PredictAll(prepared, ArmOf(prepared, study, study.gains, summary.values, 0, columns), &result);
  return result;
}

Result<Identification> IdentifyGains(const PreparedStudy& prepared, const GainSystem& system,
                                     const GainOptions& options) {
  const Study& study = prepared.study;
  if (Status status = CheckValidationPayloads(study); !status.ok()) return status;
  const int n = study.robot.dof();
  std::vector<Parameter> unknowns = GainParameters(study.robot, study.signal_side);
  const std::vector<Parameter> of_model = prepared.parameters();
  unknowns.insert(unknowns.end(), of_model.begin(), of_model.end());
  const PayloadColumns columns = AppendPayloadUnknowns(study, &unknowns);
  GainOptions used = options;
  if (used.column_noise.size() == 0) used.column_noise = APrioriColumnNoise(study, unknowns.size() + 1);
  const GainSummary summary = SolveGains(system, used);

  Identification result;
  Estimate& estimate = result.estimate;
  estimate = BeginEstimate(prepared, summary.status, GainEstimatorName(options.estimator));
  for (const GainVerdict& verdict : summary.verdicts) estimate.gain_diagnoses.push_back(DescribeGain(verdict));
  estimate.singular_values = summary.singular_values;
  if (summary.values.size() == 0) return result;
  SetParameters(prepared, unknowns, summary.values, summary.covariance, static_cast<double>(summary.degrees_of_freedom),
                n, summary.eliminated, &estimate);
  estimate.eliminated = summary.eliminated;
  estimate.condition_number = summary.condition_number;
  estimate.condition_number_weighted = summary.condition_number_solved;
  PredictAll(prepared, ArmOf(prepared, study, summary.values.head(n), summary.values, n, columns), &result);
  return result;
}

}  // namespace idim
