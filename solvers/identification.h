// The main job: prepared study -> observation matrix -> LS or WLS -> estimate and residuals (paper II.C, II.D).
//
// Drive gains are taken as known; unknown payload parameters are identified with the arm's (eq. (12)), known ones go
// to the side of the torque. Validation recordings are predicted, never fitted.

#ifndef IDIM_SOLVERS_IDENTIFICATION_H_
#define IDIM_SOLVERS_IDENTIFICATION_H_

#include <vector>

#include "core/base/status.h"
#include "core/estimate/estimate.h"
#include "core/estimate/series.h"
#include "core/observation/prepared_study.h"
#include "solvers/linear_identification.h"

namespace idim {

struct Identification {
  Estimate estimate;  // status not ok: only names and the status are set
  std::vector<RecordingSeries> series;
};

// BadInput: the study asks for what this estimator cannot do (unknown gains, a payload that no identification recording
// carries). What the data cannot tell is in estimate.status.
Result<Identification> IdentifyLinear(const PreparedStudy& prepared, const LinearOptions& options);

}  // namespace idim

#endif  // IDIM_SOLVERS_IDENTIFICATION_H_
