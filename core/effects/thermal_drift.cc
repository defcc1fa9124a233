// Friction that settles as the drive warms up: dFv dq (1 - exp(-t/T)) + dFs sign(dq) (1 - exp(-t/T)), t from the start
// of each recording. What the drive had warmed before it belongs to Fv and Fs.

#include <glog/logging.h>

#include <cmath>

#include "core/effects/columns.h"
#include "core/effects/registry.h"
#include "core/simulation/effect_equation.h"

namespace idim {
namespace {

using Eigen::VectorXd;

constexpr char kThermalDriftId[] = "thermal_drift";

// viscous_share, coulomb_share, time_constant [s]: viscous (and power) friction of the joint, or its dry friction,
// times 1 + share (1 - exp(-t / time_constant)); t begins anew in every recording.
class ThermalDriftEquation : public EffectEquation {
 public:
  ThermalDriftEquation()
      : EffectEquation(
            kThermalDriftId, EffectJoints::kOneOrMore,
            {EffectKey::Above(-1.0, 10.0, "viscous_share", 1).Alternative(),
             EffectKey::Above(-1.0, 10.0, "coulomb_share", 1).Alternative(), EffectKey::Positive("time_constant")},
            {"viscous_share", "coulomb_share"}) {}

  std::map<std::string, double> DrawValues(double duration, Random* random) const override {
    return {{"viscous_share", -random->Uniform(0.1, 0.5)},
            {"coulomb_share", -random->Uniform(0.05, 0.3)},
            {"time_constant", duration * random->LogUniform(0.15, 1.0)}};
  }

  void ScaleFriction(const SimulatedEffect& effect, double t, double* viscous, double* dry) const override {
    const double warm = 1.0 - std::exp(-t / effect.Value("time_constant"));
    *viscous *= 1.0 + effect.Value("viscous_share") * warm;
    *dry *= 1.0 + effect.Value("coulomb_share") * warm;
  }
};

class ThermalDrift : public Effect {
 public:
  std::string id() const override { return kThermalDriftId; }
  EffectSite site() const override { return EffectSite::kJoint; }
  EffectDomain domain() const override { return EffectDomain::kVelocity; }
  std::string physics() const override {
    return "Friction drifts as lubricant and gear warm up with the time constant T; dFv and dFs are the changes at the "
           "end (as a rule negative).";
  }
  std::string how_to_confirm() const override {
    return "From cold, run the same slow to-and-fro motion every few minutes with hard motion between: half the torque "
           "difference settles; a drive thermometer follows the same curve.";
  }

  std::vector<Parameter> Parameters(const Robot& robot, const std::vector<int>& joints) const override {
    const int joint = OnlyJoint(joints);
    const std::string torque = TorqueUnit(robot, joint);
    return {JointParameter("dFv", joint, torque + ".s/" + AngleUnit(robot, joint)),
            JointParameter("dFs", joint, torque)};
  }

  // Slower than three recordings it is a straight line in time.
  std::vector<ShapeParameter> Shapes(const std::vector<EffectMotion>& motions,
                                     const std::vector<int>& joints) const override {
    OnlyJoint(joints);
    const double longest = LongestDuration(motions);
    const double unit = longest > 0.0 ? longest : 1.0;
    return {{"T", "s", 0.1 * unit, 3.0 * unit, LogGrid(0.1 * unit, 3.0 * unit, 6)}};
  }

  std::vector<EffectEntry> Columns(const EffectMotion& motion, const std::vector<int>& joints,
                                   const VectorXd& shape) const override {
    const int joint = OnlyJoint(joints);
    CHECK_EQ(shape.size(), 1);
    CHECK_GT(shape[0], 0.0);
    if (motion.t().size() == 0) return {};
    const VectorXd warm = 1.0 - (-(motion.t().array() - motion.t()[0]) / shape[0]).exp();
    return {{0, joint, motion.dq().col(joint).cwiseProduct(warm)},
            {1, joint, ExpectedSigns(motion, joint).cwiseProduct(warm)}};
  }

  VectorXd TrueShape(const SimulatedEffect& effect, const Scenario&) const override {
    return VectorXd::Constant(1, effect.Value("time_constant"));
  }

  const EffectEquation* equation() const override { return &equation_; }

 private:
  const ThermalDriftEquation equation_;
};

}  // namespace

std::unique_ptr<Effect> MakeThermalDrift() { return std::make_unique<ThermalDrift>(); }

}  // namespace idim
