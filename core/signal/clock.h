// The clock of a recording: is it uniform, how fast does it run, where does it stumble.
//
// Nothing is resampled: a clock that is not uniform is filtered on the recorded time (core/signal/smoothing_spline.h).

#ifndef IDIM_CORE_SIGNAL_CLOCK_H_
#define IDIM_CORE_SIGNAL_CLOCK_H_

#include <Eigen/Core>

namespace idim {

struct Clock {
  // Every recorded instant lies within `tolerance` steps of an equidistant grid from the first to the last one.
  bool uniform = false;
  double start = 0;     // [s] first instant
  double end = 0;       // [s] last instant
  double step = 0;      // [s] nominal: (end - start) / (N - 1) where uniform, else the median step
  double max_step = 0;  // [s] the longest step ...
  int longest = 0;      // ... lies between the samples `longest` and `longest + 1`

  double rate() const { return 1.0 / step; }  // [Hz] nominal
};

// The default tolerance is 1 % of a step: at 5 kHz a time stamp printed with six decimals (rounded by 0.25 % of a
// step) is uniform, and a joint at 1 rad/s moves by 2e-6 rad in the time error that is ignored; at 100 Hz by 1e-4 rad.
inline constexpr double kUniformClockTolerance = 0.01;

// t: N >= 2 strictly increasing instants [s] (CHECK).
Clock AnalyzeClock(const Eigen::VectorXd& t, double tolerance = kUniformClockTolerance);

// The stretch of time [s] that each sample stands for: half the distance between its neighbours; the first and the
// last sample stand for one whole adjacent step. On a uniform clock all are equal.
Eigen::VectorXd SampleSpacing(const Eigen::VectorXd& t);

}  // namespace idim

#endif  // IDIM_CORE_SIGNAL_CLOCK_H_
