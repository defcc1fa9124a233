// From a recording to joint states and the parallel decimator (paper II.C):
//
//   position -> zero-phase low-pass -> derivatives -> q, dq, ddq at the recorded instants ->
//   [regressor columns] -> decimator
//
// Uniform clock: forward-backward Butterworth (core/signal/butterworth.h), then central differences
//   dq_k = (q_{k+1} - q_{k-1}) / 2h,    ddq_k = (q_{k+1} - 2 q_k + q_{k-1}) / h^2.
// Jittering clock: smoothing spline on the recorded time (core/signal/smoothing_spline.h), the same filter to within
// the bilinear warping and the droop of the differences, with exact derivatives. Nothing is resampled: the states stand
// at the recorded instants, beside the recorded signal.

#ifndef IDIM_CORE_MOTION_PREPROCESSING_H_
#define IDIM_CORE_MOTION_PREPROCESSING_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/base/status.h"
#include "core/recording/recording.h"
#include "core/recording/study.h"
#include "core/signal/clock.h"
#include "core/signal/decimator.h"

namespace idim {

struct PreprocessingOptions {
  // Order of the Butterworth low-pass (each of the two passes), 3 to 6.
  int filter_order = 4;
  // Dropped at each end: the longer of these, in decimated steps (>= 0) and in periods of the cut-off (>= 0).
  double edge_outputs = 2.0;
  double edge_periods = 2.0;
  // See AnalyzeClock(); 0 < tolerance < 0.5 steps.
  double clock_tolerance = kUniformClockTolerance;

  bool IsValid(std::string* error) const;
};

struct Preprocessing {
  double cutoff_hz = 0;  // -6 dB of the zero-phase low-pass
  int decimation = 0;    // recorded steps to one kept sample
  PreprocessingOptions options;
  // Where the two numbers come from, a sentence for a person.
  std::string reason;
};

// Joint states at the recorded instants of a recording.
struct JointStates {
  Clock clock;
  Eigen::VectorXd t;    // [s], N
  Eigen::MatrixXd q;    // N x n [rad or m]
  Eigen::MatrixXd dq;   // N x n [rad/s or m/s]
  Eigen::MatrixXd ddq;  // N x n [rad/s^2 or m/s^2]
};

// BadInput: a cut-off at or above half the recording's rate; a recording too short for the filter (says how many
// samples are needed); a gap in a jittering clock longer than half a period of the cut-off (says when).
Result<JointStates> EstimateJointStates(const Recording& recording, const Preprocessing& preprocessing);

// The decimator that belongs to the joint states.
Result<Decimator> MakeDecimator(const Recording& recording, const Preprocessing& preprocessing);

}  // namespace idim

#endif  // IDIM_CORE_MOTION_PREPROCESSING_H_
