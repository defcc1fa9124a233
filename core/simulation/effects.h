// Effects that a scenario puts into the data beyond the standard model: physics in the time domain, written without a
// glance at the columns that identification uses for them. An effect has an id, joints and values; several may act at
// once, several of one id too. Ids, keys in `values` [unit] and laws (s_j: direction of motion of joint j, sign(dq_j)
// unless presliding acts on it; dq is the motors' velocity in joint coordinates; torques are those that the drive has
// to deliver beyond the standard model's):
//
//   stribeck             Fst [N m], vs [rad/s]: s Fst exp(-(|dq| / vs)^2)
//   power_viscous        coefficient, exponent: sign(dq) coefficient |dq|^exponent, beside the linear Fv dq
//   asymmetric_friction  viscous_difference, coulomb_difference (forwards less backwards): Fv and Fs are larger by half
//                        of it for dq > 0, smaller by half for dq < 0
//   load_friction        mu: s mu |torque of links, payload, spring and drive inertia on that joint|
//   presliding           displacement x [rad]: Dahl's bristle y, dy/dt = (dq / x) (1 - sign(dq) y), at rest y = 0; the
//                        direction s of all dry friction of the joint (Fs, Stribeck, load, asymmetric) is y. Fs > 0.
//   thermal_drift        viscous_share, coulomb_share, time_constant [s]: viscous (and power) friction of the joint, or
//                        its dry friction, times 1 + share (1 - exp(-t / time_constant)); t begins anew in every
//                        recording
//   torque_ripple        amplitude [N m], phase [rad], order or motor_order: amplitude cos(order q + phase), q the
//                        motor's position in joint coordinates, or cos(motor_order (T q)_j + phase), T the transmission
//   joint_spring         stiffness [N m/rad], rest [rad]: stiffness (q - rest), on the link's side
//   motor_coupling       joints a, b; inertia [kg m^2], viscous, coulomb: on a inertia ddq_b + viscous dq_b
//                        + coulomb sign(dq_a + dq_b), on b likewise with a (what eq. (25) of Gautier & Briot adds)
//   base_tilt            angle_1, angle_2 [rad]: gravity turned by the rotation vector angle_1 e1 + angle_2 e2. e1 is
//                        the base's x axis made normal to gravity g (y where g lies along x), e2 = e1 x g / |g|
//                        (y for gravity along -z)
//   payload_change       M [kg], x, y, z [m], from [s]: a point mass M at (x, y, z) on the last link from then on
//   time_delay           delay [s]: the signal logged at t is that of t - delay
//   gain_saturation      loss, signal [signal unit]: tau = g v (1 + 3 loss (v / signal)^2)^(-1/3), that is
//                        g v (1 - loss (v / signal)^2) for small loss, and increasing in v throughout
//   joint_elasticity     stiffness [N m/rad], damping_ratio (0.1): a spring and a damper between motor and link
//   backlash             gap [rad] (whole), contact_frequency [Hz] (100), damping_ratio (0.3): play between motor and
//                        link, with an elastic contact that does not pull
//
// The two last: the motor follows the trajectory (the control loop is ideal) and is what is logged; the link is free
// and its motion is integrated, all flexible joints together, by the Runge-Kutta method of order 4. Ia, friction and
// ripple act at the motor; springs, weight and payload on the link. With M the link's inertia about its joint where the
// first recording starts, without payload: backlash has the contact stiffness M (2 pi contact_frequency)^2; damping is
// 2 damping_ratio sqrt(stiffness M), in a contact from its first 2e-5 rad on. Both on one joint: springs in series, the
// larger damping ratio. So that nothing starts abruptly, simulation begins half a second before the recording.

#ifndef IDIM_CORE_SIMULATION_EFFECTS_H_
#define IDIM_CORE_SIMULATION_EFFECTS_H_

#include <map>
#include <string>
#include <vector>

#include "core/robot/robot.h"

namespace idim {

struct SimulatedEffect {
  std::string id;
  std::vector<int> joints;               // zero-based; one or more, two (motor_coupling), none (of the whole arm)
  std::map<std::string, double> values;  // by the keys above
  std::string recording;                 // acts in this one alone; "": in all

  // On failure `error` names the value and the constraint.
  bool IsValid(const Robot& robot, std::string* error) const;
  // The value given, else the default. CHECKs that the effect has such a key.
  double Value(const std::string& key) const;
};

enum class EffectJoints { kOneOrMore, kTwo, kNone };

struct SimulatedEffectKey {
  std::string name;
  double lower = 0.0, upper = 0.0;  // limits of the value
  bool lower_allowed = true;        // the lower limit itself
  bool required = true;
  double standard = 0.0;  // where it is not given
  int size_power = 0;     // the value is multiplied by factor^size_power when the effect is scaled
};

struct SimulatedEffectKind {
  std::string id;
  EffectJoints joints = EffectJoints::kOneOrMore;
  std::vector<SimulatedEffectKey> keys;
  std::vector<std::string> one_of;  // at least one of these is given
};

// All fifteen, in the order above.
const std::vector<SimulatedEffectKind>& SimulatedEffectKinds();
// nullptr where there is none.
const SimulatedEffectKind* FindSimulatedEffect(const std::string& id);

}  // namespace idim

#endif  // IDIM_CORE_SIMULATION_EFFECTS_H_
