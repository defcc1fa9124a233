// Effects in the model of a prepared study: their columns along every recording, from the model so far.

#ifndef IDIM_SOLVERS_ACTIVE_EFFECTS_H_
#define IDIM_SOLVERS_ACTIVE_EFFECTS_H_

#include <string>
#include <vector>

#include "core/effects/effect.h"
#include "core/observation/prepared_study.h"
#include "solvers/prediction.h"

namespace idim {

// "stribeck on joint 3", "base_tilt".
std::string EffectTitle(const ActiveEffect& active);
bool SameEffect(const ActiveEffect& a, const ActiveEffect& b);  // id and joints

// Part of the band kept by the low-pass in which motion lies; EffectMotion::derivative_cutoff_hz.
inline constexpr double kDerivativeBand = 0.25;

// One a recording of the study, by the arm's torque with its active effects. `prepared` must outlive them.
std::vector<EffectMotion> MotionsOf(const PreparedStudy& prepared, const ArmParameters& arm);

// Replaces the effects of *prepared. With known values of its linear parameters an effect also gets a column for each
// shape parameter s, sum_p values_p dc_p/ds by central differences: a parameter named like the shape ("vs3") whose
// estimate is the step from the present shape (Gauss-Newton), and whose covariance is that of the shape.
// motions: as MotionsOf() gives them.
void SetEffects(const std::vector<ActiveEffect>& effects, const std::vector<EffectMotion>& motions,
                PreparedStudy* prepared);

// Index into PreparedStudy::effect_parameters of the first parameter of each effect, then their count.
std::vector<int> FirstParameters(const PreparedStudy& prepared);

}  // namespace idim

#endif  // IDIM_SOLVERS_ACTIVE_EFFECTS_H_
