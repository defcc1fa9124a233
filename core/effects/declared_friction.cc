#include "core/effects/declared_friction.h"

#include <glog/logging.h>

#include "core/dynamics/standard_model.h"
#include "core/effects/columns.h"

namespace idim {

std::vector<EffectEntry> DeclaredFriction::Columns(const EffectMotion& motion, const std::vector<int>& joints,
                                                   const Eigen::VectorXd& shape) const {
  CHECK_EQ(shape.size(), 0);
  const int joint = OnlyJoint(joints);
  return {{0, joint, Column(motion, joint)}};
}

std::vector<Parameter> DeclaredFriction::Parameters(const Robot& robot, const std::vector<int>& joints) const {
  const int joint = OnlyJoint(joints);
  return {JointParameter(kStandardNames[Index()], joint, StandardUnit(Index(), IsPrismatic(robot, joint)))};
}

}  // namespace idim
