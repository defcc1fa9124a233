// One study: what the declared model lacks, found, added, and the error before and after.

#include <gflags/gflags.h>
#include <glog/logging.h>

#include <algorithm>
#include <chrono>
#include <iostream>
#include <thread>

#include "apps/pages/loop_report.h"
#include "apps/program.h"
#include "core/base/file.h"
#include "core/base/text.h"
#include "core/estimate/estimate_json.h"

DEFINE_string(output, "", "Directory for loop.json, estimate.json, residuals.csv and report.html");
DEFINE_double(
    significance, idim::LoopOptions().significance,
    "An effect is believed below this p-value of its score test, corrected for all that was tried; in (0, 1)");
DEFINE_double(margin, idim::LoopOptions().margin,
              "An effect is added only if it lowers the error of its joints on data not fitted by more than this "
              "fraction; in (0, 1)");
DEFINE_int32(max_effects, idim::LoopOptions().max_effects, "At most so many effects are added, at least 0");
DEFINE_int32(threads, static_cast<int>(std::max(1u, std::thread::hardware_concurrency())),
             "Threads that look at candidates, at least 1 (default: all cores); the result does not depend on it");

namespace {

using idim::Status;

// Nothing is read before the flags are right.
Status CheckFlags() {
  const auto bad = [](const std::string& flag, const std::string& value, const std::string& expected) {
    return Status::BadInput("--" + flag + "=" + value + ": expected " + expected);
  };
  const auto is_fraction = [](double value) { return value > 0.0 && value < 1.0; };
  if (!is_fraction(FLAGS_significance)) {
    return bad("significance", idim::FormatNumber(FLAGS_significance), "a number between 0 and 1");
  }
  if (!is_fraction(FLAGS_margin)) return bad("margin", idim::FormatNumber(FLAGS_margin), "a number between 0 and 1");
  if (FLAGS_max_effects < 0) return bad("max_effects", std::to_string(FLAGS_max_effects), "at least 0");
  if (FLAGS_threads < 1) return bad("threads", std::to_string(FLAGS_threads), "at least 1");
  return Status::Ok();
}

Status Run(const std::string& study_path) {
  const auto start = std::chrono::steady_clock::now();
  IDIM_RETURN_IF_ERROR(CheckFlags());
  const idim::Result<idim::Study> study = idim::ReadStudy(study_path);
  IDIM_RETURN_IF_ERROR(study);
  idim::Progress progress;
  const idim::Result<idim::PreparedStudy> prepared = idim::PrepareStudy(*study);
  IDIM_RETURN_IF_ERROR(prepared);
  idim::LoopOptions options;
  options.significance = FLAGS_significance;
  options.margin = FLAGS_margin;
  options.max_effects = FLAGS_max_effects;
  options.threads = FLAGS_threads;
  options.progress = [&progress](const std::string& stage) { progress.At(stage); };
  idim::Result<idim::LoopResult> loop = idim::CloseLoop(*prepared, options);
  IDIM_RETURN_IF_ERROR(loop);

  progress.At("report");
  idim::Estimate& estimate = loop->after.estimate;
  if (estimate.parameters.empty()) {
    estimate.status = idim::StatusOf(*loop);
    estimate.robot = study->robot.name;
    estimate.estimator = "eiv";
  }
  estimate.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  std::vector<idim::OutputFile> files = {{"loop.json", idim::LoopToJson(*loop)},
                                         {"estimate.json", idim::EstimateToJson(estimate)},
                                         {"report.html", idim::RenderLoopReport(*loop)}};
  if (!estimate.parameters.empty()) files.push_back({"residuals.csv", idim::ResidualsToCsv(loop->after.series)});
  IDIM_RETURN_IF_ERROR(idim::WriteFiles(FLAGS_output, files));
  progress.Clear();
  std::cout << idim::LoopToText(*loop) << "\nwritten to " << FLAGS_output << ":";
  for (const idim::OutputFile& file : files) std::cout << " " << file.name;
  std::cout << "\n";
  return idim::StatusOf(*loop);
}

}  // namespace

int main(int argc, char** argv) {
  const idim::ProgramUsage usage = {
      "idim_close_loop", {"STUDY"}, {"--output=DIR"}, "the effects that the declared model lacks"};
  return idim::RunProgram(argc, argv, usage,
                          [](const std::vector<std::string>& arguments) { return Run(arguments[0]); });
}
