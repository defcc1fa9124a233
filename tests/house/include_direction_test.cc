// The layers: core < residuals < solvers < apps; tests and benchmarks see all four and are seen by none.
// The rules are read off the #include lines of the tree, and the checker itself is tried on planted violations.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <ostream>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace idim {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// What the files of a folder may include. Flags belong to programs, Ceres to everything above core.
const std::map<std::string, std::set<std::string>>& AllowedIncludes() {
  static const auto* const allowed = new std::map<std::string, std::set<std::string>>{
      {"core", {"core"}},
      {"residuals", {"core", "residuals", "ceres"}},
      {"solvers", {"core", "residuals", "solvers", "ceres"}},
      {"apps", {"core", "residuals", "solvers", "apps", "ceres", "gflags"}},
      {"tests", {"core", "residuals", "solvers", "apps", "tests", "ceres", "gflags"}},
      {"benchmarks", {"core", "residuals", "solvers", "apps", "benchmarks", "ceres", "gflags"}},
  };
  return *allowed;
}

// Every top-level name that some folder is forbidden to include; other names are libraries that all may use.
bool IsRestricted(const std::string& name) {
  return AllowedIncludes().count(name) || name == "ceres" || name == "gflags";
}

bool IsSource(const fs::path& path) {
  static const std::set<std::string> extensions = {".h", ".hpp", ".inc", ".cc", ".cpp"};
  return extensions.count(path.extension().string()) > 0;
}

void CheckFile(const fs::path& root, const fs::path& file, const std::string& folder, std::vector<std::string>* found) {
  static const std::regex include(R"(^\s*#\s*include\s*([<"])([^>"]+)[>"])");
  std::ifstream stream(file);
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    std::smatch match;
    if (!std::regex_search(line, match, include)) continue;
    const std::string header = match[2];
    const std::string top = header.substr(0, header.find('/'));
    std::string reason;
    if (header.find("..") != std::string::npos || (match[1] == "\"" && fs::exists(file.parent_path() / header))) {
      reason = "is not included from the repository root";
    } else if (IsRestricted(top) && header != top && AllowedIncludes().at(folder).count(top) == 0) {
      reason = "may not be included in " + folder + "/";
    }
    if (reason.empty()) continue;
    found->push_back(fs::relative(file, root).string() + ":" + std::to_string(number) + ": \"" + header + "\" " +
                     reason);
  }
}

// "file:line: what is wrong", sorted; and how many files were read, so that an empty scan cannot pass for a clean one.
std::vector<std::string> Violations(const fs::path& root, int* num_files = nullptr) {
  std::vector<std::string> found;
  int files = 0;
  for (const auto& [folder, allowed] : AllowedIncludes()) {
    if (!fs::exists(root / folder)) continue;
    for (auto it = fs::recursive_directory_iterator(root / folder); it != fs::recursive_directory_iterator(); ++it) {
      if (it->path().filename() == "node_modules") it.disable_recursion_pending();
      if (!it->is_regular_file() || !IsSource(it->path())) continue;
      // A project of its own that uses the installed headers, by their installed names.
      if (fs::relative(it->path(), root).string().rfind("tests/house/consumer/", 0) == 0) continue;
      ++files;
      CheckFile(root, it->path(), folder, &found);
    }
  }
  std::sort(found.begin(), found.end());
  if (num_files != nullptr) *num_files = files;
  return found;
}

class PlantedTreeTest : public ::testing::Test {
 protected:
  void SetUp() override {
    root_ = fs::path(::testing::TempDir()) / ("idim_include_direction_" + std::to_string(::getpid()));
    fs::remove_all(root_);
    Write("core/a.h", "#include <Eigen/Core>\n#include <vector>\n#include \"core/b.h\"\n");
    Write("residuals/a.h", "#include <ceres/ceres.h>\n#include \"core/a.h\"\n");
    Write("solvers/a.cc", "#include \"residuals/a.h\"\n#include \"solvers/b.h\"\n");
    Write("apps/a.cc", "#include <gflags/gflags.h>\n#include \"solvers/b.h\"\n");
    Write("tests/a_test.cc", "#include \"tests/support.h\"\n#include \"apps/a.h\"\n");
    Write("benchmarks/a_benchmark.cc", "#include \"core/a.h\"\n");
  }
  void TearDown() override { fs::remove_all(root_); }

  void Write(const std::string& path, const std::string& text) {
    fs::create_directories((root_ / path).parent_path());
    std::ofstream(root_ / path) << text;
  }

  fs::path root_;
};

TEST(IncludeDirectionTest, ThisTreeKeepsItsLayers) {
  int num_files = 0;
  EXPECT_THAT(Violations(IDIM_SOURCE_DIR, &num_files), IsEmpty());
  EXPECT_GE(num_files, 8) << "the scan did not find the sources below " << IDIM_SOURCE_DIR;
}

TEST_F(PlantedTreeTest, AcceptsACleanTree) {
  int num_files = 0;
  EXPECT_THAT(Violations(root_, &num_files), IsEmpty());
  EXPECT_EQ(num_files, 6);
}

struct Planted {
  std::string file;
  std::string include;
};

void PrintTo(const Planted& planted, std::ostream* os) { *os << planted.file << ": " << planted.include; }

class PlantedViolationTest : public PlantedTreeTest, public ::testing::WithParamInterface<Planted> {};

TEST_P(PlantedViolationTest, IsFoundAndNamed) {
  const Planted& planted = GetParam();
  Write(planted.file, "// a comment\n" + planted.include + "\n");
  EXPECT_THAT(Violations(root_), ElementsAre(HasSubstr(planted.file + ":2: ")));
}

INSTANTIATE_TEST_SUITE_P(
    Layers, PlantedViolationTest,
    ::testing::Values(
        Planted{"core/x.h", "#include \"residuals/a.h\""}, Planted{"core/deep/x.cc", "#include \"solvers/a.h\""},
        Planted{"core/x.cc", "#include <ceres/ceres.h>"}, Planted{"core/x.cc", "  # include \"ceres/jet.h\""},
        Planted{"core/x.cc", "#include <gflags/gflags.h>"}, Planted{"core/x.cc", "#include \"tests/support.h\""},
        Planted{"residuals/x.h", "#include \"solvers/a.h\""}, Planted{"residuals/x.h", "#include <gflags/gflags.h>"},
        Planted{"solvers/x.h", "#include \"apps/a.h\""}, Planted{"solvers/x.h", "#include <apps/a.h>"},
        Planted{"apps/x.cc", "#include \"benchmarks/a.h\""}, Planted{"tests/x_test.cc", "#include \"benchmarks/a.h\""},
        Planted{"benchmarks/x.cc", "#include \"tests/support.h\""}, Planted{"solvers/x.h", "#include \"../core/a.h\""},
        Planted{"core/x.cc", "#include \"a.h\""}));

}  // namespace
}  // namespace idim
