#include "core/estimate/estimate_json.h"

namespace idim {
namespace {

// Keys in the order of the contract.
using Json = nlohmann::ordered_json;

Json ToJson(const Eigen::VectorXd& v) { return Json(std::vector<double>(v.data(), v.data() + v.size())); }

Json ToJson(const Eigen::MatrixXd& m) {
  Json rows = Json::array();
  for (Eigen::Index i = 0; i < m.rows(); ++i) rows.push_back(ToJson(Eigen::VectorXd(m.row(i))));
  return rows;
}

const char* StatusName(const Status& status) {
  switch (status.code()) {
    case StatusCode::kOk:
      return "ok";
    case StatusCode::kBadInput:
      return "bad_input";
    case StatusCode::kUntrusted:
      return "untrusted";
  }
  return "";
}

}  // namespace

nlohmann::ordered_json EstimateJson(const Estimate& e) {
  Json json;
  json["schema"] = "idim.estimate.1";
  json["status"] = StatusName(e.status);
  json["message"] = e.status.message();
  json["robot"] = e.robot;
  json["estimator"] = e.estimator;
  json["parameters"] = Json::array();
  for (const ParameterEstimate& p : e.parameters) {
    json["parameters"].push_back({{"name", p.parameter.name},
                                  {"kind", ParameterKindName(p.parameter.kind)},
                                  {"joint", p.parameter.joint},
                                  {"value", p.value},
                                  {"standard_deviation", p.standard_deviation},
                                  {"relative_standard_deviation_percent", p.RelativeSigmaPercent()},
                                  {"interval95", {p.interval95[0], p.interval95[1]}},
                                  {"unit", p.parameter.unit},
                                  {"regrouping", p.regrouping}});
    if (p.model_standard_deviation >= 0.0) {
      json["parameters"].back()["model_standard_deviation"] = p.model_standard_deviation;
    }
  }
  if (!e.effects.empty()) {
    json["effects"] = Json::array();
    for (const EstimatedEffect& effect : e.effects) {
      Json joints = Json::array(), shape = Json::object();
      for (const int joint : effect.joints) joints.push_back(joint + 1);
      for (const auto& [name, value] : effect.shape) shape[name] = value;
      json["effects"].push_back({{"id", effect.id}, {"joints", joints}, {"shape", shape}});
    }
  }
  if (e.velocity_zero_at_rest) json["velocity_zero_at_rest"] = true;
  json["covariance"] = ToJson(e.covariance);
  json["eliminated"] = e.eliminated;
  json["without_effect"] = e.without_effect;
  json["noise"] = {{"position", ToJson(e.position_noise)}, {"signal", ToJson(e.signal_noise)}};
  if (e.signal_noise_decimated.size() > 0) json["noise"]["signal_decimated"] = ToJson(e.signal_noise_decimated);
  if (!e.uncertainty.empty()) json["uncertainty"] = e.uncertainty;
  if (!e.start.empty()) json["start"] = e.start;
  json["preprocessing"] = {{"cutoff_hz", e.cutoff_hz}, {"decimation", e.decimation}, {"reason", e.preprocessing}};
  json["recordings"] = Json::array();
  for (const RecordingFit& r : e.recordings) {
    json["recordings"].push_back({{"name", r.name},
                                  {"use", r.use},
                                  {"samples", r.samples},
                                  {"relative_error_percent", ToJson(r.relative_error_percent)},
                                  {"relative_error_percent_all", r.relative_error_percent_all},
                                  {"rms_torque", ToJson(r.rms_torque)},
                                  {"rms_torque_unfiltered", ToJson(r.rms_torque_unfiltered)},
                                  {"residual_lag1", ToJson(r.residual_lag1)}});
  }
  json["relative_error_percent"] = e.relative_error_percent;
  json["condition_number"] = e.condition_number;
  json["condition_number_weighted"] = e.condition_number_weighted;
  if (!e.gain_diagnoses.empty()) {
    json["gain_diagnoses"] = Json::array();
    for (const GainDiagnosis& g : e.gain_diagnoses) {
      json["gain_diagnoses"].push_back({{"name", g.name},
                                        {"strength", g.strength},
                                        {"independent", g.independent},
                                        {"reliability", g.reliability},
                                        {"known_share", g.known_share},
                                        {"payload_torque_share", g.payload_torque_share},
                                        {"payload_gravity_share", g.payload_gravity_share},
                                        {"sentence", g.sentence}});
    }
  }
  if (e.singular_values.size() > 0) json["singular_values"] = ToJson(e.singular_values);
  json["seconds"] = e.seconds;
  return json;
}

std::string EstimateToJson(const Estimate& e) { return EstimateJson(e).dump(1) + "\n"; }

}  // namespace idim
