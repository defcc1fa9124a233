// Viscous friction by a power of speed.

#include <glog/logging.h>

#include <cmath>

#include "core/effects/columns.h"
#include "core/effects/registry.h"
#include "core/simulation/effect_equation.h"

namespace idim {
namespace {

using Eigen::VectorXd;

constexpr char kPowerViscousId[] = "power_viscous";

// coefficient, exponent: sign(dq) coefficient |dq|^exponent, beside the linear Fv dq.
class PowerViscousEquation : public EffectEquation {
 public:
  PowerViscousEquation()
      : EffectEquation(kPowerViscousId, EffectJoints::kOneOrMore,
                       {EffectKey::Any("coefficient", 1), EffectKey::Above(0.0, 5.0, "exponent")}) {}

  // About 1 it would be viscous friction.
  std::map<std::string, double> DrawValues(double, Random* random) const override {
    return {{"coefficient", 1.0},
            {"exponent", random->Uniform() < 0.7 ? random->Uniform(0.3, 0.7) : random->Uniform(1.6, 2.4)}};
  }

  void AddFriction(const SimulatedEffect& effect, const FrictionState& at, double* viscous, double*) const override {
    *viscous += SignOf(at.dq) * effect.Value("coefficient") * std::pow(std::abs(at.dq), effect.Value("exponent"));
  }
};

class PowerViscous : public Effect {
 public:
  std::string id() const override { return kPowerViscousId; }
  EffectSite site() const override { return EffectSite::kJoint; }
  EffectDomain domain() const override { return EffectDomain::kVelocity; }
  bool non_negative() const override { return true; }
  std::string physics() const override {
    return "Viscous friction that is not proportional to speed, Fp sign(dq) |dq|^a: grease that thins when sheared "
           "(a < 1), churning (a > 1).";
  }
  std::string how_to_confirm() const override {
    return "Drive the joint at five or more constant speeds, evenly spaced in their logarithm, both ways: log-log, "
           "half "
           "the torque difference less its value at creep has slope a.";
  }

  std::vector<Parameter> Parameters(const Robot& robot, const std::vector<int>& joints) const override {
    const int joint = OnlyJoint(joints);
    return {JointParameter("Fp", joint, TorqueUnit(robot, joint) + ".(s/" + AngleUnit(robot, joint) + ")^a")};
  }

  // About 1 it is viscous friction itself: Fp and Fv would grow without bound against each other.
  std::vector<ShapeParameter> Shapes(const std::vector<EffectMotion>&, const std::vector<int>&) const override {
    return {{"a", "1", 0.1, 2.5, {0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 1.25, 1.5, 1.75, 2.0}, 0.8, 1.25}};
  }

  std::vector<EffectEntry> Columns(const EffectMotion& motion, const std::vector<int>& joints,
                                   const VectorXd& shape) const override {
    const int joint = OnlyJoint(joints);
    CHECK_EQ(shape.size(), 1);
    CHECK_GT(shape[0], 0.0);
    return {{0, joint, ExpectedSigns(motion, joint).array() * motion.dq().col(joint).array().abs().pow(shape[0])}};
  }

  VectorXd TrueShape(const SimulatedEffect& effect, const Scenario&) const override {
    return VectorXd::Constant(1, effect.Value("exponent"));
  }

  const EffectEquation* equation() const override { return &equation_; }

 private:
  const PowerViscousEquation equation_;
};

}  // namespace

std::unique_ptr<Effect> MakePowerViscous() { return std::make_unique<PowerViscous>(); }

}  // namespace idim
