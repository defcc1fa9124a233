#include "solvers/linear/least_squares.h"

#include <glog/logging.h>

#include <Eigen/QR>
#include <Eigen/SVD>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/base/decompositions.h"

namespace idim {

using Eigen::MatrixXd;
using Eigen::VectorXd;

ParameterSolution SolveLeastSquares(const MatrixXd& r, std::int64_t degrees_of_freedom) {
  const Eigen::Index c = r.cols() - 1;
  const VectorXd scales = ColumnScales(r.leftCols(c));
  const Eigen::HouseholderQR<MatrixXd> qr(r.leftCols(c) * scales.cwiseInverse().asDiagonal());
  const VectorXd projected = qr.householderQ().transpose() * r.col(c);
  const auto triangle = qr.matrixQR().topRows(c).triangularView<Eigen::Upper>();
  ParameterSolution solution;
  solution.values = triangle.solve(projected.head(c)).cwiseQuotient(scales);
  solution.sigma = projected.tail(r.rows() - c).norm() / std::sqrt(static_cast<double>(degrees_of_freedom));
  const MatrixXd inverse = scales.cwiseInverse().asDiagonal() * MatrixXd(triangle.solve(MatrixXd::Identity(c, c)));
  solution.covariance = solution.sigma * solution.sigma * inverse * inverse.transpose();
  return solution;
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

MatrixXd SelectColumns(const MatrixXd& r, const std::vector<int>& kept) {
  MatrixXd selected(r.rows(), kept.size() + 1);
  for (size_t k = 0; k < kept.size(); ++k) selected.col(k) = r.col(kept[k]);
  selected.col(kept.size()) = r.col(r.cols() - 1);
  return selected;
}

Remainder RemainderOf(const MatrixXd& others, const VectorXd& column, double rank_tolerance) {
  Eigen::ColPivHouseholderQR<MatrixXd> qr(others * ColumnScales(others).cwiseInverse().asDiagonal());
  qr.setThreshold(rank_tolerance);
  const VectorXd projected = qr.householderQ().transpose() * column;
  const int rank = static_cast<int>(qr.rank());
  return {projected.tail(others.rows() - rank).norm(), rank};
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

Essential EliminateInessential(const std::vector<Parameter>& unknowns, double ratio,
                               const std::function<bool(const Parameter&)>& protect,
                               const std::function<ParameterSolution(const std::vector<int>& kept)>& solve) {
  Essential essential;
  essential.kept.resize(unknowns.size());
  std::iota(essential.kept.begin(), essential.kept.end(), 0);
  while (true) {
    essential.solution = solve(essential.kept);
    const ParameterSolution& solution = essential.solution;
    if (ratio == 0.0 || solution.values.size() < 2) return essential;
    const VectorXd relative = solution.covariance.diagonal().cwiseSqrt().cwiseQuotient(solution.values.cwiseAbs());
    if (relative.maxCoeff() < ratio * relative.minCoeff()) return essential;
    Eigen::Index worst = -1;
    for (Eigen::Index k = 0; k < relative.size(); ++k) {
      if (protect(unknowns[essential.kept[k]])) continue;
      if (worst < 0 || relative[k] > relative[worst]) worst = k;
    }
    if (worst < 0 || relative[worst] < ratio * relative.minCoeff()) return essential;
    essential.eliminated.push_back(unknowns[essential.kept[worst]].name);
    essential.kept.erase(essential.kept.begin() + worst);
  }
}

ParameterSolution ScatterSolution(const ParameterSolution& solution, const std::vector<int>& kept, int unknowns) {
  ParameterSolution all;
  all.sigma = solution.sigma;
  all.values = VectorXd::Zero(unknowns);
  all.covariance = MatrixXd::Zero(unknowns, unknowns);
  for (size_t a = 0; a < kept.size(); ++a) {
    all.values[kept[a]] = solution.values[a];
    for (size_t b = 0; b < kept.size(); ++b) all.covariance(kept[a], kept[b]) = solution.covariance(a, b);
  }
  return all;
}

bool IsValidEssentialRatio(double ratio, std::string* error) {
  if (ratio == 0.0 || (ratio > 1.0 && std::isfinite(ratio))) return true;
  *error = "essential_ratio is " + std::to_string(ratio) + "; expected 0 (keep all) or a number above 1";
  return false;
}

bool IsValidRankTolerance(double tolerance, std::string* error) {
  if (tolerance > 0.0 && tolerance < 1.0) return true;
  *error = "rank_tolerance is " + std::to_string(tolerance) + "; expected a number in (0, 1)";
  return false;
}

}  // namespace idim
