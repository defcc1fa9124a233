#include "core/simulation/plausible_request.h"

#include <utility>

#include "core/base/text.h"
#include "core/base/yaml.h"

namespace idim {
namespace {

std::vector<StatedParameter> ReadStated(YamlFile* file, const YAML::Node& list, const std::string& key,
                                        const std::vector<Parameter>& parameters) {
  std::vector<StatedParameter> stated;
  std::vector<std::string> names;
  for (const Parameter& parameter : parameters) names.push_back(parameter.name);
  if (!file->List(list, key, "a list of {name, value, standard_deviation}")) return stated;
  for (size_t k = 0; k < list.size() && file->ok(); ++k) {
    const YAML::Node& node = list[k];
    const std::string item = KeyPath(key, k);
    if (!file->Map(node, item, {"name", "value", "standard_deviation"})) break;
    for (const char* name : {"name", "value", "standard_deviation"}) {
      file->Require(node, item, name, "a name, a number and a number greater than 0");
    }
    if (!file->ok()) break;
    StatedParameter parameter;
    parameter.index = file->Choice(node["name"], KeyPath(item, "name"), names);
    parameter.value = file->Number(node["value"], KeyPath(item, "value"));
    parameter.standard_deviation =
        file->PositiveNumber(node["standard_deviation"], KeyPath(item, "standard_deviation"));
    for (const StatedParameter& other : stated) {
      if (other.index == parameter.index) file->Fail(node["name"], KeyPath(item, "name"), "given twice", "it once");
    }
    stated.push_back(parameter);
  }
  return stated;
}

RoughBody ReadBody(YamlFile* file, const YAML::Node& node, const std::string& key) {
  RoughBody body;
  if (!file->Map(node, key, {"mass", "centre", "radii"})) return body;
  for (const char* name : {"mass", "centre", "radii"}) {
    file->Require(node, key, name, "{mass: kg, centre: [x, y, z] in m, radii: [x, y, z] in m}");
  }
  if (!file->ok()) return body;
  body.mass = file->PositiveNumber(node["mass"], KeyPath(key, "mass"));
  body.centre = file->Numbers(node["centre"], KeyPath(key, "centre"), 3, "in m");
  body.radii = file->Numbers(node["radii"], KeyPath(key, "radii"), 3, "in m");
  if (file->ok() && body.radii.minCoeff() <= 0.0) {
    file->Fail(node["radii"], KeyPath(key, "radii"), "a radius is not positive", "three numbers greater than 0");
  }
  return body;
}

}  // namespace

Result<PlausibleRequest> ReadPlausibleRequest(const std::string& yaml_path, const BaseParameters& base) {
  YamlFile file(yaml_path);
  IDIM_RETURN_IF_ERROR(file);
  const YAML::Node& root = file.root();
  PlausibleRequest request;
  file.Map(root, "", {"base_parameters", "standard_parameters", "bodies", "spread"});
  file.Require(root, "", "base_parameters", "a list of {name, value, standard_deviation}");
  file.Require(root, "", "bodies", "a list of {mass, centre, radii}, one a link");
  IDIM_RETURN_IF_ERROR(file);
  request.base = ReadStated(&file, root["base_parameters"], "base_parameters", base.parameters());
  if (root["standard_parameters"].IsDefined()) {
    request.standard = ReadStated(&file, root["standard_parameters"], "standard_parameters", base.model().parameters());
  }
  const YAML::Node bodies = root["bodies"];
  const std::string expected = "a list of " + std::to_string(base.model().dof()) + " bodies, one a link";
  if (file.List(bodies, "bodies", expected)) {
    if (static_cast<int>(bodies.size()) != base.model().dof()) {
      file.Fail(bodies, "bodies", "has " + std::to_string(bodies.size()) + " entries", expected);
    }
    for (size_t k = 0; k < bodies.size() && file.ok(); ++k) {
      request.bodies.push_back(ReadBody(&file, bodies[k], KeyPath("bodies", k)));
    }
  }
  if (root["spread"].IsDefined()) request.spread = file.PositiveNumber(root["spread"], "spread");
  IDIM_RETURN_IF_ERROR(file);
  return request;
}

}  // namespace idim
