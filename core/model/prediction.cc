#include "core/model/prediction.h"

#include <glog/logging.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "core/base/decompositions.h"

namespace idim {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd ColumnRms(const MatrixXd& m) { return m.colwise().norm() / std::sqrt(static_cast<double>(m.rows())); }

// Recorded samples between the first decimated instant and the last: beyond them the position filter had to invent what
// comes before or after, and the model's torque is that of an invented motion.
struct Span {
  Eigen::Index begin, count;
};

Span Inner(const RecordingSeries& series) {
  if (series.decimated_t.size() == 0) return {0, 0};
  const double* const t = series.t.data();
  const double* const end = t + series.t.size();
  const double* const first = std::lower_bound(t, end, series.decimated_t[0]);
  const double* const last = std::upper_bound(first, end, series.decimated_t[series.decimated_t.size() - 1]);
  return {first - t, last - first};
}

MatrixXd UnfilteredResidual(const RecordingSeries& series) {
  const Span inner = Inner(series);
  return (series.torque - series.model).middleRows(inner.begin, inner.count);
}

}  // namespace

RecordingSeries Predict(const PreparedStudy& prepared, int index, const ArmParameters& parameters) {
  const auto r = static_cast<size_t>(index);
  const MeasuredRecording& recording = prepared.data->recordings[r];
  const RecordingRole& role = prepared.model.roles[r];
  const EffectColumns& effects = *prepared.model.columns;
  const BaseParameters& base = prepared.base();
  CHECK_EQ(static_cast<size_t>(parameters.chi.size()), static_cast<size_t>(base.size()) + effects.parameters.size());
  CHECK_EQ(parameters.payloads.size(), prepared.model.payloads.size());
  // Base parameters are standard parameters with the regrouped ones zero: the torque is the same.
  StandardModel model = base.model();
  VectorXd chi = VectorXd::Zero(model.columns());
  for (int k = 0; k < base.size(); ++k) chi[base.kept()[k]] = parameters.chi[k];
  const InertialVector body = parameters.Carried(role);

  RecordingSeries series;
  series.name = recording.entry.name;
  series.use = role.use == Use::kIdentification ? "identification" : "validation";
  series.t = recording.recording->t;
  series.torque = prepared.data->drive.Torque(parameters.gains, recording.recording->signal);
  series.model.resizeLike(series.torque);
  const JointStates& states = *recording.states;
  VectorXd q, dq, ddq, tau(model.dof());
  for (Eigen::Index i = 0; i < series.t.size(); ++i) {
    q = states.q.row(i);
    dq = states.dq.row(i);
    ddq = states.ddq.row(i);
    model.Torque(q.data(), dq.data(), ddq.data(), prepared.data->velocity_sigma.data(), chi, body, tau.data());
    series.model.row(i) = tau;
  }
  for (const EffectEntry& effect : effects.of_recording[r]) {
    series.model.col(effect.joint) += parameters.chi[base.size() + effect.parameter] * effect.torque;
  }
  const Decimator& decimator = *recording.decimator;
  series.decimated_t = decimator.times();
  series.decimated_q = decimator.Apply(states.q);
  series.decimated_dq = decimator.Apply(states.dq);
  series.decimated_torque = decimator.Apply(series.torque);
  series.decimated_model = decimator.Apply(series.model);
  return series;
}

RecordingFit FitOf(const RecordingSeries& series) {
  RecordingFit fit;
  fit.name = series.name;
  fit.use = series.use;
  fit.samples = static_cast<int>(series.decimated_t.size());
  const MatrixXd residual = series.decimated_torque - series.decimated_model;
  fit.relative_error_percent =
      100.0 * residual.colwise().norm().cwiseQuotient(series.decimated_torque.colwise().norm());
  fit.relative_error_percent_all = 100.0 * residual.norm() / series.decimated_torque.norm();
  fit.rms_torque = ColumnRms(residual);
  fit.rms_torque_unfiltered = ColumnRms(UnfilteredResidual(series));
  const Eigen::Index last = residual.rows() - 1;
  const VectorXd power = residual.colwise().squaredNorm();
  const VectorXd lagged = residual.topRows(last).cwiseProduct(residual.bottomRows(last)).colwise().sum();
  fit.residual_lag1 = (power.array() > 0.0).select(lagged.cwiseQuotient(power), 0.0);
  return fit;
}

double RelativeErrorPercent(const std::vector<RecordingSeries>& series) {
  double residual = 0.0, torque = 0.0;
  for (const RecordingSeries& s : series) {
    if (s.use != "identification") continue;
    residual += (s.decimated_torque - s.decimated_model).squaredNorm();
    torque += s.decimated_torque.squaredNorm();
  }
  return 100.0 * std::sqrt(residual / torque);
}

VectorXd SignalDeviation(const DriveMap& drive, const VectorXd& gains, const std::vector<RecordingSeries>& series) {
  const Eigen::PartialPivLU<MatrixXd> inverse(drive.Matrix(gains));
  VectorXd squares = VectorXd::Zero(drive.dof());
  double samples = 0.0;
  for (const RecordingSeries& s : series) {
    if (s.use != "identification") continue;
    const MatrixXd residual = UnfilteredResidual(s);
    squares += inverse.solve(residual.transpose()).rowwise().squaredNorm();
    samples += static_cast<double>(residual.rows());
  }
  return (squares / samples).cwiseSqrt();
}

}  // namespace idim
