// Where a study enters, read from a file or built in code: its defaults are filled here and what it holds is checked.

#ifndef IDIM_CORE_RECORDING_CHECK_STUDY_H_
#define IDIM_CORE_RECORDING_CHECK_STUDY_H_

#include "core/base/status.h"
#include "core/recording/recording.h"
#include "core/recording/study.h"

namespace idim {

// The study with its defaults: path "study", known gains 1, a recording's name that of its file without the extension
// or else "recording1", a transmission of 1 (CheckedRobot()), places for messages. BadInput, naming field, value and
// what was expected: sizes that do not fit the robot, numbers that are not finite or of the wrong sign, names that are
// missing or given twice, no recording or none for identification, payloads and joints that there are not.
Result<Study> CheckedStudy(Study study);

// A recording of that study. BadInput: fewer than 2 samples, sizes that do not fit, values that are not finite or
// beyond 1e12, time that does not increase, torque where gains are not known and 1 on the joint side.
Status CheckRecording(const Study& study, const Recording& recording);

}  // namespace idim

#endif  // IDIM_CORE_RECORDING_CHECK_STUDY_H_
