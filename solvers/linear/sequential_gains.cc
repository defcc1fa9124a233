#include "solvers/linear/sequential_gains.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "core/base/decompositions.h"
#include "solvers/linear/least_squares.h"

namespace idim {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// What others leave of a column, relative to its norm, above which an equation determines the column's parameter.
constexpr double kDetermined = 1e-6;

struct Coefficient {
  double value = 0.0;
  double standard_deviation = 0.0;
};

// Of column k in the least squares of a x = b; nothing where the other columns can imitate it.
std::optional<Coefficient> Determine(const MatrixXd& a, const VectorXd& b, Index k, double rows,
                                     double rank_tolerance) {
  MatrixXd others(a.rows(), a.cols() - 1);
  others << a.leftCols(k), a.rightCols(a.cols() - 1 - k);
  Eigen::ColPivHouseholderQR<MatrixXd> qr(others * ColumnScales(others).cwiseInverse().asDiagonal());
  qr.setThreshold(rank_tolerance);
  MatrixXd remainder(a.rows(), 2);
  remainder << a.col(k), b;
  remainder = (qr.householderQ().transpose() * remainder).bottomRows(a.rows() - qr.rank()).eval();
  const double norm_left = remainder.col(0).norm();
  if (!(norm_left > kDetermined * a.col(k).norm())) return std::nullopt;
  Coefficient c;
  c.value = remainder.col(0).dot(remainder.col(1)) / (norm_left * norm_left);
  const double freedom = std::max(1.0, rows - static_cast<double>(qr.rank()) - 1.0);
  c.standard_deviation = (remainder.col(1) - c.value * remainder.col(0)).norm() / std::sqrt(freedom) / norm_left;
  return c;
}

}  // namespace

SequentialGains SolveSequentialGains(const GainSystem& system, double rank_tolerance) {
  const int n = system.dof();
  const int unknowns = static_cast<int>(system.unknowns.size());
  std::vector<std::optional<Coefficient>> payload(unknowns);  // the best found so far
  SequentialGains result;
  result.gains = result.standard_deviation = VectorXd::Constant(n, std::numeric_limits<double>::quiet_NaN());

  // False where the joint's equation holds nothing known, or does not determine its gain.
  const auto visit = [&](int j, bool take_over) {
    const MatrixXd r = system.joints[j].R();
    VectorXd known = -r.col(unknowns);
    std::vector<int> columns;
    Index gains = 0;
    for (int k = 0; k < unknowns; ++k) {
      if (take_over && payload[k]) {
        known -= payload[k]->value * r.col(k);
      } else if (r.col(k).norm() > 0.0) {
        columns.push_back(k);
        gains += k < n;
      }
    }
    const auto own = std::find(columns.begin(), columns.end(), j);
    if (own == columns.end()) return false;
    const MatrixXd a = SelectColumns(r, columns).leftCols(static_cast<Index>(columns.size()));
    const Remainder remainder = RemainderOf(a.rightCols(a.cols() - gains), known, rank_tolerance);
    if (!(remainder.norm > kDetermined * known.norm())) return false;
    const double rows = static_cast<double>(system.joints[j].rows());
    const std::optional<Coefficient> gain = Determine(a, known, own - columns.begin(), rows, rank_tolerance);
    if (!gain) return false;
    result.gains[j] = gain->value;
    result.standard_deviation[j] = gain->standard_deviation;
    result.order.push_back(j);
    for (size_t k = 0; k < columns.size(); ++k) {
      if (system.unknowns[columns[k]].kind != ParameterKind::kPayload) continue;
      const std::optional<Coefficient> found = Determine(a, known, static_cast<Index>(k), rows, rank_tolerance);
      std::optional<Coefficient>& best = payload[columns[k]];
      if (found && (!best || found->standard_deviation < best->standard_deviation)) best = found;
    }
    return true;
  };
  std::vector<bool> done(n, false);
  for (int j = 0; j < n; ++j) done[j] = visit(j, false);
  for (bool progress = true; progress;) {
    progress = false;
    for (int j = 0; j < n; ++j) {
      if (done[j] || !visit(j, true)) continue;
      done[j] = progress = true;
      result.after_others.push_back(j);
    }
  }

  std::string missing;
  for (int j = 0; j < n; ++j) {
    if (!done[j]) missing += (missing.empty() ? "" : ", ") + system.unknowns[j].name;
  }
  result.status = missing.empty() ? Status::Ok()
                                  : Status::Untrusted("sequential identification finds no " + missing +
                                                      ": the equation of that joint alone holds nothing known of the "
                                                      "payload. Identify all joints at once");
  return result;
}

}  // namespace idim
