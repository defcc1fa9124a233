#include "solvers/bundle.h"

#include <glog/logging.h>

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/statistics/triangular_factor.h"

namespace idim {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using RowMajorMatrix = StateDerivatives::RowMajorMatrix;

// The pieces of one sample at given unknowns and weights.
class Linearization {
 public:
  Linearization(const BaseParameters& base, const BundleData& data) : data_(data), derivatives_(base, data) {
    for (size_t r = 0; r < data.state_covariance.size(); ++r) {
      covariance_.push_back(StateCovarianceOf(data, static_cast<int>(r)));
    }
  }

  // residual: n, at zero deviation. spread: n x n, B C B'. gain: C B', 3n x n.
  void Residual(const BundleSample& sample, const VectorXd& theta, VectorXd* residual, MatrixXd* spread) {
    const int n = data_.dof;
    const auto chi = theta.tail(data_.num_columns());
    torque_ = data_.inverse_drive * (sample.columns * chi + sample.known);
    *residual = sample.signal - torque_.cwiseQuotient(theta.head(n));
    derivatives_.Torque(sample, chi, &d_);
    b_ = theta.head(n).cwiseInverse().asDiagonal() * data_.inverse_drive * d_;
    cb_ = covariance_[sample.recording] * b_.transpose();
    *spread = b_ * cb_;
  }

  // After Residual(): the derivative of the residual by the unknowns at the deviation that `weighted` = V^-1 r gives.
  void Jacobian(const BundleSample& sample, const VectorXd& theta, const VectorXd& weighted, MatrixXd* jacobian) {
    const int n = data_.dof;
    const VectorXd deviation = cb_ * weighted;
    derivatives_.Columns(sample, deviation, &change_);
    const VectorXd torque = torque_ + data_.inverse_drive * (d_ * deviation);
    jacobian->resize(n, data_.num_unknowns());
    jacobian->leftCols(n) = torque.cwiseQuotient(theta.head(n).cwiseAbs2()).asDiagonal();
    jacobian->rightCols(data_.num_columns()) =
        -(theta.head(n).cwiseInverse().asDiagonal() * (data_.inverse_drive * (sample.columns + change_)));
  }

 private:
  const BundleData& data_;
  StateDerivatives derivatives_;
  std::vector<MatrixXd> covariance_;
  VectorXd torque_;
  MatrixXd d_, b_, cb_;
  RowMajorMatrix change_;
};

class Problem {
 public:
  Problem(const BaseParameters& base, const BundleData& data, const BundleOptions& options)
      : data_(data), options_(options), linearization_(base, data) {}

  double Cost(const VectorXd& theta, const VectorXd& sigma) {
    double cost = 0.0;
    for (const BundleSample& sample : data_.samples) {
      Factor(sample, theta, sigma);
      cost += half_.squaredNorm();
    }
    for (const BundlePrior& prior : options_.priors) {
      cost += std::pow((theta[prior.unknown] - prior.value) / prior.standard_deviation, 2);
    }
    return std::isfinite(cost) ? cost : std::numeric_limits<double>::infinity();
  }

  // R of the rows [J | r], whitened, priors included.
  MatrixXd NormalFactor(const VectorXd& theta, const VectorXd& sigma) {
    TriangularFactor factor(data_.num_unknowns() + 1);
    RowMajorMatrix rows(data_.dof, data_.num_unknowns() + 1);
    for (const BundleSample& sample : data_.samples) {
      WhitenedRows(sample, theta, sigma, &rows);
      for (int j = 0; j < data_.dof; ++j) factor.AddRow(rows.row(j));
    }
    Eigen::RowVectorXd row(data_.num_unknowns() + 1);
    for (const BundlePrior& prior : options_.priors) {
      row.setZero();
      row[prior.unknown] = 1.0 / prior.standard_deviation;
      row[data_.num_unknowns()] = (theta[prior.unknown] - prior.value) / prior.standard_deviation;
      factor.AddRow(row);
    }
    return factor.R();
  }

  // Each joint's mean squared residual against what joint data explain of it, and the next standard deviations.
  VectorXd NextSigma(const VectorXd& theta, const VectorXd& sigma) {
    const int n = data_.dof;
    VectorXd squares = VectorXd::Zero(n), spread = VectorXd::Zero(n);
    for (const BundleSample& sample : data_.samples) {
      linearization_.Residual(sample, theta, &residual_, &v_);
      squares += residual_.cwiseAbs2();
      spread += v_.diagonal();
    }
    const double samples = static_cast<double>(data_.samples.size());
    // Unknowns are shared between joints; each joint bears its part of the freedom they take.
    const double freedom = samples - static_cast<double>(data_.num_unknowns()) / n;
    VectorXd next = (squares / freedom - spread / samples).cwiseMax(1e-4 * squares / samples).cwiseSqrt();
    // Noise-free data: keep away from dividing by rounding.
    return next.cwiseMax(1e-12 * sigma.maxCoeff()).cwiseMax(1e-300);
  }

  // Sum over lags of score autocovariances with Bartlett weights: the middle of the sandwich.
  MatrixXd ScoreCovariance(const VectorXd& theta, const VectorXd& sigma, int lag) {
    const int c = data_.num_unknowns();
    MatrixXd scores(data_.samples.size(), c);
    RowMajorMatrix rows(data_.dof, c + 1);
    for (size_t k = 0; k < data_.samples.size(); ++k) {
      WhitenedRows(data_.samples[k], theta, sigma, &rows);
      scores.row(k) = (rows.leftCols(c).transpose() * rows.col(c)).transpose();
    }
    MatrixXd sum = scores.transpose() * scores;
    for (int l = 1; l <= lag; ++l) {
      MatrixXd cross = MatrixXd::Zero(c, c);
      for (size_t begin = 0; begin < data_.samples.size();) {
        size_t end = begin;
        while (end < data_.samples.size() && data_.samples[end].recording == data_.samples[begin].recording) ++end;
        const Eigen::Index count = static_cast<Eigen::Index>(end - begin) - l;
        if (count > 0) {
          cross += scores.middleRows(static_cast<Eigen::Index>(begin), count).transpose() *
                   scores.middleRows(static_cast<Eigen::Index>(begin) + l, count);
        }
        begin = end;
      }
      sum += (1.0 - l / (lag + 1.0)) * (cross + cross.transpose());
    }
    return sum;
  }

 private:
  // half_ = L^-1 r with V = L L'.
  void Factor(const BundleSample& sample, const VectorXd& theta, const VectorXd& sigma) {
    linearization_.Residual(sample, theta, &residual_, &v_);
    v_.diagonal() += sigma.cwiseAbs2();
    llt_.compute(v_);
    half_ = llt_.matrixL().solve(residual_);
  }

  void WhitenedRows(const BundleSample& sample, const VectorXd& theta, const VectorXd& sigma, RowMajorMatrix* rows) {
    Factor(sample, theta, sigma);
    const VectorXd weighted = llt_.matrixU().solve(half_);
    linearization_.Jacobian(sample, theta, weighted, &jacobian_);
    rows->leftCols(data_.num_unknowns()) = llt_.matrixL().solve(jacobian_);
    rows->col(data_.num_unknowns()) = half_;
  }

  const BundleData& data_;
  const BundleOptions& options_;
  Linearization linearization_;
  VectorXd residual_, half_;
  MatrixXd v_, jacobian_;
  Eigen::LLT<MatrixXd> llt_;
};

// Levenberg-Marquardt with fixed weights, gains by steps in 1/g. Returns whether it converged.
bool Minimize(Problem* problem, const BundleOptions& options, const VectorXd& sigma, VectorXd* theta,
              BundleSummary* summary) {
  const Eigen::Index c = theta->size(), n = sigma.size();
  double lambda = 0.0;
  double cost = problem->Cost(*theta, sigma);
  for (int iteration = 0; iteration < options.max_iterations; ++iteration) {
    ++summary->iterations;
    const MatrixXd r = problem->NormalFactor(*theta, sigma);
    const VectorXd scale = r.leftCols(c).colwise().norm().cwiseMax(1e-300);
    const MatrixXd scaled = r.leftCols(c) * scale.cwiseInverse().asDiagonal();
    // Standard deviation of each unknown: norms of the rows of the inverse triangle.
    const MatrixXd inverse = scaled.topRows(c).triangularView<Eigen::Upper>().solve(MatrixXd::Identity(c, c));
    const VectorXd deviation = inverse.rowwise().norm();
    while (true) {
      MatrixXd damped(c + 1 + c, c);
      damped << scaled, MatrixXd(VectorXd::Constant(c, std::sqrt(lambda)).asDiagonal());
      VectorXd right = VectorXd::Zero(c + 1 + c);
      right.head(c + 1) = -r.col(c);
      const VectorXd step = damped.householderQr().solve(right);
      const VectorXd move = step.cwiseQuotient(scale);
      const VectorXd gain_change = move.head(n).cwiseQuotient(theta->head(n));
      VectorXd next = *theta + move;
      next.head(n) = theta->head(n).cwiseQuotient(VectorXd::Ones(n) - gain_change);
      summary->largest_step = step.cwiseQuotient(deviation).cwiseAbs().maxCoeff();
      if (!step.allFinite()) return false;
      const double next_cost = problem->Cost(next, sigma);
      if (next_cost <= cost * (1.0 + 1e-12)) {
        *theta = next;
        cost = next_cost;
        lambda = lambda < 1e-9 ? 0.0 : 0.1 * lambda;
        break;
      }
      if (summary->largest_step < options.step_tolerance) break;  // rounding decides the cost
      lambda = std::max(1e-6, 10.0 * lambda);
      if (lambda > 1e12) return false;
    }
    summary->final_cost = cost;
    if (lambda == 0.0 && summary->largest_step < options.step_tolerance) return true;
    if (summary->largest_step < options.step_tolerance * 1e-3) return true;
  }
  return false;
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
  for (const BundlePrior& prior : priors) {
    if (prior.unknown >= 0 && prior.standard_deviation > 0.0) continue;
    *error = "priors: expected an unknown >= 0 and a positive standard deviation";
    return false;
  }
  if (hac_lag < -1) {
    *error = "hac_lag is " + std::to_string(hac_lag) + "; expected at least -1";
    return false;
  }
  return true;
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
      static_cast<double>(data.samples.size()) * data.dof - static_cast<double>(data.num_unknowns());
  if (!(start.head(data.dof).cwiseAbs().minCoeff() > 0.0) || !start.allFinite()) {
    summary.status = Status::Untrusted("the bundle cannot start: a gain is zero or not a number");
    return summary;
  }
  Problem problem(base, data, options);
  VectorXd theta = start;
  VectorXd sigma =
      options.signal_sigma.size() > 0 ? options.signal_sigma : problem.NextSigma(theta, VectorXd::Ones(data.dof));
  summary.initial_cost = problem.Cost(theta, sigma);
  summary.converged = Minimize(&problem, options, sigma, &theta, &summary);
  bool settled = options.max_weight_iterations == 0;
  while (summary.converged && !settled && summary.weight_iterations < options.max_weight_iterations) {
    const VectorXd next = problem.NextSigma(theta, sigma);
    ++summary.weight_iterations;
    settled = ((next - sigma).cwiseQuotient(sigma)).cwiseAbs().maxCoeff() < options.weight_tolerance;
    sigma = next;
    summary.converged = Minimize(&problem, options, sigma, &theta, &summary);
  }
  summary.values = theta;
  summary.signal_sigma = sigma;

  const Eigen::Index c = theta.size();
  const MatrixXd r = problem.NormalFactor(theta, sigma);
  const VectorXd scale = r.leftCols(c).colwise().norm().cwiseMax(1e-300);
  const MatrixXd inverse =
      scale.cwiseInverse().asDiagonal() * MatrixXd((r.topLeftCorner(c, c) * scale.cwiseInverse().asDiagonal())
                                                       .triangularView<Eigen::Upper>()
                                                       .solve(MatrixXd::Identity(c, c)));
  summary.covariance = inverse * inverse.transpose();
  size_t shortest = data.samples.size();
  for (size_t begin = 0; begin < data.samples.size();) {
    size_t end = begin;
    while (end < data.samples.size() && data.samples[end].recording == data.samples[begin].recording) ++end;
    shortest = std::min(shortest, end - begin);
    begin = end;
  }
  summary.hac_lag = options.hac_lag >= 0
                        ? options.hac_lag
                        : static_cast<int>(4.0 * std::pow(static_cast<double>(shortest) / 100.0, 2.0 / 9.0));
  summary.robust_covariance =
      summary.covariance * problem.ScoreCovariance(theta, sigma, summary.hac_lag) * summary.covariance;
  if (!summary.converged) {
    summary.status =
        Status::Untrusted("the bundle has not converged: the last step was " + std::to_string(summary.largest_step) +
                          " standard deviations after " + std::to_string(summary.iterations) +
                          " iterations. Start from better gains, or weigh more of the payload");
  } else if (!settled) {
    summary.status = Status::Untrusted("the weights of the bundle have not settled after " +
                                       std::to_string(summary.weight_iterations) + " rounds");
  } else {
    summary.status = Status::Ok();
  }
  return summary;
}

}  // namespace idim
