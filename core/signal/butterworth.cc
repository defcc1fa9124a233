#include "core/signal/butterworth.h"

#include <glog/logging.h>

#include <cmath>

namespace idim {

ButterworthFilter::ButterworthFilter(int order, double cutoff_hz, double step)
    : order_(order), cutoff_hz_(cutoff_hz), step_(step) {
  CHECK_GE(order, 1);
  CHECK_GT(step, 0.0);
  CHECK_GT(cutoff_hz, 0.0);
  CHECK_LT(cutoff_hz * step, 0.5);
  padding_ = static_cast<int>(std::ceil(2.0 / (cutoff_hz * step)));

  const double k = std::tan(M_PI * cutoff_hz * step);
  // The numerators are taken from the denominators as rounded, (1 + a1 + a2) / 4, not from k: a constant then passes to
  // the last bits even where the poles crowd at z = 1.
  for (int i = 0; i < order / 2; ++i) {
    const double damping = 2.0 * std::sin(M_PI * (2 * i + 1) / (2.0 * order));  // 1 / Q
    const double a0 = 1.0 + k * damping + k * k;
    Section s{};
    s.a1 = 2.0 * (k * k - 1.0) / a0;
    s.a2 = (1.0 - k * damping + k * k) / a0;
    s.b0 = (1.0 + s.a1 + s.a2) / 4.0;
    s.b1 = 2.0 * s.b0;
    s.b2 = s.b0;
    sections_.push_back(s);
  }
  if (order % 2 == 1) {
    Section s{};
    s.a1 = (k - 1.0) / (k + 1.0);
    s.b0 = (1.0 + s.a1) / 2.0;
    s.b1 = s.b0;
    sections_.push_back(s);
  }
  for (Section& s : sections_) {
    // Steady state for input and output 1.
    s.z2 = s.b2 - s.a2;
    s.z1 = s.b1 - s.a1 + s.z2;
  }
}

double ButterworthFilter::ZeroPhaseGain(double frequency_hz) const {
  const double x = std::tan(M_PI * frequency_hz * step_) / std::tan(M_PI * cutoff_hz_ * step_);
  return 1.0 / (1.0 + std::pow(x * x, order_));
}

void ButterworthFilter::RunInPlace(double* x, Eigen::Index n, Eigen::Index stride) const {
  for (const Section& s : sections_) {
    double* p = x;
    double z1 = s.z1 * *p;
    double z2 = s.z2 * *p;
    for (Eigen::Index i = 0; i < n; ++i, p += stride) {
      const double in = *p;
      const double out = s.b0 * in + z1;
      z1 = s.b1 * in - s.a1 * out + z2;
      z2 = s.b2 * in - s.a2 * out;
      *p = out;
    }
  }
}

Eigen::VectorXd ButterworthFilter::ZeroPhase(const Eigen::Ref<const Eigen::VectorXd>& x, int margin) const {
  const Eigen::Index n = x.size();
  CHECK_GT(n, padding_);
  CHECK(margin >= 0 && margin <= padding_);
  // Filtering the deviation from the first sample keeps the rounding of large offsets out of the differences.
  const double origin = x[0];
  Eigen::VectorXd y(n + 2 * padding_);
  y.segment(padding_, n) = x.array() - origin;
  const double last = x[n - 1] - origin;
  for (int i = 1; i <= padding_; ++i) {
    y[padding_ - i] = -(x[i] - origin);
    y[padding_ + n - 1 + i] = 2.0 * last - (x[n - 1 - i] - origin);
  }
  RunInPlace(y.data(), y.size(), 1);
  RunInPlace(y.data() + y.size() - 1, y.size(), -1);
  return y.segment(padding_ - margin, n + 2 * margin).array() + origin;
}

}  // namespace idim
