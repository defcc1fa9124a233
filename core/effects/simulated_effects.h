// The equations of the effects, as simulation asks for them.

#ifndef IDIM_CORE_EFFECTS_SIMULATED_EFFECTS_H_
#define IDIM_CORE_EFFECTS_SIMULATED_EFFECTS_H_

#include "core/simulation/effect_equation.h"

namespace idim {

// Of all effects that have one, in the registry's order. Never freed.
const EffectEquationList& EffectEquations();

}  // namespace idim

#endif  // IDIM_CORE_EFFECTS_SIMULATED_EFFECTS_H_
