// What happens between the joint's torque and the logged signal.

#include <glog/logging.h>

#include "core/effects/columns.h"
#include "core/effects/registry.h"

namespace idim {
namespace {

using Eigen::VectorXd;

// v(t) g = tau(t - Td), to first order tau - Td dtau/dt: good for delays well below the period of the fastest motion.
class TimeDelay : public Effect {
 public:
  std::string id() const override { return "time_delay"; }
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
    return {{0, joint, -TimeDerivative(motion.t, ForDerivatives(motion, motion.torque.col(joint)))}};
  }
};

// v g = tau (1 + Ksat tau^2): the more torque, the more current a newton metre takes.
class GainSaturation : public Effect {
 public:
  std::string id() const override { return "gain_saturation"; }
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
};

}  // namespace

std::unique_ptr<Effect> MakeTimeDelay() { return std::make_unique<TimeDelay>(); }
std::unique_ptr<Effect> MakeGainSaturation() { return std::make_unique<GainSaturation>(); }

}  // namespace idim
