#include "core/simulation/effect_equation.h"

#include <glog/logging.h>

#include <algorithm>
#include <set>
#include <sstream>
#include <utility>

#include "core/base/text.h"

namespace idim {
namespace {

std::string ProblemOfJoints(const SimulatedEffect& effect, EffectJoints wanted, int n) {
  std::ostringstream problem;
  const size_t count = effect.joints.size();
  if (wanted == EffectJoints::kNone && count != 0) {
    problem << "joints has " << count << " numbers, must have none: the effect is of the whole arm";
  } else if (wanted == EffectJoints::kTwo && count != 2) {
    problem << "joints has " << count << " numbers, must have two";
  } else if (wanted == EffectJoints::kOneOrMore && count == 0) {
    problem << "joints is empty, must name at least one joint";
  }
  std::set<int> seen;
  for (int joint : effect.joints) {
    if (!problem.str().empty()) break;
    if (joint < 0 || joint >= n) problem << "joint " << joint + 1 << " of an arm with " << n << ", must be 1 to " << n;
    if (!seen.insert(joint).second) problem << "joint " << joint + 1 << " is given twice, must be given once";
  }
  return problem.str();
}

std::string ProblemOfValues(const SimulatedEffect& effect, const EffectEquation& equation) {
  std::ostringstream problem;
  for (const auto& [name, value] : effect.values) {
    const EffectKey* key = equation.FindKey(name);
    if (key == nullptr) {
      problem << name << " is unknown";
      return problem.str();
    }
    if (value <= key->upper && (key->lower_allowed ? value >= key->lower : value > key->lower)) continue;
    problem << name << " = " << value << ", must be " << (key->lower_allowed ? "from " : "above ") << key->lower
            << (key->lower_allowed ? " to " : " and at most ") << key->upper;
    return problem.str();
  }
  for (const EffectKey& key : equation.keys()) {
    if (key.required && effect.values.count(key.name) == 0) return key.name + " is missing";
  }
  const std::vector<std::string>& one_of = equation.one_of();
  const bool some =
      std::any_of(one_of.begin(), one_of.end(), [&](const std::string& name) { return effect.values.count(name) > 0; });
  if (!one_of.empty() && !some) return "one of " + Join(one_of, ", ") + " must be given";
  return "";
}

}  // namespace

EffectKey EffectKey::Any(const std::string& name, int size_power) {
  return From(-kLargestInput, kLargestInput, name, size_power);
}

EffectKey EffectKey::Positive(const std::string& name, int size_power) {
  return Above(0.0, kLargestInput, name, size_power);
}

EffectKey EffectKey::From(double lower, double upper, const std::string& name, int size_power) {
  EffectKey key;
  key.name = name;
  key.lower = lower;
  key.upper = upper;
  key.size_power = size_power;
  return key;
}

EffectKey EffectKey::Above(double lower, double upper, const std::string& name, int size_power) {
  EffectKey key = From(lower, upper, name, size_power);
  key.lower_allowed = false;
  return key;
}

EffectKey EffectKey::Optional(double value) const {
  EffectKey key = *this;
  key.required = false;
  key.default_value = value;
  return key;
}

EffectKey EffectKey::Alternative() const {
  EffectKey key = Optional();
  key.default_written = false;
  return key;
}

EffectEquation::EffectEquation(std::string id, EffectJoints joints, std::vector<EffectKey> keys,
                               std::vector<std::string> one_of)
    : id_(std::move(id)), joints_(joints), keys_(std::move(keys)), one_of_(std::move(one_of)) {
  for (const std::string& name : one_of_) CHECK(FindKey(name) != nullptr) << id_ << " has no " << name;
}

const EffectKey* EffectEquation::FindKey(const std::string& name) const {
  for (const EffectKey& key : keys_) {
    if (key.name == name) return &key;
  }
  return nullptr;
}

bool SimulatedEffect::IsValid(const Robot& robot, std::string* error) const {
  if (equation == nullptr) {
    *error = "has no equation";
    return false;
  }
  *error = ProblemOfJoints(*this, equation->joints(), robot.dof());
  if (error->empty()) *error = ProblemOfValues(*this, *equation);
  if (error->empty()) *error = equation->Problem(*this, robot);
  if (!error->empty()) *error = equation->id() + ": " + *error;
  return error->empty();
}

double SimulatedEffect::Value(const std::string& key) const {
  CHECK(equation != nullptr);
  const EffectKey* found = equation->FindKey(key);
  CHECK(found != nullptr) << equation->id() << " has no " << key;
  const auto given = values.find(key);
  return given == values.end() ? found->default_value : given->second;
}

}  // namespace idim
