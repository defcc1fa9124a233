#include "core/simulation/scenario.h"

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/dynamics/base_parameters.h"
#include "core/effects/simulated_effects.h"
#include "core/simulation/simulate_scenario.h"

namespace idim::scenario_test {
namespace {

namespace fs = std::filesystem;

const char kScenario[] = R"(robot: robot.yaml
parameters:
  - {ZZ: 0.5, Ia: 0.3, Fv: 7, Fs: 5, off: 0.3}
  - {XX: 0.1, YY: 0.4, ZZ: 0.4, MX: 0.5, M: 4, Ia: 0.3, Fv: 4, Fs: 7}
  - {XX: 0.1, YY: 0.1, ZZ: 0.1, MY: -0.2, M: 3, Ia: 0.08, Fv: 1.5, Fs: 6}
  - {XX: 0.02, YY: 0.02, ZZ: 0.01, MZ: -0.1, M: 2, Ia: 0.03, Fv: 0.7, Fs: 1.9}
  - {MY: -0.01, M: 0.5, Ia: 0.05, Fv: 1.4, Fs: 3}
  - {M: 0.2, Ia: 0.01, Iam: 0.01, Fv: 0.5, Fvm: 0.4, Fs: 0.1, Fsm: 1.7, off: 0.1}
payloads:
  weight: {XX: 0.06, XY: -0.018, XZ: 0.026, YY: 0.064, YZ: 0.026, ZZ: 0.044, MX: -0.29, MY: -0.29, MZ: 0.41, M: 4.59,
           known: [M, MZ]}
gains: {values: [33.9, 32.4, 24.2, -9.21, 16.3, 6.79]}
position_side: motor
signal_side: motor
rate: 200
noise: {encoder_counts: 4096, signal_percent: 10, signal_step: 0.01}
limits:
  lower: -1.5
  upper: 1.5
  velocity: [5, 5, 6, 6, 6, 8]
  acceleration: 40
  jerk: 800
recordings:
  - {name: free, seed: 1, trajectory: {type: point_to_point, random: 8}}
  - name: load
    use: validation
    payload: weight
    seed: 2
    duration: 2.5
    trajectory: {type: fourier, frequency: 0.2, duration: 5, blend: 1}
)";

std::string Replaced(std::string text, const std::string& from, const std::string& to) {
  const size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

class InFolder : public ::testing::Test {
 protected:
  InFolder() {
    std::string name = (fs::temp_directory_path() / "idim_scenario_XXXXXX").string();
    folder_ = ::mkdtemp(name.data());
    fs::copy_file(fs::path(IDIM_SOURCE_DIR) / "datasets/tx40_synthetic/robot.yaml", folder_ / "robot.yaml");
  }
  ~InFolder() override { fs::remove_all(folder_); }

  std::string Write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return (folder_ / name).string();
  }

  Scenario Read(const std::string& text) const {
    Result<Scenario> scenario = ReadScenario(Write("scenario.yaml", text), EffectEquations());
    EXPECT_TRUE(scenario.ok()) << scenario.status().message();
    return scenario.ok() ? std::move(scenario).value() : Scenario();
  }

  // Writes what the scenario makes into `out` and reads it as a user of the data would.
  Study RenderAndReadStudy(const Scenario& scenario) const {
    const auto files = RenderScenario(scenario);
    EXPECT_TRUE(files.ok()) << files.status().message();
    EXPECT_TRUE(WriteFiles((folder_ / "out").string(), *files).ok());
    Result<Study> study = ReadStudy((folder_ / "out/study.yaml").string());
    EXPECT_TRUE(study.ok()) << study.status().message();
    return study.ok() ? std::move(study).value() : Study();
  }

  fs::path folder_;
};

using ScenarioFile = InFolder;

TEST_F(ScenarioFile, StudyTellsWhatItShould) {
  const Study study = RenderAndReadStudy(Read(kScenario));
  ASSERT_EQ(study.recordings.size(), 2u);
  EXPECT_EQ(study.recordings[0].name, "free");
  EXPECT_EQ(study.recordings[0].use, Use::kIdentification);
  EXPECT_EQ(study.recordings[0].payload, -1);
  EXPECT_EQ(study.recordings[1].use, Use::kValidation);
  EXPECT_EQ(study.recordings[1].payload, 0);
  ASSERT_EQ(study.payloads.size(), 1u);
  for (int k = 0; k < kNumInertial; ++k) EXPECT_EQ(study.payloads[0].known[k].has_value(), k == kM || k == kMZ);
  EXPECT_EQ(study.payloads[0].known[kM].value(), 4.59);
  EXPECT_EQ(study.payloads[0].known[kMZ].value(), 0.41);
  EXPECT_EQ(study.gains_mode, GainsMode::kKnown);
  EXPECT_EQ(study.gains[3], -9.21);
  EXPECT_EQ(study.position_side, Side::kMotor);
  EXPECT_EQ(study.signal_side, Side::kMotor);

  const std::string identify =
      Replaced(kScenario, "6.79]}", "6.79], mode: identify, a_priori: [30, 30, 20, -9, 15, 7]}");
  const Study asked = RenderAndReadStudy(Read(identify));
  EXPECT_EQ(asked.gains_mode, GainsMode::kIdentify);
  EXPECT_EQ(asked.gains[0], 30.0);
}

// The way back through study and recording reader: joint positions and torques of the noiseless truth.
TEST_F(ScenarioFile, NoiselessRecordingsReadBackAsTheTruth) {
  for (const char* side : {"motor", "joint"}) {
    std::string text = Replaced(kScenario, "noise: {encoder_counts: 4096, signal_percent: 10, signal_step: 0.01}", "");
    text = Replaced(text, "position_side: motor", std::string("position_side: ") + side);
    text = Replaced(text, "signal_side: motor", std::string("signal_side: ") + side);
    const Scenario scenario = Read(text);
    const Study study = RenderAndReadStudy(scenario);
    ASSERT_EQ(study.recordings.size(), 2u);
    for (int r = 0; r < 2; ++r) {
      const Truth truth = SimulateTruth(scenario, scenario.recordings[r]);
      const Result<Recording> read = ReadRecording(study, study.recordings[r]);
      ASSERT_TRUE(read.ok()) << read.status().message();
      EXPECT_EQ(read->t, truth.t);
      EXPECT_LT((read->q - truth.q).cwiseAbs().maxCoeff(), 1e-13);
      const Eigen::MatrixXd torque = DriveMap(study.robot, study.signal_side).Torque(study.gains, read->signal);
      EXPECT_LT((torque - truth.torque).cwiseAbs().maxCoeff(), 1e-12 * truth.torque.cwiseAbs().maxCoeff());
    }
    EXPECT_EQ(SimulateTruth(scenario, scenario.recordings[1]).t.size(), 501);  // 2.5 s, cut off in the motion
  }
}

TEST_F(ScenarioFile, QuantisedRecordingsKeepATenthOfTheStep) {
  const Scenario scenario = Read(kScenario);
  const Study study = RenderAndReadStudy(scenario);
  const Truth truth = SimulateTruth(scenario, scenario.recordings[0]);
  const Recording log = SimulateLog(scenario, scenario.recordings[0], truth);
  const Result<Recording> read = ReadRecording(study, study.recordings[0]);
  ASSERT_TRUE(read.ok()) << read.status().message();
  const Eigen::MatrixXd motor_error = (read->q - log.q) * study.robot.transmission.transpose();
  EXPECT_LE(motor_error.cwiseAbs().maxCoeff(), 0.05 * 2.0 * M_PI / 4096);
  EXPECT_LE((read->signal - log.signal).cwiseAbs().maxCoeff(), 1e-9);  // steps of 0.01 are written exactly
  std::ifstream csv(folder_ / "out/free.csv");
  std::string line;
  while (std::getline(csv, line)) ASSERT_LE(line.size(), 120u) << line;
}

// The torque again, from truth.json alone: its base parameters, gains and payload.
TEST_F(ScenarioFile, TruthFileGivesTheTorque) {
  const Scenario scenario = Read(kScenario);
  RenderAndReadStudy(scenario);
  const nlohmann::json json = nlohmann::json::parse(std::ifstream(folder_ / "out/truth.json"));
  const BaseParameters base(StandardModel(scenario.robot, FrictionModel()));
  Eigen::VectorXd chi(base.size()), gains(6);
  InertialVector payload;
  int found = 0;
  for (const auto& parameter : json["parameters"]) {
    const std::string name = parameter["name"], kind = parameter["kind"];
    if (kind == "drive_gain") {
      gains[parameter["joint"].get<int>() - 1] = parameter["value"];
    } else if (kind == "payload") {
      EXPECT_EQ(parameter["payload"], "weight");
      for (int k = 0; k < kNumInertial; ++k) {
        if (name == std::string(kStandardNames[k]) + "7") payload[k] = parameter["value"];
      }
    } else {
      ASSERT_EQ(name, base.parameters()[found].name);
      EXPECT_EQ(parameter["regrouping"], base.regroupings()[found]);
      chi[found++] = parameter["value"];
    }
  }
  ASSERT_EQ(found, base.size());
  EXPECT_EQ(gains, scenario.gains);
  StandardModel model = base.model();
  Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::RowMajor> w(6, model.columns()), w_payload(6, kNumInertial);
  const Truth truth = SimulateTruth(scenario, scenario.recordings[1]);
  for (int k = 0; k < truth.t.size(); k += 50) {
    const Eigen::VectorXd q = truth.q.row(k), dq = truth.dq.row(k), ddq = truth.ddq.row(k);
    model.Regressor(q.data(), dq.data(), ddq.data(), nullptr, w.data());
    model.PayloadColumns(w_payload.data());
    Eigen::VectorXd torque = w_payload * payload;
    for (int b = 0; b < base.size(); ++b) torque += w.col(base.kept()[b]) * chi[b];
    EXPECT_LT((torque - truth.torque.row(k).transpose()).norm(), 1e-10 * torque.norm());
  }
  // The noise that it declares is the one in the log: 5 standard deviations of a sample variance of 501 normal errors,
  // and of 501 uniform ones (quantisation), a false alarm in 1e-5 of the seeds.
  const Recording log = SimulateLog(scenario, scenario.recordings[1], truth);
  for (int j = 0; j < 6; ++j) {
    const double sigma = json["recordings"][1]["noise"]["signal"][j];
    const double measured = (log.signal - truth.signal).col(j).squaredNorm() / truth.t.size();
    EXPECT_NEAR(measured / (sigma * sigma + 1e-4 / 12), 1.0, 5 * std::sqrt(2.0 / 501));
    const double position = json["recordings"][1]["noise"]["position"][j];
    EXPECT_NEAR((log.q - truth.q).col(j).squaredNorm() / truth.t.size() / (position * position), 1.0,
                5 * std::sqrt(0.8 / 501));
  }
}

TEST_F(ScenarioFile, SameScenarioSameBytesOtherSeedOtherBytes) {
  const auto first = RenderScenario(Read(kScenario));
  const auto again = RenderScenario(Read(kScenario));
  const auto other = RenderScenario(Read(Replaced(kScenario, "name: free, seed: 1", "name: free, seed: 7")));
  ASSERT_TRUE(first.ok() && again.ok() && other.ok());
  ASSERT_EQ(first->size(), again->size());
  for (size_t k = 0; k < first->size(); ++k) {
    EXPECT_EQ((*first)[k].name, (*again)[k].name);
    EXPECT_TRUE((*first)[k].content == (*again)[k].content) << (*first)[k].name;
    const std::string& name = (*first)[k].name;
    const bool changes = name == "free.csv" || name == "truth.json";  // the truth holds the RMS of the torque
    EXPECT_EQ((*first)[k].content != (*other)[k].content, changes) << name;
  }
}

TEST_F(ScenarioFile, ParametersMayBeInAFileOfTheirOwn) {
  const std::string text(kScenario);
  const size_t begin = text.find("parameters:"), end = text.find("payloads:");
  Write("truth.yaml", text.substr(begin, end - begin));
  const Eigen::VectorXd inside = Read(kScenario).chi;
  EXPECT_EQ(Read(text.substr(0, begin) + "parameters: truth.yaml\n" + text.substr(end)).chi, inside);
  Write("truth.yaml", Replaced(text.substr(begin, end - begin), "ZZ: 0.5", "ZZZ: 0.5"));
  const auto bad = ReadScenario(folder_ / "scenario.yaml", EffectEquations());
  ASSERT_FALSE(bad.ok());
  EXPECT_NE(bad.status().message().find("truth.yaml:2: key 'parameters[1].ZZZ'"), std::string::npos)
      << bad.status().message();
}

TEST_F(ScenarioFile, UrdfTravelsWithTheData) {
  fs::create_directory(folder_ / "arm");
  Write("arm/one.urdf",
        "<robot name='one'><link name='base'/><link name='arm'/><joint name='j' type='revolute'>"
        "<parent link='base'/><child link='arm'/><axis xyz='0 1 0'/><limit lower='-1' upper='1' effort='1' "
        "velocity='1'/></joint></robot>");
  Write("robot.yaml", "name: one\nurdf: arm/one.urdf\n");
  const Study study = RenderAndReadStudy(
      Read("robot: robot.yaml\nparameters: [{M: 1, MX: 0.3, Fv: 1}]\nlimits: {velocity: 1, acceleration: 5, jerk: 50}\n"
           "recordings: [{name: a, seed: 1, trajectory: {type: point_to_point, via: [[0], [1]]}}]\n"));
  EXPECT_EQ(study.robot.dof(), 1);
  EXPECT_TRUE(fs::exists(folder_ / "out/one.urdf"));
}

TEST_F(ScenarioFile, TruthFileHasAGainInTheUnitOfItsJoint) {
  Write("slide.urdf",
        "<robot name='slide'><link name='base'/><link name='arm'/><joint name='j' type='prismatic'>"
        "<parent link='base'/><child link='arm'/><axis xyz='0 0 1'/><limit lower='-1' upper='1' effort='1' "
        "velocity='1'/></joint></robot>");
  Write("robot.yaml", "name: slide\nurdf: slide.urdf\n");
  for (const auto& [side, unit] :
       {std::pair("joint", "N per signal unit"), std::pair("motor", "N.m per signal unit")}) {
    RenderAndReadStudy(
        Read("robot: robot.yaml\nparameters: [{M: 1, Fv: 1}]\nlimits: {velocity: 1, acceleration: 5, jerk: 50}\n"
             "signal_side: " +
             std::string(side) +
             "\n"
             "recordings: [{name: a, seed: 1, trajectory: {type: point_to_point, via: [[0], [1]]}}]\n"));
    const nlohmann::json json = nlohmann::json::parse(std::ifstream(folder_ / "out/truth.json"));
    EXPECT_EQ(json["parameters"][0]["name"], "g1");
    EXPECT_EQ(json["parameters"][0]["unit"], unit) << side;
  }
}

struct BadCase {
  const char* name;
  const char* from;
  const char* to;
  const char* expected;  // "line: key" of the message, and a word of it
  const char* word;
};

class BadScenario : public InFolder, public ::testing::WithParamInterface<BadCase> {};

TEST_P(BadScenario, IsRefusedByTheProgramInOneLineAndNothingIsWritten) {
  const BadCase& bad = GetParam();
  const std::string path = Write("scenario.yaml", Replaced(kScenario, bad.from, bad.to));
  const fs::path out = folder_ / "out", errors = folder_ / "errors";
  const std::string command = std::string(IDIM_APPS_DIR) + "/idim_simulate '" + path + "' --output='" + out.string() +
                              "' 2>'" + errors.string() + "'";
  const int status = std::system(command.c_str());
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 1);
  std::stringstream message;
  message << std::ifstream(errors).rdbuf();
  EXPECT_NE(message.str().find(bad.expected), std::string::npos) << message.str();
  EXPECT_NE(message.str().find(bad.word), std::string::npos) << message.str();
  EXPECT_EQ(message.str().find('\n'), message.str().size() - 1) << message.str();
  EXPECT_FALSE(fs::exists(out));
}

INSTANTIATE_TEST_SUITE_P(
    Table, BadScenario,
    ::testing::Values(
        BadCase{"robot_missing", "robot: robot.yaml", "robot: arm.yaml", "scenario.yaml:1: key 'robot'", "arm.yaml"},
        BadCase{"no_robot", "robot: robot.yaml\n", "", "key 'robot': missing", "expected"},
        BadCase{"unknown_key", "rate: 200", "rates: 200", "scenario.yaml:15: key 'rates'", "rate"},
        BadCase{"rate_zero", "rate: 200", "rate: 0", "scenario.yaml:15: key 'rate'", "greater than 0"},
        BadCase{"rate_not_finite", "rate: 200", "rate: .inf", "scenario.yaml:15: key 'rate'", "not finite"},
        BadCase{"rate_in_wrong_unit", "rate: 200", "rate: 1e9", "scenario.yaml:15", "at most 100000"},
        BadCase{"jitter_too_large", "rate: 200", "rate: 200\nclock_jitter: 0.01", "scenario.yaml:16", "0.49 / rate"},
        BadCase{"text_for_a_number", "ZZ: 0.5", "ZZ: half", "scenario.yaml:3: key 'parameters[1].ZZ'", "not a number"},
        BadCase{"unknown_parameter", "Fv: 7", "Fw: 7", "scenario.yaml:3: key 'parameters[1].Fw'", "unknown"},
        BadCase{"coupling_of_another_joint", "Fv: 7", "Fvm: 7", "scenario.yaml:3: key 'parameters[1].Fvm'", "unknown"},
        BadCase{"a_link_too_few", "  - {MY: -0.01, M: 0.5, Ia: 0.05, Fv: 1.4, Fs: 3}\n", "", "key 'parameters'",
                "has 5 entries; expected a list of 6"},
        BadCase{"gain_zero", "32.4", "0", "scenario.yaml:12: key 'gains.values[2]'", "other than 0"},
        BadCase{"gains_too_few", "[33.9, ", "[", "scenario.yaml:12: key 'gains.values'", "5 values"},
        BadCase{"a_priori_but_known", "6.79]}", "6.79], a_priori: [1, 1, 1, 1, 1, 1]}", "key 'gains.a_priori'",
                "mode: identify"},
        BadCase{"bad_side", "signal_side: motor", "signal_side: drive", "scenario.yaml:14: key 'signal_side'", "joint"},
        BadCase{"noise_negative", "signal_percent: 10", "signal_percent: -10", "scenario.yaml:16: key 'noise'",
                "signal_percent[0] = -10"},
        BadCase{"two_encoders", "encoder_counts: 4096", "encoder_counts: 4096, position_step: 1e-5", "key 'noise'",
                "only one"},
        BadCase{"payload_known_twice", "[M, MZ]", "[M, M]", "key 'payloads.weight.known'", "twice"},
        BadCase{"payload_unknown_name", "[M, MZ]", "[M, IZ]", "key 'payloads.weight.known[2]'", "not known"},
        BadCase{"payload_missing", "payload: weight", "payload: wait", "scenario.yaml:27: key 'recordings[2].payload'",
                "weight"},
        BadCase{"limits_negative", "jerk: 800", "jerk: -800", "scenario.yaml:24: key 'recordings[1].trajectory'",
                "limits.jerk[0] = -800"},
        BadCase{"limits_turned_round", "lower: -1.5", "lower: 1.6", "key 'recordings[1].trajectory'", "limits.lower"},
        BadCase{"no_seed", "name: free, seed: 1", "name: free", "key 'recordings[1].seed': missing", "integer"},
        BadCase{"seed_not_integer", "seed: 2", "seed: 2.5", "key 'recordings[2].seed'", "integer"},
        BadCase{"name_not_a_file", "name: load", "name: ../load", "key 'recordings[2].name'", "letters"},
        BadCase{"name_twice", "name: load", "name: free", "key 'recordings[2].name'", "twice"},
        BadCase{"trajectory_type", "type: fourier", "type: spline", "key 'recordings[2].trajectory.type'", "fourier"},
        BadCase{"key_of_another_type", "blend: 1", "dwell: 1", "key 'recordings[2].trajectory.dwell'", "unknown"},
        BadCase{"one_point", "random: 8", "random: 1", "key 'recordings[1].trajectory'", "at least 2"},
        BadCase{"blend_too_long", "blend: 1", "blend: 3", "key 'recordings[2].trajectory'", "half the duration"},
        BadCase{"bad_motion_seed", "seed: 2", "motion_seed: -1\n    seed: 2", "key 'recordings[2].motion_seed'", "0"},
        BadCase{"one_sample", "duration: 2.5", "duration: 0.001", "key 'recordings[2]'", "1 samples"},
        BadCase{"not_yaml", "rate: 200", "rate: [200", "scenario.yaml:", "not valid YAML"}),
    [](const ::testing::TestParamInfo<BadCase>& case_info) { return case_info.param.name; });

// In memory as through the files, for known gains and for gains to be identified.
TEST_F(ScenarioFile, StudyOfIsTheStudyThatIsWritten) {
  const std::string known(kScenario);
  const std::string gains = "gains: {values: [33.9, 32.4, 24.2, -9.21, 16.3, 6.79]";
  for (const std::string& text : {known, Replaced(known, gains, gains + ", mode: identify, a_priori: 20"),
                                  Replaced(known, gains, gains + ", mode: identify")}) {
    const Scenario scenario = Read(text.find("a_priori: 20") == std::string::npos
                                       ? text
                                       : Replaced(text, "a_priori: 20", "a_priori: [30, 30, 20, -9, 16, 6]"));
    const Study written = RenderAndReadStudy(scenario);
    const Study study = StudyOf(scenario);
    ASSERT_EQ(study.recordings.size(), written.recordings.size());
    for (size_t r = 0; r < study.recordings.size(); ++r) {
      EXPECT_EQ(study.recordings[r].name, written.recordings[r].name);
      EXPECT_EQ(study.recordings[r].use, written.recordings[r].use);
      EXPECT_EQ(study.recordings[r].payload, written.recordings[r].payload);
    }
    ASSERT_EQ(study.payloads.size(), written.payloads.size());
    EXPECT_EQ(study.payloads[0].name, written.payloads[0].name);
    EXPECT_EQ(study.payloads[0].known, written.payloads[0].known);
    EXPECT_EQ(study.gains_mode, written.gains_mode);
    ASSERT_EQ(study.gains.size(), written.gains.size());
    EXPECT_EQ(study.gains, written.gains);
    EXPECT_EQ(study.position_side, written.position_side);
    EXPECT_EQ(study.signal_side, written.signal_side);
    EXPECT_EQ(study.robot.transmission, written.robot.transmission);
  }
}

TEST_F(ScenarioFile, MotionSeedMovesAlikeUnderAnotherNoise) {
  const Scenario scenario = Read(Replaced(
      kScenario, "recordings:\n",
      "recordings:\n  - {name: again, seed: 7, motion_seed: 1, trajectory: {type: point_to_point, random: 8}}\n"));
  const Truth again = SimulateTruth(scenario, scenario.recordings[0]);
  const Truth free = SimulateTruth(scenario, scenario.recordings[1]);
  EXPECT_EQ(again.q, free.q);
  const Recording log_again = SimulateLog(scenario, scenario.recordings[0], again);
  const Recording log_free = SimulateLog(scenario, scenario.recordings[1], free);
  EXPECT_NE(log_again.signal, log_free.signal);
}

TEST_F(ScenarioFile, ProgramWithoutOutputOrWithTwoScenariosSaysWhatItExpects) {
  const std::string path = Write("scenario.yaml", kScenario);
  for (const std::string& arguments : {path, path + " " + path + " --output=" + (folder_ / "out").string(),
                                       std::string("/nowhere.yaml --output=") + (folder_ / "out").string()}) {
    const int status =
        std::system((std::string(IDIM_APPS_DIR) + "/idim_simulate " + arguments + " 2>/dev/null").c_str());
    EXPECT_EQ(WEXITSTATUS(status), 1) << arguments;
    EXPECT_FALSE(fs::exists(folder_ / "out"));
  }
  const int status = std::system(
      (std::string(IDIM_APPS_DIR) + "/idim_simulate " + path + " --output=" + (folder_ / "out").string()).c_str());
  EXPECT_EQ(WEXITSTATUS(status), 0);
  EXPECT_TRUE(fs::exists(folder_ / "out/truth.json"));
}

}  // namespace
}  // namespace idim::scenario_test
