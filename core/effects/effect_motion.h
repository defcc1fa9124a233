// The motion that effects see, built from the model so far.
//
// Base parameters are standard parameters with the regrouped ones zero: every torque is that of StandardModel. This
// holds for the robot's own gravity. With gravity turned, first moments of link 1 that the regrouping dropped
// (gravity along axis 1 hides them) are missing; base_tilt has columns for them.
//
// Torque is affine in gravity: with another gravity g, tau(g0) + sum_k (g - g0)_k tau_k, tau_k the static torque in
// unit gravity along base axis k. No model has to be built for each g.

#ifndef IDIM_CORE_EFFECTS_EFFECT_MOTION_H_
#define IDIM_CORE_EFFECTS_EFFECT_MOTION_H_

#include <Eigen/Core>
#include <memory>

#include "core/dynamics/base_parameters.h"
#include "core/effects/effect.h"
#include "core/motion/preprocessing.h"

namespace idim {

// base: its robot must outlive the result. states: N x n at the recorded instants. recording: index among those of the
// study. velocity_sigma: n, of dq. chi: base.size() base parameters of the model so far, friction and drive inertias
// among them. payload: of this recording, in the frame of the last link; zero without one. position_sigma: n, of the
// filtered q; empty: zero. Sizes are CHECKed. The functions of the result may be called from several threads at once.
EffectMotion MakeEffectMotion(const BaseParameters& base, std::shared_ptr<const JointStates> states, int recording,
                              const Eigen::VectorXd& velocity_sigma, const Eigen::VectorXd& chi,
                              const InertialVector& payload, const Eigen::VectorXd& position_sigma = Eigen::VectorXd());

}  // namespace idim

#endif  // IDIM_CORE_EFFECTS_EFFECT_MOTION_H_
