#include "core/model/unknowns.h"

#include <glog/logging.h>

#include <algorithm>

#include "core/robot/joint_units.h"

namespace idim {

std::vector<Parameter> GainParameters(const Robot& robot, Side signal_side) {
  std::vector<Parameter> gains;
  for (int j = 1; j <= robot.dof(); ++j) {
    gains.push_back({"g" + std::to_string(j), ParameterKind::kDriveGain, j, GainUnit(robot, j - 1, signal_side)});
  }
  return gains;
}

Unknowns::Unknowns(const Model& model, UncertainPayload uncertain) : dof_(model.base().model().dof()) {
  if (model.IdentifiesGains()) {
    parameters_ = GainParameters(model.base().model().robot(), model.signal_side);
  } else {
    known_gains_ = model.gains;
    CHECK_EQ(known_gains_.size(), dof_);
  }
  num_base_ = model.base().size();
  const std::vector<Parameter>& of_base = model.base().parameters();
  parameters_.insert(parameters_.end(), of_base.begin(), of_base.end());

  const std::vector<Parameter>& of_effects = model.columns->parameters;
  num_effect_ = static_cast<int>(of_effects.size());
  int at = size();
  parameters_.insert(parameters_.end(), of_effects.begin(), of_effects.end());
  std::vector<double> starts;
  for (const ActiveEffect& active : model.effects) {
    const auto linear = static_cast<int>(active.effect->Parameters(model.base().model().robot(), active.joints).size());
    const int shapes = active.values.size() > 0 ? static_cast<int>(active.shape.size()) : 0;
    effects_.push_back({at, linear, shapes});
    at += linear + shapes;
    starts.resize(starts.size() + static_cast<size_t>(linear), 0.0);
    starts.insert(starts.end(), active.shape.data(), active.shape.data() + shapes);
  }
  CHECK_EQ(at, size());

  int carried = 0;
  for (int p = 0; p < static_cast<int>(model.payloads.size()); ++p) carried += model.IsCarried(p) ? 1 : 0;
  for (int p = 0; p < static_cast<int>(model.payloads.size()); ++p) {
    const Payload& payload = model.payloads[static_cast<size_t>(p)];
    std::array<int, kNumInertial> index;
    InertialVector known = InertialVector::Zero();
    for (size_t k = 0; k < kNumInertial; ++k) {
      index[k] = -1;
      const bool is_known =
          payload.known[k] && !(uncertain == UncertainPayload::kUnknown && payload.standard_deviation[k]);
      if (is_known) known[static_cast<Eigen::Index>(k)] = *payload.known[k];
      if (is_known || !model.IsCarried(p)) continue;
      index[k] = size();
      // The paper numbers the payload as link n + 1.
      std::string name = kStandardNames[k] + std::to_string(dof_ + 1);
      if (carried > 1) name += "_" + payload.name;
      parameters_.push_back({name, ParameterKind::kPayload, dof_, StandardUnit(static_cast<int>(k), false)});
    }
    payload_index_.push_back(index);
    known_payload_.push_back(known);
  }
  offsets_ = Eigen::VectorXd::Zero(size());
  offsets_.segment(first_effect(), num_effect_) =
      Eigen::VectorXd::Map(starts.data(), static_cast<Eigen::Index>(starts.size()));
}

std::optional<int> Unknowns::Find(const std::string& name) const {
  const auto found = std::find_if(parameters_.begin(), parameters_.end(),
                                  [&](const Parameter& unknown) { return unknown.name == name; });
  if (found == parameters_.end()) return std::nullopt;
  return static_cast<int>(found - parameters_.begin());
}

ArmParameters Unknowns::Arm(const Eigen::VectorXd& theta) const {
  CHECK_EQ(theta.size(), size());
  ArmParameters arm;
  arm.gains = Gains(theta);
  arm.chi = theta.segment(first_base(), num_base_ + num_effect_);
  for (int p = 0; p < num_payloads(); ++p) {
    InertialVector body = known_payload(p);
    for (int k = 0; k < kNumInertial; ++k) {
      if (payload(p, k) >= 0) body[k] = theta[payload(p, k)];
    }
    arm.payloads.push_back(body);
  }
  return arm;
}

Eigen::VectorXd Unknowns::Values(const ArmParameters& arm) const {
  Eigen::VectorXd theta(size());
  if (num_gains() > 0) theta.head(dof_) = arm.gains;
  theta.segment(first_base(), num_base_ + num_effect_) = arm.chi;
  for (int p = 0; p < num_payloads(); ++p) {
    for (int k = 0; k < kNumInertial; ++k) {
      if (payload(p, k) >= 0) theta[payload(p, k)] = arm.payloads[static_cast<size_t>(p)][k];
    }
  }
  return theta;
}

Unknowns Unknowns::WithKnownGains(const Eigen::VectorXd& gains) const {
  CHECK_EQ(gains.size(), dof_);
  Unknowns result = *this;
  result.known_gains_ = gains;
  const int fewer = num_gains();
  result.parameters_.erase(result.parameters_.begin(), result.parameters_.begin() + fewer);
  result.offsets_ = offsets_.tail(size() - fewer).eval();
  for (EffectRange& range : result.effects_) range.at -= fewer;
  for (auto& of_payload : result.payload_index_) {
    for (int& k : of_payload) k -= k >= 0 ? fewer : 0;
  }
  return result;
}

}  // namespace idim
