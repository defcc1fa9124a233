// A simulated arm and an effect of it, drawn.

#ifndef IDIM_BENCHMARKS_BLIND_TRIAL_DRAW_H_
#define IDIM_BENCHMARKS_BLIND_TRIAL_DRAW_H_

#include "core/base/random.h"
#include "core/simulation/effect_equation.h"
#include "core/simulation/scenario.h"

namespace idim::blind_trial {

struct ArmOptions {
  int joints = 3;
  double duration = 12.0;        // [s] of each of the two recordings
  double rate = 250.0;           // [Hz]
  double signal_noise = 2.0;     // [%] of a joint's signal, each recorded sample
  double position_noise = 2e-5;  // [rad]
  double identified = 0.15;      // share of arms with gains to be identified
};

// Without effect.
Scenario DrawArm(const ArmOptions& options, Random* random);

// Of typical values, at any joint (pair) of the arm; an effect whose columns belong to one recording acts in one.
SimulatedEffect DrawEffect(const EffectEquation& equation, const Scenario& scenario, Random* random);

}  // namespace idim::blind_trial

#endif  // IDIM_BENCHMARKS_BLIND_TRIAL_DRAW_H_
