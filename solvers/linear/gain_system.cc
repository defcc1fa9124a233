#include "solvers/linear/gain_system.h"

#include <glog/logging.h>

#include <string>

#include "core/model/payload_unknowns.h"
#include "core/robot/joint_units.h"

namespace idim {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using RowMajorMatrix = Observation::RowMajorMatrix;

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

}  // namespace

Status CheckGainStudy(const Study& study) {
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

void GainSystem::Merge(const GainSystem& other) {
  CHECK_EQ(other.dof(), dof());
  CHECK_EQ(other.unknowns.size(), unknowns.size());
  for (int j = 0; j < dof(); ++j) {
    joints[j].Merge(other.joints[j]);
    loads[j].Merge(other.loads[j]);
  }
}

std::vector<Parameter> GainParameters(const Robot& robot, Side signal_side) {
  std::vector<Parameter> gains;
  for (int j = 1; j <= robot.dof(); ++j) {
    const JointType driven = signal_side == Side::kMotor ? JointType::kRevolute : robot.joints[j - 1].type;
    gains.push_back(
        {"g" + std::to_string(j), ParameterKind::kDriveGain, j, UnitsOf(driven).torque + " per signal unit"});
  }
  return gains;
}

Result<GainSystem> BuildGainSystem(const PreparedStudy& prepared) {
  const Study& study = prepared.study;
  const int n = study.robot.dof();
  Result<GainRows> rows = GainRows::Create(prepared);
  if (!rows.ok()) return rows.status();
  GainSystem system(rows->unknowns(), n);
  system.a_priori_gains = study.gains;
  const Eigen::Index known_column = static_cast<Eigen::Index>(system.unknowns.size());
  for (const PreparedRecording& recording : prepared.recordings) {
    if (recording.entry.use != Use::kIdentification) continue;
    const InertialVector known = KnownPayload(study, recording.entry.payload);
    const bool loaded = known.norm() > 0.0;
    MatrixXd gravity;
    if (loaded) gravity = GravityTorque(prepared.base, recording.decimator.Apply(recording.states.q), known);
    RowMajorMatrix load = RowMajorMatrix::Zero(n, n + 2);
    Eigen::Index sample = 0;
    rows->Stream(recording, [&](const RowMajorMatrix& w) {
      for (int j = 0; j < n; ++j) system.joints[j].AddRow(w.row(j));
      if (!loaded) return;
      load.leftCols(n) = w.leftCols(n);
      load.col(n) = -w.col(known_column);
      load.col(n + 1) = gravity.row(sample++).transpose();
      for (int j = 0; j < n; ++j) system.loads[j].AddRow(load.row(j));
    });
  }
  return system;
}

Result<GainRows> GainRows::Create(const PreparedStudy& prepared) {
  if (Status status = CheckGainStudy(prepared.study); !status.ok()) return status;
  GainRows rows(prepared);
  rows.unknowns_ = GainParameters(prepared.study.robot, prepared.study.signal_side);
  const std::vector<Parameter> of_model = prepared.parameters();
  rows.unknowns_.insert(rows.unknowns_.end(), of_model.begin(), of_model.end());
  rows.payload_columns_ = AppendPayloadUnknowns(prepared.study, &rows.unknowns_);
  return rows;
}

void GainRows::Stream(const PreparedRecording& recording,
                      const std::function<void(const RowMajorMatrix& rows)>& visit) const {
  const Study& study = prepared_.study;
  const int n = study.robot.dof();
  const int payload = recording.entry.payload;
  const InertialVector known = KnownPayload(study, payload);
  // Row j: how the torque of joint j is made of the motors' (JointTorque of one motor at a time).
  const MatrixXd drive = JointTorque(study, VectorXd::Ones(n), MatrixXd::Identity(n, n)).transpose();
  const Eigen::Index known_column = static_cast<Eigen::Index>(unknowns_.size());
  RowMajorMatrix rows = RowMajorMatrix::Zero(n, known_column + 1);
  StreamObservations(prepared_, recording, [&](const Observation& observation) {
    rows.leftCols(n) = drive * observation.signal.asDiagonal();
    rows.middleCols(n, prepared_.num_columns()) = -observation.columns;
    for (int k = 0; payload >= 0 && k < kNumInertial; ++k) {
      const int column = payload_columns_[payload][k];
      if (column >= 0) rows.col(column) = -observation.payload.col(k);
    }
    rows.col(known_column) = -observation.payload * known;
    visit(rows);
  });
}

}  // namespace idim
