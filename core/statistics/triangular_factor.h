// The triangular factor R of a tall matrix whose rows arrive one at a time: R'R = W'W without forming either.
//
// Rows fill a block; a full block is folded into R by Householder reflections of [R; block], which leave Q unstored.
// Memory is that of one block and R, whatever the number of rows; factors of parts merge by one more folding
// (Golub & Van Loan, Matrix Computations, 5.2; TSQR of Demmel, Grigori, Hoemmen & Langou 2012). Least squares, total
// least squares, ranks and residual norms need nothing but R.

#ifndef IDIM_CORE_STATISTICS_TRIANGULAR_FACTOR_H_
#define IDIM_CORE_STATISTICS_TRIANGULAR_FACTOR_H_

#include <Eigen/Core>
#include <cstdint>

namespace idim {

class TriangularFactor {
 public:
  explicit TriangularFactor(int columns);

  int columns() const { return columns_; }
  // Rows added so far, those of merged factors included.
  std::int64_t rows() const { return rows_; }

  // row: columns() values with the given stride between them.
  void AddRow(const Eigen::Ref<const Eigen::RowVectorXd, 0, Eigen::InnerStride<>>& row);

  // Adds the rows of `other`, each times `scale`. Same number of columns (CHECK).
  void Merge(const TriangularFactor& other, double scale = 1.0);

  // columns() x columns(), upper triangular, diagonal of any sign.
  Eigen::MatrixXd R() const;

 private:
  // Folds `rows` buffered rows into r_.
  static void Fold(Eigen::MatrixXd* r, Eigen::MatrixXd* block, int rows);

  int columns_;
  std::int64_t rows_ = 0;
  Eigen::MatrixXd r_;
  Eigen::MatrixXd block_;  // block rows x columns, column-major: the reflections run down columns
  int buffered_ = 0;
};

}  // namespace idim

#endif  // IDIM_CORE_STATISTICS_TRIANGULAR_FACTOR_H_
