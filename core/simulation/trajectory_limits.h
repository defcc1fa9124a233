// Checks that the makers of trajectories share.

#ifndef IDIM_CORE_SIMULATION_TRAJECTORY_LIMITS_H_
#define IDIM_CORE_SIMULATION_TRAJECTORY_LIMITS_H_

#include <string>

#include "core/simulation/trajectory.h"

namespace idim::internal {

// `values` holds n positive finite numbers; else `error` says what `name` is instead.
bool IsPositive(const std::string& name, const Eigen::VectorXd& values, int n, std::string* error);

// Velocity and acceleration (where needed) and position bounds (where needed or given).
bool LimitsAreValid(const JointLimits& limits, int n, bool need_position, bool need_velocity, std::string* error);

}  // namespace idim::internal

#endif  // IDIM_CORE_SIMULATION_TRAJECTORY_LIMITS_H_
