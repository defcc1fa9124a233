// Dry friction that grows with the torque a gear transmits.

#include <glog/logging.h>

#include <cmath>

#include "core/effects/columns.h"
#include "core/effects/registry.h"
#include "core/simulation/effect_equation.h"

namespace idim {
namespace {

using Eigen::VectorXd;

constexpr char kLoadFrictionId[] = "load_friction";

// mu: s mu |torque of links, payload, spring and drive inertia on that joint|, s the direction of dry friction.
class LoadFrictionEquation : public EffectEquation {
 public:
  LoadFrictionEquation()
      : EffectEquation(kLoadFrictionId, EffectJoints::kOneOrMore, {EffectKey::From(-1.0, 1.0, "mu", 1)}) {}

  std::map<std::string, double> DrawValues(double, Random*) const override { return {{"mu", 0.05}}; }

  void AddFriction(const SimulatedEffect& effect, const FrictionState& at, double*, double* dry) const override {
    *dry += at.direction * effect.Value("mu") * std::abs(at.rigid);
  }
};

class LoadFriction : public Effect {
 public:
  std::string id() const override { return kLoadFrictionId; }
  EffectSite site() const override { return EffectSite::kJoint; }
  EffectDomain domain() const override { return EffectDomain::kVelocity; }
  bool non_negative() const override { return true; }
  std::string physics() const override {
    return "Dry friction that grows with the torque a gear transmits, Fl sign(dq) |tau_rigid|: tooth and bearing "
           "loads.";
  }
  std::string how_to_confirm() const override {
    return "Drive the joint slowly both ways through the same positions, without and with a known payload: half the "
           "torque difference grows by Fl times the added gravity torque.";
  }

  std::vector<Parameter> Parameters(const Robot&, const std::vector<int>& joints) const override {
    return {JointParameter("Fl", OnlyJoint(joints), "1")};
  }

  std::vector<EffectEntry> Columns(const EffectMotion& motion, const std::vector<int>& joints,
                                   const VectorXd& shape) const override {
    const int joint = OnlyJoint(joints);
    CHECK_EQ(shape.size(), 0);
    return {{0, joint, ExpectedSigns(motion, joint).cwiseProduct(motion.rigid.col(joint).cwiseAbs())}};
  }

  const EffectEquation* equation() const override { return &equation_; }

 private:
  const LoadFrictionEquation equation_;
};

}  // namespace

std::unique_ptr<Effect> MakeLoadFriction() { return std::make_unique<LoadFriction>(); }

}  // namespace idim
