// Linear algebra that every estimator of linear parameters shares: least squares from a factor, ranks, elimination.
//
// All of it takes the rows [A | b] through any matrix R with R'R = [A b]'[A b] (core/statistics/triangular_factor.h).
// Columns are scaled to unit norm before they are compared or solved with: parameters come in kg m^2 and N.m alike.

#ifndef IDIM_SOLVERS_LINEAR_LEAST_SQUARES_H_
#define IDIM_SOLVERS_LINEAR_LEAST_SQUARES_H_

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/base/status.h"
#include "core/dynamics/parameters.h"
#include "core/statistics/triangular_factor.h"

namespace idim {

struct ParameterSolution {
  Eigen::VectorXd values;
  Eigen::MatrixXd covariance;
  double sigma = -1.0;  // of a row that was solved with
};

// min |A x - b| with cov = s^2 (A'A)^-1, s^2 = |A x - b|^2 / degrees_of_freedom (paper eq. (7) to (10)).
// r: rows x (c + 1), its last column b; A of full column rank.
ParameterSolution SolveLeastSquares(const Eigen::MatrixXd& r, std::int64_t degrees_of_freedom);

// Norm of each column, 1 where it is zero.
Eigen::VectorXd ColumnScales(const Eigen::MatrixXd& w);

// Largest over smallest singular value, inf where that is zero.
double ConditionNumber(const Eigen::MatrixXd& w);

// Columns `kept` of r, then its last column.
Eigen::MatrixXd SelectColumns(const Eigen::MatrixXd& r, const std::vector<int>& kept);

// What a column is left with once everything that other columns can imitate is taken out of it.
struct Remainder {
  double norm = 0.0;
  int rank = 0;  // of the other columns, which need not be independent
};
Remainder RemainderOf(const Eigen::MatrixXd& others, const Eigen::VectorXd& column, double rank_tolerance);

// Ok where the columns of w are independent, else Untrusted with the parameters of each direction that the data do not
// see. unknowns[kept[k]] names column k.
Status DiagnoseRank(const Eigen::MatrixXd& w, const std::vector<int>& kept, const std::vector<Parameter>& unknowns,
                    double tolerance);

// Essential parameters (paper IV.B): cancels the parameter with the largest relative standard deviation and solves the
// rest again, until max / min of the relative standard deviations is below `ratio` (0: at once). Parameters for which
// `protect` says so count in max / min but are never cancelled (gains, without which there is no torque; effects,
// which the study declares, and of which the step of a shape is about zero).
struct Essential {
  std::vector<int> kept;                // among all, increasing
  std::vector<std::string> eliminated;  // in order of elimination
  ParameterSolution solution;           // of `kept`
};
Essential EliminateInessential(const std::vector<Parameter>& unknowns, double ratio,
                               const std::function<bool(const Parameter&)>& protect,
                               const std::function<ParameterSolution(const std::vector<int>& kept)>& solve);

// The values and covariance of `kept` among `unknowns` parameters, zero elsewhere.
ParameterSolution ScatterSolution(const ParameterSolution& solution, const std::vector<int>& kept, int unknowns);

// False with a sentence in *error unless 0 (keep all) or above 1.
bool IsValidEssentialRatio(double ratio, std::string* error);
bool IsValidRankTolerance(double tolerance, std::string* error);

}  // namespace idim

#endif  // IDIM_SOLVERS_LINEAR_LEAST_SQUARES_H_
