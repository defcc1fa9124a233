// All estimators on the same data, side by side.

#include <gflags/gflags.h>
#include <glog/logging.h>

#include <chrono>
#include <iostream>

#include "apps/program.h"
#include "core/base/file.h"
#include "core/estimate/comparison_report.h"
#include "core/estimate/reference.h"
#include "solvers/estimators.h"

DEFINE_string(output, "", "Directory for comparison.json and report.html");
DEFINE_double(r_sigma, 0.0,
              "Cancel parameters until max / min of the relative standard deviations is below this (the paper takes 10 "
              "to 30); 0 keeps all base parameters");
DEFINE_string(reference, "", "Comma-separated JSON files in the format of estimate.json to print beside the estimates");

namespace {

using idim::Status;

Status Run(const std::string& study_path) {
  const idim::Result<std::vector<idim::Reference>> references = idim::ReadReferences(FLAGS_reference);
  if (!references.ok()) return references.status();
  const idim::Result<idim::Study> study = idim::ReadStudy(study_path);
  if (!study.ok()) return study.status();
  idim::Progress progress;
  progress.At("reading and filtering");
  const idim::Result<idim::PreparedStudy> prepared = idim::PrepareStudy(*study);
  if (!prepared.ok()) return prepared.status();
  progress.At("observation matrix");
  const idim::Result<idim::EstimatorRunner> runner = idim::EstimatorRunner::Create(&*prepared);
  if (!runner.ok()) return runner.status();
  idim::Comparison comparison;
  comparison.references = *references;
  bool any_usable = false;
  for (const std::string& name : idim::EstimatorNames(study->gains_mode)) {
    progress.At(name);
    const auto start = std::chrono::steady_clock::now();
    idim::Result<idim::Identification> identification = runner->Run(name, FLAGS_r_sigma);
    if (!identification.ok()) return identification.status();
    idim::Estimate& estimate = identification->estimate;
    estimate.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    any_usable |= estimate.status.ok();
    comparison.estimates.push_back(std::move(estimate));
  }
  comparison.sequential = runner->RunSequential();
  progress.At("is LS biased?");
  idim::Result<std::vector<idim::BiasTest>> bias = runner->TestBias();
  if (!bias.ok()) return bias.status();
  comparison.bias_tests = std::move(bias).value();
  const Status written = idim::WriteFiles(FLAGS_output, {{"comparison.json", idim::ComparisonToJson(comparison)},
                                                         {"report.html", idim::RenderComparisonReport(comparison)}});
  if (!written.ok()) return written;
  progress.Clear();
  std::cout << idim::ComparisonToText(comparison);
  std::cout << "\nwritten to " << FLAGS_output << ": comparison.json report.html\n";
  if (any_usable) return Status::Ok();
  return Status::Untrusted("no estimator gives an estimate that can be trusted; the first says: " +
                           comparison.estimates.front().status.message());
}

}  // namespace

int main(int argc, char** argv) {
  return idim::RunProgram(argc, argv, "idim_compare", "STUDY", "all estimators on the same data, side by side", &Run,
                          &FLAGS_output);
}
