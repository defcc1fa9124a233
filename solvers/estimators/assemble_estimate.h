// From the fit of an estimator to an Estimate with its predictions: what every estimator shares.

#ifndef IDIM_SOLVERS_ESTIMATORS_ASSEMBLE_ESTIMATE_H_
#define IDIM_SOLVERS_ESTIMATORS_ASSEMBLE_ESTIMATE_H_

#include <string>

#include "core/estimate/estimate.h"
#include "core/model/model.h"
#include "solvers/estimators/fit_summary.h"
#include "solvers/estimators/identification.h"
#include "solvers/linear/gain_verdict.h"

namespace idim {

// BadInput: a validation recording carries a payload whose unknown parameters no identification recording can tell.
Status CheckValidationPayloads(const PreparedStudy& prepared);

// Status, names, noise and preprocessing; no parameters yet.
Estimate BeginEstimate(const PreparedStudy& prepared, const Status& status, const std::string& estimator);

GainDiagnosis DescribeGain(const GainVerdict& verdict);

// The header, and where the fit has numbers: parameters with their intervals, those in header.eliminated left out,
// steps of shapes added to the shape that they start from; effects, series and errors of every recording, by the model
// AsStated() (core/model/active_effects.h).
Identification ToIdentification(const PreparedStudy& prepared, const FitSummary& fit);

}  // namespace idim

#endif  // IDIM_SOLVERS_ESTIMATORS_ASSEMBLE_ESTIMATE_H_
