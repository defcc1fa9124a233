// From joint states to rows of the observation matrix, in one pass (paper II.C, eq. (6)).
//
// The columns of IDM are evaluated at every recorded instant and pass, like the control signal, the same low-pass and
// decimation (core/signal/decimator.h), output by output as the recording goes by. Memory is that of the outputs whose
// windows are open, whatever the length of the recording: W is never held.

#ifndef IDIM_CORE_MODEL_OBSERVATION_STREAM_H_
#define IDIM_CORE_MODEL_OBSERVATION_STREAM_H_

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "core/dynamics/base_parameters.h"
#include "core/effects/effect.h"
#include "core/motion/preprocessing.h"
#include "core/signal/decimator.h"

namespace idim {

// One decimated sample of a recording.
struct Observation {
  using RowMajorMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  double t = 0.0;          // [s]
  RowMajorMatrix columns;  // n x (base parameters + parameters of effects): IDM
  RowMajorMatrix payload;  // n x 10: the columns of a body fixed to the last link, in its frame
  Eigen::VectorXd signal;  // n, the control signal as the study has it
};

// states and signal (N x n) at the recorded instants; velocity_sigma: n, of the undecimated dq, for the sign near
// standstill (core/dynamics/standard_model.h). Calls `visit` for each output in order of time. effects: entries of
// length N, EffectEntry::parameter below `effect_parameters`.
void StreamObservations(const BaseParameters& base, const JointStates& states, const Eigen::MatrixXd& signal,
                        const Eigen::VectorXd& velocity_sigma, const Decimator& decimator,
                        const std::function<void(const Observation&)>& visit,
                        const std::vector<EffectEntry>& effects = {}, int effect_parameters = 0);

}  // namespace idim

#endif  // IDIM_CORE_MODEL_OBSERVATION_STREAM_H_
