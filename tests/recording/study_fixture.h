// A small arm, its study and its recordings as text, to be broken one line at a time.

#ifndef IDIM_TESTS_RECORDING_STUDY_FIXTURE_H_
#define IDIM_TESTS_RECORDING_STUDY_FIXTURE_H_

#include <string>

#include "core/recording/study.h"
#include "tests/support/temp_folder.h"

namespace idim {

inline const char kTwoJoints[] =
    "name: two\n"
    "joints:\n"
    "  - {type: revolute, alpha: 0, d: 0, theta: 0, r: 0}\n"
    "  - {type: revolute, alpha: 0, d: 0.5, theta: 0, r: 0}\n";

inline const char kTwoCoupledMotors[] = "transmission: [[10, 0], [4, -20]]\n";

inline const char kPlainStudy[] =
    "robot: robot.yaml\n"
    "recordings:\n"
    "  - {file: a.csv, name: a, use: identification}\n";

inline const char kPlainCsv[] =
    "t,q1,q2,v1,v2\n"
    "0.0,0.1,0.2,1.0,2.0\n"
    "0.1,0.2,0.4,1.5,2.5\n"
    "0.2,0.3,0.8,2.5,3.5\n";

// robot.yaml, study.yaml and a.csv in a folder of their own.
class StudyFolder {
 public:
  explicit StudyFolder(const std::string& study = kPlainStudy, const std::string& csv = kPlainCsv,
                       const std::string& robot = kTwoJoints) {
    folder_.Write("robot.yaml", robot);
    folder_.Write("a.csv", csv);
    study_path_ = folder_.Write("study.yaml", study);
  }

  const TempFolder& folder() const { return folder_; }
  const std::string& study_path() const { return study_path_; }

  // The first recording of the study; the first problem on the way there.
  Result<Recording> ReadFirst() const {
    const Result<Study> study = ReadStudy(study_path_);
    IDIM_RETURN_IF_ERROR(study);
    return ReadRecording(*study, study->recordings[0]);
  }

 private:
  TempFolder folder_;
  std::string study_path_;
};

}  // namespace idim

#endif  // IDIM_TESTS_RECORDING_STUDY_FIXTURE_H_
