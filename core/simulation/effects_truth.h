// What a scenario's effects (core/simulation/effect_equation.h) do to its recordings.
//
// The motor follows the trajectory (the control loop is ideal) and is what is logged. Where a joint is flexible its
// link is free and its motion is integrated, all flexible joints together (core/simulation/effects_drive_train.h). So
// that nothing starts abruptly, simulation begins half a second before the recording.

#ifndef IDIM_CORE_SIMULATION_EFFECTS_TRUTH_H_
#define IDIM_CORE_SIMULATION_EFFECTS_TRUTH_H_

#include <Eigen/Core>
#include <cstddef>

#include "core/base/status.h"
#include "core/simulation/scenario.h"

namespace idim {

// Each effect is valid and can be simulated with the scenario's parameters: recordings exist; Coulomb friction is
// above 0 where an equation needs it; flexible links have inertia; an effect that cannot act twice on a joint does not.
// The message begins with "effects[k]", k from 1.
Status CheckEffects(const Scenario& scenario);

// How far effect k changes what is logged of each joint, n: norm of the noise-free signal with all effects less that
// without effect k, over the norm of the latter, all recordings together; 0 for a joint that has no signal at all.
Eigen::VectorXd EffectShares(const Scenario& scenario, size_t k);

// The largest of these over the joints that the effect names (all joints for an effect of the whole arm).
double EffectShare(const Scenario& scenario, size_t k);

// Makes effect k larger or smaller until its share is `share` (> 0, within 2 %) by one factor on its sizes: torques,
// shares, angles, masses, delays, gaps, displacements and compliances; shapes (vs, exponent, order, ...) stay.
// Untrusted where no size gives this share; the scenario is then as before.
Status ScaleEffect(Scenario* scenario, size_t k, double share);

namespace internal {
// Replaces torque and signal of a truth without effects. CHECKs the effects.
void ApplyEffects(const Scenario& scenario, const ScenarioRecording& recording, Truth* truth);
}  // namespace internal

}  // namespace idim

#endif  // IDIM_CORE_SIMULATION_EFFECTS_TRUTH_H_
