#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "core/base/file.h"
#include "core/base/text.h"
#include "core/base/yaml.h"
#include "core/robot/robot_reader.h"
#include "core/simulation/effects_reader.h"
#include "core/simulation/scenario.h"
#include "core/simulation/trajectory_reader.h"

namespace idim {
namespace {

using internal::NumbersOrOne;

// A guard against a rate in the wrong unit.
constexpr double kLargestSampleCount = 2e7;

// Names of files, and of keys in the study that is written.
constexpr char kPlainName[] = "letters, digits, _ and -";
bool IsPlainName(const std::string& name) {
  return !name.empty() && name.size() <= 100 && std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  });
}

void ReadParameterList(YamlFile* file, const YAML::Node& node, Scenario* scenario) {
  const StandardModel model(scenario->robot, FrictionModel());
  scenario->chi = Eigen::VectorXd::Zero(model.columns());
  const int n = scenario->robot.dof();
  const std::string expected = "a list of " + std::to_string(n) + " mappings, one a link";
  if (!file->List(node, "parameters", expected)) return;
  if (static_cast<int>(node.size()) != n) {
    file->Fail(node, "parameters", "has " + std::to_string(node.size()) + " entries", expected);
    return;
  }
  for (int link = 0; link < n && file->ok(); ++link) {
    const std::string key = KeyPath("parameters", link);
    std::map<std::string, int> columns;
    std::vector<std::string> known;
    for (int c = 0; c < model.columns(); ++c) {
      const Parameter& parameter = model.parameters()[c];
      if (parameter.joint != link + 1) continue;
      const std::string number = std::to_string(link + 1);
      known.push_back(parameter.name.substr(0, parameter.name.size() - number.size()));
      columns[known.back()] = c;
    }
    if (!file->Map(node[link], key, known)) return;
    for (const auto& entry : node[link]) {
      const std::string name = entry.first.Scalar();
      scenario->chi[columns[name]] = file->Number(entry.second, KeyPath(key, name));
    }
  }
}

// The list itself, or the path of a file that holds it.
Status ReadParameters(YamlFile* file, const YAML::Node& node, Scenario* scenario) {
  if (!file->ok() || !node.IsScalar()) {
    ReadParameterList(file, node, scenario);
    return file->status();
  }
  const std::string path = ResolvePath(FolderOf(file->path()), node.Scalar());
  if (!IsRegularFile(path)) {
    file->Fail(node, "parameters", "there is no file " + path, "a list of mappings, one a link, or a file with it");
    return file->status();
  }
  YamlFile other(path);
  if (other.Map(other.root(), "", {"parameters"}) &&
      other.Require(other.root(), "", "parameters", "a list of mappings, one a link")) {
    ReadParameterList(&other, other.root()["parameters"], scenario);
  }
  return other.status();
}

void ReadPayloads(YamlFile* file, const YAML::Node& node, Scenario* scenario) {
  if (!file->ok() || !node.IsDefined()) return;
  if (!node.IsMap()) {
    file->Fail(node, "payloads", "not a mapping", "a mapping of payload names to their parameters");
    return;
  }
  const std::vector<std::string> inertial(kStandardNames.begin(), kStandardNames.begin() + kNumInertial);
  std::vector<std::string> keys = inertial;
  keys.push_back("known");
  for (const auto& entry : node) {
    ScenarioPayload payload;
    payload.name = file->Text(entry.first, "payloads", "the name of a payload");
    if (file->ok() && !IsPlainName(payload.name)) {
      file->Fail(entry.first, "payloads", "'" + Clip(payload.name) + "' is not a plain name", kPlainName);
    }
    const std::string key = KeyPath("payloads", payload.name);
    if (!file->Map(entry.second, key, keys)) return;
    for (int k = 0; k < kNumInertial; ++k) {
      const YAML::Node value = entry.second[inertial[k]];
      if (value.IsDefined()) payload.inertial[k] = file->Number(value, KeyPath(key, inertial[k]));
    }
    const YAML::Node known = entry.second["known"];
    if (known.IsDefined() &&
        file->List(known, KeyPath(key, "known"), "a list of names among " + Join(inertial, ", "))) {
      for (size_t i = 0; i < known.size(); ++i) {
        payload.known.push_back(file->Choice(known[i], KeyPath(KeyPath(key, "known"), i), inertial));
      }
      std::sort(payload.known.begin(), payload.known.end());
      if (std::adjacent_find(payload.known.begin(), payload.known.end()) != payload.known.end()) {
        file->Fail(known, KeyPath(key, "known"), "a name is given twice", "each once");
      }
    }
    for (const ScenarioPayload& other : scenario->payloads) {
      if (other.name == payload.name) file->Fail(entry.first, key, "given twice", "it once");
    }
    scenario->payloads.push_back(payload);
  }
}

void ReadGains(YamlFile* file, const YAML::Node& node, Scenario* scenario) {
  const int n = scenario->robot.dof();
  scenario->gains = Eigen::VectorXd::Ones(n);
  if (!file->ok() || !node.IsDefined() || !file->Map(node, "gains", {"values", "mode", "a_priori"})) return;
  if (node["values"].IsDefined()) {
    scenario->gains = file->Numbers(node["values"], "gains.values", n, "one a joint");
    for (int j = 0; j < n && file->ok(); ++j) {
      if (scenario->gains[j] == 0.0) {
        file->Fail(node["values"], KeyPath("gains.values", j), "a gain of 0 has no signal", "a number other than 0");
      }
    }
  }
  if (node["mode"].IsDefined()) {
    scenario->gains_mode =
        file->Choice(node["mode"], "gains.mode", {"known", "identify"}) == 0 ? GainsMode::kKnown : GainsMode::kIdentify;
  }
  if (node["a_priori"].IsDefined()) {
    scenario->a_priori_gains = file->Numbers(node["a_priori"], "gains.a_priori", n, "one a joint");
    if (file->ok() && scenario->gains_mode == GainsMode::kKnown) {
      file->Fail(node["a_priori"], "gains.a_priori", "given with mode known", "mode: identify");
    }
  }
}

void ReadNoise(YamlFile* file, const YAML::Node& node, Scenario* scenario) {
  NoiseOptions* noise = &scenario->noise;
  const std::array<std::pair<const char*, Eigen::VectorXd*>, 6> fields = {{{"position", &noise->position},
                                                                           {"position_step", &noise->position_step},
                                                                           {"encoder_counts", &noise->encoder_counts},
                                                                           {"signal", &noise->signal},
                                                                           {"signal_percent", &noise->signal_percent},
                                                                           {"signal_step", &noise->signal_step}}};
  std::vector<std::string> keys;
  for (const auto& field : fields) keys.push_back(field.first);
  if (!file->ok() || !node.IsDefined() || !file->Map(node, "noise", keys)) return;
  const int n = scenario->robot.dof();
  for (const auto& [name, values] : fields) {
    if (node[name].IsDefined()) *values = NumbersOrOne(file, node[name], KeyPath("noise", name), n);
  }
  std::string error;
  if (file->ok() && !noise->IsValid(n, &error)) file->Fail(node, "noise", error, "");
}

void ReadOneRecording(YamlFile* file, const YAML::Node& node, const std::string& key, const JointLimits& limits,
                      Scenario* scenario) {
  if (!file->Map(node, key, {"name", "use", "payload", "seed", "motion_seed", "duration", "trajectory"})) return;
  ScenarioRecording recording;
  if (!file->Require(node, key, "name", "the name of the recording, and of its file without .csv")) return;
  const std::string name_key = KeyPath(key, "name");
  recording.name = file->Text(node["name"], name_key, "the name of the recording");
  if (file->ok() && !IsPlainName(recording.name)) {
    file->Fail(node["name"], name_key, "'" + Clip(recording.name) + "' cannot name a file", kPlainName);
  }
  for (const ScenarioRecording& other : scenario->recordings) {
    if (other.name == recording.name) file->Fail(node["name"], name_key, "given twice", "another name");
  }
  if (node["use"].IsDefined()) {
    const int use = file->Choice(node["use"], KeyPath(key, "use"), {"identification", "validation"});
    recording.use = use == 0 ? Use::kIdentification : Use::kValidation;
  }
  if (node["payload"].IsDefined()) {
    std::vector<std::string> names;
    for (const ScenarioPayload& payload : scenario->payloads) names.push_back(payload.name);
    if (names.empty()) {
      file->Fail(node["payload"], KeyPath(key, "payload"), "the scenario has no payloads", "a name under 'payloads'");
    }
    recording.payload = file->Choice(node["payload"], KeyPath(key, "payload"), names);
  }
  if (!file->Require(node, key, "seed", "an integer, of all that is drawn for this recording")) return;
  recording.seed =
      static_cast<std::uint64_t>(file->Integer(node["seed"], KeyPath(key, "seed"), 0, std::numeric_limits<int>::max()));
  std::uint64_t motion_seed = recording.seed;
  if (node["motion_seed"].IsDefined()) {
    motion_seed = static_cast<std::uint64_t>(
        file->Integer(node["motion_seed"], KeyPath(key, "motion_seed"), 0, std::numeric_limits<int>::max()));
  }
  if (node["duration"].IsDefined()) {
    recording.duration = file->PositiveNumber(node["duration"], KeyPath(key, "duration"));
  }
  if (!file->Require(node, key, "trajectory", "a mapping with type: point_to_point or fourier")) return;
  recording.trajectory = internal::ReadTrajectory(file, node["trajectory"], KeyPath(key, "trajectory"),
                                                  scenario->robot.dof(), limits, motion_seed);
  if (!file->ok()) return;
  const double duration = DurationOf(recording);
  const double samples = std::floor(duration * scenario->truth.rate) + 1.0;
  if (samples < 2.0 || samples > kLargestSampleCount) {
    file->Fail(node, key, FormatNumber(duration) + " s at the given rate make " + FormatNumber(samples) + " samples",
               "from 2 to " + FormatNumber(kLargestSampleCount));
  }
  scenario->recordings.push_back(recording);
}

}  // namespace

Result<Scenario> ReadScenario(const std::string& yaml_path, const EffectEquationList& equations) {
  YamlFile file(yaml_path);
  IDIM_RETURN_IF_ERROR(file);
  const YAML::Node& root = file.root();
  file.Map(root, "",
           {"robot", "parameters", "payloads", "gains", "position_side", "signal_side", "rate", "clock_jitter", "noise",
            "limits", "effects", "recordings"});
  for (const auto& [name, expected] :
       {std::pair{"robot", "the path of a robot file"}, std::pair{"parameters", "a list of mappings, one a link"},
        std::pair{"recordings", "a list of recordings"}}) {
    file.Require(root, "", name, expected);
  }
  Scenario scenario;
  scenario.path = yaml_path;
  const std::string robot = file.ok() ? file.Text(root["robot"], "robot", "the path of a robot file") : "";
  IDIM_RETURN_IF_ERROR(file);
  scenario.robot_path = ResolvePath(FolderOf(yaml_path), robot);
  if (!IsRegularFile(scenario.robot_path)) {
    file.Fail(root["robot"], "robot", "there is no file " + scenario.robot_path, "the path of a robot file");
    return file.status();
  }
  Result<Robot> robot_read = ReadRobot(scenario.robot_path);
  IDIM_RETURN_IF_ERROR(robot_read);
  scenario.robot = std::move(robot_read).value();

  IDIM_RETURN_IF_ERROR(ReadParameters(&file, root["parameters"], &scenario));
  ReadPayloads(&file, root["payloads"], &scenario);
  ReadGains(&file, root["gains"], &scenario);
  for (const auto& [name, side] :
       {std::pair{"position_side", &scenario.position_side}, std::pair{"signal_side", &scenario.truth.signal_side}}) {
    if (root[name].IsDefined()) {
      *side = file.Choice(root[name], name, {"joint", "motor"}) == 0 ? Side::kJoint : Side::kMotor;
    }
  }
  if (root["rate"].IsDefined()) scenario.truth.rate = file.PositiveNumber(root["rate"], "rate");
  if (root["clock_jitter"].IsDefined()) {
    scenario.truth.clock_jitter = file.Number(root["clock_jitter"], "clock_jitter");
  }
  std::string error;
  if (file.ok() && !scenario.truth.IsValid(&error)) {
    file.Fail(error.rfind("rate", 0) == 0 ? root["rate"] : root["clock_jitter"], "", error, "");
  }
  ReadNoise(&file, root["noise"], &scenario);
  const JointLimits limits = internal::ReadLimits(&file, root["limits"], "limits", scenario.robot.dof());
  if (file.List(root["recordings"], "recordings", "a list of recordings")) {
    if (root["recordings"].size() == 0) file.Fail(root["recordings"], "recordings", "is empty", "at least one");
    for (size_t k = 0; k < root["recordings"].size() && file.ok(); ++k) {
      ReadOneRecording(&file, root["recordings"][k], KeyPath("recordings", k), limits, &scenario);
    }
  }
  internal::ReadEffects(&file, root["effects"], equations, &scenario);
  IDIM_RETURN_IF_ERROR(file);
  return scenario;
}

}  // namespace idim
