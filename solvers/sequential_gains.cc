#include "solvers/sequential_gains.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "solvers/least_squares.h"

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
  MatrixXd rest(a.rows(), 2);
  rest << a.col(k), b;
  rest = (qr.householderQ().transpose() * rest).bottomRows(a.rows() - qr.rank()).eval();
  const double left = rest.col(0).norm();
  if (!(left > kDetermined * a.col(k).norm())) return std::nullopt;
  Coefficient c;
  c.value = rest.col(0).dot(rest.col(1)) / (left * left);
  const double freedom = std::max(1.0, rows - static_cast<double>(qr.rank()) - 1.0);
  c.standard_deviation = (rest.col(1) - c.value * rest.col(0)).norm() / std::sqrt(freedom) / left;
  return c;
}

}  // namespace

SequentialGains SolveSequentialGains(const GainSystem& system, double rank_tolerance) {
  const int n = system.dof();
  const int unknowns = static_cast<int>(system.unknowns.size());
  std::vector<std::optional<double>> known(unknowns);
  std::vector<double> passed_values;
  SequentialGains result;
  result.gains = result.standard_deviation = VectorXd::Constant(n, std::numeric_limits<double>::quiet_NaN());

  // False where the joint's equation holds nothing known, or does not determine its gain.
  const auto visit = [&](int j) {
    const MatrixXd r = system.joints[j].R();
    VectorXd b = -r.col(unknowns);
    std::vector<int> columns;
    for (int k = 0; k < unknowns; ++k) {
      if (known[k]) {
        b -= *known[k] * r.col(k);
      } else if (r.col(k).norm() > 0.0) {
        columns.push_back(k);
      }
    }
    const auto own = std::find(columns.begin(), columns.end(), j);
    if (b.norm() == 0.0 || own == columns.end()) return false;
    const MatrixXd a = SelectColumns(r, columns).leftCols(static_cast<Index>(columns.size()));
    const double rows = static_cast<double>(system.joints[j].rows());
    const std::optional<Coefficient> gain = Determine(a, b, own - columns.begin(), rows, rank_tolerance);
    if (!gain) return false;
    result.gains[j] = gain->value;
    result.standard_deviation[j] = gain->standard_deviation;
    result.order.push_back(j);
    known[j] = gain->value;
    for (size_t k = 0; k < columns.size(); ++k) {
      const Parameter& parameter = system.unknowns[columns[k]];
      if (parameter.kind != ParameterKind::kPayload) continue;
      const std::optional<Coefficient> value = Determine(a, b, static_cast<Index>(k), rows, rank_tolerance);
      if (!value) continue;
      known[columns[k]] = value->value;
      result.passed_on.push_back(parameter);
      passed_values.push_back(value->value);
    }
    return true;
  };
  for (bool progress = true; progress;) {
    progress = false;
    for (int j = 0; j < n; ++j) {
      if (!known[j]) progress |= visit(j);
    }
  }

  result.passed_on_values = Eigen::Map<VectorXd>(passed_values.data(), static_cast<Index>(passed_values.size()));
  std::string missing;
  for (int j = 0; j < n; ++j) {
    if (!known[j]) missing += (missing.empty() ? "" : ", ") + system.unknowns[j].name;
  }
  result.status = missing.empty() ? Status::Ok()
                                  : Status::Untrusted("sequential identification finds no " + missing +
                                                      ": the equation of that joint alone holds nothing known of the "
                                                      "payload. Identify all joints at once");
  return result;
}

}  // namespace idim
