#include "core/simulation/trajectory_limits.h"

#include <cmath>
#include <sstream>

namespace idim::internal {

bool IsPositive(const std::string& name, const Eigen::VectorXd& values, int n, std::string* error) {
  std::ostringstream message;
  if (values.size() != n) {
    message << name << " has " << values.size() << " numbers, must have " << n << ", one a joint";
  } else {
    for (int j = 0; j < n; ++j) {
      if (values[j] > 0.0 && std::isfinite(values[j])) continue;
      message << name << "[" << j << "] = " << values[j] << ", must be positive";
      break;
    }
  }
  *error = message.str();
  return error->empty();
}

bool LimitsAreValid(const JointLimits& limits, int n, bool need_position, bool need_velocity, std::string* error) {
  if (need_velocity || limits.velocity.size() > 0) {
    if (!IsPositive("limits.velocity", limits.velocity, n, error)) return false;
  }
  if (need_velocity || limits.acceleration.size() > 0) {
    if (!IsPositive("limits.acceleration", limits.acceleration, n, error)) return false;
  }
  if (!need_position && limits.lower.size() == 0 && limits.upper.size() == 0) return true;
  std::ostringstream message;
  if (limits.lower.size() != n || limits.upper.size() != n) {
    message << "limits.lower and limits.upper have " << limits.lower.size() << " and " << limits.upper.size()
            << " numbers, must have " << n << ", one a joint";
  } else {
    for (int j = 0; j < n; ++j) {
      if (limits.lower[j] < limits.upper[j] && std::isfinite(limits.upper[j] - limits.lower[j])) continue;
      message << "limits.lower[" << j << "] = " << limits.lower[j] << ", must be below limits.upper[" << j
              << "] = " << limits.upper[j];
      break;
    }
  }
  *error = message.str();
  return error->empty();
}

}  // namespace idim::internal
