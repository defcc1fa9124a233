// A fitted model of the loop with what it leaves, and how large that is.

#ifndef IDIM_SOLVERS_LOOP_JUDGED_FIT_H_
#define IDIM_SOLVERS_LOOP_JUDGED_FIT_H_

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "solvers/bundle/residual_model.h"
#include "solvers/loop/effect_fit.h"

namespace idim {

struct JudgedFit {
  EffectFit fit;
  ResidualModel residual;
  ResidualModel::HeldOut held_out;  // of the model as it is

  explicit JudgedFit(EffectFit fit_in)
      : fit(std::move(fit_in)),
        residual(fit.prepared.base(), fit.data, fit.summary),
        held_out(residual.CrossValidate(Eigen::MatrixXd(residual.residual().size(), 0))) {}
};

// Relative errors 100 |residual| / |torque| of decimated samples [%].
struct LoopErrors {
  double identification = -1.0, validation = -1.0;
  Eigen::VectorXd identification_per_joint, validation_per_joint;
  // Of the samples at which the joint moves faster than a hundredth of its largest speed: at rest its friction is
  // anything between -Fs and Fs, and no model tells it.
  Eigen::VectorXd identification_moving, validation_moving;
};

// validation: of held-out blocks, or of the recordings of the study that are not for identification.
LoopErrors LoopErrorsOf(const JudgedFit& model, bool by_blocks);

// Squared held-out residuals of a model in each fold, of the joints of an effect, of all if none is named. Weights are
// those of `measure`.
Eigen::VectorXd HeldOutByFold(const ResidualModel& measure, const JudgedFit& model, const std::vector<int>& joints);

}  // namespace idim

#endif  // IDIM_SOLVERS_LOOP_JUDGED_FIT_H_
