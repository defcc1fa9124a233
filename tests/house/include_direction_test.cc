// The layers: core < residuals < solvers < apps; tests and benchmarks see all four and are seen by none. Inside core,
// solvers and apps the rooms are layers too, and no file includes its way back to itself.
// The rules are read off the #include lines of the tree, and the checker itself is tried on planted violations.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <ostream>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace idim::include_direction_test {
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

// The rooms of a folder from the bottom up; rooms of one level do not see each other. "" is the folder itself.
const std::map<std::string, std::vector<std::set<std::string>>>& Rooms() {
  static const auto* const rooms = new std::map<std::string, std::vector<std::set<std::string>>>{
      {"core",
       {{"base"},
        {"report", "statistics", "robot", "signal"},
        {"dynamics"},
        {"recording", "estimate"},
        {"motion", "simulation"},
        {"effects"},
        {"model"}}},
      {"solvers", {{"linear", "consistent"}, {"bundle"}, {"estimators"}, {"loop"}, {"judge"}, {""}}},
      {"apps", {{"pages"}, {""}, {"paper_study"}}},
  };
  return *rooms;
}

// The level of a file or of a header as it is included; -1: none.
int RoomLevel(const std::string& folder, const std::string& room) {
  const auto levels = Rooms().find(folder);
  for (size_t k = 0; levels != Rooms().end() && k < levels->second.size(); ++k) {
    if (levels->second[k].count(room) > 0) return static_cast<int>(k);
  }
  return -1;
}

// "loop" of "solvers/loop/close_loop.h", "" of "apps/program.h".
std::string RoomOf(const std::string& path) {
  const size_t first = path.find('/'), second = path.find('/', first + 1);
  return second == std::string::npos ? "" : path.substr(first + 1, second - first - 1);
}

// Empty, or why a file may not include a header of the same folder.
std::string RoomViolation(const std::string& folder, const std::string& file, const std::string& header) {
  if (Rooms().count(folder) == 0) return "";
  const std::string from = RoomOf(file), to = RoomOf(header);
  const int from_level = RoomLevel(folder, from), to_level = RoomLevel(folder, to);
  if (from_level < 0) return "is included from '" + from + "', which is no room of " + folder + "/";
  if (to_level < 0) return "is in '" + to + "', which is no room of " + folder + "/";
  if (from == to || to_level < from_level) return "";
  return "may not be included in " + folder + "/" + from + "/, which is below or beside its room";
}

// Every top-level name that some folder is forbidden to include; other names are libraries that all may use.
bool IsRestricted(const std::string& name) {
  return AllowedIncludes().count(name) || name == "ceres" || name == "gflags";
}

bool IsSource(const fs::path& path) {
  static const std::set<std::string> extensions = {".h", ".hpp", ".inc", ".cc", ".cpp"};
  return extensions.count(path.extension().string()) > 0;
}

// A header and its source file are one: "core/base/file" of both.
std::string UnitOf(const std::string& path) { return path.substr(0, path.rfind('.')); }

void CheckFile(const fs::path& root, const fs::path& file, const std::string& folder,
               std::map<std::string, std::set<std::string>>* includes, std::vector<std::string>* found) {
  const std::string unit = UnitOf(fs::relative(file, root).string());
  static const std::regex include(R"(^\s*#\s*include\s*([<"])([^>"]+)[>"])");
  std::ifstream stream(file);
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    std::smatch match;
    if (!std::regex_search(line, match, include)) continue;
    const std::string header = match[2];
    const std::string top = header.substr(0, header.find('/'));
    if (UnitOf(header) != unit && IsRestricted(top)) (*includes)[unit].insert(UnitOf(header));
    std::string reason;
    if (header.find("..") != std::string::npos || (match[1] == "\"" && fs::exists(file.parent_path() / header))) {
      reason = "is not included from the repository root";
    } else if (IsRestricted(top) && header != top && AllowedIncludes().at(folder).count(top) == 0) {
      reason = "may not be included in " + folder + "/";
    } else if (top == folder) {
      reason = RoomViolation(folder, fs::relative(file, root).string(), header);
    }
    if (reason.empty()) continue;
    found->push_back(fs::relative(file, root).string() + ":" + std::to_string(number) + ": \"" + header + "\" " +
                     reason);
  }
}

// Units that include their way back to themselves, a line each circle, from its alphabetically first unit.
std::vector<std::string> Circles(const std::map<std::string, std::set<std::string>>& includes) {
  std::set<std::string> found;
  std::set<std::string> done;
  std::vector<std::string> way;
  const std::function<void(const std::string&)> visit = [&](const std::string& unit) {
    if (const auto at = std::find(way.begin(), way.end(), unit); at != way.end()) {
      std::vector<std::string> circle(at, way.end());
      std::rotate(circle.begin(), std::min_element(circle.begin(), circle.end()), circle.end());
      std::string line;
      for (const std::string& one : circle) line += one + " -> ";
      found.insert(line + circle.front());
      return;
    }
    if (done.count(unit) > 0 || includes.count(unit) == 0) return;
    way.push_back(unit);
    for (const std::string& next : includes.at(unit)) visit(next);
    way.pop_back();
    done.insert(unit);
  };
  for (const auto& entry : includes) visit(entry.first);
  return {found.begin(), found.end()};
}

// "file:line: what is wrong", sorted; and how many files were read, so that an empty scan cannot pass for a clean one.
std::vector<std::string> Violations(const fs::path& root, int* num_files = nullptr) {
  std::vector<std::string> found;
  int files = 0;
  std::map<std::string, std::set<std::string>> includes;
  for (const auto& [folder, allowed] : AllowedIncludes()) {
    if (!fs::exists(root / folder)) continue;
    for (auto it = fs::recursive_directory_iterator(root / folder); it != fs::recursive_directory_iterator(); ++it) {
      if (it->path().filename() == "node_modules") it.disable_recursion_pending();
      if (!it->is_regular_file() || !IsSource(it->path())) continue;
      // A project of its own that uses the installed headers, by their installed names.
      if (fs::relative(it->path(), root).string().rfind("tests/house/consumer/", 0) == 0) continue;
      ++files;
      CheckFile(root, it->path(), folder, &includes, &found);
    }
  }
  for (const std::string& circle : Circles(includes)) found.push_back(circle + ": a circle");
  std::sort(found.begin(), found.end());
  if (num_files != nullptr) *num_files = files;
  return found;
}

class PlantedTreeTest : public ::testing::Test {
 protected:
  void SetUp() override {
    root_ = fs::path(::testing::TempDir()) / ("idim_include_direction_" + std::to_string(::getpid()));
    fs::remove_all(root_);
    Write("core/robot/a.h", "#include <Eigen/Core>\n#include <vector>\n#include \"core/base/b.h\"\n");
    Write("core/robot/a.cc", "#include \"core/robot/a.h\"\n#include \"core/robot/b.h\"\n");
    Write("residuals/a.h", "#include <ceres/ceres.h>\n#include \"core/robot/a.h\"\n");
    Write("solvers/loop/a.cc", "#include \"residuals/a.h\"\n#include \"solvers/bundle/b.h\"\n");
    Write("apps/a.cc", "#include <gflags/gflags.h>\n#include \"solvers/loop/b.h\"\n#include \"apps/pages/b.h\"\n");
    Write("tests/a_test.cc", "#include \"tests/support.h\"\n#include \"apps/a.h\"\n");
    Write("benchmarks/a_benchmark.cc", "#include \"core/robot/a.h\"\n");
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
  EXPECT_EQ(num_files, 7);
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

TEST_F(PlantedTreeTest, ACircleOfFilesIsFoundAndNamed) {
  Write("core/robot/b.h", "#include \"core/robot/c.h\"\n");
  Write("core/robot/c.cc", "#include \"core/robot/a.h\"\n");
  EXPECT_THAT(Violations(root_), ElementsAre("core/robot/a -> core/robot/b -> core/robot/c -> core/robot/a: a circle"));
}

INSTANTIATE_TEST_SUITE_P(Layers, PlantedViolationTest,
                         ::testing::Values(Planted{"core/base/x.h", "#include \"residuals/a.h\""},
                                           Planted{"core/base/deep/x.cc", "#include \"solvers/loop/a.h\""},
                                           Planted{"core/base/x.cc", "#include <ceres/ceres.h>"},
                                           Planted{"core/base/x.cc", "  # include \"ceres/jet.h\""},
                                           Planted{"core/base/x.cc", "#include <gflags/gflags.h>"},
                                           Planted{"core/base/x.cc", "#include \"tests/support.h\""},
                                           Planted{"residuals/x.h", "#include \"solvers/loop/a.h\""},
                                           Planted{"residuals/x.h", "#include <gflags/gflags.h>"},
                                           Planted{"solvers/loop/x.h", "#include \"apps/a.h\""},
                                           Planted{"solvers/loop/x.h", "#include <apps/a.h>"},
                                           Planted{"apps/x.cc", "#include \"benchmarks/a.h\""},
                                           Planted{"tests/x_test.cc", "#include \"benchmarks/a.h\""},
                                           Planted{"benchmarks/x.cc", "#include \"tests/support.h\""},
                                           Planted{"solvers/loop/x.h", "#include \"../core/a.h\""},
                                           Planted{"core/robot/x.cc", "#include \"a.h\""}));

// One a border between neighbouring levels and one a pair of rooms of one level.
INSTANTIATE_TEST_SUITE_P(Rooms, PlantedViolationTest,
                         ::testing::Values(Planted{"core/base/x.cc", "#include \"core/report/b.h\""},
                                           Planted{"core/report/x.h", "#include \"core/statistics/b.h\""},
                                           Planted{"core/statistics/x.h", "#include \"core/robot/b.h\""},
                                           Planted{"core/robot/x.h", "#include \"core/signal/b.h\""},
                                           Planted{"core/signal/x.h", "#include \"core/dynamics/b.h\""},
                                           Planted{"core/signal/x.h", "#include \"core/recording/b.h\""},
                                           Planted{"core/dynamics/x.h", "#include \"core/recording/b.h\""},
                                           Planted{"core/recording/x.h", "#include \"core/estimate/b.h\""},
                                           Planted{"core/recording/x.h", "#include \"core/effects/b.h\""},
                                           Planted{"core/estimate/x.h", "#include \"core/motion/b.h\""},
                                           Planted{"core/motion/x.h", "#include \"core/simulation/b.h\""},
                                           Planted{"core/simulation/x.h", "#include \"core/effects/b.h\""},
                                           Planted{"core/effects/x.h", "#include \"core/model/b.h\""},
                                           Planted{"solvers/linear/x.h", "#include \"solvers/bundle/b.h\""},
                                           Planted{"solvers/consistent/x.h", "#include \"solvers/linear/b.h\""},
                                           Planted{"solvers/bundle/x.h", "#include \"solvers/estimators/b.h\""},
                                           Planted{"solvers/estimators/x.h", "#include \"solvers/loop/b.h\""},
                                           Planted{"solvers/loop/x.h", "#include \"solvers/judge/b.h\""},
                                           Planted{"apps/pages/x.h", "#include \"apps/b.h\""},
                                           Planted{"apps/pages/x.h", "#include \"apps/paper_study/b.h\""},
                                           Planted{"core/x.h", "#include \"core/base/b.h\""},
                                           Planted{"core/robot/x.h", "#include \"core/attic/b.h\""}));

}  // namespace
}  // namespace idim::include_direction_test
