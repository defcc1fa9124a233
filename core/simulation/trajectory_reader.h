// The mapping `trajectory` of a scenario -> Trajectory.

#ifndef IDIM_CORE_SIMULATION_TRAJECTORY_READER_H_
#define IDIM_CORE_SIMULATION_TRAJECTORY_READER_H_

#include <cstdint>
#include <memory>
#include <string>

#include "core/base/yaml.h"
#include "core/simulation/trajectory.h"

namespace idim::internal {

// The mapping `limits` (an undefined node: no limits). Every one of its lists may be one number for all joints.
JointLimits ReadLimits(YamlFile* file, const YAML::Node& node, const std::string& key, int n);

// A list of n numbers, or one number that stands for all.
Eigen::VectorXd NumbersOrOne(YamlFile* file, const YAML::Node& node, const std::string& key, int n);

// nullptr after a failure, which `file` keeps. seed: of what the trajectory draws.
std::unique_ptr<Trajectory> ReadTrajectory(YamlFile* file, const YAML::Node& node, const std::string& key, int n,
                                           const JointLimits& limits, std::uint64_t seed);

}  // namespace idim::internal

#endif  // IDIM_CORE_SIMULATION_TRAJECTORY_READER_H_
