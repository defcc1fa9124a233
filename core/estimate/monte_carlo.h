// What estimators do on data whose truth is known: bias, spread, error, honesty of intervals and covariances.
//
// Over R runs with numbers, e = estimate - truth of one parameter:
//   bias = mean(e), spread s = sqrt(sum (e - bias)^2 / (R - 1)), rmse^2 = mean(e^2) (so rmse^2 = bias^2 + s^2 (R -
//   1)/R), coverage95 = share of the reported 95 % intervals that hold the truth; standard errors s / sqrt(R) and
//   sqrt(c (1 - c) / R).
// NEES of a run = e' P^-1 e / p over the p parameters of its estimate, P the reported covariance: 1 on average where P
// is right (chi-square with p degrees of freedom, over p), above where it is too small or the estimator is biased
// (Bar-Shalom, Li, Kirubarajan 2001, 5.4.2). Over R runs the mean lies in [q(0.025), q(0.975)] / (R p) of the
// chi-square with R p degrees of freedom in 95 % of cases.
//
// All runs that give numbers count, also those which the estimator itself marks as not to be trusted: these are counted
// beside as failures. Otherwise the worst estimates would be left out of the statistics of the worst estimators.

#ifndef IDIM_CORE_ESTIMATE_MONTE_CARLO_H_
#define IDIM_CORE_ESTIMATE_MONTE_CARLO_H_

#include <Eigen/Core>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/base/status.h"
#include "core/dynamics/parameters.h"
#include "core/estimate/estimate.h"

namespace idim {

struct TrueParameter {
  Parameter parameter;
  double value = 0.0;
};

// One estimate against the truth. Vectors: one entry a true parameter; NaN where the estimate does not have it.
struct RunErrors {
  Status status;                       // the estimate's
  bool has_numbers = false;            // parameters are there and finite
  Eigen::VectorXd value;               // as estimated
  Eigen::VectorXd standard_deviation;  // as reported
  std::vector<bool> covered;           // interval95 holds the truth
  double nees_gains = -1.0;            // -1: no gains, or a covariance that has no inverse
  double nees = -1.0;                  // of all parameters, likewise; by Estimate::model_covariance where there is one
  int gains = 0, parameters = 0;       // that the estimate has
};

// CHECKs that every parameter of the estimate is among the true ones.
RunErrors RunErrorsOf(const std::vector<TrueParameter>& truth, const Estimate& estimate);

struct ParameterStatistics {
  Parameter parameter;
  double truth = 0.0;
  int runs = 0;  // that gave a number; below 2 there is no spread (NaN), without any nothing (NaN)
  double bias = 0.0;
  double bias_standard_error = 0.0;
  double standard_deviation = 0.0;       // of the estimates about their mean: the spread
  double mean_standard_deviation = 0.0;  // reported, root mean square: the spread that the estimator expects
  double rmse = 0.0;
  double coverage95 = 0.0;  // in [0, 1]
  double coverage95_standard_error = 0.0;
  Eigen::VectorXd values;  // N, as estimated in each run, NaN without; for pictures, not in the JSON
  Eigen::VectorXd scores;  // N, (value - truth) / reported standard deviation, likewise
};

// Mean normalised estimation error squared. Negative mean: no run has one.
struct Nees {
  int runs = 0;
  double mean = -1.0;
  double standard_error = 0.0;  // from the runs' own scatter; NaN for one run
  // Where the mean of as many runs lies in 95 % of cases if the covariance is right.
  double expected95[2] = {0.0, 0.0};
};

struct EstimatorStatistics {
  std::string estimator;
  int failures = 0;           // runs whose status is not ok
  int without_numbers = 0;    // of these, runs that gave none
  std::string first_failure;  // its message, of the lowest run
  Nees nees_gains, nees;
  std::vector<ParameterStatistics> parameters;  // as the truth
};

struct MonteCarlo {
  int runs = 0;
  std::uint64_t seed = 0;
  std::string reference;           // the estimator whose estimate is the truth
  Eigen::VectorXd position_noise;  // n [rad or m] simulated standard deviations a sample
  Eigen::VectorXd signal_noise;    // n [signal unit]
  std::vector<EstimatorStatistics> estimators;
};

// runs: of one estimator, in the order of the runs (N).
EstimatorStatistics Accumulate(const std::string& estimator, const std::vector<TrueParameter>& truth,
                               const std::vector<RunErrors>& runs);

// Share of `runs` intervals in which an exact 95 % interval holds the truth, in 95 % of cases: [lower, upper] by the
// binomial distribution, in [0, 1].
std::pair<double, double> CoverageBand(int runs);

// The key "monte_carlo" of comparison.json; numbers that are not there (NaN) are null.
nlohmann::ordered_json MonteCarloJson(const MonteCarlo& monte_carlo);

}  // namespace idim

#endif  // IDIM_CORE_ESTIMATE_MONTE_CARLO_H_
