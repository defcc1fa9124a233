// The main job: prepared study -> observation matrix -> estimator -> estimate and residuals (paper II.C to III).
//
// Unknown payload parameters are identified with the arm's (eq. (12)), known ones go to the side of the torque.
// Validation recordings are predicted, never fitted.

#ifndef IDIM_SOLVERS_ESTIMATORS_CLOSED_FORMS_H_
#define IDIM_SOLVERS_ESTIMATORS_CLOSED_FORMS_H_

#include <vector>

#include "core/base/status.h"
#include "core/model/payload_unknowns.h"
#include "core/model/prepared_study.h"
#include "solvers/estimators/identification.h"
#include "solvers/linear/gain_identification.h"
#include "solvers/linear/linear_identification.h"

namespace idim {

// LS or WLS with known drive gains, without predictions.
struct LinearFit {
  std::vector<Parameter> unknowns;
  PayloadColumns payload_columns;
  LinearSummary summary;
};
LinearFit FitLinear(const PreparedStudy& prepared, const LinearOptions& options);

// LS or WLS with known drive gains; WLS rows weighted by the study's a priori signal noise where it has one. BadInput:
// unknown gains, a validation payload that no identification recording carries.
// What the data cannot tell is in estimate.status.
Result<Identification> IdentifyLinear(const PreparedStudy& prepared, const LinearOptions& options);

// Drive gains and parameters together. system: of the same study (BuildGainSystem), so that several estimators share
// one pass over the data. Scaled total least squares takes the columns' noise from options.column_noise, else from the
// study's a priori signal noise, else from the data. A status that is not ok comes with the numbers where there are
// any: to be shown, not to be used.
Result<Identification> IdentifyGains(const PreparedStudy& prepared, const GainSystem& system,
                                     const GainOptions& options);

}  // namespace idim

#endif  // IDIM_SOLVERS_ESTIMATORS_CLOSED_FORMS_H_
