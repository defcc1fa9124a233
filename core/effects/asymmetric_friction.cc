// Friction that differs between the two directions.

#include <glog/logging.h>

#include <cmath>

#include "core/effects/columns.h"
#include "core/effects/registry.h"
#include "core/simulation/effect_equation.h"

namespace idim {
namespace {

using Eigen::VectorXd;

constexpr char kAsymmetricFrictionId[] = "asymmetric_friction";

// viscous_difference [N m s/rad], coulomb_difference [N m], forwards less backwards: Fv and Fs are larger by half of it
// for dq > 0, smaller by half for dq < 0.
class AsymmetricFrictionEquation : public EffectEquation {
 public:
  AsymmetricFrictionEquation()
      : EffectEquation(
            kAsymmetricFrictionId, EffectJoints::kOneOrMore,
            {EffectKey::Any("viscous_difference", 1).Optional(), EffectKey::Any("coulomb_difference", 1).Optional()},
            {"viscous_difference", "coulomb_difference"}) {}

  std::map<std::string, double> DrawValues(double, Random* random) const override {
    return {{"viscous_difference", random->Sign() * random->Uniform(0.2, 1.0)},
            {"coulomb_difference", random->Sign() * random->Uniform(0.2, 1.0)}};
  }

  void AddFriction(const SimulatedEffect& effect, const FrictionState& at, double* viscous,
                   double* dry) const override {
    *viscous += 0.5 * effect.Value("viscous_difference") * std::abs(at.dq);
    *dry += 0.5 * effect.Value("coulomb_difference") * std::abs(at.direction);
  }
};

class AsymmetricFriction : public Effect {
 public:
  std::string id() const override { return kAsymmetricFrictionId; }
  EffectSite site() const override { return EffectSite::kJoint; }
  EffectDomain domain() const override { return EffectDomain::kVelocity; }
  std::string physics() const override {
    return "Friction that differs between the two directions, half the difference Fva |dq| + Fsa while moving: helical "
           "or worm gears, preloaded bearings.";
  }
  std::string how_to_confirm() const override {
    return "With the axis upright (or on positions where gravity is known) drive the joint at several constant speeds "
           "both ways: the mean of the two torques changes with speed, and is another at rest.";
  }

  std::vector<Parameter> Parameters(const Robot& robot, const std::vector<int>& joints) const override {
    const int joint = OnlyJoint(joints);
    const std::string torque = TorqueUnit(robot, joint);
    return {JointParameter("Fva", joint, torque + ".s/" + AngleUnit(robot, joint)),
            JointParameter("Fsa", joint, torque)};
  }

  std::vector<EffectEntry> Columns(const EffectMotion& motion, const std::vector<int>& joints,
                                   const VectorXd& shape) const override {
    const int joint = OnlyJoint(joints);
    CHECK_EQ(shape.size(), 0);
    return {{0, joint, motion.dq().col(joint).cwiseAbs()}, {1, joint, ExpectedSigns(motion, joint).cwiseAbs()}};
  }

  const EffectEquation* equation() const override { return &equation_; }

 private:
  const AsymmetricFrictionEquation equation_;
};

}  // namespace

std::unique_ptr<Effect> MakeAsymmetricFriction() { return std::make_unique<AsymmetricFriction>(); }

}  // namespace idim
