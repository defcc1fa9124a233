#include "core/signal/clock.h"

#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace idim {

Clock AnalyzeClock(const Eigen::VectorXd& t, double tolerance) {
  const Eigen::Index n = t.size();
  CHECK_GE(n, 2);
  std::vector<double> steps(n - 1);
  for (Eigen::Index i = 0; i + 1 < n; ++i) {
    steps[i] = t[i + 1] - t[i];
    CHECK_GT(steps[i], 0.0) << "time must increase at sample " << i + 1;
  }
  Clock clock;
  clock.start = t[0];
  clock.end = t[n - 1];
  const auto longest = std::max_element(steps.begin(), steps.end());
  clock.longest = static_cast<int>(longest - steps.begin());
  clock.max_step = *longest;

  const double mean = (clock.end - clock.start) / static_cast<double>(n - 1);
  double deviation = 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    deviation = std::max(deviation, std::abs(t[i] - clock.start - static_cast<double>(i) * mean));
  }
  clock.uniform = deviation <= tolerance * mean;
  if (clock.uniform) {
    clock.step = mean;
  } else {
    const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
    std::nth_element(steps.begin(), middle, steps.end());
    clock.step = *middle;
  }
  return clock;
}

Eigen::VectorXd SampleSpacing(const Eigen::VectorXd& t) {
  const Eigen::Index n = t.size();
  CHECK_GE(n, 2);
  Eigen::VectorXd spacing(n);
  spacing[0] = t[1] - t[0];
  spacing[n - 1] = t[n - 1] - t[n - 2];
  for (Eigen::Index i = 1; i + 1 < n; ++i) spacing[i] = 0.5 * (t[i + 1] - t[i - 1]);
  return spacing;
}

}  // namespace idim
