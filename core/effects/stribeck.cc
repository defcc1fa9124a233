// Dry friction that falls with speed (Stribeck, 1902).

#include <glog/logging.h>

#include <algorithm>
#include <cmath>

#include "core/effects/columns.h"
#include "core/effects/registry.h"
#include "core/simulation/effect_equation.h"

namespace idim {
namespace {

using Eigen::ArrayXd;
using Eigen::VectorXd;

constexpr char kStribeckId[] = "stribeck";

// Fst [N m], vs [rad/s]: s Fst exp(-(|dq| / vs)^2), s the direction of dry friction.
class StribeckEquation : public EffectEquation {
 public:
  StribeckEquation()
      : EffectEquation(kStribeckId, EffectJoints::kOneOrMore, {EffectKey::Any("Fst", 1), EffectKey::Positive("vs")}) {}

  std::map<std::string, double> DrawValues(double, Random* random) const override {
    return {{"Fst", 1.0}, {"vs", random->LogUniform(0.05, 0.5)}};
  }

  void AddFriction(const SimulatedEffect& effect, const FrictionState& at, double*, double* dry) const override {
    *dry += at.direction * effect.Value("Fst") * std::exp(-std::pow(at.dq / effect.Value("vs"), 2));
  }
};

class Stribeck : public Effect {
 public:
  std::string id() const override { return kStribeckId; }
  EffectSite site() const override { return EffectSite::kJoint; }
  EffectDomain domain() const override { return EffectDomain::kVelocity; }
  bool non_negative() const override { return true; }
  std::string physics() const override {
    return "Dry friction that falls with speed as the lubricant film builds up: Fst sign(dq) exp(-(dq / vs)^2).";
  }
  std::string how_to_confirm() const override {
    return "Drive the joint at constant speeds from a tenth of vs to ten times vs, both ways: half the torque "
           "difference falls by Fst between them; it changes with lubricant and temperature.";
  }

  std::vector<Parameter> Parameters(const Robot& robot, const std::vector<int>& joints) const override {
    return {JointParameter("Fst", OnlyJoint(joints), TorqueUnit(robot, joints[0]))};
  }

  // Below the noise of the velocity a fall of friction cannot be seen; above the speeds driven it is Coulomb friction.
  std::vector<ShapeParameter> Shapes(const std::vector<EffectMotion>& motions,
                                     const std::vector<int>& joints) const override {
    const int joint = OnlyJoint(joints);
    CHECK(!motions.empty());
    const double speed = LargestSpeed(motions, joint);
    const double upper = speed > 0.0 ? 0.5 * speed : 1.0;
    const double lower = std::clamp(2.0 * motions[0].velocity_sigma[joint], 1e-3 * upper, 0.5 * upper);
    return {{"vs", AngleUnit(*motions[0].robot, joint) + "/s", lower, upper, LogGrid(lower, upper, 8)}};
  }

  std::vector<EffectEntry> Columns(const EffectMotion& motion, const std::vector<int>& joints,
                                   const VectorXd& shape) const override {
    const int joint = OnlyJoint(joints);
    CHECK_EQ(shape.size(), 1);
    CHECK_GT(shape[0], 0.0);
    const ArrayXd decay = (-(motion.dq().col(joint).array() / shape[0]).square()).exp();
    return {{0, joint, ExpectedSigns(motion, joint).array() * decay}};
  }

  VectorXd TrueShape(const SimulatedEffect& effect, const Scenario&) const override {
    return VectorXd::Constant(1, effect.Value("vs"));
  }

  const EffectEquation* equation() const override { return &equation_; }

 private:
  const StribeckEquation equation_;
};

}  // namespace

std::unique_ptr<Effect> MakeStribeck() { return std::make_unique<Stribeck>(); }

}  // namespace idim
