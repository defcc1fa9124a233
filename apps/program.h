// What the programs share: their command line, their messages, their exit code, and what they are at.

#ifndef IDIM_APPS_PROGRAM_H_
#define IDIM_APPS_PROGRAM_H_

#include <gflags/gflags.h>
#include <glog/logging.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <iostream>
#include <string>
#include <vector>

#include "core/base/status.h"
#include "core/base/text.h"
#include "core/base/version.h"

namespace idim {

// A command line: NAME ARGUMENTS REQUIRED: PURPOSE.
struct ProgramUsage {
  std::string name;
  std::vector<std::string> arguments;  // positional, each of them needed: "STUDY"
  std::vector<std::string> required;   // flags that have no default: "--output=DIR"
  std::string purpose;

  std::string Line() const {
    std::vector<std::string> words = {name};
    words.insert(words.end(), arguments.begin(), arguments.end());
    words.insert(words.end(), required.begin(), required.end());
    return Join(words, " ");
  }
};

// Ends the process with exit code 0 where help or the version was asked for. gflags itself ends with 1 after help, and
// has no setting for it.
inline void AnswerHelpFlags() {
  static bool answering = true;
  std::atexit([] {
    if (!answering) return;
    std::cout.flush();
    std::fflush(nullptr);
    std::_Exit(0);
  });
  gflags::HandleCommandLineHelpFlags();
  answering = false;
}

// Parses the flags and leaves the program's name and its positional arguments in argc and argv. -h is --helpshort.
inline void ParseFlags(const ProgramUsage& usage, int* argc, char*** argv) {
  static char help_short[] = "--helpshort";
  for (int k = 1; k < *argc && std::strcmp((*argv)[k], "--") != 0; ++k) {
    if (std::strcmp((*argv)[k], "-h") == 0) (*argv)[k] = help_short;
  }
  gflags::SetUsageMessage(usage.Line() + ": " + usage.purpose);
  gflags::SetVersionString(Version());
  gflags::ParseCommandLineNonHelpFlags(argc, argv, true);
  AnswerHelpFlags();
}

// Empty, or what the parsed command line lacks or has too much.
inline std::string CommandLineProblem(const ProgramUsage& usage, int argc, char** argv) {
  const auto given = static_cast<size_t>(argc - 1);
  if (given < usage.arguments.size()) return usage.arguments[given] + " is missing";
  if (given > usage.arguments.size()) return std::string("unexpected '") + argv[usage.arguments.size() + 1] + "'";
  for (const std::string& flag : usage.required) {
    const std::string name = flag.substr(2, flag.find('=') - 2);
    std::string value;
    CHECK(gflags::GetCommandLineOption(name.c_str(), &value)) << flag;
    if (value.empty()) return "--" + name + " is missing";
  }
  return "";
}

// Parses the command line, runs on the positional arguments, reports on stderr. Returns the exit code.
inline int RunProgram(int argc, char** argv, const ProgramUsage& usage,
                      const std::function<Status(const std::vector<std::string>&)>& run) {
  google::InitGoogleLogging(argv[0]);
  ParseFlags(usage, &argc, &argv);
  if (const std::string problem = CommandLineProblem(usage, argc, argv); !problem.empty()) {
    std::cerr << usage.name << ": " << problem << "; expected " << usage.Line() << "\n";
    return 1;
  }
  const Status status = run({argv + 1, argv + argc});
  if (!status.ok()) std::cerr << usage.name << ": " << status.message() << "\n";
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
