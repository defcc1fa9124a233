#include "solvers/loop/effect_fit.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>

#include "core/model/active_effects.h"
#include "solvers/bundle/bundle_problem.h"
#include "solvers/estimators/assemble_estimate.h"
#include "solvers/loop/loop_rules.h"

namespace idim {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr int kMaxRounds = 8;
// Of the largest t of its values: below this a shape is not identifiable.
constexpr double kMinAbsT = 2.0;
constexpr int kHalvings = 3;

// The values of `from` by name. Unknowns that it does not have begin at zero, and so do steps of shapes: those of
// `from` have been taken.
VectorXd StartFrom(const BundleData& from, const VectorXd& values, const BundleData& to) {
  std::map<std::string, double> known;
  for (int k = 0; k < from.num_unknowns(); ++k) known[from.unknowns[k].name] = values[k];
  VectorXd start = VectorXd::Zero(to.num_unknowns());
  for (int k = 0; k < to.num_unknowns(); ++k) {
    if (to.unknowns[k].kind == ParameterKind::kEffectShape) continue;
    const auto found = known.find(to.unknowns[k].name);
    if (found != known.end()) start[k] = found->second;
  }
  return start;
}

bool IsFree(const ActiveEffect& active) { return active.values.size() > 0 && active.shape.size() > 0; }

// `from` with the columns of other effects, unsolved. *values: unknowns of `from`, become those of the result.
EffectFit WithColumns(const EffectFit& from, const std::vector<ActiveEffect>& effects,
                      const std::vector<EffectMotion>& motions, VectorXd* values) {
  EffectFit fit = from;
  fit.prepared.model = WithEffects(from.prepared, effects, motions);
  fit.data = WithEffectColumnsOf(fit.prepared, from.data);
  *values = StartFrom(from.data, *values, fit.data);
  return fit;
}

BundleSummary Solve(const EffectFit& fit, const VectorXd& start, bool inference) {
  BundleOptions options;
  options.priors = fit.data.priors;
  options.signal_sigma = fit.summary.signal_sigma;
  options.inference = inference;
  return SolveBundle(fit.prepared.base(), fit.data, start, options);
}

// What the bundle minimises, by given weights. friction: unknowns whose Coulomb friction holds at rest.
double Cost(const EffectFit& fit, const VectorXd& values, const VectorXd& friction, const VectorXd& sigma) {
  BundleProblem problem(fit.prepared.base(), fit.data, fit.data.priors, HuberNorm{});
  problem.HoldFriction(friction);
  return problem.Evaluate(values, sigma).cost;
}

// The effects with the values of a solved bundle, their shapes moved by its steps.
struct Move {
  std::vector<ActiveEffect> effects;
  std::vector<double> distance;  // of each effect: the largest move of a shape, in standard deviations
  std::vector<bool> stuck;       // effects with a shape that would go beyond its limit, or that nothing tells
};

Move MoveOf(const EffectFit& fit, const std::vector<EffectMotion>& motions) {
  const size_t count = fit.prepared.model.effects.size();
  Move move{fit.prepared.model.effects, std::vector<double>(count, 0.0), std::vector<bool>(count, false)};
  const Unknowns& unknowns = fit.data.unknowns;
  for (size_t e = 0; e < count; ++e) {
    ActiveEffect& active = move.effects[e];
    const std::vector<ShapeParameter> shapes = active.effect->Shapes(motions, active.joints);
    const auto [at, linear, free] = unknowns.effect(e);
    double largest_t = 0.0;
    for (Index k = 0; k < linear; ++k) {
      largest_t =
          std::max(largest_t, std::abs(fit.summary.values[at + k]) / std::sqrt(fit.summary.covariance(at + k, at + k)));
    }
    for (Index s = 0; s < free; ++s) {
      const Index unknown = at + linear + s;
      const double deviation = std::sqrt(fit.summary.covariance(unknown, unknown));
      // Not further than half of where it stands, nor beyond its limits.
      const double reach = 0.5 * std::max(std::abs(active.shape[s]), 1e-3 * (shapes[s].upper - shapes[s].lower));
      const double step = std::clamp(fit.summary.values[unknown], -reach, reach);
      const double next = shapes[s].Within(active.shape[s], active.shape[s] + step);
      const bool at_limit = next == active.shape[s] && std::abs(step) > kShapeConverged * deviation;
      if (at_limit || deviation > shapes[s].upper - shapes[s].lower) move.stuck[e] = true;
      move.distance[e] = std::max(move.distance[e], std::abs(next - active.shape[s]) / deviation);
      active.shape[s] = next;
    }
    active.values =
        largest_t > kMinAbsT && !active.held ? VectorXd(fit.summary.values.segment(at, linear)) : VectorXd();
  }
  return move;
}

// Halves the way from `start` to the solution of `fit`, until the cost with the columns of the moved shapes is below
// that of the start. False: it never is.
bool Backtrack(const EffectFit& fit, const VectorXd& start, const std::vector<EffectMotion>& motions, Move* move) {
  const VectorXd& sigma = fit.summary.signal_sigma;
  const double before = Cost(fit, start, start, sigma);
  double part = 1.0;
  for (int k = 0; k <= kHalvings; ++k, part *= 0.5) {
    std::vector<ActiveEffect> trial = fit.prepared.model.effects;
    for (size_t e = 0; e < trial.size(); ++e) {
      trial[e].shape += part * (move->effects[e].shape - trial[e].shape);
      trial[e].values.resize(0);
    }
    VectorXd values = start + part * (fit.summary.values - start);
    const EffectFit moved = WithColumns(fit, trial, motions, &values);
    if (!(Cost(moved, values, StartFrom(fit.data, start, moved.data), sigma) <= before)) continue;
    for (size_t e = 0; e < trial.size(); ++e) move->effects[e].shape = trial[e].shape;
    return true;
  }
  return false;
}

}  // namespace

Result<EffectFit> FitDeclared(const PreparedStudy& prepared) {
  Result<GainSystem> system = Status::BadInput("no gains to identify");
  const bool identify = prepared.model.IdentifiesGains();
  if (identify) {
    system = BuildGainSystem(prepared);
    IDIM_RETURN_IF_ERROR(system);
  }
  Result<EivFit> fit = FitEiv(prepared, identify ? &*system : nullptr, EivOptions());
  IDIM_RETURN_IF_ERROR(fit);
  if (!fit->summary.IsSolutionUsable()) return fit->summary.status;
  return EffectFit{prepared, std::move(fit->data), std::move(fit->summary), std::move(fit->header)};
}

Result<EffectFit> Refit(const EffectFit& from, const std::vector<ActiveEffect>& effects) {
  EffectFit fit = from;
  std::vector<ActiveEffect> now = effects;
  const auto hold = [&](size_t e) {
    now[e].held = true;
    now[e].values.resize(0);
  };
  bool fitted = false;
  for (int round = 0; round < kMaxRounds; ++round) {
    const std::vector<EffectMotion> motions = MotionsOf(fit.prepared, fit.Arm());
    VectorXd start = fit.summary.values;
    EffectFit next = WithColumns(fit, now, motions, &start);
    next.summary = Solve(next, start, false);
    if (!next.summary.IsSolutionUsable()) {
      // A shape whose change moves no sample's torque (an instant between two samples) makes the bundle singular. The
      // newest that is free is held.
      size_t e = now.size();
      while (e > 0 && !IsFree(now[e - 1])) --e;
      if (e == 0) return next.summary.status;
      hold(e - 1);
      continue;
    }
    Move move = MoveOf(next, motions);
    const auto farthest = std::max_element(move.distance.begin(), move.distance.end());
    const double largest = farthest == move.distance.end() ? 0.0 : *farthest;
    // A shape that cannot go where it would go, or one along which no step is better: it stays, and the rest goes on.
    if (std::find(move.stuck.begin(), move.stuck.end(), true) != move.stuck.end()) {
      for (size_t e = 0; e < now.size(); ++e) {
        if (move.stuck[e]) hold(e);
      }
      continue;
    }
    if (largest >= kShapeConverged && !Backtrack(next, start, motions, &move)) {
      hold(static_cast<size_t>(farthest - move.distance.begin()));
      continue;
    }
    const bool same_columns =
        std::equal(now.begin(), now.end(), move.effects.begin(),
                   [](const auto& a, const auto& b) { return (a.values.size() > 0) == (b.values.size() > 0); });
    fit = std::move(next);
    fitted = true;
    if (round > 0 && same_columns && largest < kShapeConverged) break;
    now = std::move(move.effects);
  }
  if (!fitted) return Status::Untrusted("the bundle cannot be fitted with the shapes of the effects free or held");
  fit.summary = Solve(fit, fit.summary.values, true);
  if (!fit.summary.IsSolutionUsable()) return fit.summary.status;
  // The shapes that the columns have, the values that they were found with.
  const Unknowns& unknowns = fit.data.unknowns;
  for (size_t e = 0; e < fit.prepared.model.effects.size(); ++e) {
    ActiveEffect& active = fit.prepared.model.effects[e];
    if (active.values.size() > 0)
      active.values = fit.summary.values.segment(unknowns.effect(e).at, unknowns.effect(e).linear);
  }
  return fit;
}

std::vector<ActiveEffect> OfWrongSign(const EffectFit& fit) {
  std::vector<ActiveEffect> wrong;
  const Unknowns& unknowns = fit.data.unknowns;
  for (size_t e = 0; e < unknowns.num_effects(); ++e) {
    const ActiveEffect& active = fit.prepared.model.effects[e];
    const VectorXd values = fit.summary.values.segment(unknowns.effect(e).at, unknowns.effect(e).linear);
    if (HasForbiddenSign(active.effect->non_negative(), values)) wrong.push_back(active);
  }
  return wrong;
}

Identification IdentificationOf(const EffectFit& fit) {
  return ToIdentification(fit.prepared, SummaryOf(fit.data, fit.summary, fit.header));
}

}  // namespace idim
