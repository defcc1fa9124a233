// Compliance of a transmission p: the link's displacement (core/effects/link_displacement.h) is d_j = -tau_link,j, the
// torque that the transmission carries.

#include <glog/logging.h>

#include "core/effects/columns.h"
#include "core/effects/link_displacement.h"
#include "core/effects/registry.h"
#include "core/simulation/effect_equation.h"

namespace idim {
namespace {

using Eigen::VectorXd;

constexpr char kJointElasticityId[] = "joint_elasticity";

// stiffness [N m/rad], damping_ratio (0.1): a spring and a damper between motor and link.
class JointElasticityEquation : public EffectEquation {
 public:
  JointElasticityEquation()
      : EffectEquation(
            kJointElasticityId, EffectJoints::kOneOrMore,
            {EffectKey::Positive("stiffness", -1), EffectKey::From(0.01, 2.0, "damping_ratio").Optional(0.1)}) {}
  bool once_a_joint() const override { return true; }
  bool is_flexible() const override { return true; }

  std::map<std::string, double> DrawValues(double, Random*) const override { return {{"stiffness", 3000.0}}; }

  Transmission TransmissionOf(const SimulatedEffect& effect, double) const override {
    return {1.0 / effect.Value("stiffness"), effect.Value("damping_ratio"), 0.0};
  }
};

class JointElasticity : public Effect {
 public:
  std::string id() const override { return kJointElasticityId; }
  EffectSite site() const override { return EffectSite::kJoint; }
  bool non_negative() const override { return true; }
  std::string physics() const override {
    return "The transmission twists by Ce times the torque it carries: the link is not where the motor's encoder says.";
  }
  std::string how_to_confirm() const override {
    return "Brake on, load the link by known weights at a known arm and read its rotation with a dial gauge: "
           "rotation over torque is Ce; or tap it and compare the resonance.";
  }

  std::vector<Parameter> Parameters(const Robot& robot, const std::vector<int>& joints) const override {
    const int joint = OnlyJoint(joints);
    return {JointParameter("Ce", joint, IsPrismatic(robot, joint) ? "m/N" : "rad/(N.m)")};
  }

  std::vector<EffectEntry> Columns(const EffectMotion& motion, const std::vector<int>& joints,
                                   const VectorXd& shape) const override {
    const int joint = OnlyJoint(joints);
    CHECK_EQ(shape.size(), 0);
    return LinkTorqueAlong(motion, joint, ForDerivatives(motion, -motion.link.col(joint)));
  }

  const EffectEquation* equation() const override { return &equation_; }

 private:
  const JointElasticityEquation equation_;
};

}  // namespace

std::unique_ptr<Effect> MakeJointElasticity() { return std::make_unique<JointElasticity>(); }

}  // namespace idim
