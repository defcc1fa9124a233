#include "solvers/loop/judged_fit.h"

#include <cmath>

#include "core/model/active_effects.h"
#include "core/model/prediction.h"

namespace idim {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// Sums of squares, joint by joint, of all samples and of those at which it moves.
class ErrorSum {
 public:
  explicit ErrorSum(const VectorXd& slowest) : slowest_(slowest), sums_(MatrixXd::Zero(4, slowest.size())) {}

  // samples x n each.
  void Add(const MatrixXd& residual, const MatrixXd& torque, const MatrixXd& velocity) {
    for (Index k = 0; k < residual.rows(); ++k) {
      for (Index j = 0; j < residual.cols(); ++j) {
        const Eigen::Vector2d squares(residual(k, j) * residual(k, j), torque(k, j) * torque(k, j));
        sums_.col(j).head<2>() += squares;
        if (std::abs(velocity(k, j)) > slowest_[j]) sums_.col(j).tail<2>() += squares;
      }
    }
  }

  double All() const { return 100.0 * std::sqrt(sums_.row(0).sum() / sums_.row(1).sum()); }
  VectorXd PerJoint() const { return 100.0 * sums_.row(0).cwiseQuotient(sums_.row(1)).cwiseSqrt().transpose(); }
  VectorXd Moving() const { return 100.0 * sums_.row(2).cwiseQuotient(sums_.row(3)).cwiseSqrt().transpose(); }

 private:
  VectorXd slowest_;
  MatrixXd sums_;  // residual, torque; the same while moving
};

}  // namespace

LoopErrors LoopErrorsOf(const JudgedFit& model, bool by_blocks) {
  const std::vector<BundleSample>& samples = model.fit.data.samples();
  const int n = model.residual.dof();
  const MatrixXd torque = model.residual.torque();
  MatrixXd velocity(torque.rows(), n);
  for (Index k = 0; k < velocity.rows(); ++k) velocity.row(k) = samples[static_cast<size_t>(k)].state.segment(n, n);
  const VectorXd slowest = 0.01 * velocity.cwiseAbs().colwise().maxCoeff().transpose();
  ErrorSum identification(slowest), validation(slowest);
  identification.Add(model.residual.TorqueResidual(), torque, velocity);
  if (by_blocks) {
    validation.Add(model.held_out.residual, torque, velocity);
  } else {
    const StatedModel stated = AsStated(model.fit.prepared, model.fit.Arm());
    for (const int r : stated.prepared.model.RecordingsFor(Use::kValidation)) {
      const MeasuredRecording& recording = stated.prepared.data->recordings[static_cast<size_t>(r)];
      const RecordingSeries series = Predict(stated.prepared, r, stated.arm);
      validation.Add(series.decimated_torque - series.decimated_model, series.decimated_torque,
                     recording.decimator->Apply(recording.states->dq));
    }
  }
  LoopErrors errors;
  errors.identification = identification.All();
  errors.identification_per_joint = identification.PerJoint();
  errors.identification_moving = identification.Moving();
  errors.validation = validation.All();
  errors.validation_per_joint = validation.PerJoint();
  errors.validation_moving = validation.Moving();
  return errors;
}

VectorXd HeldOutByFold(const ResidualModel& measure, const JudgedFit& model, const std::vector<int>& joints) {
  const MatrixXd squares = measure.WeightedSquares(model.held_out.signal);
  VectorXd sum = VectorXd::Zero(measure.num_folds());
  for (Index k = 0; k < squares.rows(); ++k) {
    double& fold = sum[measure.folds()[static_cast<size_t>(k)]];
    for (const int j : joints) fold += squares(k, j);
    if (joints.empty()) fold += squares.row(k).sum();
  }
  return sum;
}

}  // namespace idim
