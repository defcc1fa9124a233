// The friction that a study declares by itself (key `friction`), as effects: the columns of StandardModel.

#include <glog/logging.h>

#include "core/dynamics/standard_model.h"
#include "core/effects/columns.h"
#include "core/effects/registry.h"

namespace idim {
namespace {

using Eigen::VectorXd;

class DeclaredFriction : public Effect {
 public:
  EffectSite site() const override { return EffectSite::kJoint; }
  EffectDomain domain() const override { return EffectDomain::kVelocity; }
  bool in_standard_model() const override { return true; }

  std::vector<EffectEntry> Columns(const EffectMotion& motion, const std::vector<int>& joints,
                                   const VectorXd& shape) const override {
    CHECK_EQ(shape.size(), 0);
    const int joint = OnlyJoint(joints);
    return {{0, joint, Column(motion, joint)}};
  }

  std::vector<Parameter> Parameters(const Robot& robot, const std::vector<int>& joints) const override {
    const int joint = OnlyJoint(joints);
    return {JointParameter(kStandardNames[Index()], joint, StandardUnit(Index(), IsPrismatic(robot, joint)))};
  }

 private:
  virtual VectorXd Column(const EffectMotion& motion, int joint) const = 0;
  virtual int Index() const = 0;  // among the standard parameters
};

class Viscous : public DeclaredFriction {
 public:
  std::string id() const override { return "viscous"; }
  std::string physics() const override { return "Friction proportional to speed: oil and grease sheared in the gear."; }
  std::string how_to_confirm() const override {
    return "Drive the joint at several constant speeds both ways: half the difference of the two torques, against "
           "speed, is a straight line with this slope.";
  }

 private:
  VectorXd Column(const EffectMotion& motion, int joint) const override { return motion.dq.col(joint); }
  int Index() const override { return kFv; }
};

class Coulomb : public DeclaredFriction {
 public:
  std::string id() const override { return "coulomb"; }
  std::string physics() const override { return "Dry friction of constant size against the motion: seals, preload."; }
  std::string how_to_confirm() const override {
    return "Drive the joint slowly both ways through the same positions: half the difference of the torques is this "
           "value wherever the joint stands.";
  }

 private:
  VectorXd Column(const EffectMotion& motion, int joint) const override { return ExpectedSigns(motion, joint); }
  int Index() const override { return kFs; }
};

class Offset : public DeclaredFriction {
 public:
  std::string id() const override { return "offset"; }
  std::string physics() const override {
    return "A constant torque: the zero of the current sensor, friction that differs between the two directions.";
  }
  std::string how_to_confirm() const override {
    return "Turn the joint's axis upright, so that gravity has no part, and drive it both ways: the mean of the two "
           "torques is this value; with the drive enabled and the brake on, the logged current shows the sensor's "
           "part of it.";
  }

 private:
  VectorXd Column(const EffectMotion& motion, int) const override { return VectorXd::Ones(motion.t.size()); }
  int Index() const override { return kOff; }
};

}  // namespace

std::unique_ptr<Effect> MakeViscous() { return std::make_unique<Viscous>(); }
std::unique_ptr<Effect> MakeCoulomb() { return std::make_unique<Coulomb>(); }
std::unique_ptr<Effect> MakeOffset() { return std::make_unique<Offset>(); }

}  // namespace idim
