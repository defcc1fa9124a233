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
  IDIM_RETURN_IF_ERROR(scenario);
  const idim::Result<std::vector<idim::OutputFile>> files = idim::RenderScenario(*scenario);
  IDIM_RETURN_IF_ERROR(files);
  return idim::WriteFiles(FLAGS_output, *files);
}

}  // namespace

int main(int argc, char** argv) {
  const idim::ProgramUsage usage = {
      "idim_simulate", {"SCENARIO"}, {"--output=DIR"}, "recordings and a study with known truth"};
  return idim::RunProgram(argc, argv, usage,
                          [](const std::vector<std::string>& arguments) { return Run(arguments[0]); });
}
