// What the fit of any estimator comes to, before it is put into words: ToIdentification() makes an estimate of it.

#ifndef IDIM_SOLVERS_ESTIMATORS_FIT_SUMMARY_H_
#define IDIM_SOLVERS_ESTIMATORS_FIT_SUMMARY_H_

#include <Eigen/Core>

#include "core/estimate/estimate.h"
#include "core/model/unknowns.h"

namespace idim {

struct FitSummary {
  // Status, names, condition numbers, gain diagnoses, what was eliminated: all but parameters and predictions.
  Estimate header;
  Unknowns unknowns;
  Eigen::VectorXd values;      // unknowns.size(); empty: there are no numbers to show
  Eigen::MatrixXd covariance;  // of `values`
  // The same for independent samples, where `covariance` is robust; else empty.
  Eigen::MatrixXd model_covariance;
  double degrees_of_freedom = 0.0;  // of Student's t for the intervals
  double interval_factor = 1.0;     // by which they are longer than that
};

}  // namespace idim

#endif  // IDIM_SOLVERS_ESTIMATORS_FIT_SUMMARY_H_
