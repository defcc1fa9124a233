// The torque of a recording by given parameters, and how far it is from the measured one.

#ifndef IDIM_CORE_MODEL_PREDICTION_H_
#define IDIM_CORE_MODEL_PREDICTION_H_

#include <Eigen/Core>
#include <vector>

#include "core/estimate/estimate.h"
#include "core/estimate/series.h"
#include "core/model/unknowns.h"

namespace idim {

// Of a recording of the data: torque by signal and gains, and by the model, at the recorded instants and decimated.
RecordingSeries Predict(const PreparedStudy& prepared, int recording, const ArmParameters& parameters);

// A relative error is infinite (or NaN for a residual of zero) on a joint without any torque; a residual of zero has an
// autocorrelation of 0. The recorded samples count from the first decimated instant to the last.
RecordingFit FitOf(const RecordingSeries& series);

// 100 |Y - W chi| / |Y| over the decimated samples of all identification recordings.
double RelativeErrorPercent(const std::vector<RecordingSeries>& series);

// n [signal unit]: standard deviation of a logged signal about the model at the recorded rate, on its own side, over
// the identification recordings; their filtered ends do not count.
Eigen::VectorXd SignalDeviation(const DriveMap& drive, const Eigen::VectorXd& gains,
                                const std::vector<RecordingSeries>& series);

}  // namespace idim

#endif  // IDIM_CORE_MODEL_PREDICTION_H_
