// Effects in the model of a prepared study: their columns along every recording, from the model so far.

#ifndef IDIM_CORE_MODEL_ACTIVE_EFFECTS_H_
#define IDIM_CORE_MODEL_ACTIVE_EFFECTS_H_

#include <string>
#include <vector>

#include "core/effects/effect.h"
#include "core/model/prediction.h"
#include "core/model/prepared_study.h"

namespace idim {

// "stribeck on joint 3", "base_tilt".
std::string EffectTitle(const ActiveEffect& active);
bool SameEffect(const ActiveEffect& a, const ActiveEffect& b);  // id and joints

// Part of the band kept by the low-pass in which motion lies; EffectMotion::derivative_cutoff_hz.
inline constexpr double kDerivativeBand = 0.25;

// One a recording of the study, by the arm's torque with its active effects. `prepared` must outlive them.
std::vector<EffectMotion> MotionsOf(const PreparedStudy& prepared, const ArmParameters& arm);

// Replaces the effects of *prepared. With known values of its linear parameters an effect also gets a column for each
// shape parameter s, sum_p values_p dc_p/ds by central differences: a parameter named like the shape ("vs3") whose
// estimate is the step from the present shape (Gauss-Newton), and whose covariance is that of the shape.
// motions: as MotionsOf() gives them.
void SetEffects(const std::vector<ActiveEffect>& effects, const std::vector<EffectMotion>& motions,
                PreparedStudy* prepared);

// "presliding_x_s_1": the name of that column, and of the shape among the parameters of an estimate.
std::string ShapeParameterName(const std::string& effect_id, const std::string& shape, const std::vector<int>& joints);

// As Effect::Shapes() for the motion of all recordings, which no torque has a say in.
std::vector<ShapeParameter> ShapesAlong(const PreparedStudy& prepared, const Effect& effect,
                                        const std::vector<int>& joints);

// One an entry of PreparedStudy::effect_parameters: the shape that the step of a kEffectShape is added to, else zero.
Eigen::VectorXd ShapeOffsets(const PreparedStudy& prepared);

// The model as an estimate states it: shapes moved by their steps (within their limits), columns anew from the torque
// of this model itself. A function of the recordings and of what an estimate.json holds, so that whoever reads it
// predicts the same; columns during a fit rest on the torque of the round before and are straight lines in the shapes.
struct StatedModel {
  PreparedStudy prepared;  // effects without values
  ArmParameters arm;       // chi: base parameters, linear parameters of the effects
};
StatedModel AsStated(const PreparedStudy& prepared, const ArmParameters& arm);

// Index into PreparedStudy::effect_parameters of the first parameter of each effect, then their count.
std::vector<int> FirstParameters(const PreparedStudy& prepared);

}  // namespace idim

#endif  // IDIM_CORE_MODEL_ACTIVE_EFFECTS_H_
