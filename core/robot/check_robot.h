// What a robot must be, wherever it comes from: a file has been read key by key, a robot built in code has not.

#ifndef IDIM_CORE_ROBOT_CHECK_ROBOT_H_
#define IDIM_CORE_ROBOT_CHECK_ROBOT_H_

#include "core/base/status.h"
#include "core/robot/robot.h"

namespace idim {

// The robot with its defaults filled: transmission 1, weights of couplings by the transmission. BadInput, naming field,
// value and what was expected: no joints; numbers that are not finite; a rotation that is none; a transmission that is
// not n x n or not invertible; couplings of joints that there are not; inertial parameters that are not one a link.
Result<Robot> CheckedRobot(Robot robot);

}  // namespace idim

#endif  // IDIM_CORE_ROBOT_CHECK_ROBOT_H_
