// Whatever the bytes are: a result that satisfies its own promises, or a refusal with a message; never a crash.

#include <gtest/gtest.h>

#include <random>

#include "core/robot/robot_reader.h"
#include "tests/recording/study_fixture.h"

namespace idim::corrupted_input_test {
namespace {

// Every prefix of a text, and 500 copies with one to three bytes replaced by ones that mean something to a parser.
std::vector<std::string> Corrupted(const std::string& text) {
  std::vector<std::string> variants;
  for (size_t size = 0; size < text.size(); ++size) variants.push_back(text.substr(0, size));
  std::mt19937 generator(4);
  constexpr char kBytes[] = "\0\n\r\t \",.:-+[]{}#&*!|>%@'<>/=0123456789aeinftxq\xff\xc3";
  const std::string bytes(kBytes, sizeof(kBytes) - 1);
  for (int i = 0; i < 500; ++i) {
    std::string variant = text;
    for (unsigned k = 0; k <= generator() % 3; ++k)
      variant[generator() % text.size()] = bytes[generator() % bytes.size()];
    variants.push_back(std::move(variant));
  }
  return variants;
}

template <typename T>
void ExpectRefusal(const Result<T>& result, const std::string& path, const std::string& text) {
  EXPECT_EQ(result.status().code(), StatusCode::kBadInput);
  EXPECT_EQ(result.status().message().compare(0, path.size(), path), 0) << result.status().message() << "\n" << text;
}

TEST(CorruptedInput, Recording) {
  const StudyFolder files;
  const Result<Study> study = ReadStudy(files.study_path());
  ASSERT_TRUE(study.ok());
  int read = 0;
  int refused = 0;
  for (const std::string& text : Corrupted(kPlainCsv)) {
    files.folder().Write("a.csv", text);
    const Result<Recording> recording = ReadRecording(*study, study->recordings[0]);
    if (!recording.ok()) {
      ExpectRefusal(recording, files.folder() / "a.csv", text);
      ++refused;
      continue;
    }
    ++read;
    ASSERT_GE(recording->samples(), 2);
    EXPECT_EQ(recording->q.rows(), recording->samples());
    EXPECT_EQ(recording->signal.rows(), recording->samples());
    EXPECT_TRUE(recording->q.allFinite() && recording->signal.allFinite()) << text;
    const int n = recording->samples();
    EXPECT_TRUE(((recording->t.tail(n - 1) - recording->t.head(n - 1)).array() > 0.0).all()) << text;
  }
  EXPECT_GT(read, 10);      // a digit for a digit
  EXPECT_GT(refused, 300);  // most of the rest
}

TEST(CorruptedInput, Study) {
  const std::string text = std::string(kPlainStudy) +
                           "payloads: {p: {M: 1}}\ngains: {mode: identify, values: [1, 2]}\nfriction: [viscous]\n"
                           "columns: {q1: {column: 2, scale: 1}}\nnoise: {position: [1, 1]}\n"
                           "preprocessing: {cutoff_hz: 10, decimation: 2}\n";
  const StudyFolder files(text);
  ASSERT_TRUE(ReadStudy(files.study_path()).ok());
  int refused = 0;
  for (const std::string& variant : Corrupted(text)) {
    files.folder().Write("study.yaml", variant);
    const Result<Study> study = ReadStudy(files.study_path());
    if (study.ok()) {
      EXPECT_FALSE(study->recordings.empty());
      EXPECT_TRUE(study->gains.allFinite());
    } else {
      ExpectRefusal(study, files.folder().path(), variant);
      ++refused;
    }
  }
  EXPECT_GT(refused, 300);
}

TEST(CorruptedInput, Robot) {
  const std::string text =
      std::string(kTwoJoints) + kTwoCoupledMotors + "gravity: [0, 0, -9.81]\ncouplings: [{motor: 2, joints: [1, 2]}]\n";
  const TempFolder folder;
  ASSERT_TRUE(ReadRobot(folder.Write("robot.yaml", text)).ok());
  int refused = 0;
  for (const std::string& variant : Corrupted(text)) {
    const Result<Robot> robot = ReadRobot(folder.Write("robot.yaml", variant));
    if (robot.ok()) {
      EXPECT_GE(robot->dof(), 1);
      EXPECT_EQ(robot->transmission.rows(), robot->dof());
      EXPECT_TRUE(robot->transmission.allFinite() && robot->gravity.allFinite());
    } else {
      ExpectRefusal(robot, folder / "robot.yaml", variant);
      ++refused;
    }
  }
  EXPECT_GT(refused, 300);
}

TEST(CorruptedInput, Urdf) {
  const std::string text =
      "<robot name=\"r\"><link name=\"a\"/><link name=\"b\"><inertial><origin xyz=\"1 2 3\"/><mass value=\"1\"/>"
      "<inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" izz=\"1\"/></inertial></link>"
      "<joint name=\"j\" type=\"continuous\"><parent link=\"a\"/><child link=\"b\"/><axis xyz=\"0 1 0\"/>"
      "<origin xyz=\"1 0 0\" rpy=\"0 0.1 0\"/></joint></robot>";
  const TempFolder folder;
  ASSERT_TRUE(ReadUrdf(folder.Write("arm.urdf", text)).ok());
  int refused = 0;
  for (const std::string& variant : Corrupted(text)) {
    const Result<Robot> robot = ReadUrdf(folder.Write("arm.urdf", variant));
    if (robot.ok()) {
      EXPECT_EQ(robot->dof(), 1);
      EXPECT_TRUE(robot->joints[0].rotation.allFinite() && robot->joints[0].translation.allFinite()) << variant;
      EXPECT_TRUE(robot->declared_inertials[0].allFinite()) << variant;
    } else {
      ExpectRefusal(robot, folder / "arm.urdf", variant);
      ++refused;
    }
  }
  EXPECT_GT(refused, 300);
}

}  // namespace
}  // namespace idim::corrupted_input_test
