// Friction that depends on velocity otherwise than the declared one, or on the load.

#include <glog/logging.h>

#include <algorithm>
#include <cmath>

#include "core/effects/columns.h"
#include "core/effects/registry.h"

namespace idim {
namespace {

using Eigen::ArrayXd;
using Eigen::VectorXd;

class Stribeck : public Effect {
 public:
  std::string id() const override { return "stribeck"; }
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
    const ArrayXd decay = (-(motion.dq.col(joint).array() / shape[0]).square()).exp();
    return {{0, joint, ExpectedSigns(motion, joint).array() * decay}};
  }
};

class PowerViscous : public Effect {
 public:
  std::string id() const override { return "power_viscous"; }
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
    return {{0, joint, ExpectedSigns(motion, joint).array() * motion.dq.col(joint).array().abs().pow(shape[0])}};
  }
};

class AsymmetricFriction : public Effect {
 public:
  std::string id() const override { return "asymmetric_friction"; }
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
    return {{0, joint, motion.dq.col(joint).cwiseAbs()}, {1, joint, ExpectedSigns(motion, joint).cwiseAbs()}};
  }
};

class LoadFriction : public Effect {
 public:
  std::string id() const override { return "load_friction"; }
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
};

}  // namespace

std::unique_ptr<Effect> MakeStribeck() { return std::make_unique<Stribeck>(); }
std::unique_ptr<Effect> MakePowerViscous() { return std::make_unique<PowerViscous>(); }
std::unique_ptr<Effect> MakeAsymmetricFriction() { return std::make_unique<AsymmetricFriction>(); }
std::unique_ptr<Effect> MakeLoadFriction() { return std::make_unique<LoadFriction>(); }

}  // namespace idim
