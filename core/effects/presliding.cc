// Hysteresis at velocity reversal (Dahl, 1968): before the joint slips, friction is an elastic function of
// displacement that remembers where it turned.
//
//   dz/ds = (sign(dq) - z) / x_s    along the path length s;    torque Fh z
//
// Between two samples the joint moves one way, so that z <- s + (z - s) exp(-|step| / x_s), s the sign of the step, is
// exact. Of what happened before a recording: a joint that moves at its start (beyond 6 standard deviations of the
// velocity) is taken to have slipped, z = sign(dq); one at rest starts at z = 0. It is forgotten after a few x_s.
//
// Jitter of a joint at rest has a path length of its own, which would wear z away. Steps are therefore those of a
// follower with play (the position moves within +-w before it follows), w three standard deviations of the filtered
// position; real reversals are seen 2 w late, which matters only where x_s is no larger.

#include <glog/logging.h>

#include <algorithm>
#include <cmath>

#include "core/effects/columns.h"
#include "core/effects/registry.h"
#include "core/simulation/effect_equation.h"

namespace idim {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr char kPreslidingId[] = "presliding";

// displacement x [rad]: Dahl's bristle y, dy/dt = (dq / x) (1 - sign(dq) y), at rest y = 0; the direction s of all dry
// friction of the joint (Fs and that of effects) is y.
class PreslidingEquation : public EffectEquation {
 public:
  PreslidingEquation()
      : EffectEquation(kPreslidingId, EffectJoints::kOneOrMore, {EffectKey::Positive("displacement", 1)}) {}
  bool once_a_joint() const override { return true; }
  bool needs_coulomb_friction() const override { return true; }

  std::map<std::string, double> DrawValues(double, Random* random) const override {
    return {{"displacement", random->LogUniform(1e-3, 0.1)}};
  }
  // A joint at rest holds its torque however small the displacement: the share has no power law to follow.
  bool share_follows_size() const override { return false; }

  bool has_bristle() const override { return true; }
  // The equation solved for a way in one direction.
  double MoveBristle(const SimulatedEffect& effect, double bristle, double way) const override {
    const double end = SignOf(way);
    return end + (bristle - end) * std::exp(-std::abs(way) / effect.Value("displacement"));
  }
};

double Play(const EffectMotion& motion, int joint) {
  return motion.position_sigma.size() == 0 ? 0.0 : 3.0 * motion.position_sigma[joint];
}

class Presliding : public Effect {
 public:
  std::string id() const override { return kPreslidingId; }
  EffectSite site() const override { return EffectSite::kJoint; }
  EffectDomain domain() const override { return EffectDomain::kVelocity; }
  bool non_negative() const override { return true; }
  std::string physics() const override {
    return "Hysteresis at velocity reversal: contacts deform over a displacement of x_s before they slip (Dahl).";
  }
  std::string how_to_confirm() const override {
    return "Move the joint to and fro by a few x_s, then by a hundredth of it, as slowly as it goes: torque against "
           "position is a loop with rounded corners whose size is the same at half the speed.";
  }

  std::vector<Parameter> Parameters(const Robot& robot, const std::vector<int>& joints) const override {
    return {JointParameter("Fh", OnlyJoint(joints), TorqueUnit(robot, joints[0]))};
  }

  // 1e-4 to 0.1 rad for a joint that moves by 2 rad.
  std::vector<ShapeParameter> Shapes(const std::vector<EffectMotion>& motions,
                                     const std::vector<int>& joints) const override {
    const int joint = OnlyJoint(joints);
    CHECK(!motions.empty());
    const double range = PositionRange(motions, joint);
    const double upper = range > 0.0 ? 0.05 * range : 0.1;
    return {{"x_s", AngleUnit(*motions[0].robot, joint), 1e-3 * upper, upper, LogGrid(1e-3 * upper, upper, 10)}};
  }

  std::vector<EffectEntry> Columns(const EffectMotion& motion, const std::vector<int>& joints,
                                   const VectorXd& shape) const override {
    const int joint = OnlyJoint(joints);
    CHECK_EQ(shape.size(), 1);
    CHECK_GT(shape[0], 0.0);
    const double play = Play(motion, joint);
    const Index count = motion.q().rows();
    VectorXd column(count);
    double z = 0.0;
    if (count > 0 && std::abs(motion.dq()(0, joint)) > 6.0 * motion.velocity_sigma[joint]) {
      z = motion.dq()(0, joint) > 0.0 ? 1.0 : -1.0;
    }
    double follower = count > 0 ? motion.q()(0, joint) : 0.0;
    for (Index i = 0; i < count; ++i) {
      const double q = motion.q()(i, joint);
      const double moved = std::clamp(follower, q - play, q + play) - follower;
      follower += moved;
      const double sign = (moved > 0.0) - (moved < 0.0);
      z = sign + (z - sign) * std::exp(-std::abs(moved) / shape[0]);
      column[i] = z;
    }
    return {{0, joint, column}};
  }

  VectorXd TrueShape(const SimulatedEffect& effect, const Scenario&) const override {
    return VectorXd::Constant(1, effect.Value("displacement"));
  }

  const EffectEquation* equation() const override { return &equation_; }

 private:
  const PreslidingEquation equation_;
};

}  // namespace

std::unique_ptr<Effect> MakePresliding() { return std::make_unique<Presliding>(); }

}  // namespace idim
