// ReadStudy: study.yaml, key by key.

#include <algorithm>
#include <filesystem>
#include <set>

#include "core/base/file.h"
#include "core/base/text.h"
#include "core/base/yaml.h"
#include "core/recording/check_study.h"
#include "core/recording/data_path.h"
#include "core/recording/study.h"
#include "core/robot/robot_reader.h"

namespace idim {

namespace {

class StudyReader {
 public:
  explicit StudyReader(const std::string& path) : file_(path) { study_.path = path; }

  Result<Study> Read() {
    const YAML::Node& root = file_.root();
    if (!file_.Map(root, "",
                   {"robot", "recordings", "payloads", "gains", "priors", "friction", "effects", "position_side",
                    "signal_side", "columns", "sample_rate", "noise", "preprocessing"})) {
      return file_.status();
    }
    IDIM_RETURN_IF_ERROR(ReadRobotOf(root));
    if (root["payloads"].IsDefined()) ReadPayloads(root["payloads"]);
    if (file_.Require(root, "", "recordings", "a list of recordings, {file: .., name: .., use: ..} each")) {
      ReadRecordings(root["recordings"]);
    }
    ReadGains(root["gains"]);
    if (root["priors"].IsDefined()) ReadPriors(root["priors"]);
    if (root["friction"].IsDefined()) ReadFriction(root["friction"]);
    if (root["effects"].IsDefined()) ReadEffects(root["effects"]);
    if (root["position_side"].IsDefined()) study_.position_side = ReadSide(root["position_side"], "position_side");
    if (root["signal_side"].IsDefined()) study_.signal_side = ReadSide(root["signal_side"], "signal_side");
    if (root["columns"].IsDefined()) ReadColumns(root["columns"]);
    if (root["sample_rate"].IsDefined()) study_.sample_rate = file_.PositiveNumber(root["sample_rate"], "sample_rate");
    if (root["noise"].IsDefined()) ReadNoise(root["noise"]);
    if (root["preprocessing"].IsDefined()) ReadPreprocessing(root["preprocessing"]);
    IDIM_RETURN_IF_ERROR(file_);
    return CheckedStudy(std::move(study_));
  }

 private:
  Status ReadRobotOf(const YAML::Node& root) {
    if (!file_.Require(root, "", "robot", "the path of a robot.yaml")) return file_.status();
    const std::string name = file_.Text(root["robot"], "robot", "the path of a robot.yaml");
    IDIM_RETURN_IF_ERROR(file_);
    const std::string path = ResolvePath(FolderOf(file_.path()), name);
    if (!IsRegularFile(path)) {
      file_.Fail(root["robot"], "robot", "no such file '" + path + "'", "the path of a robot.yaml");
      return file_.status();
    }
    Result<Robot> robot = ReadRobot(path);
    IDIM_RETURN_IF_ERROR(robot);
    study_.robot = *std::move(robot);
    n_ = study_.robot.dof();
    return Status::Ok();
  }

  void ReadPayloads(const YAML::Node& node) {
    if (!file_.ok()) return;
    if (!node.IsMap()) {
      file_.Fail(node, "payloads", "not a mapping", "payloads by name, calibrated: {M: 4.59}");
      return;
    }
    const std::vector<std::string> names(kStandardNames.begin(), kStandardNames.begin() + kNumInertial);
    std::vector<std::string> keys = names;
    keys.push_back("standard_deviation");
    for (const auto& entry : node) {
      Payload payload;
      payload.name = file_.Text(entry.first, "payloads", "the name of a payload");
      const std::string key = KeyPath("payloads", payload.name);
      for (const Payload& other : study_.payloads) {
        if (other.name == payload.name) file_.Fail(entry.first, key, "given twice", "distinct names");
      }
      const bool nothing_known = entry.second.IsNull();
      if (!nothing_known && !file_.Map(entry.second, key, keys)) return;
      for (int i = 0; i < kNumInertial && !nothing_known; ++i) {
        const YAML::Node value = entry.second[names[i]];
        if (!value.IsDefined()) continue;
        const std::string value_key = KeyPath(key, names[i]);
        payload.known[i] = i == kM ? file_.PositiveNumber(value, value_key) : file_.Number(value, value_key);
        if ((i == kXX || i == kYY || i == kZZ) && *payload.known[i] < 0.0) {
          file_.Fail(value, value_key, FormatNumber(*payload.known[i]) + " is negative", "a moment of inertia >= 0");
        }
      }
      if (!nothing_known && entry.second["standard_deviation"].IsDefined()) {
        ReadDeviations(entry.second["standard_deviation"], KeyPath(key, "standard_deviation"), names, &payload);
      }
      study_.payloads.push_back(std::move(payload));
    }
  }

  void ReadDeviations(const YAML::Node& node, const std::string& key, const std::vector<std::string>& names,
                      Payload* payload) {
    if (!file_.Map(node, key, names)) return;
    for (int i = 0; i < kNumInertial; ++i) {
      const YAML::Node value = node[names[i]];
      if (!value.IsDefined()) continue;
      payload->standard_deviation[i] = file_.PositiveNumber(value, KeyPath(key, names[i]));
      if (!payload->known[i]) file_.Fail(value, KeyPath(key, names[i]), "the payload has no " + names[i], "its value");
    }
  }

  void ReadPriors(const YAML::Node& list) {
    if (!file_.List(list, "priors", "a list of {parameter: .., value: .., standard_deviation: ..}")) return;
    for (size_t i = 0; i < list.size() && file_.ok(); ++i) {
      const std::string key = KeyPath("priors", i);
      if (!file_.Map(list[i], key, {"parameter", "value", "standard_deviation"}) ||
          !file_.Require(list[i], key, "parameter", "a name as in estimate.json") ||
          !file_.Require(list[i], key, "value", "a number") ||
          !file_.Require(list[i], key, "standard_deviation", "a number greater than 0")) {
        return;
      }
      Prior prior;
      prior.parameter = file_.Text(list[i]["parameter"], KeyPath(key, "parameter"), "a name as in estimate.json");
      prior.value = file_.Number(list[i]["value"], KeyPath(key, "value"));
      prior.standard_deviation =
          file_.PositiveNumber(list[i]["standard_deviation"], KeyPath(key, "standard_deviation"));
      prior.where = Where(list[i], key);
      for (const Prior& other : study_.priors) {
        if (other.parameter == prior.parameter)
          file_.Fail(list[i], key, "'" + prior.parameter + "' is given twice", "one prior");
      }
      study_.priors.push_back(std::move(prior));
    }
  }

  void ReadRecordings(const YAML::Node& list) {
    if (!file_.List(list, "recordings", "a list of recordings")) return;
    for (size_t i = 0; i < list.size() && file_.ok(); ++i) ReadRecordingEntry(list[i], KeyPath("recordings", i));
    if (!file_.ok()) return;
    const bool any = std::any_of(study_.recordings.begin(), study_.recordings.end(),
                                 [](const RecordingEntry& entry) { return entry.use == Use::kIdentification; });
    if (!any) file_.Fail(list, "recordings", "none is for identification", "at least one with 'use: identification'");
  }

  void ReadRecordingEntry(const YAML::Node& node, const std::string& key) {
    if (!file_.Map(node, key, {"file", "files", "name", "use", "payload", "rows"})) return;
    RecordingEntry entry;
    const bool one = node["file"].IsDefined();
    if (one == node["files"].IsDefined()) {
      file_.Fail(node, key, one ? "has 'file' and 'files'" : "has neither 'file' nor 'files'", "exactly one of them");
      return;
    }
    if (one) {
      entry.q_file = entry.signal_file = FindFile(node["file"], KeyPath(key, "file"));
    } else {
      ReadFiles(node["files"], KeyPath(key, "files"), &entry);
    }
    if (!file_.ok()) return;
    entry.name = node["name"].IsDefined() ? file_.Text(node["name"], KeyPath(key, "name"), "a name")
                                          : std::filesystem::path(entry.q_file).stem().string();
    for (const RecordingEntry& other : study_.recordings) {
      if (other.name == entry.name) {
        file_.Fail(node, KeyPath(key, "name"), "'" + entry.name + "' is the name of an earlier recording",
                   "distinct names");
      }
    }
    if (node["use"].IsDefined()) {
      const int use = file_.Choice(node["use"], KeyPath(key, "use"), {"identification", "validation"});
      entry.use = use == 0 ? Use::kIdentification : Use::kValidation;
    }
    if (node["payload"].IsDefined()) {
      if (study_.payloads.empty()) {
        file_.Fail(node["payload"], KeyPath(key, "payload"), "the study declares no payloads",
                   "a 'payloads' section with this name");
        return;
      }
      std::vector<std::string> names;
      for (const Payload& payload : study_.payloads) names.push_back(payload.name);
      entry.payload = file_.Choice(node["payload"], KeyPath(key, "payload"), names);
    }
    if (node["rows"].IsDefined()) {
      constexpr int kLargest = 2000000000;
      const YAML::Node rows = node["rows"];
      const std::string rows_key = KeyPath(key, "rows");
      file_.Numbers(rows, rows_key, 2, "[begin, end), counted from 0 without the header");
      if (!file_.ok()) return;
      const int begin = file_.Integer(rows[0], KeyPath(rows_key, 0), 0, kLargest);
      const int end = file_.Integer(rows[1], KeyPath(rows_key, 1), 0, kLargest);
      if (file_.ok() && end - begin < 2) {
        file_.Fail(rows, rows_key, "[" + std::to_string(begin) + ", " + std::to_string(end) + "] is too short",
                   "begin and end (exclusive) of at least 2 rows");
      }
      entry.rows = std::make_pair(begin, end);
    }
    study_.recordings.push_back(std::move(entry));
  }

  void ReadFiles(const YAML::Node& files, const std::string& key, RecordingEntry* entry) {
    if (!file_.Map(files, key, {"q", "v", "tau", "dq", "ddq"})) return;
    const bool tau = files["tau"].IsDefined();
    if (tau && files["v"].IsDefined()) {
      file_.Fail(files, key, "has 'v' and 'tau'", "one of them");
      return;
    }
    const std::string signal = tau ? "tau" : "v";
    if (!file_.Require(files, key, "q", "the file with the positions") ||
        !file_.Require(files, key, signal, "the file with the control signals")) {
      return;
    }
    entry->signal_kind = signal;
    entry->q_file = FindFile(files["q"], KeyPath(key, "q"));
    entry->signal_file = FindFile(files[signal], KeyPath(key, signal));
    if (files["dq"].IsDefined()) entry->dq_file = FindFile(files["dq"], KeyPath(key, "dq"));
    if (files["ddq"].IsDefined()) entry->ddq_file = FindFile(files["ddq"], KeyPath(key, "ddq"));
  }

  std::string FindFile(const YAML::Node& node, const std::string& key) {
    const std::string name = file_.Text(node, key, "the path of a CSV file");
    if (!file_.ok()) return std::string();
    const std::string path = FindDataFile(file_.path(), name);
    if (path.empty()) {
      file_.Fail(node, key,
                 "no such file '" + name + "'; looked for " + Join(DataPathCandidates(file_.path(), name), ", "),
                 "it in one of these places (scripts/fetch_recordings.sh gets the public recordings)");
    }
    return path;
  }

  void ReadGains(const YAML::Node& node) {
    if (!node.IsDefined() || !file_.Map(node, "gains", {"mode", "values"})) return;
    if (node["mode"].IsDefined() && file_.Choice(node["mode"], "gains.mode", {"known", "identify"}) == 1) {
      study_.gains_mode = GainsMode::kIdentify;
    }
    if (!node["values"].IsDefined()) return;
    study_.gains = file_.Numbers(node["values"], "gains.values", n_, "N.m (or N) per signal unit, one a joint");
    if (file_.ok() && (study_.gains.array() == 0.0).any()) {
      file_.Fail(node["values"], "gains.values", "a gain is 0", "gains other than 0");
    }
  }

  void ReadFriction(const YAML::Node& list) {
    if (!file_.List(list, "friction", "a list out of viscous, coulomb, offset")) return;
    study_.friction = {false, false, false};
    bool* const terms[] = {&study_.friction.viscous, &study_.friction.coulomb, &study_.friction.offset};
    for (size_t i = 0; i < list.size() && file_.ok(); ++i) {
      const std::string key = KeyPath("friction", i);
      bool* const term = terms[file_.Choice(list[i], key, {"viscous", "coulomb", "offset"})];
      if (*term) file_.Fail(list[i], key, "'" + list[i].as<std::string>("") + "' is given twice", "each term once");
      *term = true;
    }
  }

  void ReadEffects(const YAML::Node& list) {
    if (!file_.List(list, "effects", "a list of {id: .., joints: [..]}")) return;
    for (size_t i = 0; i < list.size() && file_.ok(); ++i) ReadEffect(list[i], KeyPath("effects", i));
  }

  void ReadEffect(const YAML::Node& node, const std::string& key) {
    if (!file_.Map(node, key, {"id", "joints", "shape"}) ||
        !file_.Require(node, key, "id", "the id of an effect, such as stribeck")) {
      return;
    }
    DeclaredEffect effect;
    const std::string id_key = KeyPath(key, "id"), joints_key = KeyPath(key, "joints");
    effect.id = file_.Text(node["id"], id_key, "the id of an effect");
    effect.where = Where(node, key);
    effect.id_where = Where(node["id"], id_key);
    effect.joints_where = Where(node["joints"].IsDefined() ? node["joints"] : node, joints_key);
    if (node["shape"].IsDefined()) ReadShape(node["shape"], KeyPath(key, "shape"), &effect);
    if (node["joints"].IsDefined()) effect.joints = file_.Joints(node["joints"], joints_key, n_, "a list of joints");
    study_.effects.push_back(std::move(effect));
  }

  void ReadShape(const YAML::Node& node, const std::string& key, DeclaredEffect* effect) {
    if (!node.IsMap()) {
      file_.Fail(node, key, "not a mapping", "start values of shape parameters by name, such as {x_s: 0.001}");
      return;
    }
    for (const auto& entry : node) {
      const std::string name = file_.Text(entry.first, key, "the name of a shape parameter");
      const std::string value_key = KeyPath(key, name);
      for (const DeclaredShape& other : effect->shape) {
        if (other.name == name) file_.Fail(entry.first, value_key, "given twice", "one start value");
      }
      effect->shape.push_back({name, file_.Number(entry.second, value_key), Where(entry.second, value_key)});
    }
  }

  // As YamlFile::Fail begins its messages, for what is found wrong only later.
  std::string Where(const YAML::Node& node, const std::string& key) const {
    return file_.path() + ":" + std::to_string(node.Mark().line + 1) + ": key '" + key + "'";
  }

  Side ReadSide(const YAML::Node& node, const std::string& key) {
    return file_.Choice(node, key, {"joint", "motor"}) == 0 ? Side::kJoint : Side::kMotor;
  }

  void ReadColumns(const YAML::Node& node) {
    std::vector<std::string> known = {"t"};
    for (const char* const kind : {"q", "v", "tau", "dq", "ddq"}) {
      for (int j = 1; j <= n_; ++j) known.push_back(kind + std::to_string(j));
    }
    if (!file_.Map(node, "columns", known)) return;
    bool v = false;
    bool tau = false;
    for (const auto& entry : node) {
      const std::string name = entry.first.Scalar();
      const std::string key = KeyPath("columns", name);
      const YAML::Node& value = entry.second;
      if (!file_.Map(value, key, {"column", "scale", "offset"}) ||
          !file_.Require(value, key, "column", "a header name or a 1-based number")) {
        return;
      }
      Column column;
      const YAML::Node source = value["column"];
      double number = 0.0;
      // A quoted number is a header name.
      if (source.IsScalar() && source.Tag() != "!" && ParseNumber(source.Scalar(), &number) == NumberText::kOk) {
        column.number = file_.Integer(source, KeyPath(key, "column"), 1, 1000000);
      } else {
        column.header = file_.Text(source, KeyPath(key, "column"), "a header name or a 1-based number");
      }
      if (value["scale"].IsDefined()) column.scale = file_.Number(value["scale"], KeyPath(key, "scale"));
      if (value["offset"].IsDefined()) column.offset = file_.Number(value["offset"], KeyPath(key, "offset"));
      if (column.scale == 0.0) file_.Fail(value, KeyPath(key, "scale"), "0 wipes out the column", "another number");
      v = v || name[0] == 'v';
      tau = tau || name.compare(0, 3, "tau") == 0;
      study_.columns.emplace_back(name, column);
    }
    if (v && tau) file_.Fail(node, "columns", "declares v and tau", "one of them");
  }

  void ReadNoise(const YAML::Node& node) {
    if (!file_.Map(node, "noise", {"position", "signal"})) return;
    const auto read = [&](const std::string& name) {
      Eigen::VectorXd values;
      if (!node[name].IsDefined()) return values;
      const std::string key = KeyPath("noise", name);
      values = file_.Numbers(node[name], key, n_, "standard deviations, one a joint");
      if (file_.ok() && (values.array() <= 0.0).any()) {
        file_.Fail(node[name], key, "a value is not positive", "standard deviations greater than 0");
      }
      return values;
    };
    study_.position_noise = read("position");
    study_.signal_noise = read("signal");
  }

  void ReadPreprocessing(const YAML::Node& node) {
    if (!file_.Map(node, "preprocessing", {"cutoff_hz", "decimation"})) return;
    if (node["cutoff_hz"].IsDefined()) {
      study_.preprocessing.cutoff_hz = file_.PositiveNumber(node["cutoff_hz"], "preprocessing.cutoff_hz");
    }
    if (node["decimation"].IsDefined()) {
      study_.preprocessing.decimation = file_.Integer(node["decimation"], "preprocessing.decimation", 1, 1000000);
    }
  }

  YamlFile file_;
  Study study_;
  int n_ = 0;
};

}  // namespace

Result<Study> ReadStudy(const std::string& yaml_path) { return StudyReader(yaml_path).Read(); }

}  // namespace idim
