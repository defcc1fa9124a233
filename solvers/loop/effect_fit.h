// A bundle with effects in it: fitted, and fitted anew when the list of effects changes.

#ifndef IDIM_SOLVERS_LOOP_EFFECT_FIT_H_
#define IDIM_SOLVERS_LOOP_EFFECT_FIT_H_

#include <vector>

#include "core/base/status.h"
#include "core/model/model.h"
#include "solvers/bundle/bundle.h"
#include "solvers/bundle/bundle_data.h"
#include "solvers/estimators/eiv_identification.h"

namespace idim {

// Converged: no shape would move by more than this many of its standard deviations.
inline constexpr double kShapeConverged = 0.1;

struct EffectFit {
  PreparedStudy prepared;  // with the effects
  BundleData data;
  BundleSummary summary;
  Estimate header;  // names, start, gain diagnoses of the declared model

  ArmParameters Arm() const { return data.unknowns.Arm(summary.values); }
};

// The declared model. BadInput: as IdentifyEiv. Untrusted where it cannot be fitted.
Result<EffectFit> FitDeclared(const PreparedStudy& prepared);

// From the minimum of `from`, with other effects: those that it has keep their values and shapes, new ones begin at
// zero with the shape given. Columns that rest on the model's torque are computed from the fit before, and shapes move
// by Gauss-Newton, backtracking, until both have converged. A shape that the data do not tell, or that no step makes
// better, is held: other parameters are then conditional on it. Untrusted: the bundle says so.
Result<EffectFit> Refit(const EffectFit& from, const std::vector<ActiveEffect>& effects);

// Effects of `fit` with a negative value, where it cannot be.
std::vector<ActiveEffect> OfWrongSign(const EffectFit& fit);

// The estimate and its predictions; shapes with their values.
Identification IdentificationOf(const EffectFit& fit);

}  // namespace idim

#endif  // IDIM_SOLVERS_LOOP_EFFECT_FIT_H_
