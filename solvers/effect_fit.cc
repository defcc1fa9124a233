#include "solvers/effect_fit.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>

#include "solvers/active_effects.h"

namespace idim {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr int kMaxRounds = 5;
// Settled: no shape would move by more than this many of its standard deviations.
constexpr double kSettled = 0.1;
// Without a value that is this many standard deviations from zero nothing tells a shape.
constexpr double kTold = 2.0;

// The values of `from` by name; unknowns that it does not have begin at zero.
VectorXd StartFrom(const BundleData& from, const VectorXd& values, const BundleData& to) {
  std::map<std::string, double> known;
  for (int k = 0; k < from.num_unknowns(); ++k) known[from.unknowns[k].name] = values[k];
  VectorXd start = VectorXd::Zero(to.num_unknowns());
  for (int k = 0; k < to.num_unknowns(); ++k) {
    const auto found = known.find(to.unknowns[k].name);
    if (found != known.end()) start[k] = found->second;
  }
  return start;
}

// Takes values of effects from a solved bundle and moves their shapes. Returns the largest move in standard deviations.
double UpdateEffects(const EffectFit& fit, const std::vector<EffectMotion>& motions,
                     std::vector<ActiveEffect>* effects) {
  const std::vector<int> first = FirstParameters(fit.prepared);
  const int begin = fit.data.num_gains() + fit.prepared.base.size();
  double largest = 0.0;
  for (size_t e = 0; e < effects->size(); ++e) {
    ActiveEffect& active = (*effects)[e];
    const int linear = static_cast<int>(active.effect->Parameters(fit.prepared.study.robot, active.joints).size());
    const std::vector<ShapeParameter> shapes = active.effect->Shapes(motions, active.joints);
    const Index at = begin + first[e];
    double told = 0.0;
    for (int k = 0; k < linear; ++k) {
      told = std::max(told, std::abs(fit.summary.values[at + k]) / std::sqrt(fit.summary.covariance(at + k, at + k)));
    }
    const bool had_shapes = first[e + 1] - first[e] > linear;
    for (Index s = 0; had_shapes && s < active.shape.size(); ++s) {
      const Index unknown = at + linear + s;
      const double deviation = std::sqrt(fit.summary.covariance(unknown, unknown));
      // Not further than half of where it stands, nor beyond its limits.
      const double reach = 0.5 * std::max(std::abs(active.shape[s]), 1e-3 * (shapes[s].upper - shapes[s].lower));
      const double step = std::clamp(fit.summary.values[unknown], -reach, reach);
      const double next = std::clamp(active.shape[s] + step, shapes[s].lower, shapes[s].upper);
      largest = std::max(largest, std::abs(next - active.shape[s]) / deviation);
      active.shape[s] = next;
    }
    active.values = told > kTold ? VectorXd(fit.summary.values.segment(at, linear)) : VectorXd();
  }
  return largest;
}

}  // namespace

Result<EffectFit> FitDeclared(const PreparedStudy& prepared) {
  Result<GainSystem> system = Status::BadInput("no gains to identify");
  const bool identify = prepared.study.gains_mode == GainsMode::kIdentify;
  if (identify) {
    system = BuildGainSystem(prepared);
    if (!system.ok()) return system.status();
  }
  Result<EivFit> fit = FitEiv(prepared, identify ? &*system : nullptr, EivOptions());
  if (!fit.ok()) return fit.status();
  if (!fit->summary.IsSolutionUsable()) return fit->summary.status;
  return EffectFit{prepared, std::move(fit->data), std::move(fit->summary), std::move(fit->estimate)};
}

Result<EffectFit> Refit(const EffectFit& from, const std::vector<ActiveEffect>& effects) {
  EffectFit fit = from;
  std::vector<ActiveEffect> now = effects;
  std::vector<bool> held(now.size(), false);  // shapes that nothing in the data tells
  for (int round = 0; round < kMaxRounds; ++round) {
    const std::vector<EffectMotion> motions = MotionsOf(fit.prepared, fit.Arm());
    EffectFit last = fit;
    const BundleData before = std::move(fit.data);
    const VectorXd values = fit.summary.values;
    SetEffects(now, motions, &fit.prepared);
    Result<BundleData> data = BuildBundleData(fit.prepared);
    if (!data.ok()) return data.status();
    fit.data = std::move(data).value();
    BundleOptions options;
    options.priors = fit.data.priors;
    options.signal_sigma = fit.summary.signal_sigma;
    VectorXd start = StartFrom(before, values, fit.data);
    // A step of a shape has been taken: what is left to take is zero.
    const std::vector<int> first = FirstParameters(fit.prepared);
    for (size_t e = 0; e < now.size(); ++e) {
      const Index linear =
          static_cast<Index>(now[e].effect->Parameters(fit.prepared.study.robot, now[e].joints).size());
      const Index at = fit.data.num_gains() + fit.prepared.base.size() + first[e];
      start.segment(at + linear, first[e + 1] - first[e] - linear).setZero();
    }
    fit.summary = SolveBundle(fit.prepared.base, fit.data, start, options);
    if (!fit.summary.IsSolutionUsable()) {
      // A shape whose change moves no sample's torque (an instant between two samples) makes the bundle singular. The
      // newest that is free is held.
      size_t e = now.size();
      while (e > 0 && (now[e - 1].values.size() == 0 || now[e - 1].shape.size() == 0)) --e;
      if (e == 0) return fit.summary.status;
      held[e - 1] = true;
      now[e - 1].values.resize(0);
      fit = std::move(last);
      continue;
    }
    std::vector<ActiveEffect> next = now;
    const double moved = UpdateEffects(fit, motions, &next);
    for (size_t e = 0; e < next.size(); ++e) {
      if (held[e]) next[e].values.resize(0);
    }
    const bool same_columns = std::equal(now.begin(), now.end(), next.begin(), [](const auto& a, const auto& b) {
      return (a.values.size() > 0) == (b.values.size() > 0);
    });
    if (round > 0 && same_columns && moved < kSettled) break;
    now = std::move(next);
  }
  if (!fit.summary.IsSolutionUsable()) return fit.summary.status;
  // The shapes that the columns have, the values that they were found with.
  const std::vector<int> first = FirstParameters(fit.prepared);
  for (size_t e = 0; e < fit.prepared.effects.size(); ++e) {
    ActiveEffect& active = fit.prepared.effects[e];
    if (active.values.size() == 0) continue;
    active.values =
        fit.summary.values.segment(fit.data.num_gains() + fit.prepared.base.size() + first[e], active.values.size());
  }
  return fit;
}

Identification IdentificationOf(const EffectFit& fit) {
  Identification result = IdentificationOf(fit.prepared, fit.data, fit.summary, fit.begun);
  const std::vector<int> first = FirstParameters(fit.prepared);
  for (size_t e = 0; e < fit.prepared.effects.size(); ++e) {
    const ActiveEffect& active = fit.prepared.effects[e];
    const int shapes = active.values.size() > 0 ? static_cast<int>(active.shape.size()) : 0;
    for (int s = 0; s < shapes; ++s) {
      const std::string& name = fit.prepared.effect_parameters[first[e + 1] - shapes + s].name;
      for (ParameterEstimate& p : result.estimate.parameters) {
        if (p.parameter.name != name) continue;
        p.value += active.shape[s];
        for (double& end : p.interval95) end += active.shape[s];
      }
    }
  }
  return result;
}

}  // namespace idim
