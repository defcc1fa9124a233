// What every program answers to: help and version on request, with exit code 0; what is missing, by its name, with 1.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "core/base/version.h"
#include "tests/support/program.h"

namespace idim::command_line_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

// The command lines as the documentation has them. Every program that is built must be here.
const std::map<std::string, std::string>& Usage() {
  static const auto* const usage = new std::map<std::string, std::string>{
      {"idim_close_loop", "idim_close_loop STUDY --output=DIR"},
      {"idim_compare", "idim_compare STUDY --output=DIR"},
      {"idim_identify", "idim_identify STUDY --output=DIR"},
      {"idim_plausible", "idim_plausible ROBOT REQUEST --output=DIR"},
      {"idim_simulate", "idim_simulate SCENARIO --output=DIR"},
      {"idim_validate", "idim_validate STUDY --estimate=FILE.json,... --output=DIR"},
      {"paper_study", "paper_study"},
  };
  return *usage;
}

std::vector<std::string> Programs() {
  std::vector<std::string> programs;
  for (const auto& entry : std::filesystem::directory_iterator(IDIM_APPS_DIR)) {
    if (entry.is_regular_file() && ::access(entry.path().c_str(), X_OK) == 0) {
      programs.push_back(entry.path().filename());
    }
  }
  std::sort(programs.begin(), programs.end());
  return programs;
}

class CommandLine : public ::testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Programs, CommandLine, ::testing::ValuesIn(Programs()),
                         [](const auto& tested) { return tested.param; });

TEST(CommandLine, AllProgramsAreKnownHere) {
  std::vector<std::string> known;
  for (const auto& [name, usage] : Usage()) known.push_back(name);
  EXPECT_EQ(Programs(), known);
}

TEST_P(CommandLine, HelpThatIsAskedForIsNoError) {
  for (const std::string flag : {"-h", "--help", "--helpshort", "--helpfull", "--helpxml", "--helpon=program"}) {
    const testing::ProgramRun run = testing::RunProgram(GetParam(), flag);
    EXPECT_EQ(run.exit_code, 0) << flag << ": " << run.err;
    EXPECT_EQ(run.err, "") << flag;
    EXPECT_THAT(run.out, HasSubstr(Usage().at(GetParam()) + ": ")) << flag;
    if (flag.substr(0, 7) == "--helpo") continue;
    EXPECT_THAT(run.out, HasSubstr("output")) << flag;
  }
}

TEST_P(CommandLine, TellsItsVersion) {
  const testing::ProgramRun run = testing::RunProgram(GetParam(), "--version");
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_THAT(run.out, StartsWith(GetParam() + " version " + Version() + "\n"));
  EXPECT_EQ(run.err, "");
}

// Each word of the command line left out in turn.
TEST_P(CommandLine, WhatIsMissingIsNamed) {
  std::vector<std::string> words;
  std::istringstream stream(Usage().at(GetParam()));
  for (std::string word; stream >> word;) words.push_back(word);
  for (size_t left_out = 1; left_out < words.size(); ++left_out) {
    std::string arguments;
    for (size_t k = 1; k < words.size(); ++k) {
      if (k != left_out) arguments += words[k] + " ";
    }
    const testing::ProgramRun run = testing::RunProgram(GetParam(), arguments);
    EXPECT_EQ(run.exit_code, 1) << arguments;
    // Of the positional ones only the number is known: the last is missing.
    const bool flag = words[left_out][0] == '-';
    const size_t last =
        std::find_if(words.begin(), words.end(), [](const auto& w) { return w[0] == '-'; }) - words.begin();
    const std::string missing = flag ? words[left_out].substr(0, words[left_out].find('=')) : words[last - 1];
    EXPECT_EQ(run.err, GetParam() + ": " + missing + " is missing; expected " + Usage().at(GetParam()) + "\n");
    EXPECT_EQ(run.out, "");
  }
}

TEST_P(CommandLine, WhatIsTooMuchIsNamed) {
  const testing::ProgramRun run = testing::RunProgram(GetParam(), "a b c d --output=x");
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.err, AllOf(HasSubstr("unexpected '"), HasSubstr("expected " + Usage().at(GetParam()))));
}

TEST_P(CommandLine, AFlagThatThereIsNotIsNamed) {
  const testing::ProgramRun run = testing::RunProgram(GetParam(), "--outptu=x");
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.err, HasSubstr("outptu"));
}

}  // namespace
}  // namespace idim::command_line_test
