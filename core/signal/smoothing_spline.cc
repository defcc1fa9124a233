#include "core/signal/smoothing_spline.h"

#include <glog/logging.h>

#include <algorithm>
#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <vector>

#include "core/signal/clock.h"

namespace idim {
namespace {

// The degree + 1 uniform B-splines, knots one apart, that are not zero at x in [0, 1] of their common interval, or
// their derivative by x (Cox-de Boor; b' of degree p is a difference of degree p - 1).
void UniformBasis(double x, int degree, int derivative, double* b) {
  b[0] = 1.0;
  const int top = degree - derivative;
  for (int p = 1; p <= top; ++p) {
    b[p] = x * b[p - 1] / p;
    for (int j = p - 1; j > 0; --j) b[j] = ((x + p - j) * b[j - 1] + (1.0 - x + j) * b[j]) / p;
    b[0] *= (1.0 - x) / p;
  }
  for (int p = top + 1; p <= degree; ++p) {
    b[p] = b[p - 1];
    for (int j = p - 1; j > 0; --j) b[j] = b[j - 1] - b[j];
    b[0] = -b[0];
  }
}

// int over one interval of B_i^(m) B_j^(m): the same for every interval. The integrand has degree 2 m - 2, for which
// the rule below (exact to degree 13) is exact.
Eigen::MatrixXd PenaltyOfOneInterval(int order) {
  using Rule = boost::math::quadrature::gauss<double, 7>;
  static_assert(2 * SmoothingSpline::kMaxOrder - 2 <= 13);
  const int support = 2 * order;
  Eigen::MatrixXd penalty = Eigen::MatrixXd::Zero(support, support);
  Eigen::VectorXd b(support);
  const auto add = [&](double node, double weight) {
    UniformBasis(0.5 + 0.5 * node, support - 1, order, b.data());
    penalty += 0.5 * weight * b * b.transpose();
  };
  for (size_t i = 0; i < Rule::abscissa().size(); ++i) {
    const double node = Rule::abscissa()[i];
    add(node, Rule::weights()[i]);
    if (node != 0.0) add(-node, Rule::weights()[i]);
  }
  return penalty;
}

}  // namespace

Result<SmoothingSpline> SmoothingSpline::Create(const Eigen::VectorXd& t, int order, double cutoff_hz,
                                                double knots_per_period) {
  CHECK(order >= kMinOrder && order <= kMaxOrder);
  CHECK_GT(cutoff_hz, 0.0);
  CHECK_GE(knots_per_period, 4.0);
  const Eigen::Index n = t.size();
  CHECK_GE(n, 2 * order);

  SmoothingSpline s;
  s.order_ = order;
  s.degree_ = 2 * order - 1;
  s.start_ = t[0];
  const double duration = t[n - 1] - t[0];
  s.intervals_ = std::max(1, static_cast<int>(std::ceil(duration * cutoff_hz * knots_per_period)));
  s.knot_spacing_ = duration / s.intervals_;
  s.weights_ = SampleSpacing(t) / s.knot_spacing_;
  const int k = s.num_coefficients();
  const int support = s.support();

  // The lower band of A, one column of `band` for each of A's.
  Eigen::MatrixXd band = Eigen::MatrixXd::Zero(support, k);
  const double lambda = std::pow(2.0 * M_PI * cutoff_hz * s.knot_spacing_, -2.0 * order);
  const Eigen::MatrixXd penalty = lambda * PenaltyOfOneInterval(order);
  for (int interval = 0; interval < s.intervals_; ++interval) {
    for (int j = 0; j < support; ++j) {
      for (int i = j; i < support; ++i) band(i - j, interval + j) += penalty(i, j);
    }
  }
  s.basis_.resize(n, k);
  s.basis_.reserve(Eigen::VectorXi::Constant(n, support));
  double b[kMaxSupport];
  for (Eigen::Index row = 0; row < n; ++row) {
    int first = 0;
    s.Basis(t[row], 0, &first, b);
    for (int j = 0; j < support; ++j) {
      s.basis_.insert(row, first + j) = b[j];
      for (int i = j; i < support; ++i) band(i - j, first + j) += s.weights_[row] * b[i] * b[j];
    }
  }
  s.basis_.makeCompressed();

  Eigen::SparseMatrix<double> a(k, k);
  a.reserve(Eigen::VectorXi::Constant(k, support));
  for (int j = 0; j < k; ++j) {
    for (int i = 0; i < std::min(support, k - j); ++i) a.insert(j + i, j) = band(i, j);
  }
  a.makeCompressed();
  auto factor = std::make_shared<Factor>(a);
  if (factor->info() != Eigen::Success) {
    return Status::BadInput("the samples are too sparse for the cut-off frequency of the low-pass");
  }
  s.factor_ = std::move(factor);
  return s;
}

void SmoothingSpline::Basis(double time, int derivative, int* first, double* values) const {
  const double u = (time - start_) / knot_spacing_;
  *first = std::clamp(static_cast<int>(std::floor(u)), 0, intervals_ - 1);
  UniformBasis(u - *first, degree_, derivative, values);
  if (derivative > 0) {
    const double scale = std::pow(knot_spacing_, -derivative);
    for (int i = 0; i <= degree_; ++i) values[i] *= scale;
  }
}

Eigen::MatrixXd SmoothingSpline::Fit(const Eigen::MatrixXd& y) const {
  CHECK_EQ(y.rows(), basis_.rows());
  // Fitting the deviation from the first sample keeps the rounding of large offsets out of the derivatives; the
  // B-splines sum to one, so an offset of the signal is the same offset of all coefficients.
  const Eigen::RowVectorXd origin = y.row(0);
  const Eigen::MatrixXd weighted = weights_.asDiagonal() * (y.rowwise() - origin);
  const Eigen::MatrixXd right = basis_.transpose() * weighted;
  Eigen::MatrixXd coefficients = factor_->solve(right);
  coefficients.rowwise() += origin;
  return coefficients;
}

Eigen::MatrixXd SmoothingSpline::Evaluate(const Eigen::MatrixXd& coefficients, const Eigen::VectorXd& times,
                                          int derivative) const {
  CHECK_EQ(coefficients.rows(), num_coefficients());
  CHECK(derivative >= 0 && derivative < degree_);
  Eigen::MatrixXd values(times.size(), coefficients.cols());
  double b[kMaxSupport];
  for (Eigen::Index i = 0; i < times.size(); ++i) {
    int first = 0;
    Basis(times[i], derivative, &first, b);
    for (Eigen::Index c = 0; c < coefficients.cols(); ++c) {
      double sum = 0;
      for (int j = 0; j <= degree_; ++j) sum += b[j] * coefficients(first + j, c);
      values(i, c) = sum;
    }
  }
  return values;
}

Eigen::MatrixXd SmoothingSpline::SampleWeights(const Eigen::MatrixXd& functionals) const {
  CHECK_EQ(functionals.rows(), num_coefficients());
  const Eigen::MatrixXd solved = factor_->solve(functionals);
  return weights_.asDiagonal() * (basis_ * solved);
}

}  // namespace idim
