// Simulated effects as tests write them: by id.

#ifndef IDIM_TESTS_SUPPORT_GIVEN_EFFECTS_H_
#define IDIM_TESTS_SUPPORT_GIVEN_EFFECTS_H_

#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "core/effects/simulated_effects.h"

namespace idim::testing {

struct GivenEffect {
  std::string id;
  std::vector<int> joints;
  std::map<std::string, double> values;
  std::string recording;
};

inline SimulatedEffect Simulated(const GivenEffect& given) {
  for (const EffectEquation* equation : EffectEquations()) {
    if (equation->id() == given.id) return {equation, given.joints, given.values, given.recording};
  }
  ADD_FAILURE() << "no effect " << given.id;
  return {};
}

inline std::vector<SimulatedEffect> Simulated(const std::vector<GivenEffect>& given) {
  std::vector<SimulatedEffect> effects;
  for (const GivenEffect& one : given) effects.push_back(Simulated(one));
  return effects;
}

}  // namespace idim::testing

#endif  // IDIM_TESTS_SUPPORT_GIVEN_EFFECTS_H_
