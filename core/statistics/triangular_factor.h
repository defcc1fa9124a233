// The triangular factor R of a tall matrix whose rows arrive one at a time: R'R = W'W without forming either.
//
// Rows fill a block; a full block is folded into R by Householder reflections of [R; block], which leave Q unstored.
// Memory is that of one block and R, whatever the number of rows; factors of parts merge by one more folding
// (Golub & Van Loan, Matrix Computations, 5.2; TSQR of Demmel, Grigori, Hoemmen & Langou 2012). Least squares, total
// least squares, ranks and residual norms need nothing but R. How a block is folded: triangular_fold.h.

#ifndef IDIM_CORE_STATISTICS_TRIANGULAR_FACTOR_H_
#define IDIM_CORE_STATISTICS_TRIANGULAR_FACTOR_H_

#include <Eigen/Core>
#include <cstdint>

#include "core/statistics/triangular_fold.h"

namespace idim {

class TriangularFactor {
 public:
  using RowMajorMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  // The fastest variant that the processor runs, or (to compare them) one of AvailableFoldVariants().
  explicit TriangularFactor(int columns);
  TriangularFactor(int columns, FoldVariant variant);

  int columns() const { return columns_; }
  // Rows added so far, those of merged factors included.
  std::int64_t rows() const { return rows_; }

  // row: columns() values with the given stride between them.
  void AddRow(const Eigen::Ref<const Eigen::RowVectorXd, 0, Eigen::InnerStride<>>& row);
  // Any number of rows x columns(), to the bit what AddRow does with one after the other. Row-major storage is read in
  // place; any other is copied first.
  void AddRows(const Eigen::Ref<const RowMajorMatrix, 0, Eigen::OuterStride<>>& rows);

  // Adds the rows of `other`, each times `scale`. Same number of columns (CHECK).
  void Merge(const TriangularFactor& other, double scale = 1.0);

  // columns() x columns(), upper triangular, its diagonal not negative: for full rank, the one Cholesky factor of W'W.
  Eigen::MatrixXd R() const;

 private:
  // values: columns_ values with the given stride between them.
  void Buffer(const double* values, Eigen::Index stride);

  int columns_;
  FoldVariant variant_;
  std::int64_t rows_ = 0;
  OctetMatrix r_;
  OctetMatrix block_;
  int buffered_ = 0;
};

}  // namespace idim

#endif  // IDIM_CORE_STATISTICS_TRIANGULAR_FACTOR_H_
