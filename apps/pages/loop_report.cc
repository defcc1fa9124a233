#include "apps/pages/loop_report.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>
#include <utility>

#include "apps/pages/loop_facts.h"
#include "apps/pages/words.h"
#include "core/base/text.h"
#include "core/model/active_effects.h"

namespace idim {
namespace {

using Json = nlohmann::ordered_json;
using Eigen::VectorXd;

// A negative error was never computed.
Json ErrorJson(double value) { return value < 0.0 ? Json() : Json(value); }

Json ToJson(const VectorXd& v) { return Json(std::vector<double>(v.data(), v.data() + v.size())); }

Json OneBased(const std::vector<int>& joints) {
  Json list = Json::array();
  for (const int joint : joints) list.push_back(joint + 1);
  return list;
}

Json Place(const ActiveEffect& active) {
  return {{"effect", active.effect->id()}, {"joints", OneBased(active.joints)}};
}

Json PerJointJson(const VectorXd& identification, const VectorXd& validation) {
  return {{"identification", ToJson(identification)}, {"validation", ToJson(validation)}};
}

Json ModelJson(const LoopErrors& errors) {
  return {{"identification_error_percent", ErrorJson(errors.identification)},
          {"validation_error_percent", ErrorJson(errors.validation)},
          {"per_joint", PerJointJson(errors.identification_per_joint, errors.validation_per_joint)},
          {"per_joint_moving", PerJointJson(errors.identification_moving, errors.validation_moving)}};
}

Json ErrorsJson(const LoopErrors& errors) {
  return {{"identification", ErrorJson(errors.identification)},
          {"validation", ErrorJson(errors.validation)},
          {"per_joint", PerJointJson(errors.identification_per_joint, errors.validation_per_joint)}};
}

Json EstimateOf(const ParameterEstimate& p) {
  return {{"name", p.parameter.name},
          {"value", p.value},
          {"standard_deviation", p.standard_deviation},
          {"interval95", {p.interval95[0], p.interval95[1]}},
          {"unit", p.parameter.unit}};
}

Json ShapeJson(const LoopResult& result, const ActiveEffect& active) {
  Json list = Json::array();
  for (const NamedShape& shape : ShapesOf(result, active)) {
    list.push_back({{"name", shape.parameter.name}, {"value", shape.value}, {"unit", shape.parameter.unit}});
  }
  return list;
}

Json CandidateJson(const LoopResult& result, const EffectCandidate& c) {
  Json json = Place(c.effect);
  json["shape"] = ShapeJson(result, c.effect);
  json["statistic"] = c.score.statistic;
  json["p_value"] = c.p_value;
  json["parameters"] = c.parameters;
  json["held_out_decrease_percent"] = 100.0 * c.held_out_decrease;
  json["held_out_standard_error_percent"] = 100.0 * c.held_out_error;
  return json;
}

Json StepJson(const LoopResult& result, const LoopStep& step) {
  Json json = Place(step.effect);
  json["parameters"] = Json::array();
  for (const ParameterEstimate& p : EffectEstimates(result, step.effect)) json["parameters"].push_back(EstimateOf(p));
  json["shape"] = ShapeJson(result, step.effect);
  json["statistic"] = step.candidate.score.statistic;
  json["p_value"] = step.candidate.p_value;
  json["threshold"] = step.threshold;
  json["held_out_decrease_percent"] = 100.0 * step.candidate.held_out_decrease;
  json["held_out_standard_error_percent"] = 100.0 * step.candidate.held_out_error;
  json["error_before"] = ErrorsJson(step.before);
  json["error_after"] = ErrorsJson(step.after);
  json["confusable_with"] = Json::array();
  for (const LoopRival& rival : step.confusable_with) {
    Json entry = Place(rival.effect);
    entry["held_out_error_percent"] = ErrorJson(rival.held_out_error_percent);
    json["confusable_with"].push_back(std::move(entry));
  }
  json["physics"] = step.effect.effect->physics();
  json["how_to_confirm"] = step.effect.effect->how_to_confirm();
  json["moved"] = Json::array();
  for (const MovedParameter& m : step.moved) {
    json["moved"].push_back({{"name", m.parameter.name},
                             {"before", m.before},
                             {"after", m.after},
                             {"standard_deviation_before", m.standard_deviation},
                             {"unit", m.parameter.unit}});
  }
  json["ranking"] = Json::array();
  for (const EffectCandidate& c : step.ranking) json["ranking"].push_back(CandidateJson(result, c));
  return json;
}

// Rows "declared", "final" for each set of data, a column a joint.
std::string ErrorTableText(const LoopResult& result) {
  std::vector<std::vector<std::string>> lines = {{"relative error, %", "all"}};
  for (Eigen::Index j = 1; j <= result.declared.identification_per_joint.size(); ++j) {
    lines[0].push_back("joint " + std::to_string(j));
  }
  const auto add = [&](const std::string& name, double all, const VectorXd& joints) {
    std::vector<std::string> line = {name, ErrorText(all, "-")};
    for (const double error : joints) line.push_back(ErrorText(error, "-"));
    lines.push_back(std::move(line));
  };
  const std::string held_out = HeldOutName(result);
  add("identification, declared model", result.declared.identification, result.declared.identification_per_joint);
  add("identification, final model", result.final.identification, result.final.identification_per_joint);
  add(held_out + ", declared model", result.declared.validation, result.declared.validation_per_joint);
  add(held_out + ", final model", result.final.validation, result.final.validation_per_joint);
  add("- while the joint moves, declared model", -1.0, result.declared.validation_moving);
  add("- while the joint moves, final model", -1.0, result.final.validation_moving);
  return AlignColumns(lines);
}

// Broken between words; lines after the first begin with `indent` blanks.
std::string Wrapped(const std::string& text, size_t indent) {
  constexpr size_t kWidth = 110;
  std::string wrapped, word;
  size_t column = indent;
  std::istringstream words(text);
  while (words >> word) {
    const bool fits = wrapped.empty() || column + 1 + word.size() <= kWidth;
    if (!wrapped.empty()) wrapped += fits ? " " : "\n" + std::string(indent, ' ');
    column = (fits ? column + 1 : indent) + word.size();
    wrapped += word;
  }
  return wrapped;
}

std::string StepText(const LoopResult& result, const LoopStep& step, size_t number) {
  std::string text = std::to_string(number) + ". " + EffectTitle(step.effect) + "\n";
  const auto line = [&](const std::string& key, const std::string& value) {
    text += Format("   %-11s %s\n", key.c_str(), Wrapped(value, 15).c_str());
  };
  line("what", step.effect.effect->physics());
  line("how sure", EvidenceSentence(result, step));
  const auto error = [&](const std::string& data, double before, double after, const VectorXd& joints_before,
                         const VectorXd& joints_after) {
    std::string value = data + Format(" %s -> %s %%", ErrorText(before, "-").c_str(), ErrorText(after, "-").c_str());
    const std::string joints = OfItsJoints(step, joints_before, joints_after);
    return joints.empty() ? value : value + " (" + joints + ")";
  };
  line("error", error("identification", step.before.identification, step.after.identification,
                      step.before.identification_per_joint, step.after.identification_per_joint));
  line("", error(HeldOutName(result), step.before.validation, step.after.validation, step.before.validation_per_joint,
                 step.after.validation_per_joint));
  std::string key = "parameters";
  for (const ParameterEstimate& p : EffectEstimates(result, step.effect)) {
    line(std::exchange(key, ""), p.parameter.name + " = " + ValueText(p));
  }
  line("to confirm", step.effect.effect->how_to_confirm());
  line("rivals", RivalSentence(step));
  return text;
}

std::string MovementTable(const std::vector<Movement>& movements) {
  std::vector<std::vector<std::string>> lines = {{"parameter", "declared model", "final model", "unit"}};
  for (const Movement& m : movements) {
    lines.push_back({m.before.parameter.name, Format("%.4g +- %.2g", m.before.value, m.before.standard_deviation),
                     Format("%.4g +- %.2g", m.after.value, m.after.standard_deviation), m.before.parameter.unit});
  }
  return AlignColumns(lines);
}

}  // namespace

Status StatusOf(const LoopResult& result) { return result.status.ok() ? result.after.estimate.status : result.status; }

std::string LoopToJson(const LoopResult& result) {
  const Status status = StatusOf(result);
  Json json;
  json["schema"] = "idim.loop.1";
  json["status"] = status.ok() ? "ok" : "untrusted";
  json["message"] = status.message();
  json["robot"] = result.prepared.robot().name;
  json["options"] = {{"significance", result.given.significance},
                     {"margin", result.given.margin},
                     {"max_effects", result.given.max_effects}};
  json["held_out_by_blocks"] = result.held_out_by_blocks;
  json["declared"] = ModelJson(result.declared);
  json["steps"] = Json::array();
  for (const LoopStep& step : result.steps) json["steps"].push_back(StepJson(result, step));
  json["dropped"] = result.dropped;
  json["warnings"] = Warnings(result);
  json["final"] = ModelJson(result.final);
  json["unexplained"] = Json::array();
  for (const Unexplained& u : result.unexplained) {
    json["unexplained"].push_back({{"joint", u.joint + 1},
                                   {"depends_on", u.depends_on},
                                   {"share_of_residual_percent", u.share_percent},
                                   {"p_value", u.p_value}});
  }
  json["moved"] = Json::array();
  for (const Movement& m : Movements(result)) {
    json["moved"].push_back({{"name", m.before.parameter.name},
                             {"before", m.before.value},
                             {"after", m.after.value},
                             {"standard_deviation_before", m.before.standard_deviation},
                             {"standard_deviation_after", m.after.standard_deviation},
                             {"unit", m.before.parameter.unit}});
  }
  json["seconds"] = result.after.estimate.seconds;
  return json.dump(1) + "\n";
}

std::string LoopToText(const LoopResult& result) {
  std::string text = result.prepared.robot().name + ", what the declared model lacks\n\n";
  if (const Status status = StatusOf(result); !status.ok()) {
    text += "NOT TO BE TRUSTED: " + status.message() + "\n\n";
  }
  if (result.before.estimate.parameters.empty()) return text;
  text += ErrorTableText(result);
  text += result.held_out_by_blocks
              ? "Held-out blocks: each fitted on the other blocks of the identification recordings.\n\n"
              : "Validation recordings were not looked at while effects were chosen.\n\n";
  if (result.steps.empty()) text += "No effect was found that lowers the error of data not fitted.\n\n";
  for (size_t k = 0; k < result.steps.size(); ++k) text += StepText(result, result.steps[k], k + 1) + "\n";
  for (const std::string& sentence : result.dropped) text += sentence + "\n";
  if (!result.dropped.empty()) text += "\n";
  for (const std::string& warning : Warnings(result)) text += "WARNING: " + Wrapped(warning, 9) + "\n\n";
  if (result.unexplained.empty()) {
    text += "What is left depends on no position, velocity, acceleration, torque or time that was tried.\n";
  } else {
    text += "What is left:\n";
    for (const Unexplained& u : result.unexplained) text += "  " + Wrapped(UnexplainedSentence(u), 2) + "\n";
  }
  if (result.steps.empty()) return text;
  const std::vector<Movement> movements = Movements(result);
  if (movements.empty()) return text + "\nNo parameter left the 95 % interval that the declared model gave it.\n";
  return text + "\nOutside the 95 % interval that the declared model gave them:\n" + MovementTable(movements);
}

}  // namespace idim
