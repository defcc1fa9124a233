#include "core/motion/preprocessing.h"

#include <glog/logging.h>

#include <cmath>
#include <sstream>

#include "core/signal/butterworth.h"
#include "core/signal/smoothing_spline.h"

namespace idim {
namespace {

// Everything that can be wrong with a recording for this filter.
Status CheckFilterable(const Recording& recording, const Preprocessing& preprocessing, const Clock& clock) {
  std::string error;
  if (!preprocessing.options.IsValid(&error)) return Status::BadInput(error);
  const double cutoff = preprocessing.cutoff_hz;
  std::ostringstream message;
  message << "recording '" << recording.name << "': ";
  if (!(cutoff > 0)) {
    message << "cutoff_hz is " << cutoff << ", must be positive";
    return Status::BadInput(message.str());
  }
  if (!(cutoff < 0.5 * clock.rate())) {
    message << "cutoff_hz is " << cutoff << ", must be below half the sampling rate of " << clock.rate() << " Hz";
    return Status::BadInput(message.str());
  }
  // What the edges take, a period between them, and never less than the filter's own continuation at both ends.
  const double needed = std::max(2.0 * preprocessing.options.edge_periods + 1.0, 3.0) / (cutoff * clock.step);
  if (recording.samples() <= needed) {
    message << "has " << recording.samples() << " samples at " << clock.rate() << " Hz; a low-pass at " << cutoff
            << " Hz needs at least " << static_cast<int64_t>(std::floor(needed)) + 1;
    return Status::BadInput(message.str());
  }
  if (!clock.uniform && clock.max_step > 0.5 / cutoff) {
    message << "a gap of " << clock.max_step << " s without samples after t = " << recording.t[clock.longest]
            << " s; a low-pass at " << cutoff << " Hz needs a sample at least every " << 0.5 / cutoff << " s";
    return Status::BadInput(message.str());
  }
  return Status::Ok();
}

}  // namespace

bool PreprocessingOptions::IsValid(std::string* error) const {
  const auto fail = [error](const std::string& message) {
    if (error != nullptr) *error = message;
    return false;
  };
  if (filter_order < SmoothingSpline::kMinOrder || filter_order > SmoothingSpline::kMaxOrder) {
    return fail("filter_order is " + std::to_string(filter_order) + ", must be 3 to 6");
  }
  if (!(edge_outputs >= 0)) return fail("edge_outputs is " + std::to_string(edge_outputs) + ", must not be negative");
  if (!(edge_periods >= 0)) return fail("edge_periods is " + std::to_string(edge_periods) + ", must not be negative");
  if (!(clock_tolerance > 0 && clock_tolerance < 0.5)) {
    return fail("clock_tolerance is " + std::to_string(clock_tolerance) + ", must be between 0 and 0.5");
  }
  return true;
}

Result<JointStates> EstimateJointStates(const Recording& recording, const Preprocessing& preprocessing) {
  CHECK_EQ(recording.t.size(), recording.q.rows());
  CHECK_GE(recording.samples(), 2);
  JointStates states;
  states.clock = AnalyzeClock(recording.t, preprocessing.options.clock_tolerance);
  IDIM_RETURN_IF_ERROR(CheckFilterable(recording, preprocessing, states.clock));

  states.t = recording.t;
  const Eigen::Index n = recording.q.rows();
  const Eigen::Index dof = recording.q.cols();
  const int order = preprocessing.options.filter_order;
  if (states.clock.uniform) {
    const double h = states.clock.step;
    const ButterworthFilter filter(order, preprocessing.cutoff_hz, h);
    states.q.resize(n, dof);
    states.dq.resize(n, dof);
    states.ddq.resize(n, dof);
    for (Eigen::Index j = 0; j < dof; ++j) {
      // One sample of margin, so that the ends have neighbours too.
      const Eigen::VectorXd x = filter.ZeroPhase(recording.q.col(j), 1);
      states.q.col(j) = x.segment(1, n);
      states.dq.col(j) = (x.tail(n) - x.head(n)) / (2.0 * h);
      states.ddq.col(j) = (x.tail(n) - 2.0 * x.segment(1, n) + x.head(n)) / (h * h);
    }
  } else {
    const Result<SmoothingSpline> spline = SmoothingSpline::Create(recording.t, order, preprocessing.cutoff_hz);
    if (!spline.ok()) return Status::BadInput("recording '" + recording.name + "': " + spline.status().message());
    const Eigen::MatrixXd coefficients = spline->Fit(recording.q);
    states.q = spline->Evaluate(coefficients, recording.t, 0);
    states.dq = spline->Evaluate(coefficients, recording.t, 1);
    states.ddq = spline->Evaluate(coefficients, recording.t, 2);
  }
  return states;
}

Result<Decimator> MakeDecimator(const Recording& recording, const Preprocessing& preprocessing) {
  DecimatorOptions options;
  options.decimation = preprocessing.decimation;
  options.edge_outputs = preprocessing.options.edge_outputs;
  options.edge_seconds = preprocessing.options.edge_periods / preprocessing.cutoff_hz;
  const Clock clock = AnalyzeClock(recording.t, preprocessing.options.clock_tolerance);
  Result<Decimator> decimator = Decimator::Create(recording.t, clock, options);
  if (!decimator.ok()) {
    return Status::BadInput("recording '" + recording.name + "': " + decimator.status().message());
  }
  return decimator;
}

}  // namespace idim
