#include "core/simulation/effects.h"

#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <sstream>

#include "core/base/text.h"

namespace idim {
namespace {

constexpr double kLarge = kLargestInput;
constexpr double kLongestDelay = 0.1;  // [s]

SimulatedEffectKey Any(const std::string& name, int size_power = 0) {
  return {name, -kLarge, kLarge, true, true, 0.0, size_power};
}
SimulatedEffectKey Positive(const std::string& name, int size_power = 0) {
  return {name, 0.0, kLarge, false, true, 0.0, size_power};
}
SimulatedEffectKey Within(const std::string& name, double lower, double upper, int size_power = 0) {
  return {name, lower, upper, true, true, 0.0, size_power};
}
SimulatedEffectKey Optional(SimulatedEffectKey key, double standard = 0.0) {
  key.required = false;
  key.standard = standard;
  return key;
}

std::vector<SimulatedEffectKind> MakeKinds() {
  const EffectJoints joint = EffectJoints::kOneOrMore;
  const SimulatedEffectKey share = {"", -1.0, 10.0, false, false, 0.0, 1};
  SimulatedEffectKey viscous_share = share, coulomb_share = share;
  viscous_share.name = "viscous_share";
  coulomb_share.name = "coulomb_share";
  SimulatedEffectKey exponent = Positive("exponent");
  exponent.upper = 5.0;
  SimulatedEffectKey damping = Within("damping_ratio", 0.01, 2.0);
  return {
      {"stribeck", joint, {Any("Fst", 1), Positive("vs")}, {}},
      {"power_viscous", joint, {Any("coefficient", 1), exponent}, {}},
      {"asymmetric_friction",
       joint,
       {Optional(Any("viscous_difference", 1)), Optional(Any("coulomb_difference", 1))},
       {"viscous_difference", "coulomb_difference"}},
      {"load_friction", joint, {Within("mu", -1.0, 1.0, 1)}, {}},
      {"presliding", joint, {Positive("displacement", 1)}, {}},
      {"thermal_drift",
       joint,
       {viscous_share, coulomb_share, Positive("time_constant")},
       {viscous_share.name, coulomb_share.name}},
      {"torque_ripple",
       joint,
       {Any("amplitude", 1), Optional(Any("phase")), Optional(Positive("order")), Optional(Positive("motor_order"))},
       {"order", "motor_order"}},
      {"joint_spring", joint, {Any("stiffness", 1), Optional(Any("rest"))}, {}},
      {"motor_coupling",
       EffectJoints::kTwo,
       {Optional(Any("inertia", 1)), Optional(Any("viscous", 1)), Optional(Any("coulomb", 1))},
       {"inertia", "viscous", "coulomb"}},
      {"base_tilt",
       EffectJoints::kNone,
       {Optional(Within("angle_1", -M_PI, M_PI, 1)), Optional(Within("angle_2", -M_PI, M_PI, 1))},
       {"angle_1", "angle_2"}},
      {"payload_change",
       EffectJoints::kNone,
       {Any("M", 1), Optional(Any("x")), Optional(Any("y")), Optional(Any("z")), Optional(Within("from", 0.0, kLarge))},
       {}},
      {"time_delay", joint, {Within("delay", -kLongestDelay, kLongestDelay, 1)}, {}},
      {"gain_saturation", joint, {Within("loss", 0.0, kLarge, 1), Positive("signal")}, {}},
      {"joint_elasticity", joint, {Positive("stiffness", -1), Optional(damping, 0.1)}, {}},
      {"backlash",
       joint,
       {Within("gap", 0.0, 1.0, 1), Optional(Within("contact_frequency", 1.0, 2000.0), 100.0), Optional(damping, 0.3)},
       {}},
  };
}

const SimulatedEffectKey* FindKey(const SimulatedEffectKind& kind, const std::string& name) {
  for (const SimulatedEffectKey& key : kind.keys) {
    if (key.name == name) return &key;
  }
  return nullptr;
}

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

std::string ProblemOfValues(const SimulatedEffect& effect, const SimulatedEffectKind& kind) {
  std::ostringstream problem;
  for (const auto& [name, value] : effect.values) {
    const SimulatedEffectKey* key = FindKey(kind, name);
    if (key == nullptr) {
      problem << name << " is unknown";
      return problem.str();
    }
    if (value <= key->upper && (key->lower_allowed ? value >= key->lower : value > key->lower)) continue;
    problem << name << " = " << value << ", must be " << (key->lower_allowed ? "from " : "above ") << key->lower
            << (key->lower_allowed ? " to " : " and at most ") << key->upper;
    return problem.str();
  }
  for (const SimulatedEffectKey& key : kind.keys) {
    if (key.required && effect.values.count(key.name) == 0) return key.name + " is missing";
  }
  const bool some = std::any_of(kind.one_of.begin(), kind.one_of.end(),
                                [&](const std::string& name) { return effect.values.count(name) > 0; });
  if (!kind.one_of.empty() && !some) return "one of " + Join(kind.one_of, ", ") + " must be given";
  if (effect.id == "torque_ripple" && effect.values.count("order") + effect.values.count("motor_order") == 2) {
    return "order and motor_order are both given, only one of them can be";
  }
  return "";
}

}  // namespace

const std::vector<SimulatedEffectKind>& SimulatedEffectKinds() {
  static const auto* kinds = new std::vector<SimulatedEffectKind>(MakeKinds());
  return *kinds;
}

const SimulatedEffectKind* FindSimulatedEffect(const std::string& id) {
  for (const SimulatedEffectKind& kind : SimulatedEffectKinds()) {
    if (kind.id == id) return &kind;
  }
  return nullptr;
}

bool SimulatedEffect::IsValid(const Robot& robot, std::string* error) const {
  const SimulatedEffectKind* kind = FindSimulatedEffect(id);
  if (kind == nullptr) {
    *error = "id '" + Clip(id) + "' is not known";
    return false;
  }
  *error = ProblemOfJoints(*this, kind->joints, robot.dof());
  if (error->empty()) *error = ProblemOfValues(*this, *kind);
  if (error->empty() && id == "base_tilt" && robot.gravity.isZero()) *error = "the robot has no gravity to be tilted";
  if (!error->empty()) *error = id + ": " + *error;
  return error->empty();
}

double SimulatedEffect::Value(const std::string& key) const {
  const SimulatedEffectKind* kind = FindSimulatedEffect(id);
  CHECK(kind != nullptr) << id;
  const SimulatedEffectKey* found = FindKey(*kind, key);
  CHECK(found != nullptr) << id << " has no " << key;
  const auto given = values.find(key);
  return given == values.end() ? found->standard : given->second;
}

}  // namespace idim
