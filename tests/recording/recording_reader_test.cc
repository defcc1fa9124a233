#include <gmock/gmock.h>

#include <Eigen/LU>

#include "core/recording/study.h"
#include "tests/recording/study_fixture.h"

namespace idim::recording_reader_test {
namespace {

using ::testing::HasSubstr;

Eigen::MatrixXd Rows(std::initializer_list<std::initializer_list<double>> rows) {
  Eigen::MatrixXd matrix(rows.size(), rows.begin()->size());
  int i = 0;
  for (const auto& row : rows) {
    int j = 0;
    for (const double x : row) matrix(i, j++) = x;
    ++i;
  }
  return matrix;
}

TEST(ReadRecording, PlainFile) {
  const Result<Recording> recording = StudyFolder().ReadFirst();
  ASSERT_TRUE(recording.ok()) << recording.status().message();
  EXPECT_EQ(recording->name, "a");
  EXPECT_EQ(recording->samples(), 3);
  EXPECT_EQ(recording->dof(), 2);
  EXPECT_EQ(recording->t, Eigen::Vector3d(0.0, 0.1, 0.2));
  EXPECT_EQ(recording->q, Rows({{0.1, 0.2}, {0.2, 0.4}, {0.3, 0.8}}));
  EXPECT_EQ(recording->signal, Rows({{1.0, 2.0}, {1.5, 2.5}, {2.5, 3.5}}));
  EXPECT_EQ(recording->logged_dq.size(), 0);
  EXPECT_EQ(recording->logged_ddq.size(), 0);
  EXPECT_FALSE(recording->signal_is_torque);
}

// What is only a matter of spelling must not change a number.
TEST(ReadRecording, SpellingsOfTheSameFile) {
  const Result<Recording> plain = StudyFolder().ReadFirst();
  ASSERT_TRUE(plain.ok());
  const std::vector<std::string> spellings = {
      // no newline at the end; CRLF; byte-order mark and blanks; blank lines; quotes; another order and other columns
      "t,q1,q2,v1,v2\n0.0,0.1,0.2,1.0,2.0\n0.1,0.2,0.4,1.5,2.5\n0.2,0.3,0.8,2.5,3.5",
      "t,q1,q2,v1,v2\r\n0.0,0.1,0.2,1.0,2.0\r\n0.1,0.2,0.4,1.5,2.5\r\n0.2,0.3,0.8,2.5,3.5\r\n",
      "\xEF\xBB\xBFt, q1 , q2,v1,v2\n0,1e-1, 0.2,+1,2\n0.1,2E-1,0.4,1.5,2.5 \n.2,0.3,0.8,2.5,3.5\n",
      "\nt,q1,q2,v1,v2\n\n0.0,0.1,0.2,1.0,2.0\n0.1,0.2,0.4,1.5,2.5\n0.2,0.3,0.8,2.5,3.5\n\n  \n",
      "\"t\",\"q1\",q2,v1,v2\n0.0,\"0.1\",0.2,1.0,2.0\n0.1,0.2,0.4,1.5,2.5\n0.2,0.3,0.8,2.5,3.5\n",
      "v2,mode,q2,q1,t,v1\n2,auto,.2,.1,0,1\n2.5,,.4,.2,.1,1.5\n3.5,nan,.8,.3,.2,2.5\n",
  };
  for (const std::string& csv : spellings) {
    const Result<Recording> recording = StudyFolder(kPlainStudy, csv).ReadFirst();
    ASSERT_TRUE(recording.ok()) << recording.status().message() << "\n" << csv;
    EXPECT_EQ(recording->t, plain->t) << csv;
    EXPECT_EQ(recording->q, plain->q) << csv;
    EXPECT_EQ(recording->signal, plain->signal) << csv;
  }
}

TEST(ReadRecording, ManyRowsCrossTheChunksOfTheReader) {
  std::string csv = "t,q1,q2,v1,v2\n";
  constexpr int kRows = 20000;
  for (int k = 0; k < kRows; ++k) {
    csv += std::to_string(k) + ",0." + std::to_string(k) + ",2,3," + std::to_string(-k) + "\n";
  }
  const Result<Recording> recording = StudyFolder(kPlainStudy, csv).ReadFirst();
  ASSERT_TRUE(recording.ok()) << recording.status().message();
  ASSERT_EQ(recording->samples(), kRows);
  for (int k = 0; k < kRows; ++k) {
    ASSERT_EQ(recording->t[k], k);
    ASSERT_EQ(recording->q(k, 0), std::stod("0." + std::to_string(k)));
    ASSERT_EQ(recording->signal(k, 1), -k);
  }
}

TEST(ReadRecording, LoggedVelocityAndAcceleration) {
  const Result<Recording> recording =
      StudyFolder(kPlainStudy, "t,q1,q2,dq1,dq2,ddq1,ddq2,v1,v2\n0,1,2,3,4,5,6,7,8\n1,1,2,-3,-4,-5,-6,7,8\n")
          .ReadFirst();
  ASSERT_TRUE(recording.ok()) << recording.status().message();
  EXPECT_EQ(recording->logged_dq, Rows({{3, 4}, {-3, -4}}));
  EXPECT_EQ(recording->logged_ddq, Rows({{5, 6}, {-5, -6}}));
}

TEST(ReadRecording, NoHeaderAndColumnsByNumber) {
  const std::string study = std::string(kPlainStudy) +
                            "sample_rate: 100\n"
                            "columns:\n"
                            "  q1: {column: 4, scale: 2, offset: 1}\n"
                            "  q2: {column: 3}\n"
                            "  v1: {column: 1}\n"
                            "  v2: {column: 2, scale: -1}\n";
  // The same numbers with and without a header: the first line is data only where it is numbers.
  for (const std::string& header : {std::string(), std::string("a,b,c,d,e\n")}) {
    const Result<Recording> recording = StudyFolder(study, header + "1,2,3,4,x\n5,6,7,8,y\n9,10,11,12,z\n").ReadFirst();
    if (header.empty()) {
      // A column that is not read may hold text, in the first line too.
      ASSERT_TRUE(recording.ok()) << recording.status().message();
    }
    ASSERT_TRUE(recording.ok()) << recording.status().message();
    ASSERT_EQ(recording->samples(), 3);
    EXPECT_EQ(recording->t, Eigen::Vector3d(0.0, 0.01, 0.02));
    EXPECT_EQ(recording->q, Rows({{9, 3}, {17, 7}, {25, 11}}));
    EXPECT_EQ(recording->signal, Rows({{1, -2}, {5, -6}, {9, -10}}));
  }
}

TEST(ReadRecording, SeparateFilesWithTheSameForeignHeaderAndRows) {
  const StudyFolder files(
      "robot: robot.yaml\n"
      "recordings: [{files: {q: q.csv, v: v.csv, dq: dq.csv}, name: cut, rows: [1, 3]}]\n"
      "columns: {q1: {column: J1}, q2: {column: J2}, v1: {column: J1}, v2: {column: J2}}\n"
      "sample_rate: 10\n");
  files.folder().Write("q.csv", "J1,J2\n1,2\n3,4\n5,6\n7,8\n");
  files.folder().Write("v.csv", "J1,J2\n10,20\n30,40\n50,60\n70,80\n");
  files.folder().Write("dq.csv", "dq1,dq2\n.1,.2\n.3,.4\n.5,.6\n.7,.8\n");
  const Result<Recording> recording = files.ReadFirst();
  ASSERT_TRUE(recording.ok()) << recording.status().message();
  EXPECT_EQ(recording->t, Eigen::Vector2d(0.1, 0.2));  // of the file's rows 1 and 2
  EXPECT_EQ(recording->q, Rows({{3, 4}, {5, 6}}));
  EXPECT_EQ(recording->signal, Rows({{30, 40}, {50, 60}}));
  EXPECT_EQ(recording->logged_dq, Rows({{.3, .4}, {.5, .6}}));
}

TEST(ReadRecording, MotorPositionsGoThroughTheTransmission) {
  const std::string csv = "t,q1,q2,dq1,dq2,ddq1,ddq2,v1,v2\n0,10,-16,20,8,1,2,7,8\n1,0,20,3,5,4,6,9,10\n";
  const StudyFolder files(std::string(kPlainStudy) + "position_side: motor\n", csv,
                          std::string(kTwoJoints) + kTwoCoupledMotors);
  const Result<Study> study = ReadStudy(files.study_path());
  ASSERT_TRUE(study.ok());
  const Result<Recording> recording = files.ReadFirst();
  ASSERT_TRUE(recording.ok()) << recording.status().message();
  // motor 1 = 10 q1, motor 2 = 4 q1 - 20 q2, solved by hand for q: (10, -16) -> (1, 1), (0, 20) -> (0, -1).
  EXPECT_LT((recording->q - Rows({{1, 1}, {0, -1}})).norm(), 1e-14);
  const Eigen::MatrixXd back = study->robot.transmission * recording->logged_dq.transpose();
  EXPECT_LT((back.transpose() - Rows({{20, 8}, {3, 5}})).norm(), 1e-13);
  const Eigen::MatrixXd back2 = study->robot.transmission * recording->logged_ddq.transpose();
  EXPECT_LT((back2.transpose() - Rows({{1, 2}, {4, 6}})).norm(), 1e-13);
  EXPECT_EQ(recording->signal, Rows({{7, 8}, {9, 10}}));  // its side is another key's business
}

TEST(DriveMap, PowerIsTheSameOnBothSides) {
  const StudyFolder files(std::string(kPlainStudy) + "signal_side: motor\n", kPlainCsv,
                          std::string(kTwoJoints) + kTwoCoupledMotors);
  Result<Study> study = ReadStudy(files.study_path());
  ASSERT_TRUE(study.ok());
  const Eigen::Vector2d gains(2.0, -3.0);
  const Eigen::MatrixXd signal = Rows({{0.3, 0.7}, {-1.2, 0.4}, {2.0, 5.0}});
  const Eigen::MatrixXd torque = DriveMap(study->robot, study->signal_side).Torque(gains, signal);
  const Eigen::Vector2d dq(0.6, -1.7);
  const Eigen::Vector2d motor_velocity = study->robot.transmission * dq;
  for (int k = 0; k < 3; ++k) {
    const double motor_power =
        gains[0] * signal(k, 0) * motor_velocity[0] + gains[1] * signal(k, 1) * motor_velocity[1];
    EXPECT_NEAR(torque.row(k).dot(dq), motor_power, 1e-12);
  }
  study->signal_side = Side::kJoint;
  EXPECT_EQ(DriveMap(study->robot, study->signal_side).Torque(gains, signal).row(0),
            Eigen::RowVector2d(0.6, -3.0 * 0.7));
}

TEST(ReadRecording, TorqueInPlaceOfTheSignal) {
  const std::string csv = "t,q1,q2,tau1,tau2\n0,1,2,3,4\n1,1,2,5,6\n";
  const Result<Recording> recording = StudyFolder(kPlainStudy, csv).ReadFirst();
  ASSERT_TRUE(recording.ok()) << recording.status().message();
  EXPECT_TRUE(recording->signal_is_torque);
  EXPECT_EQ(recording->signal, Rows({{3, 4}, {5, 6}}));
}

TEST(ReadRecording, FilesSayWhetherTheSignalIsTorque) {
  const std::string both = "q1,q2,v1,v2,tau1,tau2\n1,2,3,4,5,6\n1,2,7,8,9,10\n";
  const std::string lines = "robot: robot.yaml\nsample_rate: 10\nrecordings: [{files: {q: a.csv, ";
  const Result<Recording> torque = StudyFolder(lines + "tau: a.csv}, name: x}]\n", both).ReadFirst();
  ASSERT_TRUE(torque.ok()) << torque.status().message();
  EXPECT_TRUE(torque->signal_is_torque);
  EXPECT_EQ(torque->signal, Rows({{5, 6}, {9, 10}}));
  const Result<Recording> signal = StudyFolder(lines + "v: a.csv}, name: x}]\n", both).ReadFirst();
  ASSERT_TRUE(signal.ok()) << signal.status().message();
  EXPECT_FALSE(signal->signal_is_torque);
  EXPECT_EQ(signal->signal, Rows({{3, 4}, {7, 8}}));
}

struct BadRecording {
  const char* name;
  std::string study;  // lines after the plain study
  std::string csv;
  std::vector<std::string> message;
};

void PrintTo(const BadRecording& test, std::ostream* out) { *out << test.name; }

class BadRecordingTest : public ::testing::TestWithParam<BadRecording> {};

TEST_P(BadRecordingTest, IsRefusedWithAClearMessage) {
  const StudyFolder files(kPlainStudy + GetParam().study, GetParam().csv);
  const Result<Recording> recording = files.ReadFirst();
  ASSERT_FALSE(recording.ok());
  EXPECT_EQ(recording.status().code(), StatusCode::kBadInput);
  EXPECT_EQ(recording.status().exit_code(), 1);
  EXPECT_THAT(recording.status().message(), HasSubstr("a.csv:"));
  EXPECT_THAT(recording.status().message(), HasSubstr("expected "));
  for (const std::string& part : GetParam().message) EXPECT_THAT(recording.status().message(), HasSubstr(part));
}

const std::string kHead = "t,q1,q2,v1,v2\n";
const std::string kRow = "0.0,0.1,0.2,1.0,2.0\n";
const std::string kNextRow = "0.1,0.2,0.4,1.5,2.5\n";
const std::string kNumbered =
    "sample_rate: 9\ncolumns: {q1: {column: 1}, q2: {column: 2}, v1: {column: 3}, v2: {column: 4}}\n";

INSTANTIATE_TEST_SUITE_P(
    Table, BadRecordingTest,
    ::testing::Values(
        BadRecording{"empty", "", "", {"a.csv:1:", "empty"}}, BadRecording{"blank", "", "\n\n", {"empty"}},
        BadRecording{"header_only", "", kHead, {"0 samples", "at least 2"}},
        BadRecording{"one_sample", "", kHead + kRow, {"1 sample;", "at least 2"}},
        BadRecording{"text",
                     "",
                     kHead + kRow + "0.1,0.2,abc,1.5,2.5\n" + kRow,
                     {"a.csv:3: column 'q2': 'abc' is not a number", "expected a finite number"}},
        BadRecording{"trailing_text", "", kHead + kRow + "0.1,0.2,0.4x,1.5,2.5\n" + kRow, {":3:", "'0.4x'"}},
        BadRecording{"decimal_comma", "", kHead + kRow + "\"0,1\",0.2,0.4,1.5,2.5\n" + kRow, {":3:", "'0,1'"}},
        BadRecording{
            "nan", "", kHead + "0.0,nan,0.2,1.0,2.0\n" + kNextRow, {"a.csv:2: column 'q1': 'nan' is not finite"}},
        BadRecording{
            "inf", "", kHead + kRow + "0.1,0.2,0.4,-inf,2.5\n" + kRow, {"a.csv:3: column 'v1': '-inf' is not finite"}},
        BadRecording{"garbage",
                     "",
                     kHead + kRow + "0.1,0.2,0.4,1.5,1e300\n" + kRow,
                     {"a.csv:3: column 'v2': '1e300' is out of range"}},
        BadRecording{"beyond_double", "", kHead + kRow + "0.1,0.2,0.4,1.5,1e400\n" + kRow, {"'1e400'", "out of range"}},
        BadRecording{"garbage_by_scale",
                     "columns: {q1: {column: q1, scale: 1e12}}\n",
                     kHead + "0,9,0,0,0\n1,0,0,0,0\n",
                     {"a.csv:2: column 'q1' (q1): '9'", "after scale and offset"}},
        BadRecording{
            "empty_field", "", kHead + kRow + "0.1,,0.4,1.5,2.5\n" + kRow, {"a.csv:3: column 'q1': empty field"}},
        BadRecording{"line_counts_blank_lines",
                     "",
                     "\n" + kHead + "\r\n\n" + kRow + "\n0.1,0.2,abc,1.5,2.5\n" + kRow,
                     {"a.csv:7: column 'q2'"}},
        BadRecording{"few_columns",
                     "",
                     kHead + kRow + "0.1,0.2,0.4,1.5\n0.2,0.2,0.4,1.5,2.5\n",
                     {"a.csv:3: 4 columns; expected 5"}},
        BadRecording{"many_columns",
                     "",
                     kHead + kRow + "0.1,0.2,0.4,1.5,2.5,9\n0.2,0.2,0.4,1.5,2.5\n",
                     {"a.csv:3: 6 columns; expected 5"}},
        BadRecording{
            "many_columns_last", "", kHead + kRow + "0.1,0.2,0.4,1.5,2.5,9\n", {"a.csv:3: 6 columns; expected 5"}},
        BadRecording{"truncated",
                     "",
                     kHead + kRow + kNextRow + "0.2,0.3,0.",
                     {"a.csv:4: the last line is truncated: 3 columns; expected 5"}},
        BadRecording{"truncated_with_newline",
                     "",
                     kHead + kRow + kNextRow + "0.2,0.3\n\n",
                     {"a.csv:4: the last line is truncated: 2 columns; expected 5"}},
        BadRecording{"truncated_in_the_last_field",
                     "",
                     kHead + kRow + kNextRow + "0.2,0.3,0.8,2.5,",
                     {"a.csv:4: the last line is truncated: column 'v2': empty field"}},
        BadRecording{"time_repeats",
                     "",
                     kHead + kRow + kNextRow + "0.1,0.2,0.4,1.5,2.5\n",
                     {"a.csv:4: column 't': time repeats, 0.1 s after 0.1 s"}},
        BadRecording{"time_backwards",
                     "",
                     kHead + kRow + kNextRow + "0.05,0.2,0.4,1.5,2.5\n",
                     {"a.csv:4: column 't': time runs backwards, 0.05 s after 0.1 s"}},
        BadRecording{"no_time",
                     "",
                     "q1,q2,v1,v2\n1,2,3,4\n5,6,7,8\n",
                     {"a.csv:1: column 't': missing", "sample_rate", "study.yaml"}},
        BadRecording{
            "fewer_joints", "", "t,q1,v1\n0,1,2\n1,2,3\n", {"a.csv:1: column 'q2': missing", "the robot has 2 joints"}},
        BadRecording{"more_joints",
                     "",
                     "t,q1,q2,q3,v1,v2,v3\n0,1,2,3,4,5,6\n1,1,2,3,4,5,6\n",
                     {"a.csv:1: column 'q3': the robot 'two' has 2 joints"}},
        BadRecording{"more_signals", "", "t,q1,q2,v1,v2,v3\n0,1,2,3,4,5\n1,1,2,3,4,5\n", {"column 'v3'", "2 joints"}},
        BadRecording{"no_signal", "", "t,q1,q2\n0,1,2\n1,1,2\n", {"column 'v1': missing"}},
        BadRecording{"one_velocity", "", "t,q1,q2,dq1,v1,v2\n0,1,2,3,4,5\n1,1,2,3,4,5\n", {"column 'dq2': missing"}},
        BadRecording{"misspelt",
                     "",
                     "t,q1,q_2,v1,v2\n0,1,2,3,4\n1,1,2,3,4\n",
                     {"column 'q2': missing (nearest: 'q_2')", "t,q1,q_2,v1,v2"}},
        BadRecording{
            "header_twice", "", "t,q1,q2,q1,v1,v2\n0,1,2,3,4,5\n1,1,2,3,4,5\n", {"column 'q1'", "more than once"}},
        BadRecording{"no_header",
                     "sample_rate: 9\n",
                     "1,2,3,4\n5,6,7,8\n",
                     {"a.csv:1: column 'q1': missing, the file has no header", "by number"}},
        BadRecording{"foreign_header",
                     "columns: {q1: {column: Joint_1}}\n",
                     kHead + kRow + kNextRow,
                     {"column 'Joint_1' (q1): missing"}},
        BadRecording{"number_beyond", kNumbered, "1,2,3\n4,5,6\n", {"a.csv:1: column 4 (v2): missing", "has 3"}},
        BadRecording{"text_in_first_line",
                     kNumbered,
                     "1,x,3,4\n5,6,7,8\n9,9,9,9\n",
                     {"a.csv:1: column 2 (q2): 'x' is not a number"}},
        BadRecording{"text_without_header",
                     kNumbered,
                     "1,2,3,4\n5,x,7,8\n9,9,9,9\n",
                     {"a.csv:2: column 2 (q2): 'x' is not a number"}},
        BadRecording{"same_column_twice",
                     "columns: {q2: {column: q1}}\n",
                     kHead + kRow + kNextRow,
                     {"column 'q1' (q2): is read as q1 already"}},
        BadRecording{"open_quote", "", kHead + kRow + "0.1,\"0.2,0.4,1.5,2.5\n", {"a.csv:3:", "not valid CSV"}},
        BadRecording{"tau_identify",
                     "gains: {mode: identify}\n",
                     "t,q1,q2,tau1,tau2\n0,1,2,3,4\n1,1,2,5,6\n",
                     {"a.csv:1: column 'tau1'", "no gains to identify", "study.yaml"}},
        BadRecording{"tau_gains",
                     "gains: {values: [2, 2]}\n",
                     "t,q1,q2,tau1,tau2\n0,1,2,3,4\n1,1,2,5,6\n",
                     {"column 'tau1'", "gains are 1"}},
        BadRecording{"tau_motor",
                     "signal_side: motor\n",
                     "t,q1,q2,tau1,tau2\n0,1,2,3,4\n1,1,2,5,6\n",
                     {"column 'tau1'", "signal_side: joint"}}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(ReadRecording, FilesOfDifferentLength) {
  const StudyFolder files("robot: robot.yaml\nsample_rate: 10\nrecordings: [{files: {q: q.csv, v: v.csv}, name: x}]\n");
  files.folder().Write("q.csv", "q1,q2\n1,2\n3,4\n5,6\n");
  files.folder().Write("v.csv", "v1,v2\n1,2\n3,4\n");
  const Result<Recording> recording = files.ReadFirst();
  ASSERT_FALSE(recording.ok());
  for (const char* part : {"v.csv: has 2 samples", "q.csv has 3", "equal length"}) {
    EXPECT_THAT(recording.status().message(), HasSubstr(part));
  }
}

TEST(ReadRecording, RowsBeyondTheFile) {
  const StudyFolder files("robot: robot.yaml\nrecordings: [{file: a.csv, rows: [1, 4]}]\n");
  const Result<Recording> recording = files.ReadFirst();
  ASSERT_FALSE(recording.ok());
  EXPECT_THAT(recording.status().message(), HasSubstr("rows [1, 4]"));
  EXPECT_THAT(recording.status().message(), HasSubstr("within [0, 3]"));
}

TEST(ReadRecording, DirectoryInPlaceOfAFile) {
  const StudyFolder files("robot: robot.yaml\nrecordings: [{file: sub}]\n");
  std::filesystem::create_directory(files.folder() / "sub");
  const Result<Study> study = ReadStudy(files.study_path());
  ASSERT_FALSE(study.ok());
  EXPECT_THAT(study.status().message(), HasSubstr("no such file 'sub'"));
}

}  // namespace
}  // namespace idim::recording_reader_test
