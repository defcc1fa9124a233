// A drive gain that falls with the signal.

#include <glog/logging.h>

#include <cmath>

#include "core/base/text.h"
#include "core/effects/columns.h"
#include "core/effects/registry.h"
#include "core/simulation/effect_equation.h"

namespace idim {
namespace {

using Eigen::VectorXd;

constexpr char kGainSaturationId[] = "gain_saturation";

// loss, signal [signal unit]: tau = g v (1 + 3 loss (v / signal)^2)^(-1/3), that is g v (1 - loss (v / signal)^2) for
// small loss, and increasing in v throughout.
class GainSaturationEquation : public EffectEquation {
 public:
  GainSaturationEquation()
      : EffectEquation(kGainSaturationId, EffectJoints::kOneOrMore,
                       {EffectKey::From(0.0, kLargestInput, "loss", 1), EffectKey::Positive("signal")}) {}
  bool once_a_joint() const override { return true; }

  std::map<std::string, double> DrawValues(double, Random*) const override { return {{"loss", 0.1}, {"signal", 2.0}}; }

  // v of linear = v (1 + 3 loss (v / reference)^2)^(-1/3), linear = tau / g. The right-hand side is increasing and, for
  // v > 0, concave, so that Newton's method comes from below.
  double SignalOf(const SimulatedEffect& effect, double linear) const override {
    const double loss = effect.Value("loss"), reference = effect.Value("signal");
    double v = std::abs(linear);
    for (int iteration = 0; iteration < 100; ++iteration) {
      const double x = 3.0 * loss * std::pow(v / reference, 2);
      const double share = std::pow(1.0 + x, -1.0 / 3.0);
      const double step = (std::abs(linear) - v * share) / (share * (1.0 - 2.0 / 3.0 * x / (1.0 + x)));
      v += step;
      if (std::abs(step) <= 1e-14 * v) break;
    }
    return std::copysign(v, linear);
  }
};

// v g = tau (1 + Ksat tau^2): the more torque, the more current a newton metre takes.

class GainSaturation : public Effect {
 public:
  std::string id() const override { return kGainSaturationId; }
  EffectSite site() const override { return EffectSite::kJoint; }
  bool non_negative() const override { return true; }
  std::string physics() const override {
    return "The drive gain falls with the signal (Ksat > 0): iron of the motor saturates at high current.";
  }
  std::string how_to_confirm() const override {
    return "Hold known weights at a known lever arm from light to the largest allowed, approached from both sides: the "
           "current grows faster than the torque.";
  }

  std::vector<Parameter> Parameters(const Robot& robot, const std::vector<int>& joints) const override {
    const int joint = OnlyJoint(joints);
    return {JointParameter("Ksat", joint, IsPrismatic(robot, joint) ? "1/N^2" : "1/(N.m)^2")};
  }

  std::vector<EffectEntry> Columns(const EffectMotion& motion, const std::vector<int>& joints,
                                   const VectorXd& shape) const override {
    const int joint = OnlyJoint(joints);
    CHECK_EQ(shape.size(), 0);
    return {{0, joint, motion.torque.col(joint).array().cube()}};
  }

  const EffectEquation* equation() const override { return &equation_; }

 private:
  const GainSaturationEquation equation_;
};

}  // namespace

std::unique_ptr<Effect> MakeGainSaturation() { return std::make_unique<GainSaturation>(); }

}  // namespace idim
