// Strict reading of the YAML that people write: every message names file, line and key.
//
// The first problem sticks: after it every accessor returns a neutral value at once, so that a reader is written as
// a plain sequence and asks for the status at the end. Nothing throws.

#ifndef IDIM_CORE_BASE_YAML_H_
#define IDIM_CORE_BASE_YAML_H_

#include <yaml-cpp/yaml.h>

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/base/status.h"

namespace idim {

// The path of a key for messages: "joints[3].alpha"; list items count from 1, like joints.
std::string KeyPath(const std::string& parent, const std::string& key);
std::string KeyPath(const std::string& parent, size_t index);

class YamlFile {
 public:
  explicit YamlFile(const std::string& path);

  bool ok() const { return status_.ok(); }
  const Status& status() const { return status_; }
  const std::string& path() const { return path_; }
  const YAML::Node& root() const { return root_; }

  // "path:line: key 'key': problem; expected ..." (without the key when it is empty). Keeps the first.
  void Fail(const YAML::Node& node, const std::string& key, const std::string& problem, const std::string& expected);

  // A mapping whose keys are all known and none twice; unknown keys are refused naming the nearest known one.
  bool Map(const YAML::Node& node, const std::string& key, const std::vector<std::string>& known_keys);
  // `map` has the key `name`; otherwise fails with what was expected there.
  bool Require(const YAML::Node& map, const std::string& parent, const std::string& name, const std::string& expected);
  bool List(const YAML::Node& node, const std::string& key, const std::string& expected);

  double Number(const YAML::Node& node, const std::string& key);
  double PositiveNumber(const YAML::Node& node, const std::string& key);
  int Integer(const YAML::Node& node, const std::string& key, int smallest, int largest);
  std::string Text(const YAML::Node& node, const std::string& key, const std::string& expected);
  // One-based joints of a robot with `dof`, as zero-based ones; `expected` names the list.
  std::vector<int> Joints(const YAML::Node& node, const std::string& key, int dof, const std::string& expected);
  // One of the given words; returns its index, 0 after a failure.
  int Choice(const YAML::Node& node, const std::string& key, const std::vector<std::string>& words);
  // A list of exactly `size` numbers; zeros after a failure. `what` explains the size ("one a joint").
  Eigen::VectorXd Numbers(const YAML::Node& node, const std::string& key, int size, const std::string& what);

 private:
  std::string path_;
  YAML::Node root_;
  Status status_;
};

}  // namespace idim

#endif  // IDIM_CORE_BASE_YAML_H_
