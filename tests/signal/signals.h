// Clocks and motions shared by the tests of signals.

#ifndef IDIM_TESTS_SIGNAL_SIGNALS_H_
#define IDIM_TESTS_SIGNAL_SIGNALS_H_

#include <Eigen/Core>
#include <cmath>
#include <random>

#include "core/recording/recording.h"

namespace idim {

inline Eigen::VectorXd UniformClock(int n, double step, double start = 0.0) {
  return start + step * Eigen::ArrayXd::LinSpaced(n, 0, n - 1);
}

// Steps drawn from step * [1 - jitter, 1 + jitter].
inline Eigen::VectorXd JitteringClock(int n, double step, double jitter, unsigned seed, double start = 100.0) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-jitter, jitter);
  Eigen::VectorXd t(n);
  t[0] = start;
  for (int i = 1; i < n; ++i) t[i] = t[i - 1] + step * (1.0 + uniform(random));
  return t;
}

inline Eigen::MatrixXd Gaussian(Eigen::Index rows, Eigen::Index columns, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd x(rows, columns);
  for (Eigen::Index c = 0; c < columns; ++c) {
    for (Eigen::Index r = 0; r < rows; ++r) x(r, c) = normal(random);
  }
  return x;
}

// cos(2 pi f t + phase) and its derivatives by t.
inline Eigen::VectorXd Wave(const Eigen::VectorXd& t, double f, double phase, int derivative) {
  const double w = 2.0 * M_PI * f;
  return std::pow(w, derivative) * (w * t.array() + phase + 0.5 * M_PI * derivative).cos();
}

inline Recording MakeRecording(const Eigen::VectorXd& t, const Eigen::MatrixXd& q) {
  Recording recording;
  recording.name = "test";
  recording.t = t;
  recording.q = q;
  recording.signal = Eigen::MatrixXd::Zero(q.rows(), q.cols());
  return recording;
}

}  // namespace idim

#endif  // IDIM_TESTS_SIGNAL_SIGNALS_H_
