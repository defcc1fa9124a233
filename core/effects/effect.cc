#include "core/effects/effect.h"

namespace idim {

std::vector<ShapeParameter> Effect::Shapes(const std::vector<EffectMotion>&, const std::vector<int>&) const {
  return {};
}

}  // namespace idim
