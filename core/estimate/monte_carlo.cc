#include "core/estimate/monte_carlo.h"

#include <glog/logging.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <boost/math/distributions/binomial.hpp>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <limits>
#include <utility>

#include "core/base/decompositions.h"

namespace idim {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// e' P^-1 e / p; -1 where P has no inverse. Scaled to a correlation matrix first: units differ by many decades.
double NormalisedErrorSquared(const VectorXd& error, const MatrixXd& covariance) {
  if (error.size() == 0) return -1.0;
  const VectorXd scale = covariance.diagonal().cwiseSqrt().cwiseInverse();
  if (!scale.allFinite() || !covariance.allFinite()) return -1.0;
  const MatrixXd correlation = scale.asDiagonal() * covariance * scale.asDiagonal();
  const Eigen::LLT<MatrixXd> factor(correlation);
  if (factor.info() != Eigen::Success || factor.rcond() < 1e-14) return -1.0;
  const VectorXd scaled = scale.cwiseProduct(error);
  return scaled.dot(factor.solve(scaled)) / static_cast<double>(error.size());
}

double SampleDeviation(const std::vector<double>& values, double mean) {
  if (values.size() < 2) return kNaN;
  double squares = 0.0;
  for (const double v : values) squares += (v - mean) * (v - mean);
  return std::sqrt(squares / static_cast<double>(values.size() - 1));
}

double Mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double v : values) sum += v;
  return sum / static_cast<double>(values.size());  // 0 / 0 without any: NaN
}

// value[k] over p[k] degrees of freedom each.
Nees NeesOf(const std::vector<double>& values, double degrees_of_freedom) {
  Nees nees;
  nees.runs = static_cast<int>(values.size());
  if (values.empty()) return nees;
  nees.mean = Mean(values);
  nees.standard_error = SampleDeviation(values, nees.mean) / std::sqrt(static_cast<double>(values.size()));
  const boost::math::chi_squared chi_square(degrees_of_freedom);
  nees.expected95[0] = boost::math::quantile(chi_square, 0.025) / degrees_of_freedom;
  nees.expected95[1] = boost::math::quantile(chi_square, 0.975) / degrees_of_freedom;
  return nees;
}

ParameterStatistics StatisticsOf(const TrueParameter& truth, Index at, const std::vector<RunErrors>& runs) {
  ParameterStatistics s;
  s.parameter = truth.parameter;
  s.truth = truth.value;
  s.values = s.scores = VectorXd::Constant(static_cast<Index>(runs.size()), kNaN);
  std::vector<double> errors, squares, variances, covered;
  for (size_t k = 0; k < runs.size(); ++k) {
    if (!runs[k].has_numbers || !std::isfinite(runs[k].value[at])) continue;
    const double value = runs[k].value[at], sigma = runs[k].standard_deviation[at], error = value - truth.value;
    s.values[static_cast<Index>(k)] = value;
    s.scores[static_cast<Index>(k)] = error / sigma;
    errors.push_back(error);
    squares.push_back(error * error);
    variances.push_back(sigma * sigma);
    covered.push_back(runs[k].covered[static_cast<size_t>(at)] ? 1.0 : 0.0);
  }
  s.runs = static_cast<int>(errors.size());
  const double count = static_cast<double>(s.runs);
  s.bias = Mean(errors);
  s.standard_deviation = SampleDeviation(errors, s.bias);
  s.bias_standard_error = s.standard_deviation / std::sqrt(count);
  s.mean_standard_deviation = std::sqrt(Mean(variances));
  s.rmse = std::sqrt(Mean(squares));
  s.coverage95 = Mean(covered);
  s.coverage95_standard_error = std::sqrt(s.coverage95 * (1.0 - s.coverage95) / count);
  return s;
}

nlohmann::ordered_json ToJson(const Nees& nees) {
  if (nees.runs == 0) return nullptr;
  return {{"mean", nees.mean},
          {"standard_error", nees.standard_error},
          {"expected95", {nees.expected95[0], nees.expected95[1]}},
          {"runs", nees.runs}};
}

nlohmann::ordered_json ListOf(const VectorXd& v) { return std::vector<double>(v.data(), v.data() + v.size()); }

}  // namespace

RunErrors RunErrorsOf(const std::vector<TrueParameter>& truth, const Estimate& estimate) {
  RunErrors run;
  run.status = estimate.status;
  run.value = run.standard_deviation = VectorXd::Constant(static_cast<Index>(truth.size()), kNaN);
  run.covered.assign(truth.size(), false);
  run.has_numbers = !estimate.parameters.empty();
  const Index count = static_cast<Index>(estimate.parameters.size());
  VectorXd error(count);
  std::vector<Index> gains;
  for (Index k = 0; k < count; ++k) {
    const ParameterEstimate& p = estimate.parameters[static_cast<size_t>(k)];
    const auto found = std::find_if(truth.begin(), truth.end(),
                                    [&](const TrueParameter& t) { return t.parameter.name == p.parameter.name; });
    CHECK(found != truth.end()) << "no truth for " << p.parameter.name;
    const Index at = found - truth.begin();
    run.has_numbers &= std::isfinite(p.value);
    run.value[at] = p.value;
    run.standard_deviation[at] = p.standard_deviation;
    run.covered[static_cast<size_t>(at)] = p.interval95[0] <= found->value && found->value <= p.interval95[1];
    error[k] = p.value - found->value;
    if (p.parameter.kind == ParameterKind::kDriveGain) gains.push_back(k);
  }
  if (!run.has_numbers) return run;
  run.parameters = static_cast<int>(count);
  run.gains = static_cast<int>(gains.size());
  CHECK_EQ(estimate.covariance.rows(), count);
  // The inverse of a robust covariance of many parameters is too noisy for a mean of quadratic forms.
  const bool robust = estimate.model_covariance.size() > 0;
  run.nees = NormalisedErrorSquared(error, robust ? estimate.model_covariance : estimate.covariance);
  run.nees_gains = NormalisedErrorSquared(error(gains), estimate.covariance(gains, gains));
  return run;
}

EstimatorStatistics Accumulate(const std::string& estimator, const std::vector<TrueParameter>& truth,
                               const std::vector<RunErrors>& runs) {
  EstimatorStatistics s;
  s.estimator = estimator;
  std::vector<double> nees, nees_gains;
  double freedom = 0.0, freedom_gains = 0.0;
  for (const RunErrors& run : runs) {
    if (!run.status.ok() && s.failures++ == 0) s.first_failure = run.status.message();
    s.without_numbers += !run.has_numbers;
    if (run.has_numbers && run.nees >= 0.0) {
      nees.push_back(run.nees);
      freedom += run.parameters;
    }
    if (run.has_numbers && run.nees_gains >= 0.0) {
      nees_gains.push_back(run.nees_gains);
      freedom_gains += run.gains;
    }
  }
  s.nees = NeesOf(nees, freedom);
  s.nees_gains = NeesOf(nees_gains, freedom_gains);
  for (size_t k = 0; k < truth.size(); ++k) {
    s.parameters.push_back(StatisticsOf(truth[k], static_cast<Index>(k), runs));
  }
  return s;
}

std::pair<double, double> CoverageBand(int runs) {
  CHECK_GE(runs, 1);
  const boost::math::binomial covered(runs, 0.95);
  return {boost::math::quantile(covered, 0.025) / runs, boost::math::quantile(covered, 0.975) / runs};
}

nlohmann::ordered_json MonteCarloJson(const MonteCarlo& monte_carlo) {
  nlohmann::ordered_json json;
  json["runs"] = monte_carlo.runs;
  json["seed"] = monte_carlo.seed;
  json["reference"] = monte_carlo.reference;
  json["noise"] = {{"position", ListOf(monte_carlo.position_noise)}, {"signal", ListOf(monte_carlo.signal_noise)}};
  json["estimators"] = nlohmann::ordered_json::array();
  for (const EstimatorStatistics& e : monte_carlo.estimators) {
    nlohmann::ordered_json estimator;
    estimator["estimator"] = e.estimator;
    estimator["failures"] = e.failures;
    estimator["without_numbers"] = e.without_numbers;
    estimator["first_failure"] = e.first_failure;
    estimator["nees_gains"] = ToJson(e.nees_gains);
    estimator["nees"] = ToJson(e.nees);
    estimator["parameters"] = nlohmann::ordered_json::array();
    for (const ParameterStatistics& p : e.parameters) {
      estimator["parameters"].push_back({{"name", p.parameter.name},
                                         {"kind", ParameterKindName(p.parameter.kind)},
                                         {"truth", p.truth},
                                         {"runs", p.runs},
                                         {"bias", p.bias},
                                         {"bias_standard_error", p.bias_standard_error},
                                         {"standard_deviation", p.standard_deviation},
                                         {"mean_standard_deviation", p.mean_standard_deviation},
                                         {"rmse", p.rmse},
                                         {"coverage95", p.coverage95},
                                         {"coverage95_standard_error", p.coverage95_standard_error}});
    }
    json["estimators"].push_back(std::move(estimator));
  }
  return json;
}

}  // namespace idim
