#include "core/simulation/simulate_scenario.h"

#include <yaml-cpp/yaml.h>

#include <Eigen/LU>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/base/decompositions.h"
#include "core/base/text.h"
#include "core/dynamics/base_parameters.h"
#include "core/robot/joint_units.h"
#include "core/simulation/effects_truth.h"

namespace idim {
namespace {

using Json = nlohmann::ordered_json;

// Decimals that resolve a tenth of the step; -1: all digits (no step).
int Decimals(double step) {
  if (!(step > 0.0)) return -1;
  return std::max(0, static_cast<int>(std::ceil(-std::log10(step) - 1e-9)) + 1);
}

void AppendNumber(double value, int decimals, std::string* text) {
  if (decimals < 0) {
    *text += FormatNumber(value);
    return;
  }
  char buffer[400];  // the largest double has 309 digits before the point
  const auto result = std::to_chars(buffer, buffer + sizeof(buffer), value, std::chars_format::fixed, decimals);
  std::string number(buffer, result.ptr);
  if (number.find('.') != std::string::npos) {
    number.erase(number.find_last_not_of('0') + 1);
    if (number.back() == '.') number.pop_back();
  }
  *text += number == "-0" ? "0" : number;
}

// The steps of the position columns on the side that is written; 0 where nothing is quantised.
Eigen::VectorXd PositionSteps(const Scenario& scenario) {
  const int n = scenario.robot.dof();
  const bool motor = scenario.position_side == Side::kMotor;
  Eigen::VectorXd steps = Eigen::VectorXd::Zero(n);
  const NoiseOptions& noise = scenario.noise;
  if (noise.encoder_counts.size() > 0) {
    const Eigen::VectorXd counts = 2.0 * M_PI * noise.encoder_counts.cwiseInverse();
    const Eigen::MatrixXd inverse = scenario.robot.transmission.inverse();
    for (int j = 0; j < n; ++j) {
      if (motor) {
        steps[j] = counts[j];
        continue;
      }
      // Where several encoders make up a joint, the finest of their steps.
      for (int m = 0; m < n; ++m) {
        const double step = std::abs(inverse(j, m)) * counts[m];
        if (step > 0.0 && (steps[j] == 0.0 || step < steps[j])) steps[j] = step;
      }
    }
  } else if (noise.position_step.size() > 0 && !motor) {
    steps = noise.position_step;
  }
  return steps;
}

// Standard deviation of the logged joint position about the truth: white noise, and quantisation as uniform errors of
// the encoders.
Eigen::VectorXd PositionNoise(const Scenario& scenario) {
  const int n = scenario.robot.dof();
  const NoiseOptions& noise = scenario.noise;
  Eigen::VectorXd variance = Eigen::VectorXd::Zero(n);
  if (noise.position.size() > 0) variance += noise.position.cwiseAbs2();
  if (noise.position_step.size() > 0) variance += noise.position_step.cwiseAbs2() / 12.0;
  if (noise.encoder_counts.size() > 0) {
    const Eigen::VectorXd motor = (2.0 * M_PI * noise.encoder_counts.cwiseInverse()).cwiseAbs2() / 12.0;
    variance += scenario.robot.transmission.inverse().cwiseAbs2() * motor;
  }
  return variance.cwiseSqrt();
}

std::string RenderCsv(const Scenario& scenario, const Recording& recording) {
  const int n = recording.dof();
  std::vector<int> q_decimals(n), v_decimals(n, -1);
  const Eigen::VectorXd steps = PositionSteps(scenario);
  std::string text = "t";
  for (int j = 0; j < n; ++j) {
    q_decimals[j] = Decimals(steps[j]);
    if (scenario.noise.signal_step.size() > 0) v_decimals[j] = Decimals(scenario.noise.signal_step[j]);
    text += ",q" + std::to_string(j + 1);
  }
  for (int j = 0; j < n; ++j) text += ",v" + std::to_string(j + 1);
  text += "\n";
  Eigen::MatrixXd q = recording.q;
  if (scenario.position_side == Side::kMotor) q *= scenario.robot.transmission.transpose();
  const int t_decimals = static_cast<int>(std::lround(-std::log10(kClockTick)));
  for (int k = 0; k < recording.samples(); ++k) {
    AppendNumber(recording.t[k], t_decimals, &text);
    for (int j = 0; j < n; ++j) AppendNumber(q(k, j), q_decimals[j], &(text += ","));
    for (int j = 0; j < n; ++j) AppendNumber(recording.signal(k, j), v_decimals[j], &(text += ","));
    text += "\n";
  }
  return text;
}

std::string List(const Eigen::VectorXd& values) {
  std::vector<std::string> numbers;
  for (double value : values) numbers.push_back(FormatNumber(value));
  return "[" + Join(numbers, ", ") + "]";
}

std::string RenderStudy(const Scenario& scenario) {
  const auto side = [](Side s) { return s == Side::kMotor ? "motor" : "joint"; };
  std::string text = "# Simulated by idim_simulate; the truth is in truth.json.\nrobot: robot.yaml\nrecordings:\n";
  for (const ScenarioRecording& recording : scenario.recordings) {
    text += "  - {file: " + recording.name + ".csv, name: " + recording.name;
    if (recording.payload >= 0) text += ", payload: " + scenario.payloads[recording.payload].name;
    text += std::string(", use: ") + (recording.use == Use::kValidation ? "validation" : "identification") + "}\n";
  }
  if (!scenario.payloads.empty()) text += "payloads:\n";
  for (const ScenarioPayload& payload : scenario.payloads) {
    std::vector<std::string> known;
    for (int k : payload.known) known.push_back(kStandardNames[k] + (": " + FormatNumber(payload.inertial[k])));
    text += "  " + payload.name + ": {" + Join(known, ", ") + "}\n";
  }
  if (scenario.gains_mode == GainsMode::kKnown) {
    text += "gains: {mode: known, values: " + List(scenario.gains) + "}\n";
  } else if (scenario.a_priori_gains.size() > 0) {
    text += "gains: {mode: identify, values: " + List(scenario.a_priori_gains) + "}\n";
  } else {
    text += "gains: {mode: identify}\n";
  }
  text += "friction: [viscous, coulomb, offset]\n";
  text += std::string("position_side: ") + side(scenario.position_side) + "\n";
  text += std::string("signal_side: ") + side(scenario.truth.signal_side) + "\n";
  return text;
}

std::vector<double> ToList(const Eigen::VectorXd& values) {
  return std::vector<double>(values.data(), values.data() + values.size());
}

Json ToJson(const Parameter& parameter, double value, const std::string& regrouping) {
  return {{"name", parameter.name},   {"kind", ParameterKindName(parameter.kind)},
          {"joint", parameter.joint}, {"value", value},
          {"unit", parameter.unit},   {"regrouping", regrouping}};
}

Json TrueParameters(const Scenario& scenario, const BaseParameters& base) {
  const int n = scenario.robot.dof();
  Json parameters = Json::array();
  for (int j = 0; j < n; ++j) {
    const Parameter gain = {"g" + std::to_string(j + 1), ParameterKind::kDriveGain, j + 1,
                            GainUnit(scenario.robot, j, scenario.truth.signal_side)};
    parameters.push_back(ToJson(gain, scenario.gains[j], ""));
  }
  const Eigen::VectorXd chi = base.projection() * scenario.chi;
  for (int k = 0; k < base.size(); ++k) {
    parameters.push_back(ToJson(base.parameters()[k], chi[k], base.regroupings()[k]));
  }
  for (const ScenarioPayload& payload : scenario.payloads) {
    for (int k = 0; k < kNumInertial; ++k) {
      const Parameter parameter = {kStandardNames[k] + std::to_string(n + 1), ParameterKind::kPayload, n,
                                   StandardUnit(k, false)};
      Json json = ToJson(parameter, payload.inertial[k], "");
      json["payload"] = payload.name;
      parameters.push_back(json);
    }
  }
  return parameters;
}

Json ToJson(const SimulatedEffect& effect) {
  Json joints = Json::array();
  for (int j : effect.joints) joints.push_back(j + 1);
  Json json = {{"effect", effect.equation->id()}, {"joints", joints}, {"values", Json::object()}};
  for (const EffectKey& key : effect.equation->keys()) {
    const bool given = effect.values.count(key.name) > 0;
    if (given || key.default_written) json["values"][key.name] = effect.Value(key.name);
  }
  if (!effect.recording.empty()) json["recording"] = effect.recording;
  return json;
}

// robot.yaml as it is; a URDF that it names goes beside it.
Status AddRobotFiles(const Scenario& scenario, std::vector<OutputFile>* files) {
  Result<std::string> text = ReadFile(scenario.robot_path);
  IDIM_RETURN_IF_ERROR(text);
  YAML::Node yaml = YAML::Load(*text);  // ReadRobot() has read it before
  if (yaml["urdf"].IsDefined()) {
    const std::string given = yaml["urdf"].Scalar();
    Result<std::string> urdf = ReadFile(ResolvePath(FolderOf(scenario.robot_path), given));
    IDIM_RETURN_IF_ERROR(urdf);
    const std::string name = std::filesystem::path(given).filename().string();
    files->push_back({name, std::move(urdf).value()});
    if (name != given) {
      yaml["urdf"] = name;
      text = YAML::Dump(yaml) + "\n";
    }
  }
  files->push_back({"robot.yaml", std::move(text).value()});
  return Status::Ok();
}

}  // namespace

Study StudyOf(const Scenario& scenario) {
  Study study;
  study.path = scenario.path;
  study.robot = scenario.robot;
  for (const ScenarioRecording& recording : scenario.recordings) {
    RecordingEntry entry;
    entry.name = recording.name;
    entry.use = recording.use;
    entry.payload = recording.payload;
    entry.q_file = entry.signal_file = recording.name + ".csv";
    study.recordings.push_back(entry);
  }
  for (const ScenarioPayload& payload : scenario.payloads) {
    study.payloads.emplace_back().name = payload.name;
    for (int k : payload.known) study.payloads.back().known[k] = payload.inertial[k];
  }
  study.gains_mode = scenario.gains_mode;
  study.gains = scenario.gains_mode == GainsMode::kKnown ? scenario.gains : scenario.a_priori_gains;
  study.position_side = scenario.position_side;
  study.signal_side = scenario.truth.signal_side;
  return study;
}

Truth SimulateTruth(const Scenario& scenario, const ScenarioRecording& recording) {
  StandardModel model(scenario.robot, FrictionModel());
  TruthOptions options = scenario.truth;
  options.duration = recording.duration;
  options.seed = recording.seed;
  const InertialVector payload =
      recording.payload >= 0 ? scenario.payloads[recording.payload].inertial : InertialVector(InertialVector::Zero());
  Truth truth = SimulateTruth(&model, scenario.chi, payload, scenario.gains, *recording.trajectory, options);
  internal::ApplyEffects(scenario, recording, &truth);
  return truth;
}

Recording SimulateLog(const Scenario& scenario, const ScenarioRecording& recording, const Truth& truth) {
  Recording log = AddNoise(truth, scenario.robot, scenario.noise, recording.seed);
  log.name = recording.name;
  return log;
}

Result<std::vector<OutputFile>> RenderScenario(const Scenario& scenario) {
  std::vector<OutputFile> files;
  IDIM_RETURN_IF_ERROR(AddRobotFiles(scenario, &files));
  const BaseParameters base(StandardModel(scenario.robot, FrictionModel()));
  Json standard = Json::object();
  for (int c = 0; c < base.model().columns(); ++c) standard[base.model().parameters()[c].name] = scenario.chi[c];
  Json json = {{"schema", "idim.truth.1"},
               {"robot", scenario.robot.name},
               {"parameters", TrueParameters(scenario, base)},
               {"standard_parameters", standard},
               {"recordings", Json::array()}};
  for (const SimulatedEffect& effect : scenario.effects) json["effects"].push_back(ToJson(effect));
  for (const ScenarioRecording& recording : scenario.recordings) {
    const Truth truth = SimulateTruth(scenario, recording);
    files.push_back({recording.name + ".csv", RenderCsv(scenario, SimulateLog(scenario, recording, truth))});
    const Eigen::VectorXd rms = (truth.torque.colwise().squaredNorm() / truth.t.size()).cwiseSqrt().transpose();
    json["recordings"].push_back({{"name", recording.name},
                                  {"use", recording.use == Use::kValidation ? "validation" : "identification"},
                                  {"samples", truth.t.size()},
                                  {"rms_torque", ToList(rms)},
                                  {"noise",
                                   {{"position", ToList(PositionNoise(scenario))},
                                    {"signal", ToList(AddedSignalNoise(truth, scenario.noise))}}}});
  }
  files.push_back({"study.yaml", RenderStudy(scenario)});
  files.push_back({"truth.json", json.dump(1) + "\n"});
  return files;
}

}  // namespace idim
