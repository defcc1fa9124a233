// From what a solver returns to an Estimate with its predictions: what every estimator shares.

#ifndef IDIM_SOLVERS_ESTIMATORS_ASSEMBLE_ESTIMATE_H_
#define IDIM_SOLVERS_ESTIMATORS_ASSEMBLE_ESTIMATE_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/dynamics/parameters.h"
#include "core/estimate/estimate.h"
#include "core/model/payload_unknowns.h"
#include "core/model/prediction.h"
#include "core/model/prepared_study.h"
#include "solvers/estimators/identification.h"
#include "solvers/linear/gain_verdict.h"

namespace idim {

// BadInput: a validation recording carries a payload whose unknown parameters no identification recording can tell.
Status CheckValidationPayloads(const Study& study);

// Status, names, noise and preprocessing; no parameters yet.
Estimate BeginEstimate(const PreparedStudy& prepared, const Status& status, const std::string& estimator);

// Parameters with their intervals, the eliminated ones left out. Base parameters start at `first_base`. Steps of
// shapes are added to the shape that they start from.
void SetParameters(const PreparedStudy& prepared, const std::vector<Parameter>& unknowns, const Eigen::VectorXd& values,
                   const Eigen::MatrixXd& covariance, double degrees_of_freedom, int first_base,
                   const std::vector<std::string>& eliminated, Estimate* estimate);

// `values` from `first_base` on: base parameters, effects, then the unknown ones of the payloads of `study` (that of
// `prepared`, or with parameters that it holds for known released) in `columns`.
ArmParameters ArmOf(const PreparedStudy& prepared, const Study& study, const Eigen::VectorXd& gains,
                    const Eigen::VectorXd& values, int first_base, const PayloadColumns& columns);

// Effects, series and errors of every recording, by the model AsStated() (core/model/active_effects.h).
void PredictAll(const PreparedStudy& prepared, const ArmParameters& arm, Identification* result);

// After SetParameters() with a robust covariance: that of independent samples beside it.
void SetModelCovariance(const std::vector<Parameter>& unknowns, const Eigen::MatrixXd& covariance, Estimate* estimate);

GainDiagnosis DescribeGain(const GainVerdict& verdict);

}  // namespace idim

#endif  // IDIM_SOLVERS_ESTIMATORS_ASSEMBLE_ESTIMATE_H_
