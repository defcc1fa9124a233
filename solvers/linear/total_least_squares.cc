#include "solvers/linear/total_least_squares.h"

#include <glog/logging.h>

#include <Eigen/QR>
#include <Eigen/SVD>
#include <cmath>
#include <limits>
#include <vector>

#include "core/base/decompositions.h"

namespace idim {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kInf = std::numeric_limits<double>::infinity();

// W with its exact columns eliminated. Members named as in the header.
struct Reduced {
  std::vector<Index> exact, noisy;  // columns of W
  VectorXd noise;                   // of the noisy ones
  MatrixXd r11, r12, r22;
  Eigen::JacobiSVD<MatrixXd> svd;  // of r22 D^-1

  // The whole x, of norm 1, that belongs to a vector z of the scaled noisy space.
  VectorXd Unscale(const VectorXd& z) const {
    VectorXd x(exact.size() + noisy.size());
    const VectorXd x_noisy = z.cwiseQuotient(noise);
    VectorXd x_exact;
    if (!exact.empty()) x_exact = -r11.triangularView<Eigen::Upper>().solve(r12 * x_noisy);
    for (size_t k = 0; k < noisy.size(); ++k) x[noisy[k]] = x_noisy[k];
    for (size_t k = 0; k < exact.size(); ++k) x[exact[k]] = x_exact[k];
    return x.normalized();
  }
};

MatrixXd Pick(const MatrixXd& r, const std::vector<Index>& columns) {
  MatrixXd picked(r.rows(), columns.size());
  for (size_t k = 0; k < columns.size(); ++k) picked.col(k) = r.col(columns[k]);
  return picked;
}

// Of the first `columns` columns.
Reduced Reduce(const MatrixXd& r, const VectorXd& noise, Index columns) {
  Reduced reduced;
  for (Index k = 0; k < columns; ++k) (noise[k] > 0.0 ? reduced.noisy : reduced.exact).push_back(k);
  const Index e = static_cast<Index>(reduced.exact.size());
  MatrixXd noisy = Pick(r, reduced.noisy);
  if (e > 0) {
    const Eigen::HouseholderQR<MatrixXd> qr(Pick(r, reduced.exact));
    noisy = (qr.householderQ().transpose() * noisy).eval();
    reduced.r11 = qr.matrixQR().topRows(e).triangularView<Eigen::Upper>();
    CHECK((reduced.r11.diagonal().array() != 0.0).all()) << "dependent exact columns";
  }
  reduced.r12 = noisy.topRows(e);
  reduced.r22 = noisy.bottomRows(noisy.rows() - e);
  reduced.noise = Pick(noise.transpose(), reduced.noisy).transpose();
  if (!reduced.noisy.empty()) {
    reduced.svd.compute(reduced.r22 * reduced.noise.cwiseInverse().asDiagonal(), Eigen::ComputeThinV);
  }
  return reduced;
}

// The first c - 1 columns of the corrected W, up to a rotation: R22 less its smallest singular component.
MatrixXd Corrected(const Reduced& reduced, const VectorXd& z, Index columns) {
  const Index e = static_cast<Index>(reduced.exact.size());
  MatrixXd corrected = MatrixXd::Zero(e + reduced.r22.rows(), columns);
  const VectorXd w = reduced.r22 * z.cwiseQuotient(reduced.noise);
  const MatrixXd r22 = reduced.r22 - w * z.cwiseProduct(reduced.noise).transpose();
  for (Index k = 0; k < e; ++k) corrected.col(reduced.exact[k]).head(e) = reduced.r11.col(k);
  for (size_t k = 0; k < reduced.noisy.size(); ++k) {
    corrected.col(reduced.noisy[k]) << reduced.r12.col(k), r22.col(k);
  }
  return corrected.leftCols(columns - 1);
}

// (A'A)^-1.
MatrixXd InverseGram(const MatrixXd& a) {
  const VectorXd scales = ColumnScales(a);
  const Eigen::HouseholderQR<MatrixXd> qr(a * scales.cwiseInverse().asDiagonal());
  const auto triangle = qr.matrixQR().topRows(a.cols()).triangularView<Eigen::Upper>();
  const MatrixXd inverse =
      scales.cwiseInverse().asDiagonal() * MatrixXd(triangle.solve(MatrixXd::Identity(a.cols(), a.cols())));
  return inverse * inverse.transpose();
}

}  // namespace

bool TotalLeastSquaresOptions::IsValid(std::string* error) const {
  if (noise.size() > 0 && !((noise.array() >= 0.0).all() && noise.allFinite() && noise.maxCoeff() > 0.0)) {
    *error = "noise has a negative entry or none above 0; expected a standard deviation for each column, 0 if exact";
    return false;
  }
  if (!(min_separation >= 1.0)) {
    *error = "min_separation is " + std::to_string(min_separation) + "; expected a number of at least 1";
    return false;
  }
  if (!(min_last_share >= 0.0 && min_last_share < 1.0)) {
    *error = "min_last_share is " + std::to_string(min_last_share) + "; expected a number in [0, 1)";
    return false;
  }
  return true;
}

TotalLeastSquares SolveTotalLeastSquares(const MatrixXd& r, std::int64_t rows,
                                         const TotalLeastSquaresOptions& options) {
  std::string error;
  CHECK(options.IsValid(&error)) << error;
  const Index c = r.cols();
  CHECK_GE(r.rows(), c);
  CHECK_GT(rows, c);
  CHECK_GE(c, 2);
  CHECK(options.noise.size() == 0 || options.noise.size() == c) << "a noise for each column";
  const VectorXd noise = options.noise.size() > 0 ? options.noise : VectorXd::Ones(c);

  const Reduced reduced = Reduce(r, noise, c);
  const VectorXd& s = reduced.svd.singularValues();
  const Index last = s.size() - 1;
  const VectorXd z = reduced.svd.matrixV().col(last);
  VectorXd x = reduced.Unscale(z);
  if (x[c - 1] < 0.0) x = -x;
  const VectorXd norms = r.colwise().norm();

  TotalLeastSquares result;
  result.singular_vector = x;
  result.singular_values = s;
  result.separation = last > 0 && s[last] > 0.0 ? s[last - 1] / s[last] : kInf;
  const VectorXd share = x.cwiseAbs().cwiseProduct(norms);
  result.last_share = share[c - 1] / share.maxCoeff();
  if (last > 0) {
    result.weak_direction = reduced.Unscale(reduced.svd.matrixV().col(last - 1)).cwiseAbs().cwiseProduct(norms);
    result.weak_direction /= result.weak_direction.maxCoeff();
  }
  result.scale_significance = kInf;
  if (const Reduced without = Reduce(r, noise, c - 1); !without.noisy.empty() && s[last] > 0.0) {
    const double ratio = without.svd.singularValues().tail<1>()[0] / s[last];
    result.scale_significance = std::sqrt(static_cast<double>(rows - c) * std::max(0.0, ratio * ratio - 1.0));
  }

  ParameterSolution& solution = result.solution;
  solution.sigma = s[last] / std::sqrt(static_cast<double>(rows - c));
  if (x[c - 1] > 0.0) {
    solution.values = x.head(c - 1) / x[c - 1];
    const double spread = solution.sigma * noise.cwiseProduct(x).norm() / x[c - 1];
    solution.covariance = spread * spread * InverseGram(Corrected(reduced, z, c));
  }
  result.defect = !(x[c - 1] > 0.0 && result.last_share > options.min_last_share) ? TlsDefect::kNongeneric
                  : !(result.separation > options.min_separation)                 ? TlsDefect::kNotSeparated
                                                                                  : TlsDefect::kNone;
  return result;
}

}  // namespace idim
