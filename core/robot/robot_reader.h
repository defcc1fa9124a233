// robot.yaml (MDH or URDF) -> Robot. The keys are those of the README's "Robot file".

#ifndef IDIM_CORE_ROBOT_ROBOT_READER_H_
#define IDIM_CORE_ROBOT_ROBOT_READER_H_

#include <string>

#include "core/base/status.h"
#include "core/robot/robot.h"

namespace idim {

// Errors name file, line and key, what is wrong and what was expected.
Result<Robot> ReadRobot(const std::string& yaml_path);

// revolute, continuous, prismatic; fixed joints are merged, their inertials added to the link that carries them.
// Refused: a branching tree, mimic, floating, planar, no moving joint.
Result<Robot> ReadUrdf(const std::string& urdf_path);

}  // namespace idim

#endif  // IDIM_CORE_ROBOT_ROBOT_READER_H_
