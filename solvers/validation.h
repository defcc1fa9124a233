// An estimate judged on recordings that it has not seen (paper IV.C, Tables V to VIII).
//
// For each validation recording: the relative error of the torque V g against IDM chi, with the estimate's own gains
// and parameters (Table VI); the condition number of its observation matrix (Table V); and the payload's mass,
// estimated anew by IDIM-WLS from the unloaded identification recordings together with this one (eq. (12)), all ten
// payload parameters unknown and the torque computed with the estimate's gains (Tables VII and VIII). The mass is what
// a scale can check: gains wrong by a factor make the mass wrong by it.

#ifndef IDIM_SOLVERS_VALIDATION_H_
#define IDIM_SOLVERS_VALIDATION_H_

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "core/base/status.h"
#include "core/estimate/reference.h"
#include "core/observation/prepared_study.h"
#include "solvers/prediction.h"

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

// The parameters of an estimate.json in the order of the study's model. Gains: the estimate's, else the study's. Base
// parameters that it lacks are zero (not essential). BadInput: it states another robot; neither has gains; it has
// parameters that the study's model does not; it has none of the model's.
Result<ArmParameters> ParametersOf(const PreparedStudy& prepared, const Reference& estimate);

// BadInput: as ParametersOf; a study without validation recording.
Result<Validation> Validate(const PreparedStudy& prepared, const Reference& estimate);

}  // namespace idim

#endif  // IDIM_SOLVERS_VALIDATION_H_
