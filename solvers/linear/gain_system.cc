#include "solvers/linear/gain_system.h"

#include <glog/logging.h>

#include <string>

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

Status CheckGainStudy(const PreparedStudy& prepared) {
  const Model& model = prepared.model;
  if (!model.IdentifiesGains()) {
    return Status::BadInput(prepared.path() +
                            ": key 'gains.mode': 'known' leaves no drive gain to identify; expected 'identify'");
  }
  for (const int r : model.RecordingsFor(Use::kIdentification)) {
    if (KnownPayload(model, model.roles[static_cast<size_t>(r)].payload).norm() > 0.0) return Status::Ok();
  }
  return Status::BadInput(
      prepared.path() +
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

Result<GainSystem> BuildGainSystem(const PreparedStudy& prepared) {
  const int n = prepared.robot().dof();
  Result<GainRows> rows = GainRows::Create(prepared);
  IDIM_RETURN_IF_ERROR(rows);
  GainSystem system(rows->unknowns().parameters(), n);
  system.a_priori_gains = prepared.model.gains;
  const Eigen::Index known_column = rows->unknowns().size();
  for (const int r : prepared.model.RecordingsFor(Use::kIdentification)) {
    const MeasuredRecording& recording = prepared.data->recordings[static_cast<size_t>(r)];
    const InertialVector known = KnownPayload(prepared.model, prepared.model.roles[static_cast<size_t>(r)].payload);
    const bool loaded = known.norm() > 0.0;
    MatrixXd gravity;
    if (loaded) gravity = GravityTorque(prepared.base(), recording.decimator->Apply(recording.states->q), known);
    RowMajorMatrix load = RowMajorMatrix::Zero(n, n + 2);
    Eigen::Index sample = 0;
    rows->Stream(r, [&](const RowMajorMatrix& w) {
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
  IDIM_RETURN_IF_ERROR(CheckGainStudy(prepared));
  return GainRows(prepared);
}

void GainRows::Stream(int recording, const std::function<void(const RowMajorMatrix& rows)>& visit) const {
  const int n = unknowns_.dof();
  // Row j: how the torque of joint j is made of the motors'.
  const MatrixXd drive = prepared_.data->drive.Matrix();
  RowMajorMatrix rows = RowMajorMatrix::Zero(n, unknowns_.size() + 1);
  StreamSamples(prepared_, unknowns_, recording, [&](const Sample& sample) {
    rows.leftCols(n) = drive * sample.signal.asDiagonal();
    rows.middleCols(n, unknowns_.num_columns()) = -sample.columns;
    rows.col(unknowns_.size()) = -sample.known;
    visit(rows);
  });
}

}  // namespace idim
