// Inertia and viscous friction shared between the drives of two joints (eq. (25) without its dry part): a motor
// that turns with both joints loads each of them with the motion of the other,
//   tau_a += Iab ddq_b + Fab dq_b,    tau_b += Iab ddq_a + Fab dq_a.
// What each carries by its own motion is in Ia and Fv.

#include <glog/logging.h>

#include "core/effects/columns.h"
#include "core/effects/registry.h"

namespace idim {
namespace {

class MotorCoupling : public Effect {
 public:
  std::string id() const override { return "motor_coupling"; }
  EffectSite site() const override { return EffectSite::kJointPair; }
  std::string physics() const override {
    return "Two drives share inertia and friction: a motor whose shaft passes the other joint's gear turns with both.";
  }
  std::string how_to_confirm() const override {
    return "Command the first joint to stand still and shake the second: the first motor's current follows the "
           "acceleration of the second joint; with the brake of the first on, watch its motor encoder turn.";
  }

  std::vector<Parameter> Parameters(const Robot& robot, const std::vector<int>& joints) const override {
    Check(joints);
    const std::string pair = std::to_string(joints[0] + 1) + "_" + std::to_string(joints[1] + 1);
    const int prismatic = IsPrismatic(robot, joints[0]) + IsPrismatic(robot, joints[1]);
    const char* const inertia[] = {"kg.m^2", "kg.m", "kg"};
    const char* const viscous[] = {"N.m.s/rad", "N.s/rad", "N.s/m"};
    return {{"Iab" + pair, ParameterKind::kEffect, joints[0] + 1, inertia[prismatic]},
            {"Fab" + pair, ParameterKind::kEffect, joints[0] + 1, viscous[prismatic]}};
  }

  std::vector<EffectEntry> Columns(const EffectMotion& motion, const std::vector<int>& joints,
                                   const Eigen::VectorXd& shape) const override {
    Check(joints);
    CHECK_EQ(shape.size(), 0);
    const int a = joints[0], b = joints[1];
    return {{0, a, motion.ddq.col(b)}, {0, b, motion.ddq.col(a)}, {1, a, motion.dq.col(b)}, {1, b, motion.dq.col(a)}};
  }

 private:
  static void Check(const std::vector<int>& joints) {
    CHECK_EQ(joints.size(), 2u);
    CHECK_GE(joints[0], 0);
    CHECK_LT(joints[0], joints[1]);
  }
};

}  // namespace

std::unique_ptr<Effect> MakeMotorCoupling() { return std::make_unique<MotorCoupling>(); }

}  // namespace idim
