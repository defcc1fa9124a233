// robot.yaml (MDH or URDF) -> Robot. The keys are those of the README's "Robot file".
//
// A URDF joint may turn about any axis of its frame; Robot wants it along z. Internal frame j is therefore the frame
// of URDF link j turned by the shortest rotation that takes z onto the joint axis (for an axis along -z: by pi about
// x). An axis along +z leaves the URDF frame as it is. The origin stays, so do q and its sign. Everything "about the
// frame of link j" (declared inertials, parameters, payload) is about the internal frame.
//
// Links behind fixed joints are part of the link that carries them. The fixed way from the base link to the first
// moving joint is kept in joint 1's rotation and translation; inertials of links fixed to the base move nothing and
// are dropped.

#ifndef IDIM_CORE_ROBOT_ROBOT_READER_H_
#define IDIM_CORE_ROBOT_ROBOT_READER_H_

#include <string>

#include "core/base/status.h"
#include "core/robot/robot.h"

namespace idim {

// Errors name file, line and key, what is wrong and what was expected. A relative `urdf` is relative to the YAML
// file. Without `transmission` the robot's is the identity; without `gravity` it is (0, 0, -9.81). A transmission
// whose reciprocal condition number (2-norm) is below 1e-10 is refused as singular.
Result<Robot> ReadRobot(const std::string& yaml_path);

// revolute, continuous, prismatic; fixed joints are merged, their inertials added to the link that carries them.
// Refused, naming file and joint: more than one moving joint on a link (a branching tree), a closed loop, mimic,
// floating, planar, no moving joint, an axis of length zero, values that are not finite, negative mass, XML that the
// URDF parser refuses (with the parser's own words). The transmission is the identity.
Result<Robot> ReadUrdf(const std::string& urdf_path);

}  // namespace idim

#endif  // IDIM_CORE_ROBOT_ROBOT_READER_H_
