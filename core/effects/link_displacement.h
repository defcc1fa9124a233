// The link is not where the motor is: the position is measured at the motor, and the transmission of joint j gives way
// by p d_j(t), p the parameter: q_link = q + p d_j e_j. Motor, drive inertia (where the base parameters tell it from
// the links') and friction stay at the measured state; the torque of the links moves to first order in p,
//   column = d tau_link / dq_j d_j + d tau_link / d(dq_j) d_j' + d tau_link / d(ddq_j) d_j'',
// in the rows of all joints, by a central difference along (d_j, d_j', d_j''): exact in velocity and acceleration, of
// which torque is a polynomial of second degree. d_j' and d_j'' are central differences in time.

#ifndef IDIM_CORE_EFFECTS_LINK_DISPLACEMENT_H_
#define IDIM_CORE_EFFECTS_LINK_DISPLACEMENT_H_

#include <Eigen/Core>
#include <vector>

#include "core/effects/effect.h"

namespace idim {

// The column of parameter 0 in the rows of all joints; displacement: d_j, N. Empty where nothing moves.
std::vector<EffectEntry> LinkTorqueAlong(const EffectMotion& motion, int joint, const Eigen::VectorXd& displacement);

}  // namespace idim

#endif  // IDIM_CORE_EFFECTS_LINK_DISPLACEMENT_H_
