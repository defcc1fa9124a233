// The studies of datasets/ on the public recordings themselves, and the script that fetches these.

#include <gmock/gmock.h>
#include <sys/wait.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <iostream>

#include "core/base/file.h"
#include "core/recording/study.h"
#include "tests/support/shared_recordings.h"
#include "tests/support/temp_folder.h"

namespace idim::public_recordings_test {
namespace {

using ::testing::HasSubstr;

constexpr char kDatasets[] = IDIM_SOURCE_DIR "/datasets/";

// The numbers of one line of a CSV file, by the plainest means: the independent route of these tests.
std::vector<double> LineOf(const std::string& path, int line) {
  std::ifstream file(path);
  std::string text;
  for (int i = 0; i < line; ++i) std::getline(file, text);
  std::replace(text.begin(), text.end(), ',', ' ');
  std::istringstream words(text);
  std::vector<double> numbers;
  for (double x = 0.0; words >> x;) numbers.push_back(x);
  return numbers;
}

TEST(PublicRecordings, Tx40) {
  const std::string position_file = FindPublicRecording("tx40/motor_position.csv");
  IDIM_SKIP_WITHOUT("tx40/motor_position.csv");
  IDIM_SKIP_WITHOUT("tx40/motor_torque.csv");
  const Result<Study> study = ReadStudy(std::string(kDatasets) + "tx40/study.yaml");
  ASSERT_TRUE(study.ok()) << study.status().message();
  EXPECT_EQ(*study->preprocessing.cutoff_hz, 100.0);
  EXPECT_EQ(*study->preprocessing.decimation, 50);
  ASSERT_EQ(study->recordings.size(), 1u);
  const auto start = std::chrono::steady_clock::now();
  const Result<Recording> recording = ReadRecording(*study, study->recordings[0]);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  ASSERT_TRUE(recording.ok()) << recording.status().message();
  RecordProperty("seconds", std::to_string(seconds));
  std::cout << "45000 x 12 numbers read in " << seconds << " s\n";
  EXPECT_EQ(recording->name, "tx40");
  ASSERT_EQ(recording->samples(), 45000);
  EXPECT_DOUBLE_EQ(recording->t[44999], 44999 / 5000.0);
  // Back to the motors by eq. (24), written out: a diagonal, and motor 6 turning with joint 5 too.
  const std::vector<double> diagonal = {32, 32, 45, -48, 45, 32};
  for (const int k : {0, 1, 20000, 44999}) {
    const std::vector<double> motor = LineOf(position_file, k + 2);
    const std::vector<double> torque = LineOf(FindPublicRecording("tx40/motor_torque.csv"), k + 2);
    ASSERT_EQ(motor.size(), 6u);
    for (int j = 0; j < 6; ++j) {
      const double expected = diagonal[j] * recording->q(k, j) + (j == 5 ? 32 * recording->q(k, 4) : 0.0);
      EXPECT_NEAR(motor[j], expected, 1e-12) << "row " << k << " joint " << j + 1;
      EXPECT_EQ(recording->signal(k, j), torque[j]);
    }
    // tau = T' tau_m: joint 5 carries motor 6 as well.
    const Eigen::MatrixXd tau =
        DriveMap(study->robot, study->signal_side).Torque(study->gains, recording->signal.row(k));
    EXPECT_NEAR(tau(0, 4), 45 * torque[4] + 32 * torque[5], 1e-12);
    EXPECT_NEAR(tau(0, 3), -48 * torque[3], 1e-12);
  }
}

TEST(PublicRecordings, Tx40SplitIsCutFromTheWhole) {
  IDIM_SKIP_WITHOUT("tx40/motor_position.csv");
  IDIM_SKIP_WITHOUT("tx40/motor_torque.csv");
  const Result<Study> whole_study = ReadStudy(std::string(kDatasets) + "tx40/study.yaml");
  const Result<Study> study = ReadStudy(std::string(kDatasets) + "tx40/study_split.yaml");
  ASSERT_TRUE(study.ok()) << study.status().message();
  ASSERT_EQ(study->recordings.size(), 2u);
  EXPECT_EQ(study->recordings[0].use, Use::kIdentification);
  EXPECT_EQ(study->recordings[1].use, Use::kValidation);
  const Result<Recording> whole = ReadRecording(*whole_study, whole_study->recordings[0]);
  const Result<Recording> first = ReadRecording(*study, study->recordings[0]);
  const Result<Recording> last = ReadRecording(*study, study->recordings[1]);
  ASSERT_TRUE(whole.ok() && first.ok() && last.ok());
  EXPECT_EQ(first->q, whole->q.topRows(24750));
  EXPECT_EQ(last->q, whole->q.bottomRows(15750));
  EXPECT_EQ(last->signal, whole->signal.bottomRows(15750));
  EXPECT_EQ(last->t, whole->t.tail(15750));
}

TEST(PublicRecordings, Ur10e) {
  IDIM_SKIP_WITHOUT("ur10e/free_14.csv");
  IDIM_SKIP_WITHOUT("ur10e/load_14.csv");
  IDIM_SKIP_WITHOUT("ur10e/free_12.csv");
  const Result<Study> study = ReadStudy(std::string(kDatasets) + "ur10e/study.yaml");
  ASSERT_TRUE(study.ok()) << study.status().message();
  EXPECT_EQ(study->gains_mode, GainsMode::kIdentify);
  const int samples[] = {5375, 5307, 4639};
  for (int i = 0; i < 3; ++i) {
    const RecordingEntry& entry = study->recordings[i];
    const Result<Recording> recording = ReadRecording(*study, entry);
    ASSERT_TRUE(recording.ok()) << recording.status().message();
    EXPECT_EQ(recording->samples(), samples[i]);
    EXPECT_EQ(entry.payload >= 0, entry.name == "load_14");
    EXPECT_EQ(entry.use == Use::kValidation, entry.name == "free_12");
    const Eigen::VectorXd steps = recording->t.tail(samples[i] - 1) - recording->t.head(samples[i] - 1);
    EXPECT_GT(steps.minCoeff(), 0.0015);
    EXPECT_LT(steps.maxCoeff(), 0.0345);
    const std::vector<double> line = LineOf(entry.q_file, 1000);
    ASSERT_EQ(line.size(), 19u);
    EXPECT_EQ(recording->t[998], line[0]);
    for (int j = 0; j < 6; ++j) {
      EXPECT_EQ(recording->q(998, j), line[1 + j]);
      EXPECT_EQ(recording->logged_dq(998, j), line[7 + j]);
      EXPECT_EQ(recording->signal(998, j), line[13 + j]);
    }
  }
}

struct ShellOutcome {
  int exit_code = -1;
  std::string output;
};

ShellOutcome Shell(const std::string& command) {
  ShellOutcome outcome;
  std::FILE* const pipe = ::popen((command + " 2>&1").c_str(), "r");
  if (pipe == nullptr) return outcome;
  char buffer[4096];
  while (std::fgets(buffer, sizeof(buffer), pipe) != nullptr) outcome.output += buffer;
  const int status = ::pclose(pipe);
  outcome.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return outcome;
}

ShellOutcome Fetch(const TempFolder& source, const TempFolder& target) {
  return Shell("IDIM_FETCH_BASE_URL=file://" + source.path() + " IDIM_DATA_DIR=" + target.path() + "/data bash " +
               IDIM_SOURCE_DIR "/scripts/fetch_recordings.sh");
}

// "owner/repository/commit/path" of a manifest entry: the path of a raw file at its source.
std::string RawPath(const YAML::Node& entry) {
  const std::string repository = entry["repository"].as<std::string>();
  return repository.substr(std::string("https://github.com/").size()) + "/" + entry["commit"].as<std::string>() + "/" +
         entry["source"].as<std::string>();
}

TEST(FetchRecordings, GetsChecksAndKeepsWhatTheManifestNames) {
  if (Shell("command -v curl").exit_code != 0) GTEST_SKIP() << "skipped: no curl";
  const YAML::Node manifest = YAML::LoadFile(std::string(kDatasets) + "manifest.yaml")["recordings"];
  ASSERT_EQ(manifest.size(), 5u);
  const TempFolder source;
  const TempFolder target;
  for (const YAML::Node& entry : manifest) {
    const std::string file = entry["file"].as<std::string>();
    IDIM_SKIP_WITHOUT(file);
    std::string content = *ReadFile(FindPublicRecording(file));
    if (entry["derived"].IsDefined()) {  // the source has no header and twelve columns more
      std::istringstream lines(content.substr(content.find('\n') + 1));
      content.clear();
      for (std::string line; std::getline(lines, line);) content += line + ",1,2,3,4,5,6,7,8,9,10,11,12\n";
    }
    source.Write(RawPath(entry), content);
  }
  ShellOutcome outcome = Fetch(source, target);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
  for (const YAML::Node& entry : manifest) {
    const std::string file = entry["file"].as<std::string>();
    EXPECT_THAT(outcome.output, HasSubstr(file + ": fetched"));
    const Result<std::string> fetched = ReadFile(target / ("data/" + file));
    ASSERT_TRUE(fetched.ok()) << fetched.status().message();
    EXPECT_TRUE(*fetched == *ReadFile(FindPublicRecording(file))) << file;
    EXPECT_THAT(Shell("sha256sum " + target.path() + "/data/" + file).output,
                HasSubstr(entry["sha256"].as<std::string>()));
  }
  // Again: nothing to do, the source may be gone; but a file that was damaged here is fetched anew.
  std::filesystem::rename(source / "thanhndv212", source / "gone");
  outcome = Fetch(source, target);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
  EXPECT_THAT(outcome.output, HasSubstr("tx40/motor_position.csv: there already"));
  std::ofstream(target / "data/tx40/motor_position.csv", std::ios::app) << "x";
  EXPECT_EQ(Fetch(source, target).exit_code, 1);
}

TEST(FetchRecordings, RefusesACorruptedFile) {
  if (Shell("command -v curl").exit_code != 0) GTEST_SKIP() << "skipped: no curl";
  const YAML::Node first = YAML::LoadFile(std::string(kDatasets) + "manifest.yaml")["recordings"][0];
  const TempFolder source;
  const TempFolder target;
  source.Write(RawPath(first), "Joint_1\n1\n");
  const ShellOutcome outcome = Fetch(source, target);
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.output, HasSubstr("tx40/motor_position.csv: SHA-256 is "));
  EXPECT_THAT(outcome.output, HasSubstr("expected " + first["sha256"].as<std::string>()));
  EXPECT_FALSE(std::filesystem::exists(target / "data"));
}

TEST(FetchRecordings, SaysWhenTheSourceIsNotThere) {
  if (Shell("command -v curl").exit_code != 0) GTEST_SKIP() << "skipped: no curl";
  const TempFolder source;
  const TempFolder target;
  const ShellOutcome outcome = Fetch(source, target);
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.output, HasSubstr("tx40/motor_position.csv: cannot be fetched from file://"));
  EXPECT_FALSE(std::filesystem::exists(target / "data"));
}

}  // namespace
}  // namespace idim::public_recordings_test
