// Physically consistent standard parameters with stated base parameters (solvers/consistent/plausible_parameters.h),
// written so that a scenario can name the file under its key `parameters`.

#include <gflags/gflags.h>
#include <glog/logging.h>

#include <cstdio>
#include <iostream>
#include <utility>

#include "apps/program.h"
#include "core/base/file.h"
#include "core/base/text.h"
#include "core/robot/robot_reader.h"
#include "solvers/consistent/plausible_parameters.h"

DEFINE_string(output, "", "Directory for parameters.yaml");

namespace {

std::string Number(const char* format, double value) {
  char text[64];
  std::snprintf(text, sizeof(text), format, value);
  return text;
}

std::string RenderParameters(const idim::StandardModel& model, const idim::PlausibleSummary& summary) {
  std::string text = "# Found by idim_plausible; largest distance to a stated base parameter " +
                     Number("%.3f", summary.largest_distance) + " standard deviations.\nparameters:\n";
  for (int link = 1; link <= model.dof(); ++link) {
    std::vector<std::string> items;
    for (int c = 0; c < model.columns(); ++c) {
      const idim::Parameter& parameter = model.parameters()[c];
      if (parameter.joint != link) continue;
      const std::string key = parameter.name.substr(0, parameter.name.size() - std::to_string(link).size());
      items.push_back(key + ": " + Number("%.6g", summary.chi[c] + 0.0));  // + 0.0: no "-0"
    }
    text += "  - {" + idim::Join(items, ", ") + "}  # link " + std::to_string(link) + "\n";
  }
  return text;
}

void PrintTable(const idim::BaseParameters& base, const idim::PlausibleRequest& request,
                const idim::PlausibleSummary& summary) {
  std::cout << "name        stated     sigma   reached  distance\n";
  for (size_t k = 0; k < request.base.size(); ++k) {
    const idim::StatedParameter& stated = request.base[k];
    std::printf("%-6s %11.5g %9.3g %9.5g %9.3f\n", base.parameters()[stated.index].name.c_str(), stated.value,
                stated.standard_deviation, summary.base[stated.index], summary.distance[k]);
  }
  std::printf("%d iterations, largest distance %.3f, bodies %.2f spreads from the rough ones (root mean square)\n",
              summary.iterations, summary.largest_distance, summary.prior_distance);
}

idim::Status Run(const std::string& robot_path, const std::string& request_path) {
  idim::Result<idim::Robot> robot = idim::ReadRobot(robot_path);
  IDIM_RETURN_IF_ERROR(robot);
  const idim::BaseParameters base(idim::StandardModel(*robot, idim::FrictionModel()));
  const idim::Result<idim::PlausibleRequest> request = idim::ReadPlausibleRequest(request_path, base);
  IDIM_RETURN_IF_ERROR(request);
  const idim::PlausibleSummary summary = idim::FindPlausibleParameters(base, *request);
  if (!summary.IsSolutionUsable()) return idim::Status::Untrusted("no convergence: " + summary.message);
  PrintTable(base, *request, summary);
  return idim::WriteFiles(FLAGS_output, {{"parameters.yaml", RenderParameters(base.model(), summary)}});
}

}  // namespace

int main(int argc, char** argv) {
  const idim::ProgramUsage usage = {
      "idim_plausible", {"ROBOT", "REQUEST"}, {"--output=DIR"}, "standard parameters of a robot that could exist"};
  return idim::RunProgram(argc, argv, usage,
                          [](const std::vector<std::string>& arguments) { return Run(arguments[0], arguments[1]); });
}
