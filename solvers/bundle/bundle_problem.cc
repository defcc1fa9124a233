#include "solvers/bundle/bundle_problem.h"

#include <Eigen/Cholesky>
#include <algorithm>
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
  const int n = data.dof;
  torque_.resize(n);
  lower_.resize(n);
  rest_.resize(n);
  friction_.setZero(n, n);
  cb_.resize(3 * n, n);
  factor_.setZero(n, n);
  rows_.setZero(n, data.num_unknowns() + 1);
}

void BundleProblem::Set(const VectorXd& theta, const VectorXd& sigma) {
  chi_ = theta.tail(data_.num_columns());
  inverse_gains_ = data_.Gains(theta).cwiseInverse();
  variance_ = sigma.cwiseAbs2();
  drive_ = inverse_gains_.asDiagonal() * data_.inverse_drive;
}

void BundleProblem::HoldFriction(const VectorXd& theta) {
  Set(theta, VectorXd::Ones(data_.dof));
  for (int j = 0; j < data_.dof; ++j) {
    const int column = data_.coulomb_columns.empty() ? -1 : data_.coulomb_columns[static_cast<size_t>(j)];
    friction_.col(j) = drive_.col(j) * (column < 0 ? 0.0 : chi_[column]);
  }
}

// Lazy products and loops: these matrices are smaller than what a blocked product costs to begin.
double BundleProblem::Whiten(size_t k) {
  const BundleSample& sample = data_.samples()[k];
  const RowMajorMatrix& columns = data_.Columns(k, &columns_);
  const int n = data_.dof, c = data_.num_unknowns();
  for (int i = 0; i < n; ++i) torque_[i] = sample.known[i] + columns.row(i).dot(chi_);
  signal_ = drive_.lazyProduct(torque_);
  residual_ = sample.signal - signal_;
  derivatives_.Torque(sample, chi_, &d_);
  b_ = drive_.lazyProduct(d_);
  const std::vector<Eigen::Matrix3d>& covariance = data_.state_covariance[sample.recording];
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const Eigen::Matrix3d& own = covariance[j];
      const double q = b_(i, j), dq = b_(i, n + j), ddq = b_(i, 2 * n + j);
      for (int a = 0; a < 3; ++a) cb_(a * n + j, i) = own(a, 0) * q + own(a, 1) * dq + own(a, 2) * ddq;
    }
  }
  v_ = b_.lazyProduct(cb_);
  spread_ = v_.diagonal();
  AddSignVariance(sample);
  v_.diagonal() += variance_;
  InvertFactor();
  half_ = factor_.lazyProduct(residual_);
  weighted_ = factor_.transpose().lazyProduct(half_);
  // The latent's best value, and the derivative of the residual by the unknowns there.
  deviation_ = cb_.lazyProduct(weighted_);
  derivatives_.Columns(sample, deviation_, &change_);
  change_ += columns;
  whitened_drive_ = factor_.lazyProduct(drive_);
  const int gains = data_.num_gains();
  for (int i = 0; i < n; ++i) {
    auto row = rows_.row(i).segment(gains, data_.num_columns());
    row = -whitened_drive_(i, 0) * change_.row(0);
    for (int j = 1; j < n; ++j) {
      if (whitened_drive_(i, j) != 0.0) row -= whitened_drive_(i, j) * change_.row(j);
    }
  }
  for (int j = 0; j < gains; ++j) {
    const double signal = signal_[j] + b_.row(j).dot(deviation_);
    rows_.col(j) = factor_.col(j) * (signal * inverse_gains_[j]);
  }
  rows_.col(c) = half_;
  return half_.squaredNorm();
}

// At rest dry friction may be anything between -Fs and Fs.
void BundleProblem::AddSignVariance(const BundleSample& sample) {
  rest_.setZero();
  if (sample.sign_variance.size() == 0) return;
  for (int j = 0; j < data_.dof; ++j) {
    if (sample.sign_variance[j] == 0.0) continue;
    for (int a = 0; a < data_.dof; ++a) {
      if (friction_(a, j) == 0.0) continue;
      const double share = friction_(a, j) * sample.sign_variance[j];
      for (int b = 0; b < data_.dof; ++b) v_(a, b) += share * friction_(b, j);
      rest_[a] += share * friction_(a, j);
    }
  }
}

// L^-1 of v_ = L L' into factor_, by rows: row i of L, then row i of its inverse.
void BundleProblem::InvertFactor() {
  const int n = data_.dof;
  log_determinant_ = 0.0;
  for (int i = 0; i < n; ++i) {
    // L_ij = (L^-1 v_.col(i))_j.
    double pivot = v_(i, i);
    for (int j = 0; j < i; ++j) {
      double entry = 0.0;
      for (int k = 0; k <= j; ++k) entry += factor_(j, k) * v_(k, i);
      lower_[j] = entry;
      pivot -= entry * entry;
    }
    const double inverse = 1.0 / std::sqrt(pivot);
    for (int k = 0; k < i; ++k) {
      double entry = 0.0;
      for (int j = k; j < i; ++j) entry += lower_[j] * factor_(j, k);
      factor_(i, k) = -entry * inverse;
    }
    factor_(i, i) = inverse;
    log_determinant_ += std::log(pivot);
  }
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
  result.squares = result.spread = result.weight = VectorXd::Zero(data_.dof);
  Set(theta, sigma);
  double cost = 0.0;
  for (size_t k = 0; k < data_.samples().size(); ++k) {
    const double s = Whiten(k);
    const double weight = loss_.Weight(s);
    cost += loss_.Cost(s);
    for (int j = 0; j < data_.dof; ++j) {
      const double share = variance_[j] / (variance_[j] + rest_[j]), own = share * share;
      result.squares[j] += own * weight * residual_[j] * residual_[j];
      result.spread[j] += own * (spread_[j] + rest_[j]);
      result.weight[j] += own;
    }
    result.log_determinants += log_determinant_;
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

BundleProblem::Rows BundleProblem::Linearize(const VectorXd& theta, const VectorXd& sigma) {
  Rows result;
  const Index n = data_.dof;
  result.rows.resize(n * static_cast<Index>(data_.samples().size()), data_.num_unknowns() + 1);
  Set(theta, sigma);
  for (size_t k = 0; k < data_.samples().size(); ++k) {
    Whiten(k);
    result.rows.middleRows(n * static_cast<Index>(k), n) = rows_;
    result.of_torque.push_back(whitened_drive_);
  }
  return result;
}

VectorXd BundleProblem::NextSigma(const Evaluation& at) const {
  const double samples = static_cast<double>(data_.samples().size());
  // Unknowns are shared between joints; each joint bears its part of the freedom they take.
  const double freedom = samples - static_cast<double>(data_.num_unknowns()) / data_.dof;
  const VectorXd mean_square =
      at.squares.cwiseQuotient(at.weight) * (samples / (loss_.Consistency(data_.dof) * freedom));
  const VectorXd next = (mean_square - at.spread.cwiseQuotient(at.weight)).cwiseMax(1e-4 * mean_square).cwiseSqrt();
  // Noise-free data: keep away from dividing by rounding.
  return next.cwiseMax(1e-12 * next.maxCoeff()).cwiseMax(1e-300);
}

MatrixXd BundleProblem::NoiseInformation(const VectorXd& theta, const VectorXd& sigma, int max_samples) {
  const int n = data_.dof, c = data_.num_unknowns(), gains = data_.num_gains();
  MatrixXd sum = MatrixXd::Zero(c, c);
  Set(theta, sigma);
  const size_t count = data_.samples().size();
  const size_t step = std::max<size_t>(1, count / static_cast<size_t>(max_samples));
  std::vector<MatrixXd> states;
  for (size_t r = 0; r < data_.state_covariance.size(); ++r)
    states.push_back(StateCovarianceOf(data_, static_cast<int>(r)));
  RowMajorMatrix rows(3 * n * n, c);
  double used = 0.0;
  for (size_t k = step / 2; k < count; k += step, used += 1.0) {
    const BundleSample& sample = data_.samples()[k];
    Whiten(k);
    const MatrixXd half = factor_ * cb_.transpose();
    // Units of q, dq and ddq differ by orders of magnitude.
    const VectorXd scale = states[static_cast<size_t>(sample.recording)].diagonal().cwiseSqrt().cwiseMax(1e-300);
    const MatrixXd q = scale.cwiseInverse().asDiagonal() *
                       (states[static_cast<size_t>(sample.recording)] - half.transpose() * half) *
                       scale.cwiseInverse().asDiagonal();
    const Eigen::LDLT<MatrixXd> ldlt(q);
    const MatrixXd root = scale.asDiagonal() * (ldlt.transpositionsP().transpose() * MatrixXd(ldlt.matrixL())) *
                          ldlt.vectorD().cwiseMax(0.0).cwiseSqrt().asDiagonal();
    for (int s = 0; s < 3 * n; ++s) {
      deviation_ = root.col(s);
      derivatives_.Columns(sample, deviation_, &change_);
      auto own = rows.middleRows(s * n, n);
      own.rightCols(data_.num_columns()) = -(whitened_drive_ * change_);
      if (gains > 0)
        own.leftCols(gains) = factor_ * VectorXd((b_ * deviation_).cwiseProduct(inverse_gains_)).asDiagonal();
    }
    sum.selfadjointView<Eigen::Lower>().rankUpdate(rows.transpose());
  }
  return MatrixXd(sum.selfadjointView<Eigen::Lower>()) * (static_cast<double>(count) / std::max(used, 1.0));
}

VectorXd BundleProblem::ScoreSum(const VectorXd& theta, const VectorXd& sigma, size_t step) {
  const int c = data_.num_unknowns();
  Set(theta, sigma);
  VectorXd sum = VectorXd::Zero(c);
  double used = 0.0;
  for (size_t k = step / 2; k < data_.samples().size(); k += step, used += 1.0) {
    const double weight = loss_.Weight(Whiten(k));
    sum.noalias() += weight * (rows_.leftCols(c).transpose() * half_);
  }
  return sum * (static_cast<double>(data_.samples().size()) / std::max(used, 1.0));
}

MatrixXd BundleProblem::ScoreByVariance(const VectorXd& theta, const VectorXd& sigma, int max_samples) {
  constexpr double kStep = 1e-3;  // of the variance
  const size_t step = std::max<size_t>(1, data_.samples().size() / static_cast<size_t>(max_samples));
  MatrixXd result(data_.num_unknowns(), data_.dof);
  for (int j = 0; j < data_.dof; ++j) {
    const auto at = [&](double share) {
      VectorXd moved = sigma;
      moved[j] *= std::sqrt(1.0 + share);
      return ScoreSum(theta, moved, step);
    };
    result.col(j) = (at(kStep) - at(-kStep)) / (2.0 * kStep * sigma[j] * sigma[j]);
  }
  return result;
}

BundleProblem::Sensitivity BundleProblem::Scores(const VectorXd& theta, const VectorXd& sigma) {
  const int c = data_.num_unknowns();
  Sensitivity result;
  const double count = static_cast<double>(data_.samples().size());
  const double scale = count / (loss_.Consistency(data_.dof) * (count - static_cast<double>(c) / data_.dof));
  result.scores.resize(static_cast<Index>(data_.samples().size()), c);
  result.variances.resize(result.scores.rows(), data_.dof);
  VectorXd shares = VectorXd::Zero(data_.dof);
  TriangularFactor factor(c + 1);
  Set(theta, sigma);
  for (size_t k = 0; k < data_.samples().size(); ++k) {
    const double s = Whiten(k);
    const double weight = loss_.Weight(s);
    for (int j = 0; j < data_.dof; ++j) {
      const double share = std::pow(variance_[j] / (variance_[j] + rest_[j]), 2);
      shares[j] += share;
      result.variances(static_cast<Index>(k), j) =
          share * (scale * weight * residual_[j] * residual_[j] - spread_[j] - rest_[j] - variance_[j]);
    }
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
  result.variances *= shares.cwiseInverse().asDiagonal();
  return result;
}

}  // namespace idim
