// Estimates judged on the validation recordings of a study: torque error, condition number, payload mass.

#include <gflags/gflags.h>
#include <glog/logging.h>

#include <iostream>

#include "apps/pages/validation_report.h"
#include "apps/program.h"
#include "core/base/file.h"
#include "core/recording/study.h"
#include "solvers/judge/validation.h"

DEFINE_string(estimate, "", "Comma-separated estimate.json files to judge, with their gains or the study's");
DEFINE_string(output, "", "Directory for validation.json and report.html");

namespace {

using idim::Status;

Status Run(const std::string& study_path) {
  const idim::Result<std::vector<idim::Reference>> estimates = idim::ReadReferences(FLAGS_estimate);
  IDIM_RETURN_IF_ERROR(estimates);
  const idim::Result<idim::Study> study = idim::ReadStudy(study_path);
  IDIM_RETURN_IF_ERROR(study);
  idim::Progress progress;
  const idim::Result<idim::PreparedStudy> prepared = idim::PrepareStudy(*study);
  IDIM_RETURN_IF_ERROR(prepared);
  std::vector<idim::Validation> validations;
  for (const idim::Reference& estimate : *estimates) {
    progress.At(estimate.name);
    idim::Result<idim::Validation> validation = idim::Validate(*prepared, estimate);
    IDIM_RETURN_IF_ERROR(validation);
    validations.push_back(std::move(validation).value());
  }
  const Status written =
      idim::WriteFiles(FLAGS_output, {{"validation.json", idim::ValidationToJson(study->robot.name, validations)},
                                      {"report.html", idim::RenderValidationReport(study->robot, validations)}});
  IDIM_RETURN_IF_ERROR(written);
  progress.Clear();
  std::cout << idim::ValidationToText(validations);
  std::cout << "\nwritten to " << FLAGS_output << ": validation.json report.html\n";
  return Status::Ok();
}

}  // namespace

int main(int argc, char** argv) {
  const idim::ProgramUsage usage = {"idim_validate",
                                    {"STUDY"},
                                    {"--estimate=FILE.json,...", "--output=DIR"},
                                    "estimates judged on recordings they have not seen"};
  return idim::RunProgram(argc, argv, usage,
                          [](const std::vector<std::string>& arguments) { return Run(arguments[0]); });
}
