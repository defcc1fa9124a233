// Recordings and a study from a scenario (core/simulation/scenario.h describes the file).

#include <gflags/gflags.h>
#include <glog/logging.h>

#include <iostream>

#include "core/base/file.h"
#include "core/simulation/scenario.h"

DEFINE_string(output, "", "Directory for the recordings, study.yaml, robot.yaml and truth.json");

namespace {

idim::Status Run(const std::string& scenario_path) {
  const idim::Result<idim::Scenario> scenario = idim::ReadScenario(scenario_path);
  if (!scenario.ok()) return scenario.status();
  const idim::Result<std::vector<idim::OutputFile>> files = idim::RenderScenario(*scenario);
  if (!files.ok()) return files.status();
  return idim::WriteFiles(FLAGS_output, *files);
}

}  // namespace

int main(int argc, char** argv) {
  google::InitGoogleLogging(argv[0]);
  gflags::SetUsageMessage("idim_simulate SCENARIO --output=DIR: recordings and a study with known truth");
  gflags::ParseCommandLineFlags(&argc, &argv, true);
  if (argc != 2 || FLAGS_output.empty()) {
    std::cerr << "idim_simulate: expected one scenario and --output, as in: idim_simulate scenario.yaml --output=DIR\n";
    return 1;
  }
  const idim::Status status = Run(argv[1]);
  if (!status.ok()) std::cerr << status.message() << "\n";
  return status.exit_code();
}
