#include "solvers/gain_system.h"

#include <glog/logging.h>

#include <string>

#include "core/observation/observation_stream.h"
#include "solvers/payload_unknowns.h"

namespace idim {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using RowMajorMatrix = Observation::RowMajorMatrix;

Status CheckStudy(const Study& study) {
  if (study.gains_mode != GainsMode::kIdentify) {
    return Status::BadInput(study.path +
                            ": key 'gains.mode': 'known' leaves no drive gain to identify; expected 'identify'");
  }
  bool scaled = false;
  for (const RecordingEntry& entry : study.recordings) {
    if (entry.use == Use::kIdentification) scaled |= KnownPayload(study, entry.payload).norm() > 0.0;
  }
  if (scaled) return Status::Ok();
  return Status::BadInput(
      study.path +
      ": key 'payloads': no identification recording carries a payload of which anything is known, so that gains and "
      "parameters have no common scale; expected at least one, with a weighed mass, as in {M: 4.59}");
}

// Torque at rest of a body on the last link, at each row of q.
MatrixXd GravityTorque(const BaseParameters& base, const MatrixXd& q, const InertialVector& body) {
  StandardModel model = base.model();
  const int n = model.dof();
  const VectorXd zero = VectorXd::Zero(n);
  RowMajorMatrix w(n, model.columns()), payload(n, kNumInertial);
  MatrixXd torque(q.rows(), n);
  VectorXd position(n);
  for (Eigen::Index i = 0; i < q.rows(); ++i) {
    position = q.row(i);
    model.Regressor(position.data(), zero.data(), zero.data(), nullptr, w.data());
    model.PayloadColumns(payload.data());
    torque.row(i) = payload * body;
  }
  return torque;
}

void AddRecording(const PreparedStudy& prepared, const PreparedRecording& recording,
                  const std::vector<std::array<int, kNumInertial>>& payload_columns, GainSystem* system) {
  const Study& study = prepared.study;
  const int n = study.robot.dof();
  const int payload = recording.entry.payload;
  const InertialVector known = KnownPayload(study, payload);
  const bool loaded = known.norm() > 0.0;
  MatrixXd gravity;
  if (loaded) gravity = GravityTorque(prepared.base, recording.decimator.Apply(recording.states.q), known);
  // Row j: how the torque of joint j is made of the motors' (JointTorque of one motor at a time).
  const MatrixXd drive = JointTorque(study, VectorXd::Ones(n), MatrixXd::Identity(n, n)).transpose();
  const int columns = static_cast<int>(system->unknowns.size()) + 1;
  RowMajorMatrix rows = RowMajorMatrix::Zero(n, columns);
  RowMajorMatrix load = RowMajorMatrix::Zero(n, n + 2);
  Eigen::Index sample = 0;
  StreamObservations(prepared.base, recording.states, recording.recording.signal, prepared.velocity_sigma,
                     recording.decimator, [&](const Observation& observation) {
                       rows.leftCols(n) = drive * observation.signal.asDiagonal();
                       rows.middleCols(n, prepared.base.size()) = -observation.base;
                       for (int k = 0; payload >= 0 && k < kNumInertial; ++k) {
                         const int column = payload_columns[payload][k];
                         if (column >= 0) rows.col(column) = -observation.payload.col(k);
                       }
                       rows.col(columns - 1) = -observation.payload * known;
                       for (int j = 0; j < n; ++j) system->joints[j].AddRow(rows.row(j));
                       if (!loaded) return;
                       load.leftCols(n) = rows.leftCols(n);
                       load.col(n) = -rows.col(columns - 1);
                       load.col(n + 1) = gravity.row(sample++).transpose();
                       for (int j = 0; j < n; ++j) system->loads[j].AddRow(load.row(j));
                     });
}

}  // namespace

void GainSystem::Merge(const GainSystem& other) {
  CHECK_EQ(other.dof(), dof());
  CHECK_EQ(other.unknowns.size(), unknowns.size());
  for (int j = 0; j < dof(); ++j) {
    joints[j].Merge(other.joints[j]);
    loads[j].Merge(other.loads[j]);
  }
}

std::vector<Parameter> GainParameters(int dof) {
  std::vector<Parameter> gains;
  for (int j = 1; j <= dof; ++j) {
    gains.push_back({"g" + std::to_string(j), ParameterKind::kDriveGain, j, "N.m per signal unit"});
  }
  return gains;
}

Result<GainSystem> BuildGainSystem(const PreparedStudy& prepared) {
  const Study& study = prepared.study;
  if (Status status = CheckStudy(study); !status.ok()) return status;
  std::vector<Parameter> unknowns = GainParameters(study.robot.dof());
  unknowns.insert(unknowns.end(), prepared.base.parameters().begin(), prepared.base.parameters().end());
  const std::vector<std::array<int, kNumInertial>> payload_columns = AppendPayloadUnknowns(study, &unknowns);
  GainSystem system(std::move(unknowns), study.robot.dof());
  system.a_priori_gains = study.gains;
  for (const PreparedRecording& recording : prepared.recordings) {
    if (recording.entry.use == Use::kIdentification) AddRecording(prepared, recording, payload_columns, &system);
  }
  return system;
}

}  // namespace idim
