// The effects that a study declares (key `effects`), each at its place.

#ifndef IDIM_CORE_EFFECTS_PLACED_EFFECTS_H_
#define IDIM_CORE_EFFECTS_PLACED_EFFECTS_H_

#include <string>
#include <vector>

#include "core/base/status.h"
#include "core/effects/effect.h"
#include "core/recording/study.h"

namespace idim {

struct PlacedEffect {
  const Effect* effect = nullptr;    // none of the declared friction
  std::vector<int> joints;           // zero-based, see Effect::Parameters()
  std::vector<DeclaredShape> shape;  // empty: to be found
  std::string where;                 // "file:line: key '...'", for messages
};

// One a place, in the study's order: joints [1, 2] of a joint's effect make two. BadInput, naming file, line and key:
// an unknown id (with the nearest known one), one of the declared friction, joints that do not suit the effect, an
// effect twice at a place.
Result<std::vector<PlacedEffect>> PlaceDeclaredEffects(const Study& study);

}  // namespace idim

#endif  // IDIM_CORE_EFFECTS_PLACED_EFFECTS_H_
