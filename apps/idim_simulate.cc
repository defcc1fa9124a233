// Recordings and a study from a scenario (core/simulation/scenario.h describes the file).

#include <gflags/gflags.h>
#include <glog/logging.h>

#include <iostream>

#include "apps/program.h"
#include "core/base/file.h"
#include "core/effects/simulated_effects.h"
#include "core/simulation/scenario.h"
#include "core/simulation/simulate_scenario.h"

DEFINE_string(output, "", "Directory for the recordings, study.yaml, robot.yaml and truth.json");

namespace {

idim::Status Run(const std::string& scenario_path) {
  const idim::Result<idim::Scenario> scenario = idim::ReadScenario(scenario_path, idim::EffectEquations());
  if (!scenario.ok()) return scenario.status();
  const idim::Result<std::vector<idim::OutputFile>> files = idim::RenderScenario(*scenario);
  if (!files.ok()) return files.status();
  return idim::WriteFiles(FLAGS_output, *files);
}

}  // namespace

int main(int argc, char** argv) {
  return idim::RunProgram(argc, argv, "idim_simulate", "SCENARIO", "recordings and a study with known truth", &Run,
                          &FLAGS_output);
}
