// The list `effects` of a scenario -> Scenario::effects.

#ifndef IDIM_CORE_SIMULATION_EFFECTS_READER_H_
#define IDIM_CORE_SIMULATION_EFFECTS_READER_H_

#include "core/base/yaml.h"
#include "core/simulation/scenario.h"

namespace idim::internal {

// All else of the scenario has been read. An undefined node: no effects. `file` keeps a failure.
void ReadEffects(YamlFile* file, const YAML::Node& node, const EffectEquationList& equations, Scenario* scenario);

}  // namespace idim::internal

#endif  // IDIM_CORE_SIMULATION_EFFECTS_READER_H_
