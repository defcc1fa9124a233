// Inertia and friction shared between the drives of two joints (eq. (25) of Gautier & Briot): a motor that turns with
// both joints, by the sum of their velocities, loads each of them with the motion of the other,
//   tau_a += Iab ddq_b + Fab dq_b + Cab sign(dq_a + dq_b),    tau_b likewise with a.
// What each carries by its own motion is in Ia and Fv. A motor that turns with the difference has negative Iab and Fab;
// its dry friction is not in the columns.

#include <glog/logging.h>

#include <cmath>

#include "core/dynamics/standard_model.h"
#include "core/effects/columns.h"
#include "core/effects/registry.h"
#include "core/simulation/effect_equation.h"

namespace idim {
namespace {

constexpr char kMotorCouplingId[] = "motor_coupling";

// joints a, b; inertia [kg m^2], viscous [N m s/rad], coulomb [N m]: on a inertia ddq_b + viscous dq_b
// + coulomb sign(dq_a + dq_b), on b likewise with a (what eq. (25) of Gautier & Briot adds).
class MotorCouplingEquation : public EffectEquation {
 public:
  MotorCouplingEquation()
      : EffectEquation(kMotorCouplingId, EffectJoints::kTwo,
                       {EffectKey::Any("inertia", 1).Optional(), EffectKey::Any("viscous", 1).Optional(),
                        EffectKey::Any("coulomb", 1).Optional()},
                       {"inertia", "viscous", "coulomb"}) {}

  std::map<std::string, double> DrawValues(double, Random* random) const override {
    return {{"inertia", random->Uniform(0.02, 0.1)},
            {"viscous", random->Uniform(0.1, 0.5)},
            {"coulomb", random->Uniform(0.1, 0.5)}};
  }

  void AddMotorTorque(const SimulatedEffect& effect, const Robot&, const JointState& motor,
                      Eigen::VectorXd* torque) const override {
    const int a = effect.joints[0], b = effect.joints[1];
    const double dry = effect.Value("coulomb") * SignOf(motor.dq[a] + motor.dq[b]);
    const double inertia = effect.Value("inertia"), viscous = effect.Value("viscous");
    (*torque)[a] += inertia * motor.ddq[b] + viscous * motor.dq[b] + dry;
    (*torque)[b] += inertia * motor.ddq[a] + viscous * motor.dq[a] + dry;
  }
};

class MotorCoupling : public Effect {
 public:
  std::string id() const override { return kMotorCouplingId; }
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
            {"Fab" + pair, ParameterKind::kEffect, joints[0] + 1, viscous[prismatic]},
            {"Cab" + pair, ParameterKind::kEffect, joints[0] + 1, prismatic == 2 ? "N" : "N.m"}};
  }

  std::vector<EffectEntry> Columns(const EffectMotion& motion, const std::vector<int>& joints,
                                   const Eigen::VectorXd& shape) const override {
    Check(joints);
    CHECK_EQ(shape.size(), 0);
    const int a = joints[0], b = joints[1];
    const double sigma = std::hypot(motion.velocity_sigma[a], motion.velocity_sigma[b]);
    const Eigen::VectorXd sign =
        (motion.dq().col(a) + motion.dq().col(b)).unaryExpr([sigma](double dq) { return ExpectedSign(dq, sigma); });
    return {{0, a, motion.ddq().col(b)},
            {0, b, motion.ddq().col(a)},
            {1, a, motion.dq().col(b)},
            {1, b, motion.dq().col(a)},
            {2, a, sign},
            {2, b, sign}};
  }

  const EffectEquation* equation() const override { return &equation_; }

 private:
  static void Check(const std::vector<int>& joints) {
    CHECK_EQ(joints.size(), 2u);
    CHECK_GE(joints[0], 0);
    CHECK_LT(joints[0], joints[1]);
  }

  const MotorCouplingEquation equation_;
};

}  // namespace

std::unique_ptr<Effect> MakeMotorCoupling() { return std::make_unique<MotorCoupling>(); }

}  // namespace idim
