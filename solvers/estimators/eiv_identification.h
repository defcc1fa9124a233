// IDIM-EIV: the errors-in-variables bundle (solvers/bundle/bundle.h) from a prepared study to an estimate.
//
// Start. Where gains are identified, in this order: WGTLS (scaled, row-weighted total least squares) where it is sound;
// the study's a priori gains with the parameters that weighted least squares gives for them; WLS. A start other than a
// sound WGTLS is not trusted alone: the bundle is run from each of those left, and the smallest deviance -2 log L kept;
// minima that differ are reported. With known gains: WLS, from which the minimum is the only one.
//
// Priors. The study's `priors` by the names of parameters, and payload parameters known to a standard deviation (a
// weighed mass), which become unknowns with a prior. The closed forms take the latter for exact and know no priors.
//
// Uncertainty shown: the robust covariance, its interval factor in the intervals; ParameterEstimate::
// model_standard_deviation is that of the Schur complement, for independent samples.
//
// Velocity reversal and rest. A Coulomb column is E[sign | measured velocity] = erf(dq / (sqrt(2) sigma))
// (core/dynamics/standard_model.h): near rest, where the sign of noise would be a regressor full of garbage, it goes to
// zero and says nothing, and it has no derivative in the bundle.

#ifndef IDIM_SOLVERS_ESTIMATORS_EIV_IDENTIFICATION_H_
#define IDIM_SOLVERS_ESTIMATORS_EIV_IDENTIFICATION_H_

#include <string>

#include "core/base/status.h"
#include "core/model/model.h"
#include "solvers/bundle/bundle.h"
#include "solvers/estimators/fit_summary.h"
#include "solvers/estimators/identification.h"
#include "solvers/linear/gain_system.h"

namespace idim {

struct EivOptions {
  double huber_threshold = 0.0;  // BundleOptions::huber_threshold
  double essential_ratio = 0.0;  // r_sigma of the essential parameters, as GainOptions
  // A gain whose relative standard deviation is above this is not to be trusted [%], > 0.
  double max_spread_percent = 25.0;

  bool IsValid(std::string* error) const;
};

// The bundle of a study, solved.
struct EivFit {
  BundleData data;
  BundleSummary summary;
  Estimate header;  // status, names, start, gain diagnoses, what is eliminated; no parameters
};

// As IdentifyEiv().
Result<EivFit> FitEiv(const PreparedStudy& prepared, const GainSystem* system, const EivOptions& options);

// A solved bundle as an answer; without numbers where it has no covariance.
FitSummary SummaryOf(const BundleData& data, const BundleSummary& summary, const Estimate& header);

// system: of the same study where gains are identified, else nullptr. options valid (CHECK). BadInput: a prior on a
// parameter that the study does not identify; as BuildBundleData and CheckValidationPayloads. Untrusted in
// estimate.status, with the numbers where there are any: as SolveBundle; a gain of another sign than its a priori
// value or of too large a spread.
Result<FitSummary> SummarizeEiv(const PreparedStudy& prepared, const GainSystem* system, const EivOptions& options);
Result<Identification> IdentifyEiv(const PreparedStudy& prepared, const GainSystem* system, const EivOptions& options);

}  // namespace idim

#endif  // IDIM_SOLVERS_ESTIMATORS_EIV_IDENTIFICATION_H_
