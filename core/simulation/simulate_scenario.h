// From a scenario to its recordings and the files of `idim_simulate`.

#ifndef IDIM_CORE_SIMULATION_SIMULATE_SCENARIO_H_
#define IDIM_CORE_SIMULATION_SIMULATE_SCENARIO_H_

#include <vector>

#include "core/base/file.h"
#include "core/base/status.h"
#include "core/recording/study.h"
#include "core/simulation/scenario.h"
#include "core/simulation/simulate.h"

namespace idim {

// Truth and log of one recording of the scenario, effects included. CHECKs the effects (CheckEffects(),
// core/simulation/effects_truth.h). q, dq and ddq are the motors' in joint coordinates, which is what is logged.
Truth SimulateTruth(const Scenario& scenario, const ScenarioRecording& recording);
Recording SimulateLog(const Scenario& scenario, const ScenarioRecording& recording, const Truth& truth);

// The study that `idim_simulate` writes, its recordings to be simulated: what an experimenter knows of the scenario.
Study StudyOf(const Scenario& scenario);

// All that `idim_simulate` writes, none of it depending on where: robot.yaml (and its URDF), one CSV a recording,
// study.yaml, and truth.json with the true gains, base, payload and standard parameters, named as in estimate.json, and
// the effects, of which study.yaml says nothing.
// Quantised values are written with the digits that tell the steps apart to a tenth, others in full.
Result<std::vector<OutputFile>> RenderScenario(const Scenario& scenario);

}  // namespace idim

#endif  // IDIM_CORE_SIMULATION_SIMULATE_SCENARIO_H_
