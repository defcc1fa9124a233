#include "solvers/loop/declared_effects.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "core/base/text.h"
#include "core/model/active_effects.h"
#include "solvers/bundle/residual_model.h"
#include "solvers/loop/effect_scan.h"

namespace idim {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

// Refit() moves shapes a few times; from a start far off this often again.
constexpr int kMaxRefits = 4;

struct Declared {
  ActiveEffect active;
  bool has_shape = false;  // given, or nothing to give
};

Result<Declared> Resolve(const PreparedStudy& prepared, const PlacedEffect& declared) {
  const std::vector<ShapeParameter> shapes = ShapesAlong(prepared, *declared.effect, declared.joints);
  Declared result{{declared.effect, declared.joints, VectorXd::Zero(static_cast<Index>(shapes.size()))},
                  shapes.empty() || !declared.shape.empty()};
  std::vector<std::string> names;
  for (const ShapeParameter& shape : shapes) names.push_back(shape.name);
  for (const DeclaredShape& given : declared.shape) {
    const auto found = std::find(names.begin(), names.end(), given.name);
    if (found == names.end()) {
      return Status::BadInput(given.where + ": '" + declared.effect->id() + "' has no such shape parameter; expected " +
                              (names.empty() ? "none" : Join(names, ", ")));
    }
    const ShapeParameter& shape = shapes[static_cast<size_t>(found - names.begin())];
    if (!(given.value >= shape.lower && given.value <= shape.upper)) {
      return Status::BadInput(given.where + ": " + FormatNumber(given.value) +
                              " is outside the limits that the motion of the recordings sets; expected a number from " +
                              Format("%.4g to %.4g %s", shape.lower, shape.upper, shape.unit.c_str()));
    }
    result.active.shape[found - names.begin()] = given.value;
  }
  if (!declared.shape.empty() && declared.shape.size() < shapes.size()) {
    return Status::BadInput(declared.where + ": only some of the shape parameters are given; expected all of " +
                            Join(names, ", ") + ", or none");
  }
  for (const ShapeParameter& shape : shapes) {
    const std::string name = ShapeParameterName(declared.effect->id(), shape.name, declared.joints);
    for (const Prior& prior : prepared.model.priors) {
      if (prior.parameter != name) continue;
      return Status::BadInput(prior.where + ": '" + name + "' is a shape, which takes no prior; expected its start " +
                              "value under key 'effects'");
    }
  }
  return result;
}

// In the study's order, whatever the order in which they are added.
Result<EffectFit> RefitWith(const EffectFit& from, const std::vector<ActiveEffect>& effects) {
  std::vector<ActiveEffect> sorted;
  for (const PlacedEffect& declared : from.prepared.model.declared) {
    for (const ActiveEffect& active : effects) {
      if (active.effect == declared.effect && active.joints == declared.joints) sorted.push_back(active);
    }
  }
  return Refit(from, sorted);
}

Status WithEffectNames(const std::vector<ActiveEffect>& effects, const std::string& study, const Status& status) {
  if (status.code() == StatusCode::kBadInput) return status;
  std::vector<std::string> titles;
  for (const ActiveEffect& active : effects) titles.push_back(EffectTitle(active));
  return Status::Untrusted(study + ": key 'effects': with " + Join(titles, ", ") +
                           " the model cannot be fitted: " + status.message());
}

// Those whose shape is known. Where they cannot be fitted together, the first with which it fails is named.
Result<EffectFit> AddKnown(const EffectFit& from, const std::vector<ActiveEffect>& effects) {
  const std::string& study = from.prepared.path();
  Result<EffectFit> together = RefitWith(from, effects);
  if (together.ok() || effects.size() == 1) {
    return together.ok() ? together : Result<EffectFit>(WithEffectNames(effects, study, together.status()));
  }
  for (const ActiveEffect& one : effects) {
    const Result<EffectFit> fit = RefitWith(from, {one});
    if (!fit.ok()) return WithEffectNames({one}, study, fit.status());
  }
  return WithEffectNames(effects, study, together.status());
}

bool HaveConverged(const EffectFit& fit) {
  for (int k = 0; k < fit.data.num_unknowns(); ++k) {
    if (fit.data.unknowns[k].kind != ParameterKind::kEffectShape) continue;
    if (std::abs(fit.summary.values[k]) > kShapeConverged * std::sqrt(fit.summary.covariance(k, k))) return false;
  }
  return true;
}

}  // namespace

Result<EffectFit> FitWithDeclaredEffects(const PreparedStudy& prepared) {
  std::vector<ActiveEffect> known, to_find;
  for (const PlacedEffect& declared : prepared.model.declared) {
    Result<Declared> resolved = Resolve(prepared, declared);
    IDIM_RETURN_IF_ERROR(resolved);
    (resolved->has_shape ? known : to_find).push_back(std::move(resolved->active));
  }
  Result<EffectFit> fit = FitDeclared(prepared);
  IDIM_RETURN_IF_ERROR(fit);
  if (!known.empty()) {
    fit = AddKnown(*fit, known);
    IDIM_RETURN_IF_ERROR(fit);
  }
  for (const ActiveEffect& declared : to_find) {
    const ResidualModel residual(fit->prepared.base(), fit->data, fit->summary);
    std::vector<ActiveEffect> effects = fit->prepared.model.effects;
    effects.push_back(FindShape(fit->prepared, residual, fit->Arm(), declared));
    Result<EffectFit> next = RefitWith(*fit, effects);
    if (!next.ok()) return WithEffectNames({declared}, prepared.path(), next.status());
    fit = std::move(next);
  }
  for (int k = 0; k < kMaxRefits && !HaveConverged(*fit); ++k) {
    Result<EffectFit> next = RefitWith(*fit, fit->prepared.model.effects);
    if (!next.ok()) return WithEffectNames(fit->prepared.model.effects, prepared.path(), next.status());
    fit = std::move(next);
  }
  return fit;
}

Result<PreparedStudy> DeclareEffects(const PreparedStudy& prepared) {
  if (prepared.model.declared.empty()) return prepared;
  Result<EffectFit> fit = FitWithDeclaredEffects(prepared);
  IDIM_RETURN_IF_ERROR(fit);
  return std::move(fit->prepared);
}

}  // namespace idim
