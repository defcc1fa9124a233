// One study, one estimator: the parameters of the arm with their uncertainty, as a table, JSON, CSV and a report.

#include <gflags/gflags.h>
#include <glog/logging.h>

#include <chrono>
#include <iostream>

#include "apps/pages/identification_report.h"
#include "apps/program.h"
#include "core/base/file.h"
#include "core/estimate/estimate_json.h"
#include "core/estimate/reference.h"
#include "core/robot/joint_units.h"
#include "solvers/estimators/estimators.h"
#include "solvers/loop/declared_effects.h"

DEFINE_string(estimator, "eiv",
              "eiv: errors in variables, maximum likelihood; ls | wls: least squares, rows as they are or weighted per "
              "joint; where the study identifies gains also tls | wtls: total least squares, gtls | wgtls: total least "
              "squares scaled by the noise of each column");
DEFINE_double(huber, 0.0,
              "eiv: samples whose residual is beyond this many standard deviations count less (Huber's loss; 2 is "
              "usual); 0: all count alike");
DEFINE_string(output, "", "Directory for estimate.json, residuals.csv and report.html");
DEFINE_double(
    r_sigma, 0.0,
    "Cancel parameters until max / min of the relative standard deviations is below this (the paper takes 10 to "
    "30); 0 keeps all base parameters");
DEFINE_string(reference, "", "Comma-separated JSON files in the format of estimate.json to print beside the estimate");

namespace {

using idim::Status;

Status Run(const std::string& study_path) {
  const auto start = std::chrono::steady_clock::now();
  const idim::Result<std::vector<idim::Reference>> references = idim::ReadReferences(FLAGS_reference);
  IDIM_RETURN_IF_ERROR(references);
  const idim::Result<idim::Study> study = idim::ReadStudy(study_path);
  IDIM_RETURN_IF_ERROR(study);
  idim::Progress progress;
  const idim::Result<idim::PreparedStudy> plain = idim::PrepareStudy(*study);
  IDIM_RETURN_IF_ERROR(plain);
  if (!study->effects.empty()) progress.At("declared effects");
  const idim::Result<idim::PreparedStudy> prepared = idim::DeclareEffects(*plain);
  if (prepared.status().code() == idim::StatusCode::kUntrusted) {
    idim::Estimate untrusted;
    untrusted.status = prepared.status();
    untrusted.robot = study->robot.name;
    untrusted.estimator = FLAGS_estimator;
    const Status written = idim::WriteFiles(FLAGS_output, {{"estimate.json", idim::EstimateToJson(untrusted)}});
    return written.ok() ? prepared.status() : written;
  }
  IDIM_RETURN_IF_ERROR(prepared);
  progress.At("observation matrix, " + FLAGS_estimator);
  const idim::Result<idim::EstimatorRunner> runner = idim::EstimatorRunner::Create(&*prepared);
  IDIM_RETURN_IF_ERROR(runner);
  idim::Result<idim::Identification> identification = runner->Run(FLAGS_estimator, FLAGS_r_sigma, FLAGS_huber);
  IDIM_RETURN_IF_ERROR(identification);

  progress.At("report");
  idim::Estimate& estimate = identification->estimate;
  estimate.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (estimate.parameters.empty()) {
    const Status written = idim::WriteFiles(FLAGS_output, {{"estimate.json", idim::EstimateToJson(estimate)}});
    return written.ok() ? estimate.status : written;
  }
  IDIM_RETURN_IF_ERROR(idim::WriteFiles(
      FLAGS_output, {{"estimate.json", idim::EstimateToJson(estimate)},
                     {"residuals.csv", idim::ResidualsToCsv(identification->series)},
                     {"report.html",
                      idim::RenderIdentificationReport(study->robot, estimate, identification->series, *references)}}));
  progress.Clear();
  std::cout << idim::EstimateToText(estimate, idim::TorqueUnits(study->robot));
  for (const idim::Reference& reference : *references) {
    std::cout << "\n" << idim::BesideReference(estimate, reference);
  }
  std::cout << "\nwritten to " << FLAGS_output << ": estimate.json residuals.csv report.html\n";
  return estimate.status;
}

}  // namespace

int main(int argc, char** argv) {
  const idim::ProgramUsage usage = {
      "idim_identify", {"STUDY"}, {"--output=DIR"}, "dynamic parameters with their uncertainty"};
  return idim::RunProgram(argc, argv, usage,
                          [](const std::vector<std::string>& arguments) { return Run(arguments[0]); });
}
