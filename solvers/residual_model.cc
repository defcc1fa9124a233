#include "solvers/residual_model.h"

#include <glog/logging.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <boost/math/distributions/fisher_f.hpp>
#include <cmath>

#include "solvers/least_squares.h"

namespace idim {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

ResidualModel::ResidualModel(const PreparedStudy& prepared, const BundleData& data, const BundleSummary& summary,
                             int folds)
    : dof_(data.dof), recordings_(RecordingsOf(data)), folds_(folds) {
  CHECK(summary.IsSolutionUsable()) << summary.status.message();
  CHECK_GE(folds, 2);
  BundleProblem problem(prepared.base, data, data.priors, HuberNorm{});
  problem.HoldFriction(summary.values);
  BundleProblem::Rows rows = problem.Linearize(summary.values, summary.signal_sigma);
  const Index c = data.num_unknowns();
  residual_ = rows.rows.col(c);
  const MatrixXd j = rows.rows.leftCols(c);
  rows.rows.resize(0, 0);
  const MatrixXd scaled = j * ColumnScales(j).cwiseInverse().asDiagonal();
  q_ = Eigen::HouseholderQR<MatrixXd>(scaled).householderQ() * MatrixXd::Identity(j.rows(), c);
  of_torque_ = std::move(rows.of_torque);
  torque_.resize(samples(), dof_);
  const VectorXd gains = data.Gains(summary.values);
  drive_ = gains.cwiseInverse().asDiagonal() * data.inverse_drive;
  for (Index k = 0; k < samples(); ++k) {
    to_torque_.push_back(of_torque_[static_cast<size_t>(k)].inverse());
    torque_.row(k) = data.inverse_drive.inverse() * gains.cwiseProduct(data.samples[static_cast<size_t>(k)].signal);
  }
  fold_.resize(static_cast<size_t>(samples()));
  for (const auto& [begin, end] : recordings_) {
    for (Index k = begin; k < end; ++k) {
      fold_[static_cast<size_t>(k)] = static_cast<int>((k - begin) * folds_ / (end - begin));
    }
  }
}

MatrixXd ResidualModel::TorqueResidual() const {
  MatrixXd result(samples(), dof_);
  for (Index k = 0; k < samples(); ++k) {
    result.row(k) = to_torque_[static_cast<size_t>(k)] * residual_.segment(k * dof_, dof_);
  }
  return result;
}

MatrixXd ResidualModel::WeightedSquares(const MatrixXd& signal_residual) const {
  const MatrixXd to_torque = drive_.inverse();
  MatrixXd squares(samples(), dof_);
  for (Index k = 0; k < samples(); ++k) {
    squares.row(k) =
        (of_torque_[static_cast<size_t>(k)] * (to_torque * signal_residual.row(k).transpose())).cwiseAbs2().transpose();
  }
  return squares;
}

MatrixXd ResidualModel::Whiten(const std::vector<int>& joints, const std::vector<MatrixXd>& torques) const {
  CHECK_EQ(joints.size(), torques.size());
  MatrixXd z = MatrixXd::Zero(residual_.size(), torques.empty() ? 0 : torques[0].cols());
  for (size_t a = 0; a < joints.size(); ++a) {
    for (Index k = 0; k < samples(); ++k) {
      z.middleRows(k * dof_, dof_) -= of_torque_[static_cast<size_t>(k)].col(joints[a]) * torques[a].row(k);
    }
  }
  return z;
}

MatrixXd ResidualModel::Remainder(const MatrixXd& z, int passes) const {
  constexpr double kTolerance = 0.02;
  MatrixXd result(z.rows(), z.cols());
  Index kept = 0;
  for (Index a = 0; a < z.cols(); ++a) {
    const double norm = z.col(a).norm();
    if (!(norm > 0.0) || !std::isfinite(norm)) continue;
    VectorXd rest = z.col(a) / norm;
    // Twice is enough (Giraud, Langou & Rozloznik 2005).
    for (int pass = 0; pass < passes; ++pass) {
      rest -= q_ * (q_.transpose() * rest).eval();
      rest -= result.leftCols(kept) * (result.leftCols(kept).transpose() * rest).eval();
    }
    if (rest.norm() < kTolerance) continue;
    result.col(kept++) = rest.normalized();
  }
  return result.leftCols(kept);
}

double ResidualModel::Explained(const MatrixXd& remainder) const {
  return (remainder.transpose() * residual_).squaredNorm();
}

ResidualModel::Score ResidualModel::Test(const MatrixXd& remainder) const {
  Score score;
  score.degrees = static_cast<int>(remainder.cols());
  if (score.degrees == 0) return score;
  const VectorXd sum = remainder.transpose() * residual_;
  const VectorXd rest = residual_ - remainder * sum;
  MatrixXd scores(samples(), remainder.cols());
  VectorXd leverage(samples());
  for (Index k = 0; k < samples(); ++k) {
    const auto rows = remainder.middleRows(k * dof_, dof_);
    scores.row(k) = rest.segment(k * dof_, dof_).transpose() * rows;
    leverage[k] = rows.squaredNorm();
  }
  score.lag = ChooseLag(scores, recordings_);
  const MatrixXd covariance = LongRunCovariance(scores, recordings_, score.lag);
  score.statistic = sum.dot(covariance.ldlt().solve(sum));
  // Of how many pieces, each as long as the correlation lasts, the effect is told.
  double pieces = 0.0;
  for (const auto& [begin, end] : recordings_) {
    for (Index k = begin; k < end; k += score.lag + 1) {
      pieces += std::pow(leverage.segment(k, std::min<Index>(score.lag + 1, end - k)).sum(), 2);
    }
  }
  pieces = std::pow(leverage.sum(), 2) / pieces;
  score.pieces = pieces;
  const double p = score.degrees;
  if (!(score.statistic > 0.0) || !std::isfinite(score.statistic) || pieces <= p + 1.0) return score;
  const double f = score.statistic / p * (pieces - p) / pieces;
  score.p_value = boost::math::cdf(boost::math::complement(boost::math::fisher_f(p, pieces - p), f));
  return score;
}

ResidualModel::HeldOut ResidualModel::CrossValidate(const MatrixXd& remainder) const {
  const Index c = q_.cols(), p = remainder.cols();
  MatrixXd d(q_.rows(), c + p);
  d << q_, remainder;
  const VectorXd all = d.transpose() * residual_;
  HeldOut result;
  result.squares = MatrixXd::Zero(folds_, dof_);
  result.residual.resize(samples(), dof_);
  for (int f = 0; f < folds_; ++f) {
    MatrixXd normal = MatrixXd::Identity(c + p, c + p);
    VectorXd right = all;
    for (Index k = 0; k < samples(); ++k) {
      if (fold_[static_cast<size_t>(k)] != f) continue;
      Index last = k;
      while (last + 1 < samples() && fold_[static_cast<size_t>(last + 1)] == f) ++last;
      const auto rows = d.middleRows(k * dof_, (last - k + 1) * dof_);
      normal.noalias() -= rows.transpose() * rows;
      right -= rows.transpose() * residual_.segment(k * dof_, (last - k + 1) * dof_);
      k = last;
    }
    const VectorXd move = normal.ldlt().solve(right);
    for (Index k = 0; k < samples(); ++k) {
      if (fold_[static_cast<size_t>(k)] != f) continue;
      const VectorXd rest = residual_.segment(k * dof_, dof_) - d.middleRows(k * dof_, dof_) * move;
      result.squares.row(f) += rest.cwiseAbs2().transpose();
      result.residual.row(k) = to_torque_[static_cast<size_t>(k)] * rest;
    }
  }
  result.signal = result.residual * drive_.transpose();
  return result;
}

}  // namespace idim
