#include "core/effects/registry.h"

namespace idim {
namespace {

std::vector<const Effect*>* MakeAll() {
  auto* all = new std::vector<const Effect*>;
#define IDIM_MAKE_EFFECT(name) all->push_back(Make##name().release());
  IDIM_EFFECTS(IDIM_MAKE_EFFECT)
#undef IDIM_MAKE_EFFECT
  return all;
}

}  // namespace

const std::vector<const Effect*>& AllEffects() {
  static const std::vector<const Effect*>* const all = MakeAll();
  return *all;
}

const Effect* FindEffect(const std::string& id) {
  for (const Effect* effect : AllEffects()) {
    if (effect->id() == id) return effect;
  }
  return nullptr;
}

}  // namespace idim
