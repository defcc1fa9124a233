// The decimated samples of a recording as equations of the model's unknowns: the one way from recordings to rows.

#ifndef IDIM_CORE_MODEL_SAMPLE_STREAM_H_
#define IDIM_CORE_MODEL_SAMPLE_STREAM_H_

#include <Eigen/Core>
#include <functional>

#include "core/model/model.h"
#include "core/model/observation_stream.h"
#include "core/model/unknowns.h"

namespace idim {

// tau = columns * (base parameters, effects, unknown payload parameters) + known.
struct Sample {
  double t = 0.0;                       // [s]
  Observation::RowMajorMatrix columns;  // n x Unknowns::num_columns()
  Eigen::VectorXd known;                // n [N m or N]: torque of what is known of the payload
  Eigen::VectorXd signal;               // n, the control signal as it was logged
};

// Calls `visit` for each sample of a recording of the data in order of time. unknowns: of the same model.
void StreamSamples(const PreparedStudy& prepared, const Unknowns& unknowns, int recording,
                   const std::function<void(const Sample&)>& visit);

// The same before the payload: StreamObservations() of one of the recordings, its effects included.
void StreamObservations(const PreparedStudy& prepared, int recording,
                        const std::function<void(const Observation&)>& visit);

}  // namespace idim

#endif  // IDIM_CORE_MODEL_SAMPLE_STREAM_H_
