// Whether an estimator's errors over repeated draws are what its covariances say: bias, spread, coverage, normalised
// errors and the noise that it found, each against its sampling distribution.
//
// R runs, p parameters, e_r the error of run r, P_r its reported covariance, P the mean of these. If e_r ~ N(0, P_r):
//   bias      sqrt(R) mean(e)_i / sqrt(P_ii) is standard normal; R mean(e)' P^-1 mean(e) is chi-square with p degrees
//   spread    sum_r (e_ri - mean)^2 / P_ii is chi-square with R - 1 degrees
//   coverage  the runs whose interval of 95 % holds the truth are binomial (R, 0.95), parameter by parameter; a mean
//             over parameters is not (their errors are correlated) and is printed, not judged
//   NEES      sum_r e_r' P_r^-1 e_r is chi-square with R p degrees
// A judgement of a whole set has the false-alarm rate `alarm`, split evenly between the kinds and, within a kind,
// between the parameters (Bonferroni). Detectable, at R = 200, p = 30, alarm 1e-4: a bias of 0.45 of a spread in one
// parameter and 0.09 spread to all directions (the chi-square), 35 % of a standard deviation of one parameter, 3.3 %
// of all standard deviations (NEES: 6.7 % of the variance).

#ifndef IDIM_TESTS_SUPPORT_MONTE_CARLO_H_
#define IDIM_TESTS_SUPPORT_MONTE_CARLO_H_

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <boost/math/distributions/binomial.hpp>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/normal.hpp>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include "core/base/decompositions.h"
#include "core/base/parallel_for.h"
#include "solvers/bundle/bundle.h"

namespace idim::testing {

struct MonteCarloRun {
  std::string failure;  // empty: the estimator gave an estimate
  Eigen::VectorXd error;
  Eigen::MatrixXd covariance;         // of independent samples
  Eigen::MatrixXd robust_covariance;  // sandwich, times the square of its interval factor
  Eigen::VectorXd sigma;              // found noise over true noise, a joint
};

// error, covariances and noise of a bundle's run.
inline MonteCarloRun RunOf(const BundleSummary& summary, const Eigen::VectorXd& truth, const Eigen::VectorXd& sigma) {
  MonteCarloRun run;
  if (!summary.IsSolutionUsable()) {
    run.failure = summary.status.message();
    return run;
  }
  run.error = summary.values - truth;
  run.covariance = summary.model_covariance;
  run.robust_covariance = summary.interval_factor * summary.interval_factor * summary.robust_covariance;
  run.sigma = summary.signal_sigma.cwiseQuotient(sigma);
  return run;
}

// run(r) for r = 0 .. runs - 1 on two threads; the results do not depend on which thread takes which.
inline std::vector<MonteCarloRun> RunMonteCarlo(int runs, const std::function<MonteCarloRun(int run)>& run) {
  std::vector<MonteCarloRun> results(runs);
  ParallelFor(2, runs, [&](int r) { results[r] = run(r); });
  return results;
}

enum class ReportedCovariance { kSchur, kRobust };

struct MonteCarloStatistics {
  std::vector<std::string> names;  // p
  int runs = 0;                    // with an estimate
  Eigen::VectorXd bias;            // p, mean error
  Eigen::VectorXd spread;          // p, standard deviation of the errors
  Eigen::VectorXd predicted;       // p, root of the mean reported variance
  Eigen::VectorXi covered;         // p, runs whose interval of 95 % holds the truth
  double bias_chi_square = 0.0;    // R mean(e)' P^-1 mean(e)
  double nees = 0.0;               // sum over runs

  double MeanNees() const { return nees / (static_cast<double>(runs) * static_cast<double>(names.size())); }
  double Coverage(int k) const { return static_cast<double>(covered[k]) / runs; }
  double MeanCoverage() const { return covered.cast<double>().mean() / runs; }
};

// Of the parameters `which` (their names beside them), among the runs that gave an estimate.
inline MonteCarloStatistics Summarize(const std::vector<MonteCarloRun>& results, const std::vector<int>& which,
                                      const std::vector<std::string>& names, ReportedCovariance reported) {
  const auto p = static_cast<Eigen::Index>(which.size());
  MonteCarloStatistics s;
  s.names = names;
  s.bias = s.spread = s.predicted = Eigen::VectorXd::Zero(p);
  s.covered = Eigen::VectorXi::Zero(p);
  Eigen::MatrixXd mean = Eigen::MatrixXd::Zero(p, p);
  const double factor = boost::math::quantile(boost::math::normal(), 0.975);
  for (const MonteCarloRun& run : results) {
    if (!run.failure.empty()) continue;
    ++s.runs;
    const Eigen::VectorXd error = run.error(which);
    const Eigen::MatrixXd& all = reported == ReportedCovariance::kSchur ? run.covariance : run.robust_covariance;
    const Eigen::MatrixXd covariance = all(which, which);
    s.bias += error;
    s.spread += error.cwiseAbs2();
    mean += covariance;
    // Scaled to a unit diagonal: units span orders of magnitude.
    const Eigen::VectorXd deviation = covariance.diagonal().cwiseSqrt();
    const Eigen::VectorXd z = error.cwiseQuotient(deviation);
    for (Eigen::Index k = 0; k < p; ++k) s.covered[k] += std::abs(z[k]) < factor;
    const Eigen::MatrixXd correlation =
        deviation.cwiseInverse().asDiagonal() * covariance * deviation.cwiseInverse().asDiagonal();
    s.nees += z.dot(correlation.llt().solve(z));
  }
  const double r = s.runs;
  s.bias /= r;
  s.spread = ((s.spread - r * s.bias.cwiseAbs2()) / (r - 1.0)).cwiseSqrt();
  mean /= r;
  s.predicted = mean.diagonal().cwiseSqrt();
  const Eigen::VectorXd scale = s.predicted.cwiseInverse();
  const Eigen::VectorXd z = s.bias.cwiseProduct(scale);
  s.bias_chi_square = r * z.dot((scale.asDiagonal() * mean * scale.asDiagonal()).eval().llt().solve(z));
  return s;
}

// Of all parameters.
inline MonteCarloStatistics Summarize(const std::vector<MonteCarloRun>& results, const std::vector<std::string>& names,
                                      ReportedCovariance reported) {
  std::vector<int> all;
  for (size_t k = 0; k < names.size(); ++k) all.push_back(static_cast<int>(k));
  return Summarize(results, all, names, reported);
}

// One sentence for each figure that is not what its sampling distribution lets it be; empty if all are.
// false-alarm rate of the whole: alarm.
inline std::vector<std::string> Inconsistencies(const MonteCarloStatistics& s, double alarm) {
  using boost::math::complement;
  using boost::math::quantile;
  std::vector<std::string> found;
  const auto judge = [&](const std::string& what, double value, double low, double high) {
    if (value >= low && value <= high) return;
    char text[200];
    std::snprintf(text, sizeof text, "%s is %.4g, expected %.4g to %.4g", what.c_str(), value, low, high);
    found.emplace_back(text);
  };
  const double r = s.runs, p = static_cast<double>(s.names.size());
  const double each = alarm / 5.0;     // bias, its chi-square, spread, coverage, NEES
  const double tail = each / p / 2.0;  // of one side of one parameter
  const boost::math::normal normal;
  const boost::math::chi_squared spread(r - 1.0), all(p), nees(r * p);
  const boost::math::binomial coverage(r, 0.95);
  const double bias = quantile(complement(normal, tail)) / std::sqrt(r);
  for (Eigen::Index k = 0; k < s.bias.size(); ++k) {
    const std::string& name = s.names[static_cast<size_t>(k)];
    judge("bias of " + name + " in predicted spreads", s.bias[k] / s.predicted[k], -bias, bias);
    judge("spread of " + name + " over predicted", s.spread[k] / s.predicted[k],
          std::sqrt(quantile(spread, tail) / (r - 1.0)), std::sqrt(quantile(complement(spread, tail)) / (r - 1.0)));
    judge("coverage of " + name, s.covered[k], quantile(coverage, tail), quantile(complement(coverage, tail)));
  }
  judge("chi-square of all biases", s.bias_chi_square, 0.0, quantile(complement(all, each)));
  judge("mean NEES a parameter", s.MeanNees(), quantile(nees, each / 2.0) / (r * p),
        quantile(complement(nees, each / 2.0)) / (r * p));
  return found;
}

// The mean over the runs of (found / true noise)^2, a joint.
inline Eigen::VectorXd MeanVarianceRatio(const std::vector<MonteCarloRun>& results) {
  Eigen::VectorXd sum;
  int runs = 0;
  for (const MonteCarloRun& run : results) {
    if (!run.failure.empty()) continue;
    if (runs++ == 0) sum = Eigen::VectorXd::Zero(run.sigma.size());
    sum += run.sigma.cwiseAbs2();
  }
  return sum / runs;
}

// A table for a person; the figures that Inconsistencies() judges. Those of the whole go into the test's result too.
inline void Print(const std::string& title, const MonteCarloStatistics& s) {
  std::printf("%s, %d runs\n%-6s %10s %10s %10s\n", title.c_str(), s.runs, "", "bias/sd", "sd/pred", "coverage");
  for (Eigen::Index k = 0; k < s.bias.size(); ++k) {
    std::printf("%-6s %10.3f %10.3f %10.3f\n", s.names[static_cast<size_t>(k)].c_str(), s.bias[k] / s.predicted[k],
                s.spread[k] / s.predicted[k], s.Coverage(static_cast<int>(k)));
  }
  std::printf("bias chi-square %.1f of %d, mean NEES / p %.4f, mean coverage %.4f, from %.3f to %.3f\n",
              s.bias_chi_square, static_cast<int>(s.bias.size()), s.MeanNees(), s.MeanCoverage(),
              static_cast<double>(s.covered.minCoeff()) / s.runs, static_cast<double>(s.covered.maxCoeff()) / s.runs);
  ::testing::Test::RecordProperty(title + ": mean NEES / p", std::to_string(s.MeanNees()));
  ::testing::Test::RecordProperty(title + ": mean coverage", std::to_string(s.MeanCoverage()));
  ::testing::Test::RecordProperty(title + ": bias chi-square / p",
                                  std::to_string(s.bias_chi_square / static_cast<double>(s.bias.size())));
}

inline std::vector<std::string> Failures(const std::vector<MonteCarloRun>& results) {
  std::vector<std::string> failures;
  for (const MonteCarloRun& run : results) {
    if (!run.failure.empty()) failures.push_back(run.failure);
  }
  return failures;
}

}  // namespace idim::testing

#endif  // IDIM_TESTS_SUPPORT_MONTE_CARLO_H_
