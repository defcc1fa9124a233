#include "core/effects/simulated_effects.h"

#include "core/effects/effect.h"

namespace idim {

const EffectEquationList& EffectEquations() {
  static const EffectEquationList* const equations = [] {
    auto* list = new EffectEquationList;
    for (const Effect* effect : AllEffects()) {
      if (effect->equation() != nullptr) list->push_back(effect->equation());
    }
    return list;
  }();
  return *equations;
}

}  // namespace idim
