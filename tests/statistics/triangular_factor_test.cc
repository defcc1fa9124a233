#include "core/statistics/triangular_factor.h"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <Eigen/SVD>
#include <cmath>
#include <tuple>
#include <vector>

#include "core/base/decompositions.h"
#include "tests/support/random_arm.h"

namespace idim::triangular_factor_test {
namespace {

using Eigen::MatrixXd;

MatrixXd RandomMatrix(int rows, int columns, unsigned seed) {
  Random random(seed);
  return MatrixXd::NullaryExpr(rows, columns, [&] { return random.Uniform(-1.0, 1.0); });
}

TriangularFactor Factor(const MatrixXd& w, FoldVariant variant = AvailableFoldVariants().back()) {
  TriangularFactor factor(static_cast<int>(w.cols()), variant);
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
INSTANTIATE_TEST_SUITE_P(FewerAndMoreThanABlock, Rows, ::testing::Values(1, 5, 7, 30, 191, 192, 193, 384, 1000));

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

std::vector<double> Flat(const MatrixXd& m) { return {m.data(), m.data() + m.size()}; }

// Every width of a strip and of the last panel, by every instruction set of this processor: against Eigen, so also
// against one another. 493 rows: two blocks and a rest that four does not divide.
using VariantAndColumns = std::tuple<FoldVariant, int>;
class Variants : public ::testing::TestWithParam<VariantAndColumns> {};
INSTANTIATE_TEST_SUITE_P(AllOfThisProcessor, Variants,
                         ::testing::Combine(::testing::ValuesIn(AvailableFoldVariants()),
                                            ::testing::Values(1, 2, 3, 4, 5, 8, 9, 12, 13, 16, 17, 24, 25, 30, 33, 41,
                                                              48, 62, 70, 97)));

TEST_P(Variants, AgreeWithEigen) {
  const auto [variant, columns] = GetParam();
  const MatrixXd w = RandomMatrix(493, columns, 17);
  const MatrixXd r = PositiveDiagonal(Factor(w, variant).R());
  const MatrixXd expected =
      PositiveDiagonal(Eigen::HouseholderQR<MatrixXd>(w).matrixQR().topRows(columns).triangularView<Eigen::Upper>());
  EXPECT_LT((r - expected).norm(), 1e-12 * expected.norm());
}

// Not only up to signs: all choose the sign of a diagonal entry in the same way.
TEST(TriangularFactor, VariantsDifferByRoundingOnly) {
  MatrixXd w = RandomMatrix(1000, 70, 18);
  for (int j = 0; j < 70; ++j) w.col(j) *= std::pow(10.0, j % 9 - 4);
  const MatrixXd baseline = Factor(w, FoldVariant::kBaseline).R();
  for (const FoldVariant variant : AvailableFoldVariants()) {
    const MatrixXd r = Factor(w, variant).R();
    for (int j = 0; j < 70; ++j) {
      EXPECT_LT((r.col(j) - baseline.col(j)).norm(), 1e-12 * baseline.col(j).norm()) << static_cast<int>(variant);
    }
    EXPECT_EQ(Flat(r), Flat(Factor(w, variant).R())) << "not the same on a second run";
  }
}

TEST(TriangularFactor, RowsByBlocksAreRowsOneByOne) {
  using RowMajor = TriangularFactor::RowMajorMatrix;
  const RowMajor w = RandomMatrix(400, 13, 5);
  const MatrixXd expected = Factor(w).R();
  TriangularFactor blocks(13);
  blocks.AddRows(w.topRows(1));
  blocks.AddRows(w.middleRows(1, 150));
  blocks.AddRows(w.middleRows(151, 0));
  blocks.AddRows(w.bottomRows(249));
  EXPECT_EQ(blocks.rows(), 400);
  EXPECT_EQ(Flat(blocks.R()), Flat(expected));
  // Part of a wider matrix; column-major storage, whose rows are strided; a temporary.
  const RowMajor wide = RowMajor::Random(400, 16);
  TriangularFactor part(13), column_major(13), expression(13);
  part.AddRows(wide.middleCols(2, 13));
  EXPECT_EQ(Flat(part.R()), Flat(Factor(wide.middleCols(2, 13)).R()));
  column_major.AddRows(MatrixXd(w));
  EXPECT_EQ(Flat(column_major.R()), Flat(expected));
  expression.AddRows(-1.0 * w);
  EXPECT_EQ(Flat(expression.R().cwiseAbs()), Flat(expected.cwiseAbs()));
}

// R() folds a copy: looking at it, twice or half way, changes nothing that follows.
TEST(TriangularFactor, LookingDoesNotChangeIt) {
  const MatrixXd w = RandomMatrix(300, 9, 6);
  TriangularFactor factor(9);
  for (int i = 0; i < 300; ++i) {
    factor.AddRow(w.row(i));
    if (i % 50 == 0) {
      EXPECT_EQ(Flat(factor.R()), Flat(factor.R()));
    }
  }
  EXPECT_EQ(Flat(factor.R()), Flat(Factor(w).R()));
}

// A column of zeros and columns that repeat others, in the middle of a panel and of a strip: no reflector, or one whose
// inner products are all rounding.
TEST(TriangularFactor, RankDeficient) {
  MatrixXd w = RandomMatrix(500, 40, 7);
  w.col(3).setZero();
  w.col(17) = w.col(2);
  w.col(30) = w.col(5) - 2.0 * w.col(29);
  for (const FoldVariant variant : AvailableFoldVariants()) {
    const MatrixXd r = Factor(w, variant).R();
    EXPECT_EQ(r.col(3).norm(), 0.0);
    EXPECT_LT((r.transpose() * r - w.transpose() * w).norm(), 1e-13 * w.squaredNorm());
    EXPECT_LT(std::abs(r(17, 17)), 1e-13 * w.col(17).norm());
    EXPECT_LT(std::abs(r(30, 30)), 1e-13 * w.col(30).norm());
  }
}

// Small rows after large ones: R_jj - beta cancels unless taken with care; and a small column of a block still turns
// another one into R, here 1e-11 of it.
TEST(TriangularFactor, SmallRowsAfterLargeOnes) {
  const MatrixXd large = RandomMatrix(300, 20, 10), small = RandomMatrix(300, 20, 11);
  for (const FoldVariant variant : AvailableFoldVariants()) {
    for (const double scale : {1e-4, 1e-9, 1e-11, 1e-30, 1e-156}) {
      MatrixXd all(600, 20);
      all << large, scale * small;
      all.block(0, 10, 300, 10).setZero();
      all.block(300, 10, 300, 10) = small.rightCols(10);
      const MatrixXd r = Factor(all, variant).R();
      const MatrixXd expected =
          PositiveDiagonal(Eigen::HouseholderQR<MatrixXd>(all).matrixQR().topRows(20).triangularView<Eigen::Upper>());
      EXPECT_LT((r - expected).norm(), 1e-13 * expected.norm()) << scale;
    }
  }
}

// Rounding of many folds is that of sums: the diagonal of R is as good as a sum of 100 000 squares taken in turn. The
// bound: 521 folds that each round it twice at random, 2^-53 sqrt(1042) = 3.6e-15, four times over.
TEST(TriangularFactor, ManyFolds) {
  const MatrixXd w = RandomMatrix(100000, 3, 12);
  for (const FoldVariant variant : AvailableFoldVariants()) {
    const MatrixXd r = Factor(w, variant).R();
    for (int j = 0; j < 3; ++j) {
      EXPECT_GT(r(j, j), 0.0);
      const long double norm = w.col(j).cast<long double>().norm();
      EXPECT_NEAR(static_cast<double>(r.col(j).cast<long double>().norm() / norm), 1.0, 1.4e-14);
    }
  }
}

// A condition number of 1e10, whose square is beyond double precision: the smallest singular value survives, which the
// normal equations would lose.
TEST(TriangularFactor, IllConditioned) {
  MatrixXd w = RandomMatrix(2000, 30, 8);
  w.col(29) = w.leftCols(29).rowwise().sum() + 1e-10 * w.col(29);
  const double expected = Eigen::JacobiSVD<MatrixXd>(w).singularValues()[29];
  for (const FoldVariant variant : AvailableFoldVariants()) {
    EXPECT_NEAR(Eigen::JacobiSVD<MatrixXd>(Factor(w, variant).R()).singularValues()[29] / expected, 1.0, 1e-4);
  }
}

TEST(TriangularFactor, TheEndsOfTheRange) {
  for (const FoldVariant variant : AvailableFoldVariants()) {
    MatrixXd w = RandomMatrix(300, 5, 9);
    const MatrixXd expected = Factor(w, variant).R();
    // Powers of two change no mantissa. A column whose squares are subnormal is left out, not divided by.
    w.col(0) *= 0x1p+500;
    w.col(2) *= 0x1p-450;
    MatrixXd r = Factor(w, variant).R();
    r.col(0) *= 0x1p-500;
    r.col(2) *= 0x1p+450;
    EXPECT_EQ(Flat(r), Flat(expected));
    w.col(2) *= 0x1p-80;
    EXPECT_EQ(Factor(w, variant).R()(2, 2), 0.0);
    // Small rows after large ones, whose ratio squared is no double.
    MatrixXd far(600, 5);
    far << 0x1p+400 * RandomMatrix(300, 5, 9), 0x1p-400 * RandomMatrix(300, 5, 9);
    EXPECT_LT((0x1p-400 * Factor(far, variant).R() - expected).norm(), 1e-14 * expected.norm());
    // What is not a number is not lost either.
    w(100, 3) = std::nan("");
    EXPECT_TRUE(std::isnan(Factor(w, variant).R()(3, 3)));
  }
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
}  // namespace idim::triangular_factor_test
