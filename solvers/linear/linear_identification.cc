#include "solvers/linear/linear_identification.h"

#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "solvers/linear/least_squares.h"

namespace idim {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Standard deviation of the residual of one joint's equations alone, whose columns need not be independent.
double OwnSigma(const TriangularFactor& joint, double rank_tolerance) {
  const MatrixXd r = joint.R();
  const Eigen::Index c = r.cols() - 1;
  const Remainder remainder = RemainderOf(r.leftCols(c), r.col(c), rank_tolerance);
  return remainder.norm / std::sqrt(std::max<double>(1.0, static_cast<double>(joint.rows() - remainder.rank)));
}

}  // namespace

bool LinearOptions::IsValid(std::string* error) const {
  if (!IsValidEssentialRatio(essential_ratio, error) || !IsValidRankTolerance(rank_tolerance, error)) return false;
  if (a_priori_sigma.size() > 0 && !(a_priori_sigma.array() > 0.0).all()) {
    *error = "a_priori_sigma has an entry that is not positive; expected standard deviations in N.m or N";
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
  std::iota(kept.begin(), kept.end(), 0);
  if (summary.rows <= unknowns) {
    summary.status = Status::Untrusted("not identifiable: " + std::to_string(summary.rows) + " equations for " +
                                       std::to_string(unknowns) + " unknowns. Record longer, or decimate less");
    return summary;
  }
  summary.status = DiagnoseRank(r.leftCols(unknowns), kept, system.unknowns, options.rank_tolerance);
  if (!summary.status.ok()) return summary;

  const Essential essential = EliminateInessential(
      system.unknowns, options.essential_ratio, [](const Parameter& parameter) { return IsOfEffect(parameter.kind); },
      [&](const std::vector<int>& columns) {
        return SolveLeastSquares(SelectColumns(r, columns), summary.rows - static_cast<std::int64_t>(columns.size()));
      });
  summary.eliminated = essential.eliminated;
  summary.sigma = essential.solution.sigma;
  const Eigen::Index c = essential.solution.values.size();
  summary.degrees_of_freedom = summary.rows - c;
  const MatrixXd w_plain = SelectColumns(r_plain, essential.kept);
  summary.condition_number = ConditionNumber(w_plain.leftCols(c));
  summary.condition_number_solved = ConditionNumber(SelectColumns(r, essential.kept).leftCols(c));
  const ParameterSolution all = ScatterSolution(essential.solution, essential.kept, unknowns);
  summary.values = all.values;
  summary.covariance = all.covariance;
  return summary;
}

}  // namespace idim
