#include "solvers/bundle_problem.h"

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>

#include "core/statistics/triangular_factor.h"

namespace idim {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

double HuberNorm::Cost(double s) const {
  if (threshold <= 0.0 || s <= threshold * threshold) return s;
  return 2.0 * threshold * std::sqrt(s) - threshold * threshold;
}

double HuberNorm::Weight(double s) const {
  return threshold <= 0.0 || s <= threshold * threshold ? 1.0 : threshold / std::sqrt(s);
}

double HuberNorm::Consistency(int n) const {
  if (threshold <= 0.0) return 1.0;
  using boost::math::chi_squared;
  const double t = threshold, within = n * boost::math::cdf(chi_squared(n + 2), t * t);
  // E[sqrt(s); s > t^2] = sqrt(2) Gamma((n + 1) / 2) / Gamma(n / 2) P(chi^2_(n + 1) > t^2).
  const double root = std::sqrt(2.0) * boost::math::tgamma_ratio(0.5 * (n + 1), 0.5 * n);
  return (within + t * root * boost::math::cdf(boost::math::complement(chi_squared(n + 1), t * t))) / n;
}

double HuberNorm::VarianceFactor(int n) const {
  if (threshold <= 0.0) return 1.0;
  using boost::math::chi_squared;
  const double t2 = threshold * threshold;
  const double squares =
      n * boost::math::cdf(chi_squared(n + 2), t2) + t2 * boost::math::cdf(boost::math::complement(chi_squared(n), t2));
  return squares / (n * Consistency(n));
}

BundleProblem::BundleProblem(const BaseParameters& base, const BundleData& data, const std::vector<BundlePrior>& priors,
                             HuberNorm loss)
    : data_(data), priors_(priors), loss_(loss), derivatives_(base, data) {
  for (size_t r = 0; r < data.state_covariance.size(); ++r) {
    covariance_.push_back(StateCovarianceOf(data, static_cast<int>(r)));
  }
  rows_.setZero(data.dof, data.num_unknowns() + 1);
}

double BundleProblem::Whiten(const BundleSample& sample, const VectorXd& gains, const VectorXd& chi,
                             const VectorXd& variance) {
  const int c = data_.num_unknowns();
  inverse_gains_ = gains.cwiseInverse();
  torque_.noalias() = data_.inverse_drive * (sample.columns * chi + sample.known);
  residual_ = sample.signal - torque_.cwiseProduct(inverse_gains_);
  derivatives_.Torque(sample, chi, &d_);
  b_.noalias() = inverse_gains_.asDiagonal() * (data_.inverse_drive * d_);
  cb_.noalias() = covariance_[sample.recording] * b_.transpose();
  v_.noalias() = b_ * cb_;
  spread_ = v_.diagonal();
  v_.diagonal() += variance;
  llt_.compute(v_);
  half_ = llt_.matrixL().solve(residual_);
  const double s = half_.squaredNorm();
  // The latent's best value, and the derivative of the residual by the unknowns there.
  weighted_ = llt_.matrixU().solve(half_);
  deviation_.noalias() = cb_ * weighted_;
  derivatives_.Columns(sample, deviation_, &change_);
  change_ += sample.columns;
  rows_.middleCols(data_.num_gains(), data_.num_columns()).noalias() =
      -(inverse_gains_.asDiagonal() * (data_.inverse_drive * change_));
  if (data_.num_gains() > 0) {
    torque_.noalias() += data_.inverse_drive * (d_ * deviation_);
    rows_.leftCols(data_.dof) = torque_.cwiseProduct(inverse_gains_.cwiseAbs2()).asDiagonal();
  }
  rows_.col(c) = residual_;
  llt_.matrixL().solveInPlace(rows_);
  return s;
}

void BundleProblem::AddPriors(const VectorXd& theta, TriangularFactor* factor) const {
  Eigen::RowVectorXd row(data_.num_unknowns() + 1);
  for (const BundlePrior& prior : priors_) {
    row.setZero();
    row[prior.unknown] = 1.0 / prior.standard_deviation;
    row[data_.num_unknowns()] = (theta[prior.unknown] - prior.value) / prior.standard_deviation;
    factor->AddRow(row);
  }
}

BundleProblem::Evaluation BundleProblem::Evaluate(const VectorXd& theta, const VectorXd& sigma) {
  Evaluation result;
  TriangularFactor factor(data_.num_unknowns() + 1);
  result.squares = result.spread = VectorXd::Zero(data_.dof);
  const VectorXd gains = data_.Gains(theta), chi = theta.tail(data_.num_columns()), variance = sigma.cwiseAbs2();
  double cost = 0.0;
  for (const BundleSample& sample : data_.samples) {
    const double s = Whiten(sample, gains, chi, variance);
    const double weight = loss_.Weight(s);
    cost += loss_.Cost(s);
    result.squares += weight * residual_.cwiseAbs2();
    result.spread += spread_;
    result.log_determinants += 2.0 * llt_.matrixLLT().diagonal().array().log().sum();
    if (weight != 1.0) rows_ *= std::sqrt(weight);
    factor.AddRows(rows_);
  }
  for (const BundlePrior& prior : priors_) {
    cost += std::pow((theta[prior.unknown] - prior.value) / prior.standard_deviation, 2);
  }
  AddPriors(theta, &factor);
  if (!std::isfinite(cost)) return result;
  result.cost = cost;
  result.r = factor.R();
  return result;
}

VectorXd BundleProblem::NextSigma(const Evaluation& at) const {
  const double samples = static_cast<double>(data_.samples.size());
  // Unknowns are shared between joints; each joint bears its part of the freedom they take.
  const double freedom = samples - static_cast<double>(data_.num_unknowns()) / data_.dof;
  const VectorXd mean_square = at.squares / (loss_.Consistency(data_.dof) * freedom);
  const VectorXd next = (mean_square - at.spread / samples).cwiseMax(1e-4 * mean_square).cwiseSqrt();
  // Noise-free data: keep away from dividing by rounding.
  return next.cwiseMax(1e-12 * next.maxCoeff()).cwiseMax(1e-300);
}

BundleProblem::Sensitivity BundleProblem::Scores(const VectorXd& theta, const VectorXd& sigma) {
  const int c = data_.num_unknowns();
  Sensitivity result;
  result.scores.resize(static_cast<Index>(data_.samples.size()), c);
  TriangularFactor factor(c + 1);
  const VectorXd gains = data_.Gains(theta), chi = theta.tail(data_.num_columns()), variance = sigma.cwiseAbs2();
  for (size_t k = 0; k < data_.samples.size(); ++k) {
    const double s = Whiten(data_.samples[k], gains, chi, variance);
    const double weight = loss_.Weight(s);
    result.scores.row(static_cast<Index>(k)).noalias() = weight * (half_.transpose() * rows_.leftCols(c));
    if (weight != 1.0) {
      half_ /= std::sqrt(s);
      rows_ -= half_ * (half_.transpose() * rows_).eval();
      rows_ *= std::sqrt(weight);
    }
    factor.AddRows(rows_);
  }
  AddPriors(theta, &factor);
  result.curvature = factor.R().topLeftCorner(c, c);
  return result;
}

}  // namespace idim
