// Zero-phase low-pass and exact derivatives of signals whose clock jitters, on the recorded time.
//
// The smoothing spline of order m minimises over functions f
//
//   sum_i w_i (y_i - f(t_i))^2 + lambda int f^(m)(t)^2 dt,       w_i = spacing of sample i [s].        (1)
//
// With w_i the spacing, the sum is the quadrature of int (y - f)^2 dt, whose minimiser has the frequency response
//
//   F(w) / Y(w) = 1 / (1 + lambda w^(2 m)) = 1 / (1 + (w / w_c)^(2 m))    for lambda = w_c^(-2 m),    (2)
//
// the squared magnitude, at zero phase, of a Butterworth filter of order m (M. Unser, T. Blu, "Self-similarity: Part I,
// splines and operators", IEEE TSP 55, 2007; for cubics, m = 2: G. Wahba, "Spline models for observational data", 1990,
// and P. Craven, G. Wahba 1979). So this is the filter of core/signal/butterworth.h on a clock that it cannot handle,
// with the same order and cut-off, and without its bilinear warping: there x = tan(pi f h) / tan(pi f_c h), here f /
// f_c. The derivatives are those of f itself, without the sinc droop of central differences.
//
// f is a spline of degree 2 m - 1 like the exact minimiser, on uniform knots instead of one at each sample (P-splines
// with the exact penalty instead of a difference one: P. H. C. Eilers, B. D. Marx, Statistical Science 11, 1996). With
// `knots_per_period` knots a period of the cut-off the projection changes (2) by less than 1e-3 anywhere (tests halve
// the spacing). Polynomials of degree below m pass unchanged, up to the ends; other signals are distorted within about
// two periods of the cut-off from an end, like any filter's.
//
// The normal matrix A = B' W B + lambda P is banded and positive definite; time is counted in knot spacings, so its
// condition number does not depend on units. Fails (BadInput) where a stretch without samples leaves A singular.

#ifndef IDIM_CORE_SIGNAL_SMOOTHING_SPLINE_H_
#define IDIM_CORE_SIGNAL_SMOOTHING_SPLINE_H_

#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <memory>

#include "core/base/status.h"

namespace idim {

class SmoothingSpline {
 public:
  static constexpr int kMinOrder = 3;  // with 2 the second derivative is only piecewise linear between knots
  static constexpr int kMaxOrder = 6;
  static constexpr int kMaxSupport = 2 * kMaxOrder;

  // t: N >= 2 order strictly increasing instants [s]; order m in [kMinOrder, kMaxOrder]; cutoff_hz > 0;
  // knots_per_period >= 4 (CHECK).
  static Result<SmoothingSpline> Create(const Eigen::VectorXd& t, int order, double cutoff_hz,
                                        double knots_per_period = 10.0);

  // y: N x c signals. Returns the K x c coefficients of their splines.
  Eigen::MatrixXd Fit(const Eigen::MatrixXd& y) const;

  // The derivative (0 to 2 m - 2) of the splines at instants inside the recording: times.size() x c,
  // [unit / s^derivative].
  Eigen::MatrixXd Evaluate(const Eigen::MatrixXd& coefficients, const Eigen::VectorXd& times, int derivative) const;

  // The 2 m basis functions that are not zero at `time`: values[i] of coefficient first + i.
  void Basis(double time, int derivative, int* first, double* values) const;

  // The linear map behind Fit, transposed: for functionals g' c of the coefficients (K x r, a column each) the weights
  // W B A^-1 g (N x r) that they give to the samples.
  Eigen::MatrixXd SampleWeights(const Eigen::MatrixXd& functionals) const;

  int num_coefficients() const { return intervals_ + degree_; }
  int support() const { return degree_ + 1; }

 private:
  using Factor = Eigen::SimplicialLLT<Eigen::SparseMatrix<double>, Eigen::Lower, Eigen::NaturalOrdering<int>>;

  SmoothingSpline() = default;

  int order_ = 0;
  int degree_ = 0;
  double start_ = 0;
  double knot_spacing_ = 0;  // [s]
  int intervals_ = 0;
  Eigen::SparseMatrix<double, Eigen::RowMajor> basis_;  // B, N x K
  Eigen::VectorXd weights_;                             // w_i in knot spacings
  std::shared_ptr<const Factor> factor_;                // of A; shared, so that copies are cheap
};

}  // namespace idim

#endif  // IDIM_CORE_SIGNAL_SMOOTHING_SPLINE_H_
