// What the programs share: their command line, their messages, their exit code, and what they are at.

#ifndef IDIM_APPS_PROGRAM_H_
#define IDIM_APPS_PROGRAM_H_

#include <gflags/gflags.h>
#include <glog/logging.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <functional>
#include <iostream>
#include <string>

#include "core/base/status.h"

namespace idim {

// Parses the flags, runs on the one positional argument, reports on stderr. Returns the exit code.
inline int RunProgram(int argc, char** argv, const std::string& name, const std::string& argument,
                      const std::string& purpose, const std::function<Status(const std::string&)>& run,
                      const std::string* output) {
  google::InitGoogleLogging(argv[0]);
  const std::string usage = name + " " + argument + " --output=DIR";
  gflags::SetUsageMessage(usage + ": " + purpose);
  gflags::ParseCommandLineFlags(&argc, &argv, true);
  if (argc != 2 || output->empty()) {
    std::cerr << name << ": expected one " << argument << " and --output, as in: " << usage << "\n";
    return 1;
  }
  const Status status = run(argv[1]);
  if (!status.ok()) std::cerr << name << ": " << status.message() << "\n";
  return status.exit_code();
}

// The stage that a program is at, on stderr when that is a terminal and the work takes longer than two seconds.
class Progress {
 public:
  Progress() : start_(std::chrono::steady_clock::now()), terminal_(isatty(STDERR_FILENO) != 0) {}
  ~Progress() { Clear(); }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void At(const std::string& stage) {
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    if (!terminal_ || seconds < 2.0) return;
    std::fprintf(stderr, "\r\033[K%.0f s: %s", seconds, stage.c_str());
    shown_ = true;
  }
  void Clear() {
    if (shown_) std::fprintf(stderr, "\r\033[K");
    shown_ = false;
  }

 private:
  std::chrono::steady_clock::time_point start_;
  bool terminal_;
  bool shown_ = false;
};

}  // namespace idim

#endif  // IDIM_APPS_PROGRAM_H_
