// Two rules for the sources of an effect, read off the tree; the checker itself is tried on planted violations.
//
// - Its id stands as a string in its own file alone, core/effects/<id>.cc: who needs to know something of an effect
//   asks it, so that adding one touches nothing else.
// - Its equation calls no function of the columns and names none of their types: neither what core/effects declares in
//   headers nor a function of its own file that the columns call as well. Else a mistake in both would pass for truth.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <ostream>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "core/effects/effect.h"
#include "tests/support/temp_folder.h"

namespace idim::effect_sources_test {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Names = std::set<std::string>;

// Words that are something else where they stand: keys of files.
const std::map<std::string, Names>& Homonyms() {
  static const auto* const homonyms = new std::map<std::string, Names>{
      {"core/recording/study_reader.cc", {"viscous", "coulomb", "offset"}},
      {"core/effects/motor_coupling.cc", {"viscous", "coulomb"}},
  };
  return *homonyms;
}

std::string Read(const fs::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

struct Source {
  std::string code;                   // without comments, strings empty
  std::vector<std::string> literals;  // the strings
};

Source Parse(const std::string& text) {
  Source source;
  for (size_t i = 0; i < text.size(); ++i) {
    if (text.compare(i, 2, "//") == 0) {
      i = std::min(text.find('\n', i), text.size()) - 1;
    } else if (text.compare(i, 2, "/*") == 0) {
      i = std::min(text.find("*/", i), text.size() - 1) + 1;
    } else if (text[i] == '\'' && i + 2 < text.size() && text.find('\'', i + 1) - i <= 3) {
      i = text.find('\'', i + (text[i + 1] == '\\' ? 3 : 2));
    } else if (text[i] == '"') {
      std::string literal;
      for (++i; i < text.size() && text[i] != '"'; ++i) {
        if (text[i] == '\\') ++i;
        literal += text[i];
      }
      source.literals.push_back(literal);
      source.code += "\"\"";
    } else {
      source.code += text[i];
    }
  }
  return source;
}

Names Words(const std::string& text, const std::string& pattern) {
  Names words;
  const std::regex regex(pattern);
  for (std::sregex_iterator it(text.begin(), text.end(), regex); it != std::sregex_iterator(); ++it) {
    words.insert((*it)[it->size() - 1]);
  }
  return words;
}

Names Called(const std::string& code) { return Words(code, R"(\b(\w+)\s*\()"); }
Names Identifiers(const std::string& code) { return Words(code, R"(\b([A-Za-z_]\w*)\b)"); }

// Functions, classes and constants of a file, in or out of namespaces: name, and the text with the body.
std::multimap<std::string, std::string> Definitions(const std::string& code) {
  std::multimap<std::string, std::string> found;
  static const std::regex of_namespace(R"(\bnamespace\s*[\w:]*\s*$)"), type(R"(\b(?:class|struct)\s+(\w+))"),
      function(R"((?:(\w+)::)?\b(\w+)\s*\()");
  std::string item;
  int depth = 0;
  for (const char c : code) {
    if (depth == 0 && c == '}') continue;  // of a namespace
    if (depth == 0 && c == '{' && std::regex_search(item, of_namespace)) {
      item.clear();
      continue;
    }
    item += c;
    depth += (c == '{') - (c == '}');
    if (depth > 0 || (c != ';' && c != '}')) continue;
    const std::string head = item.substr(0, item.find('{'));
    std::smatch match;
    if (std::regex_search(head, match, type)) {
      found.emplace(match[1], item);
    } else if (head != item && head.find('=') == std::string::npos && std::regex_search(head, match, function)) {
      found.emplace(match[1].matched ? match[1] : match[2], item);  // a member counts to its class
    }
    item.clear();
  }
  return found;
}

Names DerivedFrom(const std::string& base, const std::multimap<std::string, std::string>& definitions) {
  Names derived;
  for (const auto& [name, text] : definitions) {
    if (std::regex_search(text, std::regex(name + R"(\s*(final\s*)?:\s*public\s+)" + base + R"(\b)"))) {
      derived.insert(name);
    }
  }
  return derived;
}

// What is used from `roots` on, the roots included, those of `without` and what only they use left out.
Names Closure(const Names& roots, const Names& without, const std::multimap<std::string, std::string>& definitions) {
  Names closure = roots;
  for (std::vector<std::string> next(roots.begin(), roots.end()); !next.empty();) {
    const std::string name = next.back();
    next.pop_back();
    for (auto [it, end] = definitions.equal_range(name); it != end; ++it) {
      for (const std::string& word : Identifiers(it->second)) {
        if (definitions.count(word) > 0 && without.count(word) == 0 && closure.insert(word).second) {
          next.push_back(word);
        }
      }
    }
  }
  return closure;
}

std::vector<fs::path> Files(const fs::path& folder, const Names& extensions) {
  std::vector<fs::path> files;
  if (!fs::exists(folder)) return files;
  for (auto it = fs::recursive_directory_iterator(folder); it != fs::recursive_directory_iterator(); ++it) {
    if (it->path().filename() == "node_modules") it.disable_recursion_pending();
    if (it->is_regular_file() && extensions.count(it->path().extension().string()) > 0) files.push_back(it->path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

// "file: what is wrong"; and how many equations were read.
std::vector<std::string> EquationViolations(const fs::path& root, int* equations) {
  Names types, functions;
  for (const fs::path& header : Files(root / "core/effects", {".h"})) {
    const std::string code = Parse(Read(header)).code;
    types.merge(Words(code, R"(\b(?:class|struct|enum class)\s+(\w+)\s*(?:final\s*)?[:{])"));
    functions.merge(Words(code, R"([^:\w]([A-Z]\w*)\s*\()"));
  }
  std::vector<std::string> found;
  *equations = 0;
  for (const fs::path& file : Files(root / "core/effects", {".cc"})) {
    const auto definitions = Definitions(Parse(Read(file)).code);
    const Names roots = DerivedFrom("EffectEquation", definitions);
    *equations += static_cast<int>(roots.size());
    Names effects = DerivedFrom("Effect", definitions);
    effects.merge(DerivedFrom("DeclaredFriction", definitions));
    const Names of_columns = Closure(effects, roots, definitions);
    const auto violation = [&](const std::string& text) {
      found.push_back(fs::relative(file, root).string() + ": " + text);
    };
    for (const std::string& name : Closure(roots, {}, definitions)) {
      if (of_columns.count(name) > 0) violation("equation and columns both use " + name);
      for (auto [it, end] = definitions.equal_range(name); it != end; ++it) {
        for (const std::string& word : Identifiers(it->second)) {
          if (types.count(word) > 0) violation("equation names " + word + " of the columns");
        }
        for (const std::string& word : Called(it->second)) {
          if (functions.count(word) > 0) violation("equation calls " + word + " of the columns");
        }
      }
    }
  }
  return found;
}

// "file: what is wrong"; and how many files were read.
std::vector<std::string> IdViolations(const fs::path& root, const Names& ids, int* num_files) {
  std::vector<std::string> found;
  *num_files = 0;
  for (const char* folder : {"apps", "benchmarks", "core", "residuals", "solvers"}) {
    for (const fs::path& file : Files(root / folder, {".h", ".cc"})) {
      ++*num_files;
      const std::string path = fs::relative(file, root).string();
      const auto homonyms = Homonyms().find(path);
      for (const std::string& literal : Parse(Read(file)).literals) {
        for (const std::string& id : ids) {
          if (literal.find(id) == std::string::npos) continue;
          // An id with an underscore is no word of prose.
          const bool within = id.find('_') != std::string::npos && Identifiers(literal).count(id) > 0;
          if ((literal != id && !within) || path == "core/effects/" + id + ".cc") continue;
          if (homonyms != Homonyms().end() && homonyms->second.count(id) > 0) continue;
          found.push_back(path + ": \"" + literal + "\"");
        }
      }
    }
  }
  return found;
}

TEST(EffectSources, AnIdStandsInItsOwnFileAlone) {
  Names ids;
  for (const Effect* effect : AllEffects()) {
    ids.insert(effect->id());
    const fs::path file = fs::path(IDIM_SOURCE_DIR) / "core/effects" / (effect->id() + ".cc");
    EXPECT_THAT(Parse(Read(file)).literals, ::testing::Contains(effect->id())) << file;
  }
  int files = 0;
  EXPECT_THAT(IdViolations(IDIM_SOURCE_DIR, ids, &files), IsEmpty());
  EXPECT_GT(files, 100);
}

TEST(EffectSources, EquationsCallNoFunctionOfTheColumns) {
  int equations = 0;
  EXPECT_THAT(EquationViolations(IDIM_SOURCE_DIR, &equations), IsEmpty());
  const auto& all = AllEffects();
  EXPECT_EQ(equations, std::count_if(all.begin(), all.end(), [](const Effect* e) { return !e->in_standard_model(); }));
}

const char kHeader[] = R"(class EffectEquation;
struct Motion {
  int n;
};
// As Forbidden() does.
Eigen::VectorXd Signs(const Motion& motion, int joint);
)";

const char kEffect[] = R"(#include "core/effects/columns.h"
namespace idim {
namespace {
constexpr char kId[] = "toy_effect";
constexpr double kBoth = 2.0;
double Mine(double x) { return x + kBoth; }
double Deep(double x) { return x; }
double Theirs(double x) { return Deep(x); }
// Calls neither Signs() nor a Motion.
class ToyEquation : public EffectEquation {
  double Add(double x) const override { return Mine(x) * kBoth; }
};
class Toy : public Effect {
  double Columns(const Motion& motion) const override { return Theirs(kBoth) + Signs(motion, 1); }
  const ToyEquation equation_;
};
}  // namespace
std::unique_ptr<Effect> MakeToy() { return std::make_unique<Toy>(); }
}  // namespace idim
)";

struct Planted {
  std::string from, to;  // in kEffect
  std::string named;     // in the violation; empty: none
};

void PrintTo(const Planted& planted, std::ostream* os) { *os << planted.to; }

class PlantedEquation : public ::testing::TestWithParam<Planted> {};

TEST_P(PlantedEquation, IsFoundAndNamed) {
  TempFolder folder;
  folder.Write("core/effects/columns.h", kHeader);
  std::string text = kEffect;
  const size_t at = text.find(GetParam().from);
  ASSERT_NE(at, std::string::npos);
  text.replace(at, GetParam().from.size(), GetParam().to);
  const std::string path = folder.Write("core/effects/toy_effect.cc", text);
  int equations = 0;
  const auto found = EquationViolations(fs::path(path).parent_path().parent_path().parent_path(), &equations);
  EXPECT_EQ(equations, 1);
  if (GetParam().named.empty()) {
    EXPECT_THAT(found, IsEmpty());
  } else {
    EXPECT_THAT(found,
                ::testing::Contains(::testing::AllOf(HasSubstr("toy_effect.cc: "), HasSubstr(GetParam().named))));
  }
}

INSTANTIATE_TEST_SUITE_P(
    Table, PlantedEquation,
    ::testing::Values(Planted{"Mine(x) * kBoth", "Mine(x)", ""},
                      Planted{"Mine(x) * kBoth", "Signs(motion, 2)", "calls Signs"},
                      Planted{"return x + kBoth", "return Signs(x, 2)", "calls Signs"},
                      Planted{"Mine(x) * kBoth", "Theirs(x)", "both use Theirs"},
                      Planted{"return x + kBoth", "return Deep(x)", "both use Deep"},
                      Planted{"Theirs(kBoth) +", "Mine(kBoth) +", "both use Mine"},
                      Planted{"Mine(x) * kBoth", "Toy().Columns(x)", "both use Toy"},
                      Planted{"double Mine(double x)", "double Mine(const Motion& x)", "names Motion"},
                      Planted{"{ return Mine(x) * kBoth; }\n};",
                              ";\n};\ndouble ToyEquation::Add(double x) const { return Theirs(x); }",
                              "both use Theirs"}));

struct PlantedId {
  std::string file, text;
  bool wrong;
};

void PrintTo(const PlantedId& planted, std::ostream* os) { *os << planted.file << ": " << planted.text; }

class PlantedIds : public ::testing::TestWithParam<PlantedId> {};

TEST_P(PlantedIds, AreFoundAndNamed) {
  TempFolder folder;
  const fs::path root = fs::path(folder.Write("core/effects/toy_effect.cc", kEffect)) / "../../..";
  folder.Write(GetParam().file, GetParam().text + "\n");
  int files = 0;
  const auto found = IdViolations(root.lexically_normal(), {"toy_effect", "offset"}, &files);
  EXPECT_EQ(files, GetParam().file.rfind("tests/", 0) == 0 ? 1 : 2);
  if (GetParam().wrong) {
    EXPECT_THAT(found, ElementsAre(HasSubstr(GetParam().file + ": ")));
  } else {
    EXPECT_THAT(found, IsEmpty());
  }
}

INSTANTIATE_TEST_SUITE_P(
    Table, PlantedIds,
    ::testing::Values(PlantedId{"solvers/judge/a.cc", "if (id == \"toy_effect\") return;", true},
                      PlantedId{"core/effects/other.cc", "f('\"', \"toy_effect\");", true},
                      PlantedId{"apps/a.h", "g(\"effects: {id: toy_effect}\");", true},
                      PlantedId{"core/simulation/a.cc", "/* of the */ constexpr char k[] = \"offset\";", true},
                      PlantedId{"core/simulation/a.cc", "f(\"an offset of the toy_effects\");", false},
                      PlantedId{"core/recording/study_reader.cc", "Key(\"offset\");", false},
                      PlantedId{"core/recording/study_reader.cc", "Key(\"toy_effect\");", true},
                      PlantedId{"core/model/a.h", "// \"toy_effect\" on joint 3\nint x;", false},
                      PlantedId{"tests/a_test.cc", "f(\"toy_effect\");", false}));

}  // namespace
}  // namespace idim::effect_sources_test
