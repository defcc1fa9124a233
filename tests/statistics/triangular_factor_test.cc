#include "core/statistics/triangular_factor.h"

#include <gtest/gtest.h>

#include <Eigen/QR>

#include "tests/support/random_arm.h"

namespace idim {
namespace {

using Eigen::MatrixXd;

MatrixXd RandomMatrix(int rows, int columns, unsigned seed) {
  testing::Random random(seed);
  return MatrixXd::NullaryExpr(rows, columns, [&] { return random.Uniform(-1.0, 1.0); });
}

TriangularFactor Factor(const MatrixXd& w) {
  TriangularFactor factor(static_cast<int>(w.cols()));
  for (Eigen::Index i = 0; i < w.rows(); ++i) factor.AddRow(w.row(i));
  return factor;
}

// |R| is unique up to the signs of its rows: against Eigen's Householder QR of the whole matrix.
MatrixXd PositiveDiagonal(MatrixXd r) {
  for (Eigen::Index i = 0; i < r.rows(); ++i) {
    if (r(i, i) < 0.0) r.row(i) *= -1.0;
  }
  return r;
}

class Rows : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(FewerAndMoreThanABlock, Rows, ::testing::Values(1, 5, 7, 28, 29, 30, 58, 1000));

TEST_P(Rows, TheFactorOfTheWholeMatrix) {
  const int columns = 7, rows = GetParam();
  const MatrixXd w = RandomMatrix(rows, columns, 11);
  const TriangularFactor factor = Factor(w);
  const MatrixXd r = factor.R();
  EXPECT_EQ(factor.rows(), rows);
  EXPECT_EQ(MatrixXd(r.triangularView<Eigen::StrictlyLower>()).norm(), 0.0);
  EXPECT_LT((r.transpose() * r - w.transpose() * w).norm(), 1e-13 * w.squaredNorm());
  if (rows >= columns) {
    const MatrixXd expected =
        Eigen::HouseholderQR<MatrixXd>(w).matrixQR().topRows(columns).triangularView<Eigen::Upper>();
    EXPECT_LT((PositiveDiagonal(r) - PositiveDiagonal(expected)).norm(), 1e-12 * expected.norm());
  }
}

TEST(TriangularFactor, MergingPartsIsTheWholeAndScalesRows) {
  const MatrixXd a = RandomMatrix(100, 7, 1), b = RandomMatrix(9, 7, 2);
  TriangularFactor merged = Factor(a);
  merged.Merge(Factor(b), 0.5);
  MatrixXd both(109, 7);
  both << a, 0.5 * b;
  EXPECT_EQ(merged.rows(), 109);
  EXPECT_LT((PositiveDiagonal(merged.R()) - PositiveDiagonal(Factor(both).R())).norm(), 1e-12 * both.norm());
}

// Columns of very different size, like XY4 and Fs2, keep their own relative accuracy.
TEST(TriangularFactor, BadlyScaledColumns) {
  MatrixXd w = RandomMatrix(500, 4, 3);
  w.col(1) *= 1e-8;
  w.col(2) *= 1e8;
  const MatrixXd r = Factor(w).R();
  for (int j = 0; j < 4; ++j) EXPECT_NEAR(r.col(j).norm() / w.col(j).norm(), 1.0, 1e-13);
}

}  // namespace
}  // namespace idim
