// One study, one estimator: the parameters of the arm with their uncertainty, as a table, JSON, CSV and a report.

#include <gflags/gflags.h>
#include <glog/logging.h>

#include <chrono>
#include <iostream>
#include <sstream>

#include "core/base/file.h"
#include "core/estimate/identification_report.h"
#include "core/estimate/reference.h"
#include "solvers/identification.h"

DEFINE_string(estimator, "wls", "ls | wls: least squares of the torque, rows as they are or weighted per joint");
DEFINE_string(output, "", "Directory for estimate.json, residuals.csv and report.html");
DEFINE_double(
    r_sigma, 0.0,
    "Cancel parameters until max / min of the relative standard deviations is below this (the paper takes 10 to "
    "30); 0 keeps all base parameters");
DEFINE_string(reference, "", "Comma-separated JSON files in the format of estimate.json to print beside the estimate");

namespace {

using idim::Status;

Status WriteEstimate(const idim::Estimate& estimate) {
  return idim::WriteFiles(FLAGS_output, {{"estimate.json", idim::EstimateToJson(estimate)}});
}

Status Run(const std::string& study_path) {
  const auto start = std::chrono::steady_clock::now();
  idim::LinearOptions options;
  options.weighted = FLAGS_estimator == "wls";
  options.essential_ratio = FLAGS_r_sigma;
  if (FLAGS_estimator != "ls" && FLAGS_estimator != "wls") {
    return Status::BadInput("--estimator=" + FLAGS_estimator + ": no such estimator here; expected ls or wls");
  }
  if (std::string error; !options.IsValid(&error)) return Status::BadInput("--r_sigma: " + error);
  std::vector<idim::Reference> references;
  std::stringstream paths(FLAGS_reference);
  for (std::string path; std::getline(paths, path, ',');) {
    idim::Result<idim::Reference> reference = idim::ReadReference(path);
    if (!reference.ok()) return reference.status();
    references.push_back(std::move(reference).value());
  }

  const idim::Result<idim::Study> study = idim::ReadStudy(study_path);
  if (!study.ok()) return study.status();
  const idim::Result<idim::PreparedStudy> prepared = idim::PrepareStudy(*study);
  if (!prepared.ok()) return prepared.status();
  idim::Result<idim::Identification> identification = idim::IdentifyLinear(*prepared, options);
  if (!identification.ok()) return identification.status();

  idim::Estimate& estimate = identification->estimate;
  estimate.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (!estimate.status.ok()) {
    const Status written = WriteEstimate(estimate);
    return written.ok() ? estimate.status : written;
  }
  const Status written = idim::WriteFiles(
      FLAGS_output, {{"estimate.json", idim::EstimateToJson(estimate)},
                     {"residuals.csv", idim::ResidualsToCsv(identification->series)},
                     {"report.html", idim::RenderIdentificationReport(estimate, identification->series, references)}});
  if (!written.ok()) return written;
  std::cout << idim::EstimateToText(estimate);
  for (const idim::Reference& reference : references) {
    std::cout << "\n" << idim::BesideReference(estimate, reference);
  }
  std::cout << "\nwritten to " << FLAGS_output << ": estimate.json residuals.csv report.html\n";
  return Status::Ok();
}

}  // namespace

int main(int argc, char** argv) {
  google::InitGoogleLogging(argv[0]);
  gflags::SetUsageMessage(
      "idim_identify STUDY --estimator=wls --output=DIR: dynamic parameters with their uncertainty");
  gflags::ParseCommandLineFlags(&argc, &argv, true);
  if (argc != 2 || FLAGS_output.empty()) {
    std::cerr << "idim_identify: expected one study and --output, as in: idim_identify study.yaml --output=DIR\n";
    return 1;
  }
  const Status status = Run(argv[1]);
  if (!status.ok()) std::cerr << "idim_identify: " << status.message() << "\n";
  return status.exit_code();
}
