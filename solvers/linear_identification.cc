#include "solvers/linear_identification.h"

#include <glog/logging.h>

#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>

namespace idim {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Columns `kept` of the left part of r, and the last column.
MatrixXd Select(const MatrixXd& r, const std::vector<int>& kept) {
  MatrixXd selected(r.rows(), kept.size() + 1);
  for (size_t k = 0; k < kept.size(); ++k) selected.col(k) = r.col(kept[k]);
  selected.col(kept.size()) = r.col(r.cols() - 1);
  return selected;
}

VectorXd ColumnScales(const MatrixXd& w) {
  VectorXd scales = w.colwise().norm();
  for (double& s : scales) s = s > 0.0 ? s : 1.0;
  return scales;
}

double ConditionNumber(const MatrixXd& w) {
  const VectorXd s = Eigen::JacobiSVD<MatrixXd>(w).singularValues();
  return s[s.size() - 1] > 0.0 ? s[0] / s[s.size() - 1] : std::numeric_limits<double>::infinity();
}

// Standard deviation of the residual of one joint's equations alone, whose columns need not be independent.
double OwnSigma(const TriangularFactor& joint, double rank_tolerance) {
  const MatrixXd r = joint.R();
  const int c = static_cast<int>(r.cols()) - 1;
  const VectorXd scales = ColumnScales(r.leftCols(c));
  Eigen::ColPivHouseholderQR<MatrixXd> qr(r.leftCols(c) * scales.cwiseInverse().asDiagonal());
  qr.setThreshold(rank_tolerance);
  const VectorXd projected = qr.householderQ().transpose() * r.col(c);
  const double rest = projected.tail(r.rows() - qr.rank()).norm();
  return rest / std::sqrt(std::max<double>(1.0, static_cast<double>(joint.rows() - qr.rank())));
}

Status DiagnoseRank(const MatrixXd& w, const std::vector<int>& kept, const std::vector<Parameter>& unknowns,
                    double tolerance) {
  std::string blind;
  int directions = 0;
  for (size_t k = 0; k < kept.size(); ++k) {
    if (w.col(k).norm() > 0.0) continue;
    blind += (blind.empty() ? "" : "; ") + unknowns[kept[k]].name;
    ++directions;
  }
  if (directions == 0) {
    const Eigen::JacobiSVD<MatrixXd> svd(w * ColumnScales(w).cwiseInverse().asDiagonal(), Eigen::ComputeThinV);
    const VectorXd& s = svd.singularValues();
    for (Eigen::Index d = 0; d < s.size(); ++d) {
      if (s[d] > tolerance * s[0]) continue;
      ++directions;
      const VectorXd v = svd.matrixV().col(d).cwiseAbs();
      std::string names;
      for (Eigen::Index k = 0; k < v.size(); ++k) {
        if (v[k] > 0.05 * v.maxCoeff()) names += (names.empty() ? "" : " + ") + unknowns[kept[k]].name;
      }
      blind += (blind.empty() ? "" : "; ") + names;
    }
  }
  if (directions == 0) return Status::Ok();
  return Status::Untrusted(
      "not identifiable: the recorded motion leaves " + std::to_string(directions) +
      (directions == 1 ? " direction" : " directions") + " of the parameters without effect on any torque: " + blind +
      ". Likely causes: a joint that hardly moves, motion at one speed only, a payload without a recording that lacks "
      "it. Record motion that excites them, or leave them out (friction, payloads) of the study");
}

struct Solution {
  VectorXd values;
  MatrixXd covariance;
  double sigma = 0.0;
};

// r: triangular or not, its last column the right-hand side; full column rank.
Solution LeastSquares(const MatrixXd& r, std::int64_t degrees_of_freedom) {
  const Eigen::Index c = r.cols() - 1;
  const VectorXd scales = ColumnScales(r.leftCols(c));
  const Eigen::HouseholderQR<MatrixXd> qr(r.leftCols(c) * scales.cwiseInverse().asDiagonal());
  const VectorXd projected = qr.householderQ().transpose() * r.col(c);
  const auto triangle = qr.matrixQR().topRows(c).triangularView<Eigen::Upper>();
  Solution solution;
  solution.values = triangle.solve(projected.head(c)).cwiseQuotient(scales);
  solution.sigma = projected.tail(r.rows() - c).norm() / std::sqrt(static_cast<double>(degrees_of_freedom));
  const MatrixXd inverse = scales.cwiseInverse().asDiagonal() * MatrixXd(triangle.solve(MatrixXd::Identity(c, c)));
  solution.covariance = solution.sigma * solution.sigma * inverse * inverse.transpose();
  return solution;
}

}  // namespace

bool LinearOptions::IsValid(std::string* error) const {
  if (essential_ratio != 0.0 && !(essential_ratio > 1.0 && std::isfinite(essential_ratio))) {
    *error = "essential_ratio is " + std::to_string(essential_ratio) + "; expected 0 (keep all) or a number above 1";
    return false;
  }
  if (!(rank_tolerance > 0.0 && rank_tolerance < 1.0)) {
    *error = "rank_tolerance is " + std::to_string(rank_tolerance) + "; expected a number in (0, 1)";
    return false;
  }
  if (a_priori_sigma.size() > 0 && !(a_priori_sigma.array() > 0.0).all()) {
    *error = "a_priori_sigma has an entry that is not positive; expected standard deviations in N m";
    return false;
  }
  return true;
}

double LinearSummary::RelativeSigmaPercent(int unknown) const {
  return 100.0 * std::sqrt(covariance(unknown, unknown)) / std::abs(values[unknown]);
}

LinearSummary SolveLinear(const LinearSystem& system, const LinearOptions& options) {
  std::string error;
  CHECK(options.IsValid(&error)) << error;
  const int n = static_cast<int>(system.joints.size());
  const int unknowns = static_cast<int>(system.unknowns.size());
  LinearSummary summary;
  summary.given = options;

  summary.joint_sigma.resize(n);
  for (int j = 0; j < n; ++j) {
    summary.joint_sigma[j] = options.a_priori_sigma.size() > 0 ? options.a_priori_sigma[j]
                                                               : OwnSigma(system.joints[j], options.rank_tolerance);
  }
  // Data without noise leave residuals of rounding's size, which say nothing about a joint's weight.
  const double floor = 1e-12 * summary.joint_sigma.maxCoeff();
  TriangularFactor plain(unknowns + 1), weighted(unknowns + 1);
  for (int j = 0; j < n; ++j) {
    plain.Merge(system.joints[j]);
    const double sigma = std::max(summary.joint_sigma[j], floor);
    weighted.Merge(system.joints[j], options.weighted && sigma > 0.0 ? 1.0 / sigma : 1.0);
  }
  summary.rows = plain.rows();
  const MatrixXd r_plain = plain.R();
  const MatrixXd r = weighted.R();

  std::vector<int> kept(unknowns);
  for (int k = 0; k < unknowns; ++k) kept[k] = k;
  if (summary.rows <= unknowns) {
    summary.status = Status::Untrusted("not identifiable: " + std::to_string(summary.rows) + " equations for " +
                                       std::to_string(unknowns) + " unknowns. Record longer, or decimate less");
    return summary;
  }
  summary.status = DiagnoseRank(r.leftCols(unknowns), kept, system.unknowns, options.rank_tolerance);
  if (!summary.status.ok()) return summary;

  Solution solution;
  while (true) {
    summary.degrees_of_freedom = summary.rows - static_cast<std::int64_t>(kept.size());
    solution = LeastSquares(Select(r, kept), summary.degrees_of_freedom);
    if (options.essential_ratio == 0.0 || kept.size() == 1) break;
    const VectorXd relative = solution.covariance.diagonal().cwiseSqrt().cwiseQuotient(solution.values.cwiseAbs());
    Eigen::Index worst = 0;
    if (relative.maxCoeff(&worst) < options.essential_ratio * relative.minCoeff()) break;
    summary.eliminated.push_back(system.unknowns[kept[worst]].name);
    kept.erase(kept.begin() + worst);
  }

  const Eigen::Index c = static_cast<Eigen::Index>(kept.size());
  const MatrixXd w_plain = Select(r_plain, kept);
  summary.condition_number = ConditionNumber(w_plain.leftCols(c));
  summary.condition_number_solved = ConditionNumber(Select(r, kept).leftCols(c));
  summary.sigma = solution.sigma;
  summary.values = VectorXd::Zero(unknowns);
  summary.covariance = MatrixXd::Zero(unknowns, unknowns);
  for (Eigen::Index a = 0; a < c; ++a) {
    summary.values[kept[a]] = solution.values[a];
    for (Eigen::Index b = 0; b < c; ++b) summary.covariance(kept[a], kept[b]) = solution.covariance(a, b);
  }
  return summary;
}

}  // namespace idim
