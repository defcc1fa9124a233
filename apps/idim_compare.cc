// All estimators on the same data, side by side.

#include <gflags/gflags.h>
#include <glog/logging.h>

#include <algorithm>
#include <chrono>
#include <iostream>
#include <optional>
#include <thread>

#include "apps/pages/comparison_report.h"
#include "apps/program.h"
#include "core/base/file.h"
#include "core/estimate/reference.h"
#include "solvers/estimators/estimators.h"
#include "solvers/judge/monte_carlo.h"
#include "solvers/loop/declared_effects.h"

DEFINE_string(output, "", "Directory for comparison.json and report.html");
DEFINE_double(r_sigma, 0.0,
              "Cancel parameters until max / min of the relative standard deviations is below this (the paper takes 10 "
              "to 30); 0 keeps all base parameters");
DEFINE_string(reference, "", "Comma-separated JSON files in the format of estimate.json to print beside the estimates");
DEFINE_int32(monte_carlo, 0,
             "Number of runs (at least 2) on data simulated from the last estimate that can be trusted: bias, spread, "
             "error and interval coverage of every estimator; 0: none");
DEFINE_int64(seed, 1, "Of the simulated noise, at least 0; same seed, same results, whatever the number of threads");
DEFINE_int32(threads, static_cast<int>(std::max(1u, std::thread::hardware_concurrency())),
             "Threads for the simulated runs, at least 1 (default: all cores)");

namespace {

using idim::Status;

// The flags of the simulation, as a whole: nothing is read before they are right.
Status CheckMonteCarloFlags() {
  const auto bad = [](const std::string& flag, long long value, const std::string& expected) {
    return Status::BadInput("--" + flag + "=" + std::to_string(value) + ": expected " + expected);
  };
  if (FLAGS_monte_carlo < 0 || FLAGS_monte_carlo == 1) {
    return bad("monte_carlo", FLAGS_monte_carlo, "0 for none, or at least 2 runs, since one has no spread");
  }
  if (FLAGS_seed < 0) return bad("seed", FLAGS_seed, "a whole number of at least 0");
  if (FLAGS_threads < 1) return bad("threads", FLAGS_threads, "at least 1");
  return Status::Ok();
}

// The truth to simulate from: the last estimate that can be trusted, since the list goes from the plainest to the one
// that models the noise best. nullptr: none.
const idim::Estimate* Reference(const std::vector<idim::Estimate>& estimates) {
  for (size_t k = estimates.size(); k-- > 0;) {
    if (estimates[k].status.ok() && !estimates[k].parameters.empty()) return &estimates[k];
  }
  return nullptr;
}

Status Simulate(const idim::PreparedStudy& prepared, idim::Progress* progress, idim::Comparison* comparison) {
  const idim::Estimate* reference = Reference(comparison->estimates);
  if (reference == nullptr) {
    return Status::Untrusted(
        "--monte_carlo: no estimator gives an estimate that can be trusted, so there is no truth "
        "to simulate from; the first says: " +
        comparison->estimates.front().status.message());
  }
  idim::MonteCarloOptions options;
  options.runs = FLAGS_monte_carlo;
  options.seed = static_cast<std::uint64_t>(FLAGS_seed);
  options.threads = FLAGS_threads;
  options.essential_ratio = FLAGS_r_sigma;
  const std::string of_all = " of " + std::to_string(options.runs);
  idim::Result<idim::MonteCarlo> monte_carlo =
      RunMonteCarlo(prepared, *reference, idim::EstimatorNames(prepared.model.gains_mode), options,
                    [&](int done) { progress->At("run " + std::to_string(done) + of_all); });
  IDIM_RETURN_IF_ERROR(monte_carlo);
  comparison->monte_carlo = std::move(monte_carlo).value();
  return Status::Ok();
}

Status Run(const std::string& study_path) {
  IDIM_RETURN_IF_ERROR(CheckMonteCarloFlags());
  const idim::Result<std::vector<idim::Reference>> references = idim::ReadReferences(FLAGS_reference);
  IDIM_RETURN_IF_ERROR(references);
  const idim::Result<idim::Study> study = idim::ReadStudy(study_path);
  IDIM_RETURN_IF_ERROR(study);
  idim::Progress progress;
  progress.At("reading and filtering");
  const idim::Result<idim::PreparedStudy> plain = idim::PrepareStudy(*study);
  IDIM_RETURN_IF_ERROR(plain);
  if (!study->effects.empty()) progress.At("declared effects");
  const idim::Result<idim::PreparedStudy> prepared = idim::DeclareEffects(*plain);
  IDIM_RETURN_IF_ERROR(prepared);
  progress.At("observation matrix");
  const idim::Result<idim::EstimatorRunner> runner = idim::EstimatorRunner::Create(&*prepared);
  IDIM_RETURN_IF_ERROR(runner);
  idim::Comparison comparison;
  comparison.references = *references;
  bool any_usable = false;
  for (const std::string& name : idim::EstimatorNames(study->gains_mode)) {
    progress.At(name);
    const auto start = std::chrono::steady_clock::now();
    idim::Result<idim::Identification> identification = runner->Run(name, FLAGS_r_sigma);
    IDIM_RETURN_IF_ERROR(identification);
    idim::Estimate& estimate = identification->estimate;
    estimate.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    any_usable |= estimate.status.ok();
    comparison.estimates.push_back(std::move(estimate));
  }
  comparison.sequential = runner->RunSequential();
  progress.At("is LS biased?");
  idim::Result<std::vector<idim::BiasTest>> bias = runner->TestBias();
  IDIM_RETURN_IF_ERROR(bias);
  comparison.bias_tests = std::move(bias).value();
  Status simulated = Status::Ok();
  if (FLAGS_monte_carlo > 0) simulated = Simulate(*prepared, &progress, &comparison);
  if (simulated.code() == idim::StatusCode::kBadInput) return simulated;
  IDIM_RETURN_IF_ERROR(idim::WriteFiles(FLAGS_output, {{"comparison.json", idim::ComparisonToJson(comparison)},
                                                       {"report.html", idim::RenderComparisonReport(comparison)}}));
  progress.Clear();
  std::cout << idim::ComparisonToText(comparison);
  std::cout << "\nwritten to " << FLAGS_output << ": comparison.json report.html\n";
  IDIM_RETURN_IF_ERROR(simulated);
  if (any_usable) return Status::Ok();
  return Status::Untrusted("no estimator gives an estimate that can be trusted; the first says: " +
                           comparison.estimates.front().status.message());
}

}  // namespace

int main(int argc, char** argv) {
  const idim::ProgramUsage usage = {
      "idim_compare", {"STUDY"}, {"--output=DIR"}, "all estimators on the same data, side by side"};
  return idim::RunProgram(argc, argv, usage,
                          [](const std::vector<std::string>& arguments) { return Run(arguments[0]); });
}
