#include <gmock/gmock.h>
#include <stdlib.h>

#include "core/effects/placed_effects.h"
#include "core/recording/data_path.h"
#include "core/recording/study.h"
#include "tests/recording/study_fixture.h"

namespace idim::study_reader_test {
namespace {

using ::testing::HasSubstr;

TEST(ReadStudy, DefaultsOfThePlainestStudy) {
  const StudyFolder files("robot: robot.yaml\nrecordings: [{file: a.csv}]\n");
  const Result<Study> study = ReadStudy(files.study_path());
  ASSERT_TRUE(study.ok()) << study.status().message();
  EXPECT_EQ(study->path, files.study_path());
  EXPECT_EQ(study->robot.dof(), 2);
  ASSERT_EQ(study->recordings.size(), 1u);
  EXPECT_EQ(study->recordings[0].name, "a");
  EXPECT_EQ(study->recordings[0].use, Use::kIdentification);
  EXPECT_EQ(study->recordings[0].payload, -1);
  EXPECT_EQ(study->recordings[0].q_file, files.folder() / "a.csv");
  EXPECT_EQ(study->recordings[0].signal_file, files.folder() / "a.csv");
  EXPECT_FALSE(study->recordings[0].rows.has_value());
  EXPECT_EQ(study->gains_mode, GainsMode::kKnown);
  EXPECT_EQ(study->gains, Eigen::VectorXd::Ones(2));
  EXPECT_TRUE(study->friction.viscous && study->friction.coulomb && study->friction.offset);
  EXPECT_EQ(study->position_side, Side::kJoint);
  EXPECT_EQ(study->signal_side, Side::kJoint);
  EXPECT_TRUE(study->columns.empty());
  EXPECT_FALSE(study->sample_rate.has_value());
  EXPECT_EQ(study->position_noise.size(), 0);
  EXPECT_EQ(study->signal_noise.size(), 0);
  EXPECT_FALSE(study->preprocessing.cutoff_hz.has_value());
  EXPECT_FALSE(study->preprocessing.decimation.has_value());
}

TEST(ReadStudy, EveryKey) {
  const StudyFolder files(
      "robot: robot.yaml\n"
      "recordings:\n"
      "  - {file: a.csv, name: free, use: identification, rows: [0, 2]}\n"
      "  - {file: a.csv, name: load, payload: calibrated, use: validation}\n"
      "  - {files: {q: a.csv, v: sub/b.csv, dq: sub/b.csv}, name: split, payload: unknown}\n"
      "payloads:\n"
      "  unknown:\n"
      "  calibrated: {M: 4.59, MX: -0.1, ZZ: 0}\n"
      "gains: {mode: identify, values: [32.96, -11.52]}\n"
      "friction: [offset, viscous]\n"
      "effects: []\n"
      "position_side: motor\n"
      "signal_side: motor\n"
      "columns:\n"
      "  t: {column: 1, scale: 0.001}\n"
      "  q1: {column: Joint_1, scale: 2.0, offset: -0.5}\n"
      "  v1: {column: \"3\"}\n"
      "sample_rate: 5000\n"
      "noise: {position: [1e-5, 2e-5], signal: [0.1, 0.2]}\n"
      "preprocessing: {cutoff_hz: 100, decimation: 50}\n");
  files.folder().Write("sub/b.csv", kPlainCsv);
  const Result<Study> study = ReadStudy(files.study_path());
  ASSERT_TRUE(study.ok()) << study.status().message();
  ASSERT_EQ(study->recordings.size(), 3u);
  EXPECT_EQ(study->recordings[0].rows, std::make_pair(0, 2));
  EXPECT_EQ(study->recordings[1].use, Use::kValidation);
  EXPECT_EQ(study->payloads[study->recordings[1].payload].name, "calibrated");
  EXPECT_EQ(study->payloads[study->recordings[2].payload].name, "unknown");
  EXPECT_EQ(study->recordings[2].q_file, files.folder() / "a.csv");
  EXPECT_EQ(study->recordings[2].signal_file, files.folder() / "sub/b.csv");
  EXPECT_EQ(study->recordings[2].dq_file, files.folder() / "sub/b.csv");
  EXPECT_EQ(study->recordings[2].ddq_file, "");
  const auto& known = study->payloads[study->recordings[1].payload].known;
  for (int i = 0; i < kNumInertial; ++i) EXPECT_EQ(known[i].has_value(), i == kM || i == kMX || i == kZZ);
  EXPECT_EQ(*known[kM], 4.59);
  EXPECT_EQ(*known[kMX], -0.1);
  EXPECT_EQ(study->gains_mode, GainsMode::kIdentify);
  EXPECT_EQ(study->gains, Eigen::Vector2d(32.96, -11.52));
  EXPECT_TRUE(study->friction.viscous && study->friction.offset);
  EXPECT_FALSE(study->friction.coulomb);
  EXPECT_EQ(study->position_side, Side::kMotor);
  EXPECT_EQ(study->signal_side, Side::kMotor);
  ASSERT_EQ(study->columns.size(), 3u);
  EXPECT_EQ(study->columns[0].first, "t");
  EXPECT_EQ(study->columns[0].second.number, 1);
  EXPECT_EQ(study->columns[0].second.scale, 0.001);
  EXPECT_EQ(study->columns[1].second.header, "Joint_1");
  EXPECT_EQ(study->columns[1].second.offset, -0.5);
  EXPECT_EQ(study->columns[2].second.header, "3");  // quoted: a name
  EXPECT_EQ(*study->sample_rate, 5000.0);
  EXPECT_EQ(study->position_noise, Eigen::Vector2d(1e-5, 2e-5));
  EXPECT_EQ(study->signal_noise, Eigen::Vector2d(0.1, 0.2));
  EXPECT_EQ(*study->preprocessing.cutoff_hz, 100.0);
  EXPECT_EQ(*study->preprocessing.decimation, 50);
}

TEST(ReadStudy, EffectsHaveAPlaceEach) {
  const StudyFolder files(
      "robot: robot.yaml\n"
      "recordings: [{file: a.csv}]\n"
      "effects:\n"
      "  - {id: presliding, joints: [2, 1], shape: {x_s: 0.001}}\n"
      "  - {id: motor_coupling, joints: [2, 1]}\n"
      "  - {id: base_tilt}\n"
      "  - {id: payload_change, joints: []}\n");
  const Result<Study> study = ReadStudy(files.study_path());
  ASSERT_TRUE(study.ok()) << study.status().message();
  const struct {
    const char* id;
    std::vector<int> joints;
    size_t shapes;
  } expected[] = {{"presliding", {0}, 1},
                  {"presliding", {1}, 1},
                  {"motor_coupling", {0, 1}, 0},
                  {"base_tilt", {}, 0},
                  {"payload_change", {}, 0}};
  const Result<std::vector<PlacedEffect>> placed = PlaceDeclaredEffects(*study);
  ASSERT_TRUE(placed.ok()) << placed.status().message();
  ASSERT_EQ(placed->size(), std::size(expected));
  for (size_t k = 0; k < std::size(expected); ++k) {
    EXPECT_EQ((*placed)[k].effect, FindEffect(expected[k].id));
    EXPECT_EQ((*placed)[k].joints, expected[k].joints);
    ASSERT_EQ((*placed)[k].shape.size(), expected[k].shapes);
  }
  EXPECT_EQ((*placed)[1].shape[0].name, "x_s");
  EXPECT_EQ((*placed)[1].shape[0].value, 0.001);
  EXPECT_EQ((*placed)[1].shape[0].where, files.study_path() + ":4: key 'effects[1].shape.x_s'");
}

TEST(ReadStudy, GainsToIdentifyWithoutValuesHaveNone) {
  const StudyFolder files(std::string(kPlainStudy) + "gains: {mode: identify}\nfriction: []\n");
  const Result<Study> study = ReadStudy(files.study_path());
  ASSERT_TRUE(study.ok()) << study.status().message();
  EXPECT_EQ(study->gains.size(), 0);
  EXPECT_FALSE(study->friction.viscous || study->friction.coulomb || study->friction.offset);
}

// Sets an environment variable for the length of a test.
class ScopedVariable {
 public:
  ScopedVariable(const char* name, const std::string& value) : name_(name) {
    const char* const old = ::getenv(name);
    if (old != nullptr) old_ = old;
    ::setenv(name, value.c_str(), 1);
  }
  ~ScopedVariable() {
    if (old_) {
      ::setenv(name_, old_->c_str(), 1);
    } else {
      ::unsetenv(name_);
    }
  }

 private:
  const char* name_;
  std::optional<std::string> old_;
};

TEST(ReadStudy, RecordingsAreLookedForInDocumentedOrder) {
  const TempFolder root;
  root.Write("project/datasets/arm/robot.yaml", kTwoJoints);
  const std::string path =
      root.Write("project/datasets/arm/study.yaml", "robot: robot.yaml\nrecordings: [{file: arm/a.csv}]\n");
  const TempFolder data;
  const ScopedVariable variable("IDIM_DATA_DIR", data.path());

  const Result<Study> nowhere = ReadStudy(path);
  ASSERT_FALSE(nowhere.ok());
  EXPECT_EQ(nowhere.status().code(), StatusCode::kBadInput);
  for (const std::string& part :
       {path + ":2:", std::string("'recordings[1].file'"), std::string("'arm/a.csv'"),
        root / "project/datasets/arm/arm/a.csv", data / "arm/a.csv", root / "project/datasets/recordings/arm/a.csv",
        root / "shared/datasets/arm/a.csv", std::string("scripts/fetch_recordings.sh")}) {
    EXPECT_THAT(nowhere.status().message(), HasSubstr(part));
  }

  // Nothing is looked for in the root of the file system.
  EXPECT_THAT(nowhere.status().message(), ::testing::Not(HasSubstr(" /recordings/")));
  EXPECT_THAT(nowhere.status().message(), ::testing::Not(HasSubstr(" /shared/datasets/")));
  EXPECT_EQ(DataPathCandidates("/study.yaml", "a.csv"), (std::vector<std::string>{"/a.csv", data / "a.csv"}));

  // From the last place to the first: each new one wins.
  for (const std::string& place : {root / "shared/datasets/arm/a.csv", root / "project/datasets/recordings/arm/a.csv",
                                   data / "arm/a.csv", root / "project/datasets/arm/arm/a.csv"}) {
    std::filesystem::create_directories(std::filesystem::path(place).parent_path());
    std::ofstream(place) << kPlainCsv;
    const Result<Study> study = ReadStudy(path);
    ASSERT_TRUE(study.ok()) << study.status().message();
    EXPECT_EQ(study->recordings[0].q_file, place);
  }
}

struct BadStudy {
  const char* name;
  std::string text;
  std::vector<std::string> message;
};

void PrintTo(const BadStudy& test, std::ostream* out) { *out << test.name; }

class BadStudyTest : public ::testing::TestWithParam<BadStudy> {};

// What a program sees before it reads a recording.
Status ReadAndPlace(const std::string& path) {
  const Result<Study> study = ReadStudy(path);
  return study.ok() ? PlaceDeclaredEffects(*study).status() : study.status();
}

TEST_P(BadStudyTest, IsRefusedWithAClearMessage) {
  const StudyFolder files(GetParam().text);
  const Status status = ReadAndPlace(files.study_path());
  ASSERT_FALSE(status.ok());
  EXPECT_EQ(status.code(), StatusCode::kBadInput);
  EXPECT_EQ(status.exit_code(), 1);
  EXPECT_THAT(status.message(), HasSubstr("study.yaml:"));
  EXPECT_THAT(status.message(), HasSubstr("expected "));
  for (const std::string& part : GetParam().message) EXPECT_THAT(status.message(), HasSubstr(part));
}

std::string With(const std::string& lines) { return kPlainStudy + lines + "\n"; }
std::string WithRecording(const std::string& recording) { return With("  - " + recording); }

INSTANTIATE_TEST_SUITE_P(
    Table, BadStudyTest,
    ::testing::Values(
        BadStudy{"empty", "", {":1:", "empty"}}, BadStudy{"list", "[1, 2]\n", {"a list given", "a mapping"}},
        BadStudy{"not_yaml", "robot: [\n", {"not valid YAML"}},
        BadStudy{"unknown_key", With("preprocesing: {}"), {":4:", "'preprocesing'", "unknown key", "'preprocessing'"}},
        BadStudy{"no_robot", "recordings: [{file: a.csv}]\n", {"'robot'", "missing"}},
        BadStudy{"robot_file", "robot: rob.yaml\nrecordings: [{file: a.csv}]\n", {":1:", "'robot'", "no such file"}},
        BadStudy{"robot_list", "robot: [1]\nrecordings: [{file: a.csv}]\n", {"'robot'", "a list given"}},
        BadStudy{"no_recordings", "robot: robot.yaml\n", {"'recordings'", "missing"}},
        BadStudy{"empty_recordings", "robot: robot.yaml\nrecordings: []\n", {"'recordings'", "identification"}},
        BadStudy{"only_validation",
                 "robot: robot.yaml\nrecordings: [{file: a.csv, use: validation}]\n",
                 {"'recordings'", "use: identification"}},
        BadStudy{"missing_file",
                 WithRecording("{file: b.csv}"),
                 {":4:", "'recordings[2].file'", "no such file 'b.csv'", "looked for", "fetch_recordings.sh"}},
        BadStudy{"absolute_file", WithRecording("{file: /none/b.csv}"), {"looked for /none/b.csv;"}},
        BadStudy{"recording_key", WithRecording("{file: a.csv, nam: b}"), {":4:", "'recordings[2].nam'", "'name'"}},
        BadStudy{"same_name", WithRecording("{file: a.csv, name: a}"), {":4:", "'recordings[2].name'", "earlier"}},
        BadStudy{"same_default_name", WithRecording("{file: a.csv}"), {"'recordings[2].name'", "'a'"}},
        BadStudy{"use",
                 WithRecording("{file: a.csv, name: b, use: validate}"),
                 {"'recordings[2].use'", "'validate'", "identification, validation"}},
        BadStudy{"file_and_files",
                 WithRecording("{file: a.csv, files: {q: a.csv, v: a.csv}, name: b}"),
                 {"'recordings[2]'", "exactly one"}},
        BadStudy{"no_file", WithRecording("{name: b}"), {"'recordings[2]'", "neither"}},
        BadStudy{
            "files_without_v", WithRecording("{files: {q: a.csv}, name: b}"), {"'recordings[2].files.v'", "missing"}},
        BadStudy{"files_v_and_tau",
                 WithRecording("{files: {q: a.csv, v: a.csv, tau: a.csv}, name: b}"),
                 {"'v' and 'tau'", "one of them"}},
        BadStudy{
            "rows_order", WithRecording("{file: a.csv, name: b, rows: [5, 2]}"), {"'recordings[2].rows'", "[5, 2]"}},
        BadStudy{"rows_negative",
                 WithRecording("{file: a.csv, name: b, rows: [-1, 2]}"),
                 {"'recordings[2].rows[1]'", "-1 is out of range"}},
        BadStudy{"rows_count", WithRecording("{file: a.csv, name: b, rows: [1]}"), {"has 1 values"}},
        BadStudy{"no_payloads",
                 WithRecording("{file: a.csv, name: b, payload: x}"),
                 {"'recordings[2].payload'", "declares no payloads"}},
        BadStudy{"other_payload",
                 WithRecording("{file: a.csv, name: b, payload: x}\npayloads: {calibrated: {M: 1}}"),
                 {"'recordings[2].payload'", "'x'", "calibrated"}},
        BadStudy{"payload_key", With("payloads: {p: {m: 1}}"), {"'payloads.p.m'", "unknown key", "'M'"}},
        BadStudy{"payload_friction_key", With("payloads: {p: {Fv: 1}}"), {"'payloads.p.Fv'", "unknown key"}},
        BadStudy{"payload_mass_zero", With("payloads: {p: {M: 0}}"), {"'payloads.p.M'", "greater than 0"}},
        BadStudy{"payload_mass_negative", With("payloads: {p: {M: -2}}"), {"'payloads.p.M'", "-2 is not positive"}},
        BadStudy{"payload_inertia", With("payloads: {p: {XX: -1}}"), {"'payloads.p.XX'", "negative"}},
        BadStudy{"payload_twice", With("payloads: {p: {M: 1}, p: {M: 2}}"), {"'payloads.p'", "twice"}},
        BadStudy{"payload_list", With("payloads: [1]"), {"'payloads'", "mapping"}},
        BadStudy{"gains_mode", With("gains: {mode: fixed}"), {"'gains.mode'", "known, identify"}},
        BadStudy{"gains_length", With("gains: {values: [1, 2, 3]}"), {"'gains.values'", "has 3 values", "2 numbers"}},
        BadStudy{"gains_zero", With("gains: {values: [1, 0]}"), {"'gains.values'", "other than 0"}},
        BadStudy{"gains_text", With("gains: {values: [1, x]}"), {"'gains.values[2]'", "'x' is not a number"}},
        BadStudy{"gains_list", With("gains: [1, 2]"), {"'gains'", "a mapping"}},
        BadStudy{"friction", With("friction: [viscos]"), {"'friction[1]'", "'viscos'", "nearest: viscous"}},
        BadStudy{"friction_twice", With("friction: [coulomb, coulomb]"), {"'friction[2]'", "'coulomb' is given twice"}},
        BadStudy{"friction_scalar", With("friction: viscous"), {"'friction'", "a list"}},
        BadStudy{"effects_scalar", With("effects: stribeck"), {":4:", "'effects'", "a list"}},
        BadStudy{"effect_id",
                 With("effects:\n  - {id: stribek, joints: [2]}"),
                 {":5:", "'effects[1].id'", "stribeck", "backlash", "nearest: stribeck"}},
        BadStudy{"effect_without_id", With("effects: [{joints: [2]}]"), {"'effects[1].id'", "missing"}},
        BadStudy{"effect_of_the_friction",
                 With("effects: [{id: coulomb, joints: [2]}]"),
                 {"'effects[1].id'", "'coulomb'", "key 'friction'"}},
        BadStudy{"effect_key", With("effects: [{id: stribeck, joint: 2}]"), {"'effects[1].joint'", "unknown key"}},
        BadStudy{"effect_without_joints", With("effects: [{id: stribeck}]"), {"'effects[1].joints'", "missing"}},
        BadStudy{"effect_at_no_joint",
                 With("effects: [{id: stribeck, joints: []}]"),
                 {"'effects[1].joints'", "0 joints", "one or more"}},
        BadStudy{"effect_at_joint_3",
                 With("effects: [{id: stribeck, joints: [3]}]"),
                 {"'effects[1].joints[1]'", "out of range"}},
        BadStudy{"effect_of_the_arm_at_a_joint",
                 With("effects: [{id: base_tilt, joints: [1]}]"),
                 {"'effects[1].joints'", "whole arm", "no joints"}},
        BadStudy{"coupling_of_one_joint",
                 With("effects: [{id: motor_coupling, joints: [2]}]"),
                 {"'effects[1].joints'", "1 joints", "two"}},
        BadStudy{"coupling_with_itself",
                 With("effects: [{id: motor_coupling, joints: [2, 2]}]"),
                 {"'effects[1].joints'", "twice"}},
        BadStudy{"effect_twice",
                 With("effects: [{id: stribeck, joints: [1, 2]}, {id: stribeck, joints: [2]}]"),
                 {"'effects[2]'", "'stribeck' on joint 2 is given twice"}},
        BadStudy{"effect_of_the_arm_twice",
                 With("effects: [{id: base_tilt}, {id: base_tilt}]"),
                 {"'effects[2]'", "'base_tilt' is given twice"}},
        BadStudy{"shape_list",
                 With("effects: [{id: stribeck, joints: [1], shape: [0.1]}]"),
                 {"'effects[1].shape'", "not a mapping"}},
        BadStudy{"shape_text",
                 With("effects: [{id: stribeck, joints: [1], shape: {vs: slow}}]"),
                 {"'effects[1].shape.vs'", "'slow' is not a number"}},
        BadStudy{"shape_twice",
                 With("effects: [{id: stribeck, joints: [1], shape: {vs: 0.1, vs: 0.2}}]"),
                 {"'effects[1].shape.vs'", "twice"}},
        BadStudy{"position_side", With("position_side: link"), {"'position_side'", "joint, motor"}},
        BadStudy{"signal_side", With("signal_side: 3"), {"'signal_side'", "joint, motor"}},
        BadStudy{"column_of_joint_3", With("columns: {q3: {column: A}}"), {"'columns.q3'", "unknown key"}},
        BadStudy{"column_key", With("columns: {q1: {column: A, gain: 2}}"), {"'columns.q1.gain'", "unknown key"}},
        BadStudy{"column_missing", With("columns: {q1: {scale: 2}}"), {"'columns.q1.column'", "missing"}},
        BadStudy{"column_zero", With("columns: {q1: {column: 0}}"), {"'columns.q1.column'", "out of range"}},
        BadStudy{"column_scale_zero", With("columns: {q1: {column: 1, scale: 0}}"), {"'columns.q1.scale'"}},
        BadStudy{"column_scale_nan", With("columns: {q1: {column: 1, scale: .nan}}"), {"not finite"}},
        BadStudy{"columns_v_and_tau", With("columns: {v1: {column: 1}, tau1: {column: 2}}"), {"v and tau"}},
        BadStudy{"sample_rate", With("sample_rate: 0"), {":4:", "'sample_rate'", "greater than 0"}},
        BadStudy{"sample_rate_text", With("sample_rate: 5 kHz"), {"'5 kHz' is not a number"}},
        BadStudy{"noise_length", With("noise: {position: [1]}"), {"'noise.position'", "has 1 values"}},
        BadStudy{"noise_zero", With("noise: {signal: [1, 0]}"), {"'noise.signal'", "greater than 0"}},
        BadStudy{"noise_key", With("noise: {velocity: [1, 1]}"), {"'noise.velocity'", "unknown key"}},
        BadStudy{"cutoff", With("preprocessing: {cutoff_hz: -1}"), {"'preprocessing.cutoff_hz'", "greater than 0"}},
        BadStudy{"decimation_zero", With("preprocessing: {decimation: 0}"), {"'preprocessing.decimation'"}},
        BadStudy{"decimation_half",
                 With("preprocessing: {decimation: 2.5}"),
                 {"'preprocessing.decimation'", "not an integer"}}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(ReadStudy, ABadRobotIsNamedByItsOwnFile) {
  const StudyFolder files(kPlainStudy, kPlainCsv, std::string(kTwoJoints) + "gravty: [0, 0, 0]\n");
  const Result<Study> study = ReadStudy(files.study_path());
  ASSERT_FALSE(study.ok());
  EXPECT_THAT(study.status().message(), HasSubstr("robot.yaml:5: key 'gravty'"));
}

}  // namespace
}  // namespace idim::study_reader_test
