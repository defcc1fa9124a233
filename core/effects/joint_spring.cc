// A spring along a joint, Ks q; where it is relaxed is in the declared offset: Ks (q - q0) = Ks q - Ks q0.

#include <glog/logging.h>

#include "core/effects/columns.h"
#include "core/effects/registry.h"

namespace idim {
namespace {

class JointSpring : public Effect {
 public:
  std::string id() const override { return "joint_spring"; }
  EffectSite site() const override { return EffectSite::kJoint; }
  EffectDomain domain() const override { return EffectDomain::kPosition; }
  std::string physics() const override {
    return "A torque proportional to position: gravity compensator, cables and hoses that stiffen.";
  }
  std::string how_to_confirm() const override {
    return "Hold the joint at positions over its range, axis upright where it can be, approached from both sides: the "
           "mean torque rises by Ks a radian; it changes when cables or compensator are unhooked.";
  }

  std::vector<Parameter> Parameters(const Robot& robot, const std::vector<int>& joints) const override {
    const int joint = OnlyJoint(joints);
    return {JointParameter("Ks", joint, TorqueUnit(robot, joint) + "/" + AngleUnit(robot, joint))};
  }

  std::vector<EffectEntry> Columns(const EffectMotion& motion, const std::vector<int>& joints,
                                   const Eigen::VectorXd& shape) const override {
    CHECK_EQ(shape.size(), 0);
    return {{0, OnlyJoint(joints), motion.q.col(joints[0])}};
  }
};

}  // namespace

std::unique_ptr<Effect> MakeJointSpring() { return std::make_unique<JointSpring>(); }

}  // namespace idim
