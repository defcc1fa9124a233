#include "core/signal/decimator.h"

#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace idim {
namespace {

// The window of equation (1) at s = offset * D h.
double Kernel(double offset) {
  if (std::abs(offset) > Decimator::kHalfWidth) return 0.0;
  const double x = M_PI * offset;
  const double sinc = std::abs(x) < 1e-8 ? 1.0 : std::sin(x) / x;
  return sinc * (0.54 + 0.46 * std::cos(x / Decimator::kHalfWidth));
}

}  // namespace

bool DecimatorOptions::IsValid(std::string* error) const {
  const auto fail = [error](const std::string& message) {
    if (error != nullptr) *error = message;
    return false;
  };
  if (decimation < 1) return fail("decimation is " + std::to_string(decimation) + ", must be at least 1");
  if (!(edge_outputs >= 0)) return fail("edge_outputs is " + std::to_string(edge_outputs) + ", must not be negative");
  if (!(edge_seconds >= 0)) return fail("edge_seconds is " + std::to_string(edge_seconds) + ", must not be negative");
  return true;
}

Result<Decimator> Decimator::Create(const Eigen::VectorXd& t, const Clock& clock, const DecimatorOptions& options) {
  std::string error;
  if (!options.IsValid(&error)) return Status::BadInput(error);
  const int n = static_cast<int>(t.size());
  CHECK_GE(n, 2);
  const int d = options.decimation;
  const double period = d * clock.step;
  if (!clock.uniform && d > 1 && clock.max_step > period) {
    std::ostringstream message;
    message << "a gap of " << clock.max_step << " s without samples after t = " << t[clock.longest]
            << " s is longer than a decimated step of " << period << " s";
    return Status::BadInput(message.str());
  }

  // The instants T_k kept. The slack of 1e-6 steps lets an output exactly at the edge stay.
  const double edge = std::max(d > 1 ? options.edge_outputs * period : 0.0, options.edge_seconds) - 1e-6 * clock.step;
  const bool on_samples = clock.uniform || d == 1;
  std::vector<double> times;
  Decimator out;
  for (int k = 0;; ++k) {
    if (on_samples && static_cast<int64_t>(k) * d >= n) break;
    const double time = on_samples ? t[k * d] : t[0] + k * period;
    if (time > clock.end - edge) break;
    if (time - clock.start < edge) continue;
    if (times.empty()) out.grid_offset_ = k;
    times.push_back(time);
  }
  if (times.empty()) {
    std::ostringstream message;
    message << "nothing is left of " << n << " samples (" << clock.end - clock.start << " s) after decimation by " << d
            << " and dropping " << edge << " s at each end";
    return Status::BadInput(message.str());
  }
  const int outputs = static_cast<int>(times.size());
  out.options_ = options;
  out.samples_ = n;
  out.times_ = Eigen::Map<const Eigen::VectorXd>(times.data(), outputs);
  out.half_ = d == 1 ? 0 : kHalfWidth * d;
  out.first_sample_.resize(outputs);
  out.last_sample_.resize(outputs);

  // Windows. Outside [head, tail) the weights are stored, because a window there is cut or irregular.
  std::vector<double> norm(outputs, 1.0);
  const Eigen::VectorXd spacing = SampleSpacing(t);
  std::vector<double> taps(out.half_ + 1);
  for (int j = 0; j <= out.half_; ++j) taps[j] = Kernel(static_cast<double>(j) / d);
  const auto weight = [&](int output, int sample) {
    if (on_samples) return taps[std::abs(sample - (out.grid_offset_ + output) * d)];
    return spacing[sample] * Kernel((times[output] - t[sample]) / period);
  };
  double full = 0;
  for (int j = -out.half_; j <= out.half_; ++j) full += taps[std::abs(j)];
  if (on_samples) {
    for (int j = -out.half_; j <= out.half_; ++j) out.taps_.push_back(taps[std::abs(j)] / full);
  }
  out.head_ = on_samples ? 0 : n;
  out.tail_ = n;
  for (int k = 0; k < outputs; ++k) {
    int& first = out.first_sample_[k];
    int& last = out.last_sample_[k];
    bool whole = false;
    if (on_samples) {
      const int centre = (out.grid_offset_ + k) * d;
      first = std::max(0, centre - out.half_);
      last = std::min(n - 1, centre + out.half_);
      whole = last - first == 2 * out.half_;
      if (!whole && first == 0) out.head_ = std::max(out.head_, last + 1);
      if (!whole && last == n - 1) out.tail_ = std::min(out.tail_, first);
    } else {
      const double reach = kHalfWidth * period;
      first = static_cast<int>(std::lower_bound(t.data(), t.data() + n, times[k] - reach) - t.data());
      last = static_cast<int>(std::upper_bound(t.data(), t.data() + n, times[k] + reach) - t.data()) - 1;
    }
    if (whole) {
      norm[k] = full;
    } else {
      norm[k] = 0;
      for (int i = first; i <= last; ++i) norm[k] += weight(k, i);
    }
  }
  out.tail_ = std::max(out.head_, out.tail_);

  const int row = 2 * out.half_ / d + 1;
  out.phases_.assign(static_cast<size_t>(d) * row, 0.0);
  for (int phase = 0; phase < d; ++phase) {
    // In the order of the outputs k that see the sample, counted from the instant at or before it.
    int slot = 0;
    const int begin = phase == 0 ? -out.half_ / d : -out.half_ / d + 1;
    for (int k = begin; k * d - phase <= out.half_; ++k) {
      out.phases_[static_cast<size_t>(phase) * row + slot++] = taps[std::abs(k * d - phase)] / full;
    }
  }

  int low = 0, high = 0;  // outputs [low, high) see the sample
  for (int i = 0; i < n; ++i) {
    while (high < outputs && out.first_sample_[high] <= i) ++high;
    while (low < outputs && out.last_sample_[low] < i) ++low;
    out.max_open_ = std::max(out.max_open_, high - low);
    if (i >= out.head_ && i < out.tail_) continue;
    out.stored_.push_back({low, std::max(0, high - low), out.weights_.size()});
    for (int k = low; k < high; ++k) out.weights_.push_back(weight(k, i) / norm[k]);
  }
  return out;
}

const std::vector<double>& Decimator::Taps() const {
  CHECK(!taps_.empty());
  return taps_;
}

Decimator::Contribution Decimator::At(int sample) const {
  CHECK(sample >= 0 && sample < samples_);
  if (sample < head_ || sample >= tail_) {
    const Stored& s = stored_[sample < head_ ? sample : head_ + sample - tail_];
    return {s.first, s.count, weights_.data() + s.offset};
  }
  const int d = options_.decimation;
  const int phase = sample % d;
  const int row = 2 * half_ / d + 1;
  int first = sample / d - half_ / d + (phase == 0 ? 0 : 1) - grid_offset_;
  int count = phase == 0 ? row : row - 1;
  const double* weights = phases_.data() + static_cast<size_t>(phase) * row;
  // Outputs that the edges dropped.
  const int skipped = std::min(std::max(0, -first), count);
  first = std::max(0, first);
  count = std::max(0, std::min(count - skipped, outputs() - first));
  return {first, count, weights + skipped};
}

Eigen::MatrixXd Decimator::Apply(const Eigen::MatrixXd& x) const {
  CHECK_EQ(x.rows(), samples_);
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(outputs(), x.cols());
  for (int i = 0; i < samples_; ++i) {
    const Contribution part = At(i);
    for (Eigen::Index c = 0; c < x.cols(); ++c) {
      double* accumulator = out.data() + c * out.rows() + part.first;
      const double value = x(i, c);
      for (int j = 0; j < part.count; ++j) accumulator[j] += part.weights[j] * value;
    }
  }
  return out;
}

}  // namespace idim
