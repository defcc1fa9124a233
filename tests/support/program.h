// Runs one of the programs as a user would and returns what it said.

#ifndef IDIM_TESTS_SUPPORT_PROGRAM_H_
#define IDIM_TESTS_SUPPORT_PROGRAM_H_

#include <sys/wait.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>

#include "tests/support/temp_folder.h"

namespace idim::testing {

struct ProgramRun {
  int exit_code = -1;  // -1: did not exit by itself
  std::string out;
  std::string err;
};

inline std::string ReadText(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

// `arguments` as a shell reads them.
inline ProgramRun RunProgram(const std::string& name, const std::string& arguments) {
  const TempFolder folder;
  const std::string command =
      std::string(IDIM_APPS_DIR) + "/" + name + " " + arguments + " >" + folder / "out" + " 2>" + folder / "err";
  const int status = std::system(command.c_str());
  ProgramRun run;
  if (WIFEXITED(status)) run.exit_code = WEXITSTATUS(status);
  run.out = ReadText(folder / "out");
  run.err = ReadText(folder / "err");
  return run;
}

}  // namespace idim::testing

#endif  // IDIM_TESTS_SUPPORT_PROGRAM_H_
