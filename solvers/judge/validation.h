// An estimate judged on recordings that it has not seen (paper IV.C, Tables V to VIII).
//
// For each validation recording: the relative error of the torque V g against IDM chi, with the estimate's own gains
// and parameters (Table VI); the condition number of its observation matrix (Table V); and the payload's mass,
// estimated anew by IDIM-WLS from the unloaded identification recordings together with this one (eq. (12)), all ten
// payload parameters unknown and the torque computed with the estimate's gains (Tables VII and VIII). The mass is what
// a scale can check: gains wrong by a factor make the mass wrong by it.

// Effects in the model (key `effects` of an estimate.json) are the estimate's, whatever the study declares: their
// columns along the validation recordings come from the estimate's own model (AsStated(), core/model/active_effects.h),
// so that errors are those which the program that wrote it reports. For the mass they are estimated anew with the rest,
// but for payload_change, which is what is sought.

#ifndef IDIM_SOLVERS_JUDGE_VALIDATION_H_
#define IDIM_SOLVERS_JUDGE_VALIDATION_H_

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "core/base/status.h"
#include "core/estimate/reference.h"
#include "core/model/model.h"
#include "core/model/prediction.h"

namespace idim {

struct MassEstimate {
  double value = 0.0;  // [kg]
  double standard_deviation = 0.0;
  std::optional<double> weighed;  // where the study knows it
  // 100 |weighed - value| / weighed.
  std::optional<double> ErrorPercent() const;
};

struct ValidationOfRecording {
  std::string name;
  std::string payload;              // empty: none
  std::optional<RecordingFit> fit;  // absent: the payload has parameters that neither the study nor the estimate knows
  double condition_number = -1.0;   // of its base columns
  // Absent: no payload, no unloaded identification recording, or one that does not identify it together with this.
  std::optional<MassEstimate> mass;
};

struct Validation {
  std::string name;     // of the estimate
  std::string warning;  // why it says itself that it is not to be trusted, or empty
  Eigen::VectorXd gains;
  std::vector<ValidationOfRecording> recordings;
  std::vector<RecordingSeries> series;  // of the recordings with a fit
};

// The study with the effects of an estimate.json at their stated shapes, and with velocities zero at rest where that
// was fitted so. Shapes get no columns; those of the effects wait for a model (AsStated()). BadInput: an effect or a
// shape that there is not, joints that the robot does not have.
Result<PreparedStudy> PreparedWithEffectsOf(const PreparedStudy& prepared, const Reference& estimate);

// The parameters of an estimate.json in the order of the study's model, of shapes the step from the study's. Gains: the
// estimate's, else the study's. Base parameters that it lacks are zero (not essential). BadInput: it states another
// robot; neither has gains; it has parameters that the study's model does not; it has none of the model's.
Result<ArmParameters> ArmParametersOf(const PreparedStudy& prepared, const Reference& estimate);

// BadInput: as ArmParametersOf; a study without validation recording.
Result<Validation> Validate(const PreparedStudy& prepared, const Reference& estimate);

}  // namespace idim

#endif  // IDIM_SOLVERS_JUDGE_VALIDATION_H_
