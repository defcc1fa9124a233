#include "solvers/bundle/bundle.h"

#include <glog/logging.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/base/decompositions.h"
#include "core/statistics/long_run_covariance.h"
#include "solvers/linear/least_squares.h"

namespace idim {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Evaluation = BundleProblem::Evaluation;

// While weights still move, this many standard deviations from the minimum are near enough for the next ones, which
// depend on the unknowns to second order.
constexpr double kLooseTolerance = 0.03;

// From which the noise of the final curvature is taken; a step needs it less well.
constexpr int kNoiseSamples = 2000;

// What Minimize() carries from one call to the next.
struct Iterate {
  VectorXd theta, sigma;
  Evaluation at;  // of theta, sigma
};

// theta + move, gains by steps in 1/g.
VectorXd Moved(const VectorXd& theta, const VectorXd& move, Index gains) {
  VectorXd next = theta + move;
  const VectorXd change = move.head(gains).cwiseQuotient(theta.head(gains));
  next.head(gains) = theta.head(gains).cwiseQuotient(VectorXd::Ones(gains) - change);
  return next;
}

// R^-1 of an upper triangle, by scaled columns.
MatrixXd InverseOf(const MatrixXd& r) {
  const Index c = r.cols();
  const VectorXd inverse_scale = ColumnScales(r).cwiseInverse();
  const MatrixXd scaled = r * inverse_scale.asDiagonal();
  return inverse_scale.asDiagonal() * MatrixXd(scaled.triangularView<Eigen::Upper>().solve(MatrixXd::Identity(c, c)));
}

// What the error of the estimated states makes up of the curvature K = R'R: T = R^-T N R^-1, held below the share of K
// at which K - N = R'(I - T) R is still a curvature. inverse: R^-1. *share: of the direction where it is largest.
constexpr double kLargestShare = 0.97;
MatrixXd ClampedNoiseShare(const MatrixXd& noise, const MatrixXd& inverse, double* share) {
  const MatrixXd shares = inverse.transpose() * noise * inverse;
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(MatrixXd(0.5 * (shares + shares.transpose())));
  *share = eigen.eigenvalues().maxCoeff();
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMin(kLargestShare).cwiseMax(0.0).asDiagonal() *
         eigen.eigenvectors().transpose();
}

// (K - N)^-1 for K = R'R.
MatrixXd InverseOfCorrectedInformation(const MatrixXd& shares, const MatrixXd& inverse) {
  return inverse * (MatrixXd::Identity(shares.rows(), shares.cols()) - shares).inverse() * inverse.transpose();
}

// Levenberg-Marquardt with fixed weights. Returns whether the minimum is nearer than `tolerance`. noise: to be taken
// from the curvature, c x c, or empty.
bool Minimize(BundleProblem* problem, double tolerance, int max_iterations, const MatrixXd& noise, Iterate* iterate,
              BundleSummary* summary) {
  const Index c = iterate->theta.size();
  bool newton = noise.size() > 0;
  double lambda = 0.0;
  while (std::isfinite(iterate->at.cost)) {
    const MatrixXd& r = iterate->at.r;
    // R's last column is Q'r: its upper part is the gradient in units of the standard deviations.
    summary->decrement = r.col(c).head(c).norm();
    summary->final_cost = iterate->at.cost;
    if (summary->decrement < tolerance) return true;
    if (summary->iterations >= max_iterations) return false;
    ++summary->iterations;
    if (newton) {
      const MatrixXd triangle = r.topLeftCorner(c, c), inverse = InverseOf(triangle);
      const VectorXd step =
          -(InverseOfCorrectedInformation(ClampedNoiseShare(noise, inverse, &summary->noise_share), inverse) *
            (triangle.transpose() * r.col(c).head(c)));
      const VectorXd next = Moved(iterate->theta, step, problem->num_gains());
      if (next.allFinite()) {
        Evaluation at = problem->Evaluate(next, iterate->sigma);
        if (at.cost <= iterate->at.cost * (1.0 + 1e-12)) {
          iterate->theta = next;
          iterate->at = std::move(at);
          continue;
        }
      }
      newton = false;
    }
    const VectorXd scale = ColumnScales(r.leftCols(c));
    MatrixXd damped(2 * c + 1, c);
    VectorXd right = VectorXd::Zero(2 * c + 1);
    right.head(c + 1) = -r.col(c);
    while (true) {
      damped << r.leftCols(c) * scale.cwiseInverse().asDiagonal(),
          MatrixXd(VectorXd::Constant(c, std::sqrt(lambda)).asDiagonal());
      const VectorXd step = damped.householderQr().solve(right);
      const VectorXd next = Moved(iterate->theta, step.cwiseQuotient(scale), problem->num_gains());
      if (next.allFinite()) {
        Evaluation at = problem->Evaluate(next, iterate->sigma);
        if (at.cost <= iterate->at.cost * (1.0 + 1e-12)) {
          iterate->theta = next;
          iterate->at = std::move(at);
          lambda = lambda < 1e-9 ? 0.0 : 0.1 * lambda;
          break;
        }
      }
      lambda = std::max(1e-6, 10.0 * lambda);
      if (lambda > 1e12) return false;
    }
  }
  return false;
}

// Rows that are worked on together, so that what all samples need is not held twice.
constexpr Index kBlockRows = 256;

// Kiefer & Vogelsang 2005, Bartlett, two-sided 95 %: polynomial of the critical value in b = lag / samples.
double IntervalFactor(double b) { return (1.96 + 2.9694 * b + 0.4160 * b * b - 0.5324 * b * b * b) / 1.96; }

void SetCovariance(BundleProblem* problem, const BundleData& data, const Iterate& iterate, BundleSummary* summary) {
  const BundleOptions& options = summary->given;
  const double count = static_cast<double>(data.samples().size());
  BundleProblem::Sensitivity sensitivity = problem->Scores(iterate.theta, iterate.sigma);
  const MatrixXd inverse = InverseOf(sensitivity.curvature);
  const double variance = HuberNorm{options.huber_threshold * std::sqrt(data.dof)}.VarianceFactor(data.dof);
  summary->covariance = inverse * inverse.transpose() * variance;
  if (!options.inference) return;
  const MatrixXd noise = problem->NoiseInformation(iterate.theta, iterate.sigma, kNoiseSamples);
  const MatrixXd bread =
      InverseOfCorrectedInformation(ClampedNoiseShare(noise, inverse, &summary->noise_share), inverse);
  MatrixXd middle = sensitivity.curvature.transpose() * sensitivity.curvature * variance;
  if (options.max_weight_iterations > 0) {
    // Weights that are estimated: their errors move the estimate where the joint data's noise is felt.
    const MatrixXd by_variance = problem->ScoreByVariance(iterate.theta, iterate.sigma, kNoiseSamples);
    const MatrixXd of_variances = sensitivity.variances.transpose() * sensitivity.variances;
    middle += by_variance * of_variances * by_variance.transpose();
    sensitivity.scores += sensitivity.variances * by_variance.transpose();
  }
  summary->model_covariance = bread * middle * bread.transpose();
  const SampleRanges recordings = RecordingsOf(data);
  // Influence of each sample on the parameters.
  MatrixXd& influence = sensitivity.scores;
  for (Index first = 0; first < influence.rows(); first += kBlockRows) {
    auto block = influence.middleRows(first, std::min(kBlockRows, influence.rows() - first));
    block *= bread;
  }
  summary->hac_lag = options.hac_lag >= 0 ? options.hac_lag : ChooseLag(influence, recordings);
  summary->robust_covariance = LongRunCovariance(influence, recordings, summary->hac_lag) * count * data.dof /
                               std::max(summary->degrees_of_freedom, 1.0);
  for (const BundlePrior& prior : options.priors) {
    summary->robust_covariance +=
        bread.col(prior.unknown) * bread.row(prior.unknown) / (prior.standard_deviation * prior.standard_deviation);
  }
  summary->interval_factor = IntervalFactor((summary->hac_lag + 1.0) / count);
}

}  // namespace

bool BundleOptions::IsValid(std::string* error) const {
  if (max_iterations < 1) {
    *error = "max_iterations is " + std::to_string(max_iterations) + "; expected at least 1";
    return false;
  }
  if (!(step_tolerance > 0.0) || !(weight_tolerance > 0.0)) {
    *error = "step_tolerance and weight_tolerance must be positive";
    return false;
  }
  if (max_weight_iterations < 0) {
    *error = "max_weight_iterations is " + std::to_string(max_weight_iterations) + "; expected at least 0";
    return false;
  }
  if (max_weight_iterations == 0 && signal_sigma.size() == 0) {
    *error = "signal_sigma is empty; expected standard deviations where max_weight_iterations is 0";
    return false;
  }
  if (signal_sigma.size() > 0 && !(signal_sigma.array() > 0.0).all()) {
    *error = "signal_sigma has an entry that is not positive";
    return false;
  }
  if (!AreValid(priors, error)) return false;
  if (!(huber_threshold >= 0.0)) {
    *error = "huber_threshold is " + std::to_string(huber_threshold) + "; expected 0 (no loss) or more";
    return false;
  }
  if (hac_lag < -1) {
    *error = "hac_lag is " + std::to_string(hac_lag) + "; expected at least -1";
    return false;
  }
  return IsValidRankTolerance(rank_tolerance, error);
}

BundleSummary SolveBundle(const BaseParameters& base, const BundleData& data, const VectorXd& start,
                          const BundleOptions& options) {
  std::string error;
  CHECK(options.IsValid(&error)) << error;
  CHECK_EQ(start.size(), data.num_unknowns());
  BundleSummary summary;
  summary.given = options;
  summary.iterations = 0;
  summary.weight_iterations = 0;
  summary.degrees_of_freedom =
      static_cast<double>(data.samples().size()) * data.dof - static_cast<double>(data.num_unknowns());
  if (!(data.Gains(start).cwiseAbs().minCoeff() > 0.0) || !start.allFinite()) {
    summary.status = Status::Untrusted("the bundle cannot start: a gain is zero or not a number");
    return summary;
  }
  if (summary.degrees_of_freedom < 1.0) {
    summary.status =
        Status::Untrusted("not identifiable: " + std::to_string(data.samples().size() * data.dof) + " equations for " +
                          std::to_string(data.num_unknowns()) + " unknowns. Record longer, or decimate less");
    return summary;
  }
  BundleProblem problem(base, data, options.priors, HuberNorm{options.huber_threshold * std::sqrt(data.dof)});
  Iterate iterate;
  iterate.theta = start;
  iterate.sigma = options.signal_sigma;
  if (iterate.sigma.size() == 0) {
    // Without a loss, which needs weights to tell outliers by.
    BundleProblem squares(base, data, options.priors, HuberNorm{});
    iterate.sigma = squares.NextSigma(squares.Evaluate(start, VectorXd::Ones(data.dof)));
  }
  problem.HoldFriction(start);
  const auto evaluate = [&] { iterate.at = problem.Evaluate(iterate.theta, iterate.sigma); };
  std::vector<int> all(data.num_unknowns());
  std::iota(all.begin(), all.end(), 0);
  const auto diagnose = [&] {
    return DiagnoseRank(iterate.at.r.topLeftCorner(start.size(), start.size()), all, data.unknowns.parameters(),
                        options.rank_tolerance);
  };
  evaluate();
  summary.initial_cost = iterate.at.cost;
  summary.values = iterate.theta;
  summary.signal_sigma = iterate.sigma;
  if (!std::isfinite(iterate.at.cost)) {
    summary.status = Status::Untrusted("the bundle cannot start: its cost there is not a number");
    return summary;
  }
  summary.status = diagnose();
  if (!summary.status.ok()) return summary;

  MatrixXd noise;  // not before the unknowns and weights are about right
  bool converged = options.max_weight_iterations == 0;
  while (!converged && summary.weight_iterations < options.max_weight_iterations &&
         Minimize(&problem, kLooseTolerance, options.max_iterations, noise, &iterate, &summary)) {
    const VectorXd next = problem.NextSigma(iterate.at);
    ++summary.weight_iterations;
    converged = ((next - iterate.sigma).cwiseQuotient(iterate.sigma)).cwiseAbs().maxCoeff() < options.weight_tolerance;
    iterate.sigma = next;
    if (noise.size() == 0) noise = problem.NoiseInformation(iterate.theta, iterate.sigma);
    problem.HoldFriction(iterate.theta);
    evaluate();
  }
  noise = problem.NoiseInformation(iterate.theta, iterate.sigma);
  summary.converged = Minimize(&problem, options.step_tolerance, options.max_iterations, noise, &iterate, &summary);
  summary.values = iterate.theta;
  summary.signal_sigma = iterate.sigma;
  summary.deviance = iterate.at.cost + iterate.at.log_determinants;
  summary.status = diagnose();
  if (!summary.status.ok()) return summary;
  summary.condition_number = ConditionNumber(iterate.at.r.topLeftCorner(start.size(), start.size()));
  SetCovariance(&problem, data, iterate, &summary);
  if (!summary.converged) {
    char distance[32];
    std::snprintf(distance, sizeof(distance), "%.3g", summary.decrement);
    summary.status = Status::Untrusted(std::string("the bundle has not converged: the minimum is still ") + distance +
                                       " standard deviations away after " + std::to_string(summary.iterations) +
                                       " iterations. Start from better gains, or weigh more of the payload");
  } else if (!converged) {
    summary.status = Status::Untrusted("the weights of the bundle have not settled after " +
                                       std::to_string(summary.weight_iterations) + " rounds");
  }
  return summary;
}

}  // namespace idim
