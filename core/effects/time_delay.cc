// A signal that is logged late.

#include <glog/logging.h>

#include "core/effects/columns.h"
#include "core/effects/registry.h"
#include "core/simulation/effect_equation.h"

namespace idim {
namespace {

using Eigen::VectorXd;

constexpr char kTimeDelayId[] = "time_delay";

constexpr double kLongestDelay = 0.1;  // [s]

// delay [s]: the signal logged at t is that of t - delay.
class TimeDelayEquation : public EffectEquation {
 public:
  TimeDelayEquation()
      : EffectEquation(kTimeDelayId, EffectJoints::kOneOrMore,
                       {EffectKey::From(-kLongestDelay, kLongestDelay, "delay", 1)}) {}
  bool once_a_joint() const override { return true; }

  std::map<std::string, double> DrawValues(double, Random*) const override { return {{"delay", 0.003}}; }

  double DelayOf(const SimulatedEffect& effect) const override { return effect.Value("delay"); }
};

// v(t) g = tau(t - Td), to first order tau - Td dtau/dt: good for delays well below the period of the fastest motion.

class TimeDelay : public Effect {
 public:
  std::string id() const override { return kTimeDelayId; }
  EffectSite site() const override { return EffectSite::kJoint; }
  std::string physics() const override {
    return "The signal is late against the position by Td (negative: early): logging, filters of the current loop.";
  }
  std::string how_to_confirm() const override {
    return "Command a small fast to-and-fro motion and cross-correlate the logged current with acceleration; or log "
           "one "
           "digital edge on both channels: the distance is Td.";
  }

  std::vector<Parameter> Parameters(const Robot&, const std::vector<int>& joints) const override {
    return {JointParameter("Td", OnlyJoint(joints), "s")};
  }

  std::vector<EffectEntry> Columns(const EffectMotion& motion, const std::vector<int>& joints,
                                   const VectorXd& shape) const override {
    const int joint = OnlyJoint(joints);
    CHECK_EQ(shape.size(), 0);
    return {{0, joint, -TimeDerivative(motion.t(), ForDerivatives(motion, motion.torque.col(joint)))}};
  }

  const EffectEquation* equation() const override { return &equation_; }

 private:
  const TimeDelayEquation equation_;
};

}  // namespace

std::unique_ptr<Effect> MakeTimeDelay() { return std::make_unique<TimeDelay>(); }

}  // namespace idim
