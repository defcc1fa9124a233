#include "solvers/linear/gain_identification.h"

#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "solvers/linear/least_squares.h"
#include "solvers/linear/signal_noise.h"
#include "solvers/linear/total_least_squares.h"

namespace idim {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

bool IsWeighted(GainEstimator e) {
  return e == GainEstimator::kWls || e == GainEstimator::kWtls || e == GainEstimator::kWgtls;
}
bool IsLeastSquares(GainEstimator e) { return e == GainEstimator::kLs || e == GainEstimator::kWls; }
bool IsGeneralized(GainEstimator e) { return e == GainEstimator::kGtls || e == GainEstimator::kWgtls; }

// Below this part of the torque a residual is rounding, and says nothing about a joint's weight.
constexpr double kRoundingShare = 1e-8;

// One system of rows solved with, from joint factors divided by row_sigma.
class Solver {
 public:
  Solver(const GainSystem& system, const GainOptions& options, const MatrixXd& joint_noise, const VectorXd& row_sigma)
      : options_(options) {
    TriangularFactor factor(static_cast<int>(system.unknowns.size()) + 1);
    VectorXd squares = VectorXd::Zero(factor.columns());
    for (int j = 0; j < system.dof(); ++j) {
      factor.Merge(system.joints[j], 1.0 / row_sigma[j]);
      if (IsGeneralized(options.estimator)) {
        squares += static_cast<double>(system.joints[j].rows()) * joint_noise.row(j).cwiseAbs2().transpose() /
                   (row_sigma[j] * row_sigma[j]);
      }
    }
    r_ = factor.R();
    rows_ = factor.rows();
    noise_ = (squares / static_cast<double>(rows_)).cwiseSqrt();
  }

  ParameterSolution Solve(const std::vector<int>& kept) {
    const std::int64_t c = static_cast<std::int64_t>(kept.size()) + 1;
    MatrixXd selected = SelectColumns(r_, kept);
    if (IsLeastSquares(options_.estimator)) {
      degrees_of_freedom_ = rows_ - (c - 1);
      selected.col(c - 1) *= -1.0;  // to the other side: W_r x = W_kL chi_kL
      return SolveLeastSquares(selected, degrees_of_freedom_);
    }
    degrees_of_freedom_ = rows_ - c;
    TotalLeastSquaresOptions options;
    options.min_separation = options_.min_separation;
    options.min_last_share = options_.min_last_share;
    if (IsGeneralized(options_.estimator)) {
      options.noise = SelectColumns(noise_.transpose(), kept).transpose();
    }
    tls_ = SolveTotalLeastSquares(selected, rows_, options);
    return tls_.solution;
  }

  const MatrixXd& r() const { return r_; }
  const TotalLeastSquares& tls() const { return tls_; }  // of the last Solve()
  std::int64_t degrees_of_freedom() const { return degrees_of_freedom_; }

 private:
  const GainOptions& options_;
  MatrixXd r_;
  VectorXd noise_;
  std::int64_t rows_ = 0;
  std::int64_t degrees_of_freedom_ = 0;
  TotalLeastSquares tls_;
};

// n x c.
MatrixXd JointNoise(const GainSystem& system, const GainOptions& options) {
  const int n = system.dof();
  const Index c = static_cast<Index>(system.unknowns.size()) + 1;
  if (options.column_noise.size() > 0) {
    CHECK_EQ(options.column_noise.cols(), c);
    CHECK(options.column_noise.rows() == 1 || options.column_noise.rows() == n);
    return options.column_noise.rows() == n ? options.column_noise : options.column_noise.replicate(n, 1);
  }
  MatrixXd noise = MatrixXd::Zero(n, c);
  if (IsGeneralized(options.estimator)) noise.leftCols(n) = SignalNoise(system, options.rank_tolerance);
  return noise;
}

// Of the rows of each joint at x = (values, 1), see the header.
VectorXd RowSigma(const GainSystem& system, const VectorXd& values) {
  const int n = system.dof();
  VectorXd x(values.size() + 1);
  x << values, 1.0;
  double rows = 0.0;
  for (const TriangularFactor& joint : system.joints) rows += static_cast<double>(joint.rows());
  const double freedom = (rows - static_cast<double>(x.size())) / rows;
  VectorXd sigma(n);
  for (int j = 0; j < n; ++j) {
    const MatrixXd r = system.joints[j].R();
    const double torque = (r.leftCols(n) * values.head(n)).norm();
    const double own = static_cast<double>(system.joints[j].rows());
    sigma[j] = std::max((r * x).norm() / std::sqrt(own * freedom), kRoundingShare * torque / std::sqrt(own));
    if (!(sigma[j] > 0.0)) sigma[j] = 1.0;  // a joint without any torque
  }
  return sigma;
}

Status CheckScale(const GainSystem& system, const MatrixXd& r, double rank_tolerance) {
  const Index n = system.dof(), unknowns = static_cast<Index>(system.unknowns.size());
  const double known = r.col(unknowns).norm();
  const Remainder remainder = RemainderOf(r.middleCols(n, unknowns - n), r.col(unknowns), rank_tolerance);
  if (known > 0.0 && remainder.norm > kRoundingShare * known) return Status::Ok();
  return Status::Untrusted(
      "gains have no scale: the torque of the known payload parameters is zero, or is one that the arm's own or "
      "unknown "
      "payload parameters make as well. Likely causes: every recording carries the same payload; only parameters "
      "without effect are known. Record one trajectory without the payload, and weigh it");
}

std::string DefectMessage(const GainSystem& system, const std::vector<int>& kept, const TotalLeastSquares& tls) {
  const auto names = [&](const VectorXd& share) {
    std::string text;
    for (Index k = 0; k < share.size(); ++k) {
      if (share[k] < 0.1 * share.maxCoeff()) continue;
      const std::string name = k + 1 < share.size() ? system.unknowns[kept[k]].name : "the known payload";
      text += (text.empty() ? "" : ", ") + name;
    }
    return text;
  };
  char number[32];
  if (tls.defect == TlsDefect::kNongeneric) {
    std::snprintf(number, sizeof(number), "%.2g", tls.last_share);
    return std::string(
               "degenerate total least squares: the last component of the singular vector is near zero (its "
               "share of the torque is ") +
           number +
           "), so that the known payload gives no scale. Use a heavier payload, faster motion, or an estimator that "
           "knows the noise of each column (gtls)";
  }
  std::snprintf(number, sizeof(number), "%.3g", tls.separation);
  return std::string("degenerate total least squares: the two smallest singular values are not separated (ratio ") +
         number + "), so that noise decides between the solution and a mixture of " + names(tls.weak_direction) +
         ". Excite these parameters more, or use an estimator that knows the noise of each column (gtls)";
}

// Gains that no one should use, or Ok.
Status CheckGains(const GainSystem& system, const GainSummary& summary) {
  std::string why = ReasonsAgainstGains(summary.values.head(system.dof()), summary.covariance, system.a_priori_gains,
                                        summary.given.max_spread_percent);
  char text[160];
  for (const GainVerdict& verdict : summary.verdicts) {
    // What knows the noise of each column has corrected for it.
    if (IsGeneralized(summary.given.estimator) || verdict.reliability >= summary.given.min_reliability) continue;
    std::snprintf(text, sizeof(text), "%s = %.4g rests on a signal of reliability %.2g, below %.2g",
                  verdict.name.c_str(), summary.values[verdict.joint - 1], verdict.reliability,
                  summary.given.min_reliability);
    why += (why.empty() ? "" : "; ") + std::string(text);
  }
  if (why.empty()) return Status::Ok();
  why = "gains that cannot be trusted: " + why;
  std::string verdicts;
  for (const GainVerdict& verdict : summary.verdicts) {
    if (verdict.strength == GainStrength::kStrong || why.find(verdict.name + " = ") == std::string::npos) continue;
    verdicts += " " + verdict.sentence;
  }
  if (!verdicts.empty()) why += "." + verdicts;
  return Status::Untrusted(why);
}

}  // namespace

const char* GainEstimatorName(GainEstimator estimator) {
  static constexpr const char* kNames[] = {"ls", "wls", "tls", "wtls", "gtls", "wgtls"};
  return kNames[static_cast<int>(estimator)];
}

bool GainOptions::IsValid(std::string* error) const {
  if (!IsValidEssentialRatio(essential_ratio, error) || !IsValidRankTolerance(rank_tolerance, error)) return false;
  if (weight_iterations < 1) {
    *error = "weight_iterations is " + std::to_string(weight_iterations) + "; expected at least 1";
    return false;
  }
  if (!(max_spread_percent > 0.0)) {
    *error = "max_spread_percent is " + std::to_string(max_spread_percent) + "; expected a number above 0";
    return false;
  }
  if (!(min_reliability >= 0.0 && min_reliability < 1.0)) {
    *error = "min_reliability is " + std::to_string(min_reliability) + "; expected a number in [0, 1)";
    return false;
  }
  TotalLeastSquaresOptions tls;
  tls.noise = column_noise.size() > 0 ? VectorXd(column_noise.colwise().maxCoeff()) : VectorXd();
  if (column_noise.size() > 0 && !(column_noise.array() >= 0.0).all()) tls.noise[0] = -1.0;
  tls.min_separation = min_separation;
  tls.min_last_share = min_last_share;
  return tls.IsValid(error);
}

double GainSummary::RelativeSigmaPercent(int unknown) const {
  return 100.0 * std::sqrt(covariance(unknown, unknown)) / std::abs(values[unknown]);
}

GainSummary SolveGains(const GainSystem& system, const GainOptions& options) {
  std::string error;
  CHECK(options.IsValid(&error)) << error;
  const int n = system.dof();
  const int unknowns = static_cast<int>(system.unknowns.size());
  GainSummary summary;
  summary.given = options;
  summary.joint_sigma = VectorXd::Ones(n);
  TriangularFactor plain(unknowns + 1);
  for (const TriangularFactor& joint : system.joints) plain.Merge(joint);
  summary.rows = plain.rows();
  if (summary.rows <= unknowns + 1) {
    summary.status = Status::Untrusted("not identifiable: " + std::to_string(summary.rows) + " equations for " +
                                       std::to_string(unknowns) + " unknowns. Record longer, or decimate less");
    return summary;
  }
  const MatrixXd r_plain = plain.R();
  std::vector<int> all(unknowns);
  std::iota(all.begin(), all.end(), 0);
  summary.status = CheckScale(system, r_plain, options.rank_tolerance);
  if (!summary.status.ok()) return summary;
  summary.status = DiagnoseRank(r_plain.leftCols(unknowns), all, system.unknowns, options.rank_tolerance);
  if (!summary.status.ok()) return summary;

  summary.verdicts = JudgeGains(system, options.rank_tolerance);

  const MatrixXd joint_noise = JointNoise(system, options);
  for (int k = 0; IsWeighted(options.estimator) && k < options.weight_iterations; ++k) {
    Solver solver(system, options, joint_noise, summary.joint_sigma);
    const ParameterSolution solution = solver.Solve(all);
    if (solution.values.size() == 0) {
      summary.status = Status::Untrusted(DefectMessage(system, all, solver.tls()));
      return summary;
    }
    summary.joint_sigma = RowSigma(system, solution.values);
  }

  Solver solver(system, options, joint_noise, summary.joint_sigma);
  const Essential essential = EliminateInessential(
      system.unknowns, options.essential_ratio,
      [](const Parameter& parameter) {
        return parameter.kind == ParameterKind::kDriveGain || IsOfEffect(parameter.kind);
      },
      [&](const std::vector<int>& kept) { return solver.Solve(kept); });
  summary.eliminated = essential.eliminated;
  summary.degrees_of_freedom = solver.degrees_of_freedom();
  if (!IsLeastSquares(options.estimator)) {
    const TotalLeastSquares& tls = solver.tls();
    summary.singular_values = tls.singular_values;
    summary.separation = tls.separation;
    summary.last_share = tls.last_share;
    summary.scale_significance = tls.scale_significance;
    if (!tls.ok()) summary.status = Status::Untrusted(DefectMessage(system, essential.kept, tls));
  }
  if (essential.solution.values.size() == 0) return summary;

  const ParameterSolution solution = ScatterSolution(essential.solution, essential.kept, unknowns);
  summary.values = solution.values;
  summary.covariance = solution.covariance;
  summary.sigma = solution.sigma;
  const Index c = essential.solution.values.size();
  summary.condition_number = ConditionNumber(SelectColumns(r_plain, essential.kept).leftCols(c));
  summary.condition_number_solved = ConditionNumber(SelectColumns(solver.r(), essential.kept).leftCols(c));
  VectorXd x(unknowns + 1);
  x << summary.values, 1.0;
  summary.relative_residual = (r_plain * x).norm() / (r_plain.leftCols(n) * x.head(n)).norm();
  if (summary.status.ok()) summary.status = CheckGains(system, summary);
  return summary;
}

}  // namespace idim
