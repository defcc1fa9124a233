// Total least squares from a triangular factor: plain, scaled by the noise of each column, with exact columns.
//
// Model: W0 x = 0 with x = (chi, 1), recorded W = W0 + E, the entries of E independent, of standard deviation
// s * noise_k in column k (paper eq. (17), (21); all noise_k = 1 there). Minimiser, with D = diag(noise):
//
//   min |E D^-1|_F  so that  (W - E) x = 0,   i.e.   min  |W x|^2 / |D x|^2.
//
// Columns of noise 0 are exact. They are eliminated by orthogonal reflections first, [W_e W_n] -> [R11 R12; 0 R22];
// what is left is the smallest right singular vector z of R22 D^-1, x_n = D^-1 z, x_e = -R11^-1 R12 x_n (Golub, Hoffman
// & Stewart 1987; Van Huffel & Vandewalle 1991, ch. 3.6 and 10). Noise in the last column only is least squares. The
// matrix R with R'R = W'W serves as well as W: both have the same right singular vectors.
//
// The values are dehomogenised: x / x_last. Statistics, eq. (22) and (23) with general noise:
//   s^2 = s_c^2 / (r - c),   cov(chi) = s^2 |D x|^2 (A'A)^-1,   A the first c - 1 columns of the corrected W
// ((23) has 1 + |chi|^2 for |D x|^2; exact columns reduce it to eq. (10)). To first order in the noise: too small where
// r s^2 is not small beside the square of the smallest singular values of W0.
//
// The estimate is consistent whatever the rows' own variances are, so long as noise_k^2 is proportional to the mean of
// column k's variance over the rows and the errors of two columns are uncorrelated; s and the covariance need (21).
//
// Fails, as a diagnosed result: the two smallest singular values are not separated, so that any direction in their span
// fits as well; or the last component vanishes against the others (nongeneric TLS), so that dividing by it makes noise
// of everything.

#ifndef IDIM_SOLVERS_LINEAR_TOTAL_LEAST_SQUARES_H_
#define IDIM_SOLVERS_LINEAR_TOTAL_LEAST_SQUARES_H_

#include <Eigen/Core>
#include <cstdint>
#include <string>

#include "solvers/linear/least_squares.h"

namespace idim {

struct TotalLeastSquaresOptions {
  // c, relative standard deviation of the entries of each column, >= 0 and not all 0; empty: all equal (plain TLS).
  Eigen::VectorXd noise;
  // The second smallest singular value over the smallest must be above this, >= 1. Ties are 1; a weak direction of the
  // data that noise has filled up comes close to it.
  double min_separation = 1.05;
  // The last column's share |x_c| |w_c| of the largest |x_k| |w_k| must be above this, in [0, 1).
  double min_last_share = 1e-6;

  bool IsValid(std::string* error) const;
};

enum class TlsDefect { kNone, kNotSeparated, kNongeneric };

struct TotalLeastSquares {
  TlsDefect defect = TlsDefect::kNongeneric;
  ParameterSolution solution;       // of the c - 1 first; sigma is s; empty where x_last is zero
  Eigen::VectorXd singular_vector;  // c, unit norm, last component >= 0: x of W x = 0
  // Of R22 D^-1, decreasing: all c of W where there is neither scaling nor an exact column.
  Eigen::VectorXd singular_values;
  double separation = 0.0;  // of the two smallest singular values, inf for s_c = 0 or a single one
  double last_share = 0.0;  // |x_c| |w_c| / max |x_k| |w_k|
  // sqrt((r - c) (s'^2 / s_c^2 - 1)), s' the smallest singular value without the last column: how many standard
  // deviations the scale that the last column gives is away from none. inf for least squares and for s_c = 0.
  double scale_significance = 0.0;
  // |x_k| |w_k| of the second smallest singular vector, relative to its largest: which parameters are confused
  // when the defect is kNotSeparated.
  Eigen::VectorXd weak_direction;

  bool ok() const { return defect == TlsDefect::kNone; }
};

// r: any matrix with R'R = W'W, as many rows as columns at least; rows: of W, more than columns (CHECK). Exact columns
// must be independent of each other (CHECK that R11 has no zero on its diagonal).
TotalLeastSquares SolveTotalLeastSquares(const Eigen::MatrixXd& r, std::int64_t rows,
                                         const TotalLeastSquaresOptions& options = TotalLeastSquaresOptions());

}  // namespace idim

#endif  // IDIM_SOLVERS_LINEAR_TOTAL_LEAST_SQUARES_H_
