// A spring along a joint, Ks q; where it is relaxed is in the declared offset: Ks (q - q0) = Ks q - Ks q0.

#include <glog/logging.h>

#include "core/effects/columns.h"
#include "core/effects/registry.h"
#include "core/simulation/effect_equation.h"

namespace idim {
namespace {

constexpr char kJointSpringId[] = "joint_spring";

// stiffness [N m/rad], rest [rad]: stiffness (q - rest), on the link's side.
class JointSpringEquation : public EffectEquation {
 public:
  JointSpringEquation()
      : EffectEquation(kJointSpringId, EffectJoints::kOneOrMore,
                       {EffectKey::Any("stiffness", 1), EffectKey::Any("rest").Optional()}) {}

  std::map<std::string, double> DrawValues(double, Random* random) const override {
    return {{"stiffness", 2.0}, {"rest", random->Uniform(-1.0, 1.0)}};
  }

  void AddLinkTorque(const SimulatedEffect& effect, const JointState& links, Eigen::VectorXd* torque) const override {
    for (int j : effect.joints) (*torque)[j] += effect.Value("stiffness") * (links.q[j] - effect.Value("rest"));
  }
};

class JointSpring : public Effect {
 public:
  std::string id() const override { return kJointSpringId; }
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
    return {{0, OnlyJoint(joints), motion.q().col(joints[0])}};
  }

  const EffectEquation* equation() const override { return &equation_; }

 private:
  const JointSpringEquation equation_;
};

}  // namespace

std::unique_ptr<Effect> MakeJointSpring() { return std::make_unique<JointSpring>(); }

}  // namespace idim
