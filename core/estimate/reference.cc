#include "core/estimate/reference.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <utility>

#include "core/base/file.h"

namespace idim {
namespace {

// The number under `key`, or a message.
Result<double> Number(const nlohmann::json& entry, const char* key, const std::string& where) {
  const auto found = entry.find(key);
  if (found == entry.end() || !found->is_number()) {
    return Status::BadInput(where + ": key '" + key + "': expected a number");
  }
  return found->get<double>();
}

Result<EstimatedEffect> ParseEffect(const nlohmann::json& entry, const std::string& where) {
  EstimatedEffect effect;
  if (!entry.is_object() || !entry.contains("id") || !entry["id"].is_string()) {
    return Status::BadInput(where + ": key 'id': expected the id of an effect, such as \"stribeck\"");
  }
  effect.id = entry["id"].get<std::string>();
  const nlohmann::json joints = entry.value("joints", nlohmann::json::array());
  const bool are_joints =
      joints.is_array() && std::all_of(joints.begin(), joints.end(), [](const nlohmann::json& joint) {
        return joint.is_number_integer() && joint.get<double>() >= 1.0 && joint.get<double>() < 1e6;
      });
  if (!are_joints) return Status::BadInput(where + ": key 'joints': expected a list of joints, from 1 on");
  for (const nlohmann::json& joint : joints) effect.joints.push_back(joint.get<int>() - 1);
  const nlohmann::json shape = entry.value("shape", nlohmann::json::object());
  if (!shape.is_object()) return Status::BadInput(where + ": key 'shape': expected an object of numbers");
  for (const auto& [name, value] : shape.items()) {
    if (!value.is_number()) return Status::BadInput(where + ": key 'shape." + name + "': expected a number");
    effect.shape.emplace_back(name, value.get<double>());
  }
  return effect;
}

}  // namespace

const Reference::Entry* Reference::Find(const std::string& parameter) const {
  for (const Entry& entry : parameters) {
    if (entry.name == parameter) return &entry;
  }
  return nullptr;
}

Reference ReferenceOf(const Estimate& estimate) {
  Reference reference;
  reference.name = estimate.estimator;
  reference.robot = estimate.robot;
  if (!estimate.status.ok()) reference.warning = estimate.status.message();
  for (const ParameterEstimate& p : estimate.parameters) {
    reference.parameters.push_back({p.parameter.name, p.value, p.standard_deviation});
  }
  reference.effects = estimate.effects;
  reference.velocity_zero_at_rest = estimate.velocity_zero_at_rest;
  return reference;
}

Result<Reference> ReadReference(const std::string& path) {
  Result<std::string> text = ReadFile(path);
  IDIM_RETURN_IF_ERROR(text);
  const nlohmann::json json = nlohmann::json::parse(*text, nullptr, false);
  if (json.is_discarded() || !json.is_object()) {
    return Status::BadInput(path + ": not a JSON object; expected a file in the format of estimate.json");
  }
  Reference reference;
  std::string status, message;
  for (const auto& [key, value] :
       {std::pair{"estimator", &reference.name}, std::pair{"name", &reference.name},
        std::pair{"robot", &reference.robot}, std::pair{"status", &status}, std::pair{"message", &message}}) {
    const auto found = json.find(key);
    if (found == json.end()) continue;
    if (!found->is_string()) return Status::BadInput(path + ": key '" + key + "': expected a text");
    *value = found->get<std::string>();
  }
  if (reference.name.empty()) reference.name = path.substr(path.find_last_of('/') + 1);
  if (status == "untrusted") reference.warning = message.empty() ? "no reason stated" : message;
  const auto parameters = json.find("parameters");
  if (!reference.warning.empty() && parameters != json.end() && parameters->empty()) {
    return Status::BadInput(path + ": key 'parameters': the estimate has none, because it is untrusted: " + message);
  }
  if (parameters == json.end() || !parameters->is_array() || parameters->empty()) {
    return Status::BadInput(path + ": key 'parameters': expected a list of {name, value, standard_deviation}");
  }
  for (size_t k = 0; k < parameters->size(); ++k) {
    const nlohmann::json& entry = (*parameters)[k];
    const std::string where = path + ": parameters[" + std::to_string(k) + "]";
    if (!entry.is_object() || !entry.contains("name") || !entry["name"].is_string()) {
      return Status::BadInput(where + ": key 'name': expected the name of a parameter, such as \"ZZ1R\"");
    }
    Reference::Entry parsed;
    parsed.name = entry["name"].get<std::string>();
    if (reference.Find(parsed.name) != nullptr) {
      return Status::BadInput(where + ": key 'name': '" + parsed.name + "' is given twice");
    }
    const Result<double> value = Number(entry, "value", where);
    IDIM_RETURN_IF_ERROR(value);
    parsed.value = *value;
    if (entry.contains("standard_deviation")) {
      const Result<double> sigma = Number(entry, "standard_deviation", where);
      IDIM_RETURN_IF_ERROR(sigma);
      parsed.standard_deviation = *sigma;
    }
    reference.parameters.push_back(std::move(parsed));
  }
  const nlohmann::json effects = json.value("effects", nlohmann::json::array());
  if (!effects.is_array()) return Status::BadInput(path + ": key 'effects': expected a list of {id, joints, shape}");
  for (size_t k = 0; k < effects.size(); ++k) {
    Result<EstimatedEffect> effect = ParseEffect(effects[k], path + ": effects[" + std::to_string(k) + "]");
    IDIM_RETURN_IF_ERROR(effect);
    reference.effects.push_back(std::move(effect).value());
  }
  const nlohmann::json at_rest = json.value("velocity_zero_at_rest", nlohmann::json(false));
  if (!at_rest.is_boolean()) return Status::BadInput(path + ": key 'velocity_zero_at_rest': expected true or false");
  reference.velocity_zero_at_rest = at_rest.get<bool>();
  return reference;
}

Result<std::vector<Reference>> ReadReferences(const std::string& paths) {
  std::vector<Reference> references;
  std::stringstream list(paths);
  std::vector<std::string> read;
  for (std::string path; std::getline(list, path, ',');) {
    Result<Reference> reference = ReadReference(path);
    IDIM_RETURN_IF_ERROR(reference);
    references.push_back(std::move(reference).value());
    read.push_back(path);
  }
  std::map<std::string, int> count;
  for (const Reference& reference : references) ++count[reference.name];
  for (size_t k = 0; k < references.size(); ++k) {
    if (count[references[k].name] > 1 && references[k].name != read[k]) references[k].name += " (" + read[k] + ")";
  }
  return references;
}

double DifferenceInSigmas(const ParameterEstimate& estimate, const Reference::Entry& reference) {
  const double sigma = std::hypot(estimate.standard_deviation, reference.standard_deviation);
  return sigma > 0.0 ? (estimate.value - reference.value) / sigma : std::numeric_limits<double>::quiet_NaN();
}

std::string BesideReference(const Estimate& estimate, const Reference& reference) {
  // An exact reference has no standard deviation, and nothing is a fraction of zero.
  const auto number = [](const char* format, bool known, double value) {
    char text[32] = "-";
    if (known) std::snprintf(text, sizeof(text), format, value);
    return std::string(text);
  };
  std::string text = "beside: " + reference.name + "\n";
  text += "parameter     estimate      %std     reference     %std  difference, %   in standard deviations\n";
  for (const ParameterEstimate& p : estimate.parameters) {
    const Reference::Entry* entry = reference.Find(p.parameter.name);
    if (entry == nullptr) continue;
    const double size = std::abs(entry->value);
    char line[256];
    std::snprintf(line, sizeof(line), "%-10s %+11.3e %8.2f   %+11.3e %8s  %12s   %+10.1f\n", p.parameter.name.c_str(),
                  p.value, p.RelativeSigmaPercent(), entry->value,
                  number("%.2f", entry->standard_deviation > 0.0, 100.0 * entry->standard_deviation / size).c_str(),
                  number("%+.1f", size > 0.0, 100.0 * (p.value - entry->value) / size).c_str(),
                  DifferenceInSigmas(p, *entry));
    text += line;
  }
  std::string missing;
  for (const Reference::Entry& entry : reference.parameters) {
    bool found = false;
    for (const ParameterEstimate& p : estimate.parameters) found |= p.parameter.name == entry.name;
    if (!found) missing += " " + entry.name;
  }
  if (!missing.empty()) text += "in the reference only:" + missing + "\n";
  return text;
}

}  // namespace idim
