#include "core/simulation/trajectory_reader.h"

#include <utility>

namespace idim::internal {
namespace {

constexpr int kLargestCount = 100000;

// A list of n rows of equal, but free, length.
Eigen::MatrixXd Rows(YamlFile* file, const YAML::Node& node, const std::string& key, int n) {
  Eigen::MatrixXd rows;
  if (!file->List(node, key, "a list of " + std::to_string(n) + " lists, one a joint")) return rows;
  if (static_cast<int>(node.size()) != n) {
    file->Fail(node, key, "has " + std::to_string(node.size()) + " lists", std::to_string(n) + " lists, one a joint");
    return rows;
  }
  for (int j = 0; j < n; ++j) {
    if (!file->List(node[j], KeyPath(key, j), "a list of numbers, one a harmonic")) return rows;
    if (j == 0) rows.resize(n, static_cast<int>(node[0].size()));
    rows.row(j) = file->Numbers(node[j], KeyPath(key, j), static_cast<int>(rows.cols()), "one a harmonic").transpose();
  }
  return rows;
}

Result<std::unique_ptr<Trajectory>> ReadPointToPoint(YamlFile* file, const YAML::Node& node, const std::string& key,
                                                     int n, const JointLimits& limits, std::uint64_t seed) {
  PointToPointOptions options;
  options.limits = limits;
  options.seed = seed;
  if (node["via"].IsDefined() && file->List(node["via"], KeyPath(key, "via"), "a list of configurations")) {
    for (size_t k = 0; k < node["via"].size(); ++k) {
      options.via.push_back(
          file->Numbers(node["via"][k], KeyPath(KeyPath(key, "via"), k), n, "a configuration, one number a joint"));
    }
  }
  if (node["random"].IsDefined()) {
    options.random = file->Integer(node["random"], KeyPath(key, "random"), 0, kLargestCount);
  }
  if (node["dwell"].IsDefined()) options.dwell = file->Number(node["dwell"], KeyPath(key, "dwell"));
  if (node["speed"].IsDefined()) {
    const Eigen::VectorXd speed = file->Numbers(node["speed"], KeyPath(key, "speed"), 2, "[minimum, maximum]");
    options.speed_min = speed[0];
    options.speed_max = speed[1];
  }
  if (!file->ok()) return file->status();
  return MakePointToPoint(n, options);
}

Result<std::unique_ptr<Trajectory>> ReadFourier(YamlFile* file, const YAML::Node& node, const std::string& key, int n,
                                                const JointLimits& limits, std::uint64_t seed) {
  FourierOptions options;
  options.limits = limits;
  options.seed = seed;
  file->Require(node, key, "frequency", "the base frequency of the series in Hz");
  file->Require(node, key, "duration", "the length of the motion in s");
  if (!file->ok()) return file->status();
  options.frequency = file->Number(node["frequency"], KeyPath(key, "frequency"));
  options.duration = file->Number(node["duration"], KeyPath(key, "duration"));
  if (node["blend"].IsDefined()) options.blend = file->Number(node["blend"], KeyPath(key, "blend"));
  if (node["centre"].IsDefined()) options.centre = NumbersOrOne(file, node["centre"], KeyPath(key, "centre"), n);
  if (node["harmonics"].IsDefined()) {
    options.harmonics = file->Integer(node["harmonics"], KeyPath(key, "harmonics"), 1, 1000);
  }
  if (node["fill"].IsDefined()) options.fill = file->Number(node["fill"], KeyPath(key, "fill"));
  if (node["sine"].IsDefined()) options.sine = Rows(file, node["sine"], KeyPath(key, "sine"), n);
  if (node["cosine"].IsDefined()) options.cosine = Rows(file, node["cosine"], KeyPath(key, "cosine"), n);
  if (options.sine.size() > 0 && (node["harmonics"].IsDefined() || node["fill"].IsDefined())) {
    file->Fail(node, key, "harmonics or fill given together with sine and cosine",
               "either coefficients or how to draw");
  }
  if (!file->ok()) return file->status();
  return MakeFourier(n, options);
}

}  // namespace

Eigen::VectorXd NumbersOrOne(YamlFile* file, const YAML::Node& node, const std::string& key, int n) {
  if (file->ok() && node.IsScalar()) return Eigen::VectorXd::Constant(n, file->Number(node, key));
  return file->Numbers(node, key, n, "one a joint");
}

JointLimits ReadLimits(YamlFile* file, const YAML::Node& node, const std::string& key, int n) {
  JointLimits limits;
  if (!node.IsDefined() || !file->Map(node, key, {"lower", "upper", "velocity", "acceleration", "jerk"})) return limits;
  const std::pair<const char*, Eigen::VectorXd*> fields[] = {{"lower", &limits.lower},
                                                             {"upper", &limits.upper},
                                                             {"velocity", &limits.velocity},
                                                             {"acceleration", &limits.acceleration},
                                                             {"jerk", &limits.jerk}};
  for (const auto& [name, values] : fields) {
    if (node[name].IsDefined()) *values = NumbersOrOne(file, node[name], KeyPath(key, name), n);
  }
  return limits;
}

std::unique_ptr<Trajectory> ReadTrajectory(YamlFile* file, const YAML::Node& node, const std::string& key, int n,
                                           const JointLimits& limits, std::uint64_t seed) {
  // The type first: it decides which other keys are known.
  if (!file->ok() || !file->Map(node, key,
                                {"type", "via", "random", "dwell", "speed", "frequency", "duration", "blend", "centre",
                                 "harmonics", "fill", "sine", "cosine"})) {
    return nullptr;
  }
  if (!file->Require(node, key, "type", "point_to_point or fourier")) return nullptr;
  const bool fourier = file->Choice(node["type"], KeyPath(key, "type"), {"point_to_point", "fourier"}) == 1;
  if (!file->ok()) return nullptr;
  file->Map(node, key,
            fourier ? std::vector<std::string>{"type", "frequency", "duration", "blend", "centre", "harmonics", "fill",
                                               "sine", "cosine"}
                    : std::vector<std::string>{"type", "via", "random", "dwell", "speed"});
  Result<std::unique_ptr<Trajectory>> trajectory =
      fourier ? ReadFourier(file, node, key, n, limits, seed) : ReadPointToPoint(file, node, key, n, limits, seed);
  if (!trajectory.ok()) {
    file->Fail(node, key, trajectory.status().message(), "");  // keeps the first, if there was one before
    return nullptr;
  }
  return std::move(trajectory).value();
}

}  // namespace idim::internal
