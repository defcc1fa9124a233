// Effects in a model: their columns along every recording, from the model so far.

#ifndef IDIM_CORE_MODEL_ACTIVE_EFFECTS_H_
#define IDIM_CORE_MODEL_ACTIVE_EFFECTS_H_

#include <string>
#include <vector>

#include "core/effects/effect.h"
#include "core/model/model.h"
#include "core/model/unknowns.h"

namespace idim {

// "stribeck on joint 3", "base_tilt".
std::string EffectTitle(const ActiveEffect& active);
bool SameEffect(const ActiveEffect& a, const ActiveEffect& b);  // id and joints

// Part of the band kept by the low-pass in which motion lies; EffectMotion::derivative_cutoff_hz.
inline constexpr double kDerivativeBand = 0.25;

// One a recording of the study, by the arm's torque with its active effects. `prepared` must outlive them.
std::vector<EffectMotion> MotionsOf(const PreparedStudy& prepared, const ArmParameters& arm);

// The model of `prepared` with other effects. With known values of its linear parameters an effect also gets a column
// for each shape parameter s, sum_p values_p dc_p/ds by central differences: a parameter named like the shape ("vs3")
// whose estimate is the step from the present shape (Gauss-Newton), and whose covariance is that of the shape. motions:
// as MotionsOf() gives them.
Model WithEffects(const PreparedStudy& prepared, const std::vector<ActiveEffect>& effects,
                  const std::vector<EffectMotion>& motions);
Model WithoutEffects(const Model& model);

// The model for some of its recordings (in their roles, or in others), for SomeRecordings() of its data:
// effects that act in none of them, whose columns would be zero, are left out.
Model ForRecordings(const Model& model, const std::vector<int>& indices);
Model ForRecordings(const Model& model, const std::vector<int>& indices, const std::vector<RecordingRole>& roles);

// "presliding_x_s_1": the name of that column, and of the shape among the parameters of an estimate.
std::string ShapeParameterName(const std::string& effect_id, const std::string& shape, const std::vector<int>& joints);

// As Effect::Shapes() for the motion of all recordings, which no torque has a say in.
std::vector<ShapeParameter> ShapesAlong(const PreparedStudy& prepared, const Effect& effect,
                                        const std::vector<int>& joints);

// The model as an estimate states it: shapes moved by their steps (within their limits), columns anew from the torque
// of this model itself. A function of the recordings and of what an estimate.json holds, so that whoever reads it
// predicts the same; columns during a fit rest on the torque of the round before and are straight lines in the shapes.
struct StatedModel {
  PreparedStudy prepared;  // effects without values
  ArmParameters arm;       // chi: base parameters, linear parameters of the effects
};
StatedModel AsStated(const PreparedStudy& prepared, const ArmParameters& arm);

}  // namespace idim

#endif  // IDIM_CORE_MODEL_ACTIVE_EFFECTS_H_
