// The effects that a study declares (key `effects`) in its model, so that every estimator can be run with them.
//
// 1. The bundle is fitted without them.
// 2. Those without shape, or with a start value for it, are added together; then the others one after the other, in the
//    study's order, each with the shape that explains most of what is left (FindShape, solvers/loop/effect_scan.h).
// 3. Everything is fitted anew, shapes by Gauss-Newton, until shapes and columns have converged
//    (Refit, solvers/loop/effect_fit.h).
// What comes out has a column for each linear parameter of an effect and one for the step of each shape; for the bundle
// these steps are about zero, for another estimator they are its own step from the bundle's shape.
//
// Assumes that the declared effects can be told from the rest of the model and from each other. Fails by name where
// they cannot, where nothing tells a shape it is held (no parameter of the estimate then).

#ifndef IDIM_SOLVERS_LOOP_DECLARED_EFFECTS_H_
#define IDIM_SOLVERS_LOOP_DECLARED_EFFECTS_H_

#include "core/base/status.h"
#include "core/model/model.h"
#include "solvers/loop/effect_fit.h"

namespace idim {

// The bundle of a prepared study with the effects of its key, those in FitDeclared() where there are none. BadInput,
// naming file and key: a shape parameter that the effect does not have, or lacks, or outside its limits; a prior on a
// shape; as FitDeclared(). Untrusted: the model cannot be fitted without them, or not with one, which is named.
Result<EffectFit> FitWithDeclaredEffects(const PreparedStudy& prepared);

// The study with their columns; as it is where it declares none. Failures as above.
Result<PreparedStudy> DeclareEffects(const PreparedStudy& prepared);

}  // namespace idim

#endif  // IDIM_SOLVERS_LOOP_DECLARED_EFFECTS_H_
