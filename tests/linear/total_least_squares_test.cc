#include "solvers/linear/total_least_squares.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

#include "core/base/decompositions.h"
#include "core/statistics/triangular_factor.h"

namespace idim::total_least_squares_test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd Factor(const MatrixXd& w) {
  TriangularFactor factor(static_cast<int>(w.cols()));
  for (Eigen::Index i = 0; i < w.rows(); ++i) factor.AddRow(w.row(i));
  return factor.R();
}

MatrixXd Noisy(int rows, const VectorXd& noise, unsigned seed) {
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal;
  const Eigen::Index c = noise.size();
  MatrixXd w = MatrixXd::NullaryExpr(rows, c, [&] { return normal(generator); });
  w.col(c - 1) = w.leftCols(c - 1) * VectorXd::LinSpaced(c - 1, -1.0, 2.5);
  for (Eigen::Index i = 0; i < w.rows(); ++i) {
    for (Eigen::Index k = 0; k < c; ++k) w(i, k) += noise[k] * normal(generator);
  }
  return w;
}

// The example of routine MB02MD of the SLICOT library (the algorithm of Van Huffel & Vandewalle 1991; documentation,
// "Program Data" and "Program Results"): A X = B, printed with four decimals.
TEST(TotalLeastSquares, PublishedExample) {
  MatrixXd c(6, 4);
  c << 0.80010, 0.39985, 0.60005, 0.89999,  //
      0.29996, 0.69990, 0.39997, 0.82997,   //
      0.49994, 0.60003, 0.20012, 0.79011,   //
      0.90013, 0.20016, 0.79995, 0.85002,   //
      0.39998, 0.80006, 0.49985, 0.99016,   //
      0.20002, 0.90007, 0.70009, 1.02994;
  const TotalLeastSquares tls = SolveTotalLeastSquares(Factor(c), 6);
  ASSERT_TRUE(tls.ok());
  const VectorXd solution{{0.5003, 0.8003, 0.2995}}, singular{{3.2281, 0.8716, 0.3697, 0.0001}};
  EXPECT_LT((-tls.solution.values - solution).cwiseAbs().maxCoeff(), 0.5001e-4);  // C (X, -1) = 0
  EXPECT_LT((tls.singular_values - singular).cwiseAbs().maxCoeff(), 0.5001e-4);
}

// The example of odregress() of the R package pracma: a line with errors in x and y; the constant is exact.
TEST(TotalLeastSquares, PublishedExampleWithAnExactColumn) {
  const VectorXd x{{1.0, 0.6, 1.2, 1.4, 0.2}}, y{{0.5, 0.3, 0.7, 1.0, 0.2}};
  MatrixXd c(5, 3);
  c << x, VectorXd::Ones(5), y;
  TotalLeastSquaresOptions options;
  options.noise = VectorXd{{1.0, 0.0, 1.0}};
  const TotalLeastSquares tls = SolveTotalLeastSquares(Factor(c), 5, options);
  ASSERT_TRUE(tls.ok());
  EXPECT_NEAR(-tls.solution.values[0], 0.65145762, 0.5e-8);
  EXPECT_NEAR(-tls.solution.values[1], -0.03328271, 0.5e-8);
}

// The triangle of many rows has the singular vector of all of them.
TEST(TotalLeastSquares, FactorAndWholeMatrixAgree) {
  const MatrixXd w = Noisy(2000, VectorXd::Constant(12, 0.1), 1);
  const TotalLeastSquares tls = SolveTotalLeastSquares(Factor(w), 2000);
  const Eigen::JacobiSVD<MatrixXd> svd(w, Eigen::ComputeThinV);
  const VectorXd v = svd.matrixV().col(11) * (svd.matrixV()(11, 11) < 0.0 ? -1.0 : 1.0);
  EXPECT_LT((tls.singular_vector - v).norm(), 1e-10);
  EXPECT_LT((tls.singular_values - svd.singularValues()).norm(), 1e-10 * svd.singularValues()[0]);
  // Without the last column, by definition.
  const double without = Eigen::JacobiSVD<MatrixXd>(w.leftCols(11)).singularValues()[10];
  EXPECT_NEAR(tls.scale_significance, std::sqrt(1988.0 * (std::pow(without / svd.singularValues()[11], 2) - 1.0)),
              1e-8);
}

TEST(TotalLeastSquares, NoiseInTheLastColumnOnlyIsLeastSquares) {
  const MatrixXd w = Noisy(300, VectorXd{{0.0, 0.0, 0.0, 0.0, 0.2}}, 2);
  TotalLeastSquaresOptions options;
  options.noise = VectorXd{{0.0, 0.0, 0.0, 0.0, 7.0}};
  const TotalLeastSquares tls = SolveTotalLeastSquares(Factor(w), 300, options);
  ASSERT_TRUE(tls.ok());
  const MatrixXd a = w.leftCols(4), inverse = (a.transpose() * a).inverse();
  const VectorXd x = -inverse * a.transpose() * w.col(4);
  const double s2 = (a * x + w.col(4)).squaredNorm() / (300 - 5);  // (22) counts c, (9) one less
  EXPECT_LT((tls.solution.values - x).norm(), 1e-12);
  EXPECT_LT((tls.solution.covariance - s2 * inverse).norm(), 1e-12);
  EXPECT_NEAR(tls.solution.sigma, std::sqrt(s2) / 7.0, 1e-12);
}

TEST(TotalLeastSquares, EqualNoiseIsPlainWhateverItsSize) {
  const MatrixXd r = Factor(Noisy(300, VectorXd::Constant(5, 0.2), 3));
  TotalLeastSquaresOptions options;
  options.noise = VectorXd::Constant(5, 42.0);
  const TotalLeastSquares plain = SolveTotalLeastSquares(r, 300), scaled = SolveTotalLeastSquares(r, 300, options);
  EXPECT_LT((plain.solution.values - scaled.solution.values).norm(), 1e-12);
  EXPECT_LT((plain.solution.covariance - scaled.solution.covariance).norm(), 1e-12);
  EXPECT_NEAR(plain.solution.sigma, 42.0 * scaled.solution.sigma, 1e-12);
}

// Exact columns by another route: the generalised eigenvalue problem W'W x = mu D^2 x, whose finite eigenvalues
// belong to the noisy columns once the exact ones are taken out by a Schur complement of the normal equations (here
// with squares, which the factor avoids).
TEST(TotalLeastSquares, MixedColumnsAreTheSchurComplementsEigenvector) {
  const VectorXd noise{{0.0, 0.3, 0.0, 0.1, 0.05}};
  const MatrixXd w = Noisy(400, noise, 4);
  TotalLeastSquaresOptions options;
  options.noise = noise;
  const TotalLeastSquares tls = SolveTotalLeastSquares(Factor(w), 400, options);
  ASSERT_TRUE(tls.ok());
  MatrixXd exact(400, 2), noisy(400, 3);
  exact << w.col(0), w.col(2);
  noisy << w.col(1), w.col(3), w.col(4);
  const MatrixXd inverse = (exact.transpose() * exact).inverse();
  const MatrixXd gram = noisy.transpose() * noisy - noisy.transpose() * exact * inverse * exact.transpose() * noisy;
  const MatrixXd d2 = VectorXd{{0.09, 0.01, 0.0025}}.asDiagonal();
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> eigen(gram, d2);
  const VectorXd x_noisy = eigen.eigenvectors().col(0);
  const VectorXd x_exact = -inverse * exact.transpose() * noisy * x_noisy;
  VectorXd x{{x_exact[0], x_noisy[0], x_exact[1], x_noisy[1], x_noisy[2]}};
  x /= x[4];
  EXPECT_LT((tls.solution.values - x.head(4)).norm(), 1e-10);
  EXPECT_NEAR(tls.singular_values[2], std::sqrt(eigen.eigenvalues()[0]), 1e-10);
  // Statistics by the corrected matrix written out: the smallest |E D^-1| with (W - E) x = 0.
  const VectorXd d2x = noise.cwiseAbs2().cwiseProduct(x);
  const MatrixXd a = (w - w * x * d2x.transpose() / x.dot(d2x)).leftCols(4);
  const double s2 = eigen.eigenvalues()[0] / (400 - 5);
  EXPECT_LT((tls.solution.covariance - s2 * x.dot(d2x) * (a.transpose() * a).inverse()).norm(),
            1e-9 * tls.solution.covariance.norm());
  // The gradient of |W x|^2 / |D x|^2 vanishes.
  const double mu = (w * x).squaredNorm() / noise.cwiseProduct(x).squaredNorm();
  const VectorXd gradient = w.transpose() * w * x - mu * noise.cwiseAbs2().cwiseProduct(x);
  EXPECT_LT(gradient.norm(), 1e-9 * (w.transpose() * w).norm());
}

// Exact limit: columns of vanishing noise are the exact ones.
TEST(TotalLeastSquares, SmallNoiseTendsToExact) {
  const VectorXd noise{{0.0, 0.3, 0.0, 0.1, 0.05}};
  const MatrixXd r = Factor(Noisy(400, noise, 5));
  TotalLeastSquaresOptions options;
  options.noise = noise;
  const TotalLeastSquares exact = SolveTotalLeastSquares(r, 400, options);
  options.noise[0] = options.noise[2] = 1e-7;
  const TotalLeastSquares small = SolveTotalLeastSquares(r, 400, options);
  EXPECT_LT((exact.solution.values - small.solution.values).norm(), 1e-9);
  EXPECT_LT((exact.solution.covariance - small.solution.covariance).norm(), 1e-9);
}

TEST(TotalLeastSquares, NoiseOfTheKnownColumnMayBeZero) {
  const VectorXd noise{{0.2, 0.0, 0.1, 0.0}};
  const MatrixXd w = Noisy(20000, noise, 6);
  TotalLeastSquaresOptions options;
  options.noise = noise;
  const TotalLeastSquares tls = SolveTotalLeastSquares(Factor(w), 20000, options);
  ASSERT_TRUE(tls.ok());
  const VectorXd truth{{-1.0, 0.75, 2.5}};
  // Five standard deviations; least squares is off by 0.04 / 1.04 of the first.
  for (int k = 0; k < 3; ++k) {
    const double sd = std::sqrt(tls.solution.covariance(k, k));
    EXPECT_NEAR(-tls.solution.values[k], truth[k], 5.0 * sd) << k;
    EXPECT_LT(sd, 0.005);
  }
}

// A tie of the two smallest singular values: any vector of their plane fits as well.
TEST(TotalLeastSquares, ReportsATie) {
  MatrixXd r = MatrixXd::Zero(4, 4);
  r.diagonal() << 5.0, 1.0, 4.0, 1.0;
  Eigen::HouseholderQR<MatrixXd> random(Noisy(4, VectorXd::Ones(4), 7));
  r = r * MatrixXd(random.householderQ());
  const TotalLeastSquares tls = SolveTotalLeastSquares(r, 100);
  EXPECT_EQ(tls.defect, TlsDefect::kNotSeparated);
  EXPECT_FALSE(tls.ok());
  EXPECT_NEAR(tls.separation, 1.0, 1e-12);
}

// The last column orthogonal to what is dependent: Golub & Van Loan's problem without a solution.
TEST(TotalLeastSquares, ReportsANongenericProblem) {
  MatrixXd w = MatrixXd::Zero(5, 3);
  w.col(0) << 1, 1, 1, 1, 1;
  w.col(1) << 1, 1, 1, 1, 1.0 + 1e-3;
  w.col(2) << 1, -1, 1, -1, 0;
  const TotalLeastSquares tls = SolveTotalLeastSquares(Factor(w), 5);
  EXPECT_EQ(tls.defect, TlsDefect::kNongeneric);
  EXPECT_LT(tls.last_share, 1e-6);
  EXPECT_LT(tls.scale_significance, 1e-3);
}

TEST(TotalLeastSquaresOptions, RefusesWhatMakesNoSense) {
  std::string error;
  TotalLeastSquaresOptions options;
  EXPECT_TRUE(options.IsValid(&error)) << error;
  options.noise = VectorXd::Zero(3);
  EXPECT_FALSE(options.IsValid(&error));
  options.noise = VectorXd{{1.0, -1.0}};
  EXPECT_FALSE(options.IsValid(&error));
  options = TotalLeastSquaresOptions();
  options.min_last_share = 1.0;
  EXPECT_FALSE(options.IsValid(&error));
}

}  // namespace
}  // namespace idim::total_least_squares_test
