#include "solvers/bundle/residual_model.h"

#include <glog/logging.h>

#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <boost/math/distributions/fisher_f.hpp>
#include <cmath>

#include "core/base/decompositions.h"
#include "solvers/linear/least_squares.h"

namespace idim {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// A column of which no more than this is left beside the others is one that they imitate.
constexpr double kImitated = 0.02;

// gram, scores: of columns of unit norm, less what the model's own columns imitate. Cholesky, column by column; one
// that is imitated is left out.
ResidualModel::Explanation Solve(const MatrixXd& gram, const VectorXd& scores) {
  const Index width = scores.size();
  std::vector<Index> kept;
  for (Index a = 0; a < width; ++a) {
    const Index n = static_cast<Index>(kept.size());
    double left = gram(a, a);
    if (n > 0) {
      const VectorXd mixed = gram(kept, a);
      left -= mixed.dot(gram(kept, kept).ldlt().solve(mixed));
    }
    if (left >= kImitated * kImitated) kept.push_back(a);
  }
  ResidualModel::Explanation result;
  result.step = VectorXd::Zero(width);
  if (kept.empty()) return result;
  const VectorXd of_kept = scores(kept);
  const VectorXd step = gram(kept, kept).ldlt().solve(of_kept);
  result.explained = of_kept.dot(step);
  for (size_t k = 0; k < kept.size(); ++k) result.step[kept[k]] = -step[static_cast<Index>(k)];
  return result;
}

}  // namespace

ResidualModel::ResidualModel(const BaseParameters& base, const BundleData& data, const BundleSummary& summary,
                             int folds)
    : dof_(data.dof), recordings_(RecordingsOf(data)), folds_(folds) {
  CHECK(summary.IsSolutionUsable()) << summary.status.message();
  CHECK_GE(folds, 2);
  BundleProblem problem(base, data, data.priors, HuberNorm{});
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
    torque_.row(k) = data.inverse_drive.inverse() * gains.cwiseProduct(data.samples()[static_cast<size_t>(k)].signal);
  }
  SetFolds();
}

void ResidualModel::SetFolds() {
  fold_.resize(static_cast<size_t>(samples()));
  fold_segments_.resize(static_cast<size_t>(folds_));
  for (const auto& [begin, end] : recordings_) {
    for (Index k = begin; k < end; ++k) {
      const auto f = static_cast<size_t>((k - begin) * folds_ / (end - begin));
      fold_[static_cast<size_t>(k)] = static_cast<int>(f);
      SampleRanges& segments = fold_segments_[f];
      if (segments.empty() || segments.back().second != k || k == begin) segments.push_back({k, k});
      segments.back().second = k + 1;
    }
  }
  in_space_ = q_.transpose() * residual_;
  for (const SampleRanges& segments : fold_segments_) {
    MatrixXd normal = MatrixXd::Identity(q_.cols(), q_.cols());
    VectorXd right = in_space_;
    for (const auto& [begin, end] : segments) {
      const auto rows = q_.middleRows(begin * dof_, (end - begin) * dof_);
      normal.noalias() -= rows.transpose() * rows;
      right -= rows.transpose() * residual_.segment(begin * dof_, (end - begin) * dof_);
    }
    fold_normal_.push_back(normal.ldlt());
    fold_right_.push_back(std::move(right));
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
  MatrixXd result(z.rows(), z.cols());
  Index kept = 0;
  for (Index a = 0; a < z.cols(); ++a) {
    const double norm = z.col(a).norm();
    if (!(norm > 0.0) || !std::isfinite(norm)) continue;
    VectorXd left = z.col(a) / norm;
    // Twice is enough (Giraud, Langou & Rozloznik 2005).
    for (int pass = 0; pass < passes; ++pass) {
      left -= q_ * (q_.transpose() * left).eval();
      left -= result.leftCols(kept) * (result.leftCols(kept).transpose() * left).eval();
    }
    if (left.norm() < kImitated) continue;
    result.col(kept++) = left.normalized();
  }
  return result.leftCols(kept);
}

double ResidualModel::Explained(const MatrixXd& remainder) const {
  return (remainder.transpose() * residual_).squaredNorm();
}

std::vector<ResidualModel::Explanation> ResidualModel::Explain(const MatrixXd& z, Index width) const {
  CHECK_GT(width, 0);
  CHECK_EQ(z.cols() % width, 0);
  const MatrixXd in_space = q_.transpose() * z;
  const VectorXd scores = z.transpose() * residual_ - in_space.transpose() * in_space_;
  std::vector<Explanation> result;
  for (Index first = 0; first < z.cols(); first += width) {
    const auto columns = z.middleCols(first, width);
    const auto imitated = in_space.middleCols(first, width);
    VectorXd scale = columns.colwise().norm().transpose();
    for (double& norm : scale) norm = norm > 0.0 && std::isfinite(norm) ? 1.0 / norm : 0.0;
    const MatrixXd gram =
        scale.asDiagonal() * (columns.transpose() * columns - imitated.transpose() * imitated) * scale.asDiagonal();
    result.push_back(Solve(gram, scale.cwiseProduct(scores.segment(first, width))));
    result.back().step.array() *= scale.array();
  }
  return result;
}

ResidualModel::Score ResidualModel::Test(const MatrixXd& remainder) const {
  Score score;
  score.degrees = static_cast<int>(remainder.cols());
  if (score.degrees == 0) return score;
  const VectorXd sum = remainder.transpose() * residual_;
  const VectorXd left = residual_ - remainder * sum;
  MatrixXd scores(samples(), remainder.cols());
  VectorXd leverage(samples());
  for (Index k = 0; k < samples(); ++k) {
    const auto rows = remainder.middleRows(k * dof_, dof_);
    scores.row(k) = left.segment(k * dof_, dof_).transpose() * rows;
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
  const VectorXd explained = remainder.transpose() * residual_;
  HeldOut result;
  result.squares = MatrixXd::Zero(folds_, dof_);
  result.residual.resize(samples(), dof_);
  for (int f = 0; f < folds_; ++f) {
    const SampleRanges& segments = fold_segments_[static_cast<size_t>(f)];
    const Eigen::LDLT<MatrixXd>& normal = fold_normal_[static_cast<size_t>(f)];
    VectorXd move = normal.solve(fold_right_[static_cast<size_t>(f)]), move_extra(p);
    // The unknowns are eliminated before the extra columns (Schur complement).
    if (p > 0) {
      MatrixXd mixed = MatrixXd::Zero(c, p), extra = MatrixXd::Identity(p, p);
      VectorXd right = explained;
      for (const auto& [begin, end] : segments) {
        const auto q = q_.middleRows(begin * dof_, (end - begin) * dof_);
        const auto z = remainder.middleRows(begin * dof_, (end - begin) * dof_);
        mixed.noalias() -= q.transpose() * z;
        extra.noalias() -= z.transpose() * z;
        right -= z.transpose() * residual_.segment(begin * dof_, (end - begin) * dof_);
      }
      const MatrixXd eliminated = normal.solve(mixed);
      move_extra = (extra - mixed.transpose() * eliminated).ldlt().solve(right - mixed.transpose() * move);
      move -= eliminated * move_extra;
    }
    for (const auto& [begin, end] : segments) {
      VectorXd left = residual_.segment(begin * dof_, (end - begin) * dof_) -
                      q_.middleRows(begin * dof_, (end - begin) * dof_) * move;
      if (p > 0) left.noalias() -= remainder.middleRows(begin * dof_, (end - begin) * dof_) * move_extra;
      for (Index k = begin; k < end; ++k) {
        const auto of_sample = left.segment((k - begin) * dof_, dof_);
        result.squares.row(f) += of_sample.cwiseAbs2().transpose();
        result.residual.row(k) = to_torque_[static_cast<size_t>(k)] * of_sample;
      }
    }
  }
  result.signal = result.residual * drive_.transpose();
  return result;
}

}  // namespace idim
