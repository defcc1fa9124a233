#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "core/base/text.h"
#include "core/simulation/effects_truth.h"
#include "core/simulation/simulate_scenario.h"

namespace idim {
namespace {

constexpr double kTolerance = 0.015;  // of the share
constexpr double kCoarseStep = 5e-4;  // [s] suffices for a share
constexpr int kMostTrials = 30;

SimulatedEffect Scaled(const SimulatedEffect& effect, double factor) {
  SimulatedEffect scaled = effect;
  for (const EffectKey& key : effect.equation->keys()) {
    const auto value = scaled.values.find(key.name);
    if (value != scaled.values.end()) value->second *= std::pow(factor, key.size_power);
  }
  return scaled;
}

}  // namespace

Eigen::VectorXd EffectShares(const Scenario& scenario, size_t k) {
  CHECK_LT(k, scenario.effects.size());
  Scenario without = scenario;
  without.effects.erase(without.effects.begin() + static_cast<std::ptrdiff_t>(k));
  const int n = scenario.robot.dof();
  Eigen::VectorXd changed = Eigen::VectorXd::Zero(n), all = Eigen::VectorXd::Zero(n);
  for (const ScenarioRecording& recording : scenario.recordings) {
    const Eigen::MatrixXd base = SimulateTruth(without, recording).signal;
    changed += (SimulateTruth(scenario, recording).signal - base).colwise().squaredNorm().transpose();
    all += base.colwise().squaredNorm().transpose();
  }
  for (int j = 0; j < n; ++j) changed[j] = all[j] > 0.0 ? std::sqrt(changed[j] / all[j]) : 0.0;
  return changed;
}

double EffectShare(const Scenario& scenario, size_t k) {
  const Eigen::VectorXd shares = EffectShares(scenario, k);
  if (scenario.effects[k].joints.empty()) return shares.maxCoeff();
  double largest = 0.0;
  for (int j : scenario.effects[k].joints) largest = std::max(largest, shares[j]);
  return largest;
}

Status ScaleEffect(Scenario* scenario, size_t k, double share) {
  CHECK_LT(k, scenario->effects.size());
  CHECK_GT(share, 0.0);
  const SimulatedEffect given = scenario->effects[k];
  const double step = scenario->effect_step;
  const auto failed = [&](const std::string& why) {
    scenario->effects[k] = given;
    return Status::Untrusted(given.equation->id() + " cannot be given the share " + FormatNumber(share) + ": " + why);
  };
  const Status valid = CheckEffects(*scenario);
  if (!valid.ok()) return failed(valid.message());
  // Shares grow nearly as a power of the size: a secant in logarithms, kept within the bracket once there is one.
  double factor = 1.0, lower = 0.0, upper = std::numeric_limits<double>::infinity(), power = 1.0;
  std::optional<std::pair<double, double>> last;  // logarithms of factor and share
  for (int trial = 0; trial < kMostTrials; ++trial) {
    scenario->effects[k] = Scaled(given, factor);
    const Status scaled_valid = CheckEffects(*scenario);
    if (!scaled_valid.ok()) return failed(scaled_valid.message());
    scenario->effect_step = std::max(step, kCoarseStep);
    const double found = EffectShare(*scenario, k);
    scenario->effect_step = step;
    if (!(found > 0.0 && std::isfinite(found))) return failed("its share is " + FormatNumber(found));
    if (std::abs(found / share - 1.0) <= kTolerance) return Status::Ok();
    (found < share ? lower : upper) = factor;
    const std::pair<double, double> now(std::log(factor), std::log(found));
    if (last.has_value() && std::abs(now.first - last->first) > 1e-9) {
      power = std::clamp((now.second - last->second) / (now.first - last->first), 0.3, 3.0);
    }
    last = now;
    factor *= std::clamp(std::pow(share / found, 1.0 / power), 1e-2, 1e2);
    if (!(factor > lower && factor < upper)) factor = std::sqrt(lower * upper);
  }
  return failed("no size with it was found");
}

}  // namespace idim
