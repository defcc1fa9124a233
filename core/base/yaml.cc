#include "core/base/yaml.h"

#include <yaml-cpp/eventhandler.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>

#include "core/base/file.h"
#include "core/base/text.h"

namespace idim {

namespace {

const char* KindOf(const YAML::Node& node) {
  switch (node.Type()) {
    case YAML::NodeType::Scalar:
      return "a single value";
    case YAML::NodeType::Sequence:
      return "a list";
    case YAML::NodeType::Map:
      return "a mapping";
    default:
      return "nothing";
  }
}

// yaml-cpp marks quoted scalars with the tag "!": a quoted number is text.
bool IsQuoted(const YAML::Node& node) { return node.IsScalar() && node.Tag() == "!"; }

// Remembers where the last document started and nothing else.
class DocumentStart : public YAML::EventHandler {
 public:
  int line() const { return line_; }

  void OnDocumentStart(const YAML::Mark& mark) override { line_ = mark.line; }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark&, YAML::anchor_t) override {}
  void OnAlias(const YAML::Mark&, YAML::anchor_t) override {}
  void OnScalar(const YAML::Mark&, const std::string&, YAML::anchor_t, const std::string&) override {}
  void OnSequenceStart(const YAML::Mark&, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {}
  void OnSequenceEnd() override {}
  void OnMapStart(const YAML::Mark&, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {}
  void OnMapEnd() override {}

 private:
  int line_ = -1;
};

// The zero-based line where something follows the first document, -1 if nothing does. YAML::Load drops what follows
// without a word, and YAML::LoadAll (0.7) never ends on some texts that are no YAML.
int LineAfterFirstDocument(const std::string& text) {
  std::istringstream stream(text);
  YAML::Parser parser(stream);
  DocumentStart start;
  parser.HandleNextDocument(start);
  if (!parser) return -1;
  parser.HandleNextDocument(start);
  return start.line();
}

}  // namespace

std::string KeyPath(const std::string& parent, const std::string& key) {
  return parent.empty() ? key : parent + "." + key;
}

std::string KeyPath(const std::string& parent, size_t index) { return parent + "[" + std::to_string(index + 1) + "]"; }

YamlFile::YamlFile(const std::string& path) : path_(path) {
  const Result<std::string> text = ReadFile(path);
  if (!text.ok()) {
    status_ = text.status();
    return;
  }
  try {
    root_.reset(YAML::Load(*text));
    const int line = LineAfterFirstDocument(*text);
    if (line >= 0) {
      status_ = Status::BadInput(path + ":" + std::to_string(line + 1) +
                                 ": more follows the first document; expected one mapping of keys");
    } else if (root_.IsNull()) {
      status_ = Status::BadInput(path + ":1: the file is empty; expected a mapping of keys");
    }
  } catch (const YAML::Exception& error) {
    status_ = Status::BadInput(path + ":" + std::to_string(error.mark.line + 1) + ": not valid YAML: " + error.msg +
                               "; expected 'key: value' lines");
  }
}

void YamlFile::Fail(const YAML::Node& node, const std::string& key, const std::string& problem,
                    const std::string& expected) {
  if (!ok()) return;
  std::string message = path_;
  if (node.IsDefined() && node.Mark().line >= 0) message += ":" + std::to_string(node.Mark().line + 1);
  message += ": ";
  if (!key.empty()) message += "key '" + key + "': ";
  message += problem;
  if (!expected.empty()) message += "; expected " + expected;
  status_ = Status::BadInput(std::move(message));
}

bool YamlFile::Map(const YAML::Node& node, const std::string& key, const std::vector<std::string>& known_keys) {
  if (!ok()) return false;
  if (!node.IsMap()) {
    Fail(node, key, std::string(KindOf(node)) + " given", "a mapping with keys among " + Join(known_keys, ", "));
    return false;
  }
  std::set<std::string> seen;
  for (const auto& entry : node) {
    const std::string name = entry.first.IsScalar() ? entry.first.Scalar() : std::string("?");
    if (std::find(known_keys.begin(), known_keys.end(), name) == known_keys.end()) {
      Fail(entry.first, KeyPath(key, name), "unknown key (did you mean '" + NearestName(name, known_keys) + "'?)",
           "one of " + Join(known_keys, ", "));
      return false;
    }
    if (!seen.insert(name).second) {
      Fail(entry.first, KeyPath(key, name), "given twice", "it once");
      return false;
    }
  }
  return true;
}

bool YamlFile::Require(const YAML::Node& map, const std::string& parent, const std::string& name,
                       const std::string& expected) {
  if (!ok()) return false;
  if (!map[name].IsDefined()) Fail(map, KeyPath(parent, name), "missing", expected);
  return ok();
}

bool YamlFile::List(const YAML::Node& node, const std::string& key, const std::string& expected) {
  if (ok() && !node.IsSequence()) Fail(node, key, std::string(KindOf(node)) + " given", expected);
  return ok();
}

double YamlFile::Number(const YAML::Node& node, const std::string& key) {
  if (!ok()) return 0.0;
  if (!node.IsScalar()) {
    Fail(node, key, std::string(KindOf(node)) + " given", "a number");
    return 0.0;
  }
  // The YAML spellings of values that are not finite differ from those of a number parser.
  std::string text = node.Scalar();
  NumberText problem = NumberText::kNotANumber;
  double value = 0.0;
  if (!IsQuoted(node)) {
    static const std::set<std::string> kNotFinite = {".nan",  ".NaN",  ".NAN",  ".inf",  ".Inf",  ".INF",
                                                     "-.inf", "-.Inf", "-.INF", "+.inf", "+.Inf", "+.INF"};
    problem = kNotFinite.count(text) != 0 ? NumberText::kNotFinite : ParseNumber(text, &value);
  }
  if (problem != NumberText::kOk) {
    Fail(node, key, DescribeNumberProblem(problem, text), "a finite number");
    return 0.0;
  }
  return value;
}

double YamlFile::PositiveNumber(const YAML::Node& node, const std::string& key) {
  const double value = Number(node, key);
  if (ok() && value <= 0.0) Fail(node, key, FormatNumber(value) + " is not positive", "a number greater than 0");
  return ok() ? value : 1.0;
}

int YamlFile::Integer(const YAML::Node& node, const std::string& key, int smallest, int largest) {
  const double value = Number(node, key);
  if (ok() && (value != std::floor(value) || value < smallest || value > largest)) {
    Fail(node, key, FormatNumber(value) + (value != std::floor(value) ? " is not an integer" : " is out of range"),
         "an integer from " + std::to_string(smallest) + " to " + std::to_string(largest));
  }
  return ok() ? static_cast<int>(value) : smallest;
}

std::string YamlFile::Text(const YAML::Node& node, const std::string& key, const std::string& expected) {
  if (!ok()) return std::string();
  if (!node.IsScalar() || node.Scalar().empty()) {
    Fail(node, key, std::string(node.IsScalar() ? "empty text" : KindOf(node)) + " given", expected);
    return std::string();
  }
  return node.Scalar();
}

std::vector<int> YamlFile::Joints(const YAML::Node& node, const std::string& key, int dof,
                                  const std::string& expected) {
  std::vector<int> joints;
  if (!List(node, key, expected)) return joints;
  for (size_t i = 0; i < node.size(); ++i) joints.push_back(Integer(node[i], KeyPath(key, i), 1, dof) - 1);
  return joints;
}

int YamlFile::Choice(const YAML::Node& node, const std::string& key, const std::vector<std::string>& words) {
  const std::string word = Text(node, key, "one of " + Join(words, ", "));
  if (!ok()) return 0;
  const auto found = std::find(words.begin(), words.end(), word);
  if (found == words.end()) {
    Fail(node, key, "'" + Clip(word) + "' is not known",
         "one of " + Join(words, ", ") + " (nearest: " + NearestName(word, words) + ")");
    return 0;
  }
  return static_cast<int>(found - words.begin());
}

Eigen::VectorXd YamlFile::Numbers(const YAML::Node& node, const std::string& key, int size, const std::string& what) {
  Eigen::VectorXd values = Eigen::VectorXd::Zero(size);
  const std::string expected = "a list of " + std::to_string(size) + " numbers" + (what.empty() ? "" : ", " + what);
  if (!List(node, key, expected)) return values;
  if (static_cast<int>(node.size()) != size) {
    Fail(node, key, "has " + std::to_string(node.size()) + " values", expected);
    return values;
  }
  for (int i = 0; i < size; ++i) values[i] = Number(node[i], KeyPath(key, i));
  return values;
}

}  // namespace idim
