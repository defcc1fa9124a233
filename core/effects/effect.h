// A torque effect that the declared model may lack, and what all of them have in common.
//
//   tau_effect(t) = sum_p theta_p c_p(t; s)
//
// with linear parameters theta, torque columns c_p along a recording and, for some, shape parameters s (a Stribeck
// velocity, an exponent, an order). Columns stand at the recorded instants and pass the same decimation as the columns
// of the rigid model. What an effect needs of a torque (load friction, delay, elasticity) is taken from the model so
// far, never from the noisy signal: with the signal in a regressor the estimate would be biased. Columns are functions
// of the measured states; what the states' noise does to them is neglected in the bundle, as it is for Coulomb
// friction: an effect is a small part of the torque, and the noise a small part of that.
//
// Declared friction is the same kind of object (ids viscous, coulomb, offset), its columns those of
// core/dynamics/standard_model.h. Adding an effect: one file of its id with the class of its columns and, beside it,
// that of its equation in the time domain; one line in registry.h. The equation calls nothing of the columns, so that a
// simulation tries them (tests/effects/effect_sources_test.cc); its id stands nowhere else.

#ifndef IDIM_CORE_EFFECTS_EFFECT_H_
#define IDIM_CORE_EFFECTS_EFFECT_H_

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/dynamics/parameters.h"
#include "core/motion/preprocessing.h"
#include "core/robot/robot.h"

namespace idim {

class EffectEquation;    // core/simulation/effect_equation.h
struct SimulatedEffect;  // there too
struct Scenario;         // core/simulation/scenario.h

// One recording as an effect sees it: N instants, n joints. MakeEffectMotion() of effect_motion.h fills it.
struct EffectMotion {
  // Torque of links, drives and payload (friction apart) of the model so far at any state, with gravity [m/s^2] in the
  // base frame. n each.
  using RigidTorque = std::function<Eigen::VectorXd(const Eigen::VectorXd& q, const Eigen::VectorXd& dq,
                                                    const Eigen::VectorXd& ddq, const Eigen::Vector3d& gravity)>;
  // n x 10: the columns of a body fixed to the last link, in its frame.
  using BodyColumns =
      std::function<Eigen::MatrixXd(const Eigen::VectorXd& q, const Eigen::VectorXd& dq, const Eigen::VectorXd& ddq)>;

  const Robot* robot = nullptr;
  int recording = 0;  // index among the recordings of the study
  // Shared with the data, never changed.
  std::shared_ptr<const JointStates> states;
  Eigen::VectorXd velocity_sigma;  // n, standard deviations of dq
  Eigen::MatrixXd torque;          // N x n [N m or N], of the model so far, friction included
  Eigen::MatrixXd rigid;           // N x n, rigid_torque at the recorded states with the robot's own gravity
  Eigen::MatrixXd link;            // N x n, link_torque there: what the transmissions carry
  // n, standard deviations of q after the filter; empty: not known, taken as zero.
  Eigen::VectorXd position_sigma;
  // [Hz] above which derivatives of a torque are left out; 0: none. The states' noise grows with the square of the
  // frequency in ddq and with its fourth power in the second derivative of a torque: there it would drown the motion,
  // and being that of the model's own columns, pass for the effect.
  double derivative_cutoff_hz = 0.0;
  const Eigen::VectorXd& t() const { return states->t; }      // N [s]
  const Eigen::MatrixXd& q() const { return states->q; }      // N x n
  const Eigen::MatrixXd& dq() const { return states->dq; }    // N x n
  const Eigen::MatrixXd& ddq() const { return states->ddq; }  // N x n

  RigidTorque rigid_torque;
  RigidTorque
      link_torque;  // rigid_torque less the drives' inertia, as far as the base parameters tell it from the links'
  BodyColumns body_columns;
};

// N values of one parameter's column in the rows of one joint; where no entry is, the column is zero.
struct EffectEntry {
  int parameter = 0;  // index into Effect::Parameters()
  int joint = 0;      // zero-based
  Eigen::VectorXd torque;
};

struct ShapeParameter {
  std::string name;
  std::string unit;
  double lower = 0.0, upper = 0.0;  // limits within which it is refined
  std::vector<double> grid;         // values to begin with, increasing
  // An open interval inside the limits that is left out, because the declared model imitates the effect there; empty:
  // none. Refinement stops at its ends.
  double gap_lower = 0.0, gap_upper = 0.0;

  // `to`, or how far towards it the shape may go from `from` (outside the gap).
  double Within(double from, double to) const;
};

enum class EffectSite { kJoint, kJointPair, kArm };

// What its torque is a function of, or drawn against: the velocity of its joint (friction), its position, or neither.
enum class EffectDomain { kVelocity, kPosition, kOther };

class Effect {
 public:
  virtual ~Effect() = default;

  virtual std::string id() const = 0;  // as in the contract: "stribeck"
  virtual EffectSite site() const = 0;
  virtual EffectDomain domain() const { return EffectDomain::kOther; }
  // A study declares it by its key `friction`: its columns are in the standard model.
  virtual bool in_standard_model() const { return false; }
  // Its linear parameters cannot be negative: friction would drive its joint, a compliance or a gap turn its sign. An
  // estimate below zero means that another effect is at work.
  virtual bool non_negative() const { return false; }
  virtual std::string physics() const = 0;         // one line
  virtual std::string how_to_confirm() const = 0;  // one line: what to do at the robot

  // joints (zero-based): one for kJoint, two for kJointPair, none for kArm (CHECK).
  // Parameters with kind kEffect, names unique over joints ("Fst3"), joint one-based (0: of the arm).
  virtual std::vector<Parameter> Parameters(const Robot& robot, const std::vector<int>& joints) const = 0;
  // Empty for an effect without shape. The grid may depend on all motions of the study.
  virtual std::vector<ShapeParameter> Shapes(const std::vector<EffectMotion>& motions,
                                             const std::vector<int>& joints) const;
  // shape: one value a shape parameter (CHECK).
  virtual std::vector<EffectEntry> Columns(const EffectMotion& motion, const std::vector<int>& joints,
                                           const Eigen::VectorXd& shape) const = 0;
  // Its shapes count recordings of the study (recording r and a fraction of it): other limits, other data, of no
  // meaning in another study. The effect is one of a single recording.
  virtual bool shapes_count_recordings() const { return false; }

  // What simulation has for it, never freed; nullptr where the standard model has it.
  virtual const EffectEquation* equation() const { return nullptr; }
  // The shape at which the columns are those of a simulated effect of this equation; empty for an effect without shape.
  virtual Eigen::VectorXd TrueShape(const SimulatedEffect& effect, const Scenario& scenario) const;
};

// All effects, the declared friction first, then those of the contract in its order. Never freed.
const std::vector<const Effect*>& AllEffects();
// nullptr where there is none.
const Effect* FindEffect(const std::string& id);

}  // namespace idim

#endif  // IDIM_CORE_EFFECTS_EFFECT_H_
