// Effects that a scenario puts into the data beyond the standard model: the interface of their equations. Who reads a
// scenario is handed the equations that there are (core/effects/simulated_effects.h makes the list); each stands in
// core/effects beside the columns that identification has for the effect, written without a glance at them.
//
// An equation overrides the places of the drive train where it acts. From the links to the logged signal these are
//
//   TurnGravity, AddPayload, AddLinkTorque    the links; where a joint is flexible, at the links' own motion
//   TransmissionOf                            between motor and link, see core/simulation/effects_drive_train.h
//   MoveBristle, AddFriction, ScaleFriction   friction of the motor
//   AddMotorTorque                            any other torque at the motor
//   DelayOf, SignalOf                         from the torque to the logged signal
//
// and at each of them the effects of a scenario act in its order. Joint by joint where one joint is spoken of, over all
// joints that the effect names. q, dq, ddq of a motor are in joint coordinates; torques are those asked of the drive.

#ifndef IDIM_CORE_SIMULATION_EFFECT_EQUATION_H_
#define IDIM_CORE_SIMULATION_EFFECT_EQUATION_H_

#include <Eigen/Core>
#include <map>
#include <string>
#include <vector>

#include "core/base/random.h"
#include "core/robot/robot.h"
#include "core/simulation/trajectory.h"

namespace idim {

class EffectEquation;

struct SimulatedEffect {
  const EffectEquation* equation = nullptr;  // outlives it
  std::vector<int> joints;                   // zero-based; one or more, two, or none (of the whole arm)
  std::map<std::string, double> values;      // by the equation's keys
  std::string recording;                     // acts in this one alone; "": in all

  // On failure `error` names the value and the constraint.
  bool IsValid(const Robot& robot, std::string* error) const;
  // The value given, else the default. CHECKs that the effect has such a key.
  double Value(const std::string& key) const;
};

enum class EffectJoints { kOneOrMore, kTwo, kNone };

// A value that a scenario gives an effect.
struct EffectKey {
  std::string name;
  double lower = 0.0, upper = 0.0;  // limits of the value
  bool lower_allowed = true;        // the lower limit itself
  bool required = true;
  double default_value = 0.0;   // where it is not given
  bool default_written = true;  // to truth.json
  // The value is multiplied by factor^size_power when the effect is scaled: 1 of torques, shares, angles, masses,
  // delays, -1 of stiffnesses, 0 of shapes.
  int size_power = 0;

  static EffectKey Any(const std::string& name, int size_power = 0);
  static EffectKey Positive(const std::string& name, int size_power = 0);
  static EffectKey From(double lower, double upper, const std::string& name, int size_power = 0);
  static EffectKey Above(double lower, double upper, const std::string& name, int size_power = 0);
  EffectKey Optional(double value = 0.0) const;
  // Stands for another of EffectEquation::one_of(): nothing is written where it is not given.
  EffectKey Alternative() const;
};

// What friction is a function of, for one joint at an instant.
struct FrictionState {
  double dq = 0.0;         // [rad/s or m/s]
  double direction = 0.0;  // sign(dq), or the bristle in (-1, 1)
  double rigid = 0.0;      // [N m or N] of links, payload, springs and drive inertia
};

// Motor and link are tied by a spring and a damper, perhaps with play: springs of several effects are in series, the
// largest damping ratio is that of the joint.
struct Transmission {
  double compliance = 0.0;     // [rad/(N m) or m/N]
  double damping_ratio = 0.0;  // of the link on its spring
  double gap = 0.0;            // [rad or m], whole; above 0 the contact does not pull
};

// Has no state: what changes in time is held by the simulation.
class EffectEquation {
 public:
  virtual ~EffectEquation() = default;
  EffectEquation(const EffectEquation&) = delete;
  EffectEquation& operator=(const EffectEquation&) = delete;

  const std::string& id() const { return id_; }
  EffectJoints joints() const { return joints_; }
  const std::vector<EffectKey>& keys() const { return keys_; }
  // At least one of these keys is given; empty: no such rule.
  const std::vector<std::string>& one_of() const { return one_of_; }
  const EffectKey* FindKey(const std::string& name) const;  // nullptr where there is none

  // Two of them on one joint of a recording would have no meaning.
  virtual bool once_a_joint() const { return false; }
  // Acts on Fs, which must be above 0.
  virtual bool needs_coulomb_friction() const { return false; }
  // What the ranges of the keys do not say; "": nothing is wrong.
  virtual std::string Problem(const SimulatedEffect&, const Robot&) const { return ""; }

  // All keys that a typical effect has, for a trial; duration [s] of its recordings. Sizes are in proportion to each
  // other; how large it shall be, the trial decides (ScaleEffect()) where the share of the signal follows the size.
  virtual std::map<std::string, double> DrawValues(double duration, Random* random) const = 0;
  virtual bool share_follows_size() const { return true; }

  // g [m/s^2] in the base frame.
  virtual void TurnGravity(const SimulatedEffect&, Eigen::Vector3d*) const {}
  // In the frame of the last link, at t [s] of a recording.
  virtual void AddPayload(const SimulatedEffect&, double /*t*/, InertialVector*) const {}
  // n, on the links' side.
  virtual void AddLinkTorque(const SimulatedEffect&, const JointState& /*links*/, Eigen::VectorXd*) const {}

  virtual bool is_flexible() const { return false; }
  // Where is_flexible(). link_inertia [kg m^2 or kg]: of the link about its joint where the first recording starts,
  // without payload.
  virtual Transmission TransmissionOf(const SimulatedEffect&, double /*link_inertia*/) const { return {}; }

  // The direction of all dry friction of its joints is a bristle with a memory, 0 at first.
  virtual bool has_bristle() const { return false; }
  // Where has_bristle(): what has become of it after the motor moved by `way` [rad or m] in one direction.
  virtual double MoveBristle(const SimulatedEffect&, double bristle, double /*way*/) const { return bristle; }
  // viscous, dry [N m or N]: of the joint so far.
  virtual void AddFriction(const SimulatedEffect&, const FrictionState&, double* /*viscous*/, double* /*dry*/) const {}
  // After AddFriction() of all effects; t [s] since the recording began.
  virtual void ScaleFriction(const SimulatedEffect&, double /*t*/, double* /*viscous*/, double* /*dry*/) const {}

  // torque: n, all but the friction of Fv, Fs and AddFriction().
  virtual void AddMotorTorque(const SimulatedEffect&, const Robot&, const JointState& /*motor*/,
                              Eigen::VectorXd* /*torque*/) const {}

  // [s] The signal logged at t is that of t less this.
  virtual double DelayOf(const SimulatedEffect&) const { return 0.0; }
  // The signal that the drive takes where one of constant gain takes `linear` [signal unit].
  virtual double SignalOf(const SimulatedEffect&, double linear) const { return linear; }

 protected:
  EffectEquation(std::string id, EffectJoints joints, std::vector<EffectKey> keys,
                 std::vector<std::string> one_of = {});

 private:
  const std::string id_;
  const EffectJoints joints_;
  const std::vector<EffectKey> keys_;
  const std::vector<std::string> one_of_;
};

// The equations that a scenario may name.
using EffectEquationList = std::vector<const EffectEquation*>;

inline double SignOf(double x) { return static_cast<double>((x > 0.0) - (x < 0.0)); }

}  // namespace idim

#endif  // IDIM_CORE_SIMULATION_EFFECT_EQUATION_H_
