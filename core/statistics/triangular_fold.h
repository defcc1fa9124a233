// The kernel of TriangularFactor: rows folded into an upper triangle, R'R <- R'R + B'B, by Householder reflections of
// [R; B] (Golub & Van Loan, Matrix Computations, 5.1 and 12.5.3). Reflector j touches row j of R and the block B only,
// so the triangle costs next to nothing and a block of r rows 2 r c^2 operations.
//
// Panels of P columns are factored one reflector after the other, each in one pass over the panel that applies
// reflector j and at the same time takes the inner products reflector j + 1 needs. The other columns get the P
// reflectors at once in compact WY form, C <- C - V (T' (V'C)) (Schreiber & Van Loan 1989), strip by strip, the V'C
// of a strip in registers. A reflector stays unscaled, (R_jj - beta, x), so that T's off-diagonal inner products fall
// out of the panel's passes and a column of any size keeps its own relative accuracy.
//
// R_jj keeps its sign, beta = +sqrt(R_jj^2 + x'x), and R_jj - beta is taken as -x'x / (R_jj + beta), without
// cancellation (Golub & Van Loan 5.1.3): R changes by a small correction in each of many folds, where LAPACK's choice,
// the other sign, turns every row over and rounds it anew.
//
// Plain doubles, no Eigen: the same source is compiled for several instruction sets and one is chosen at run time.
// Variants group the sums differently and with or without fused multiply-add: R differs by rounding from one to the
// other (1e-12 relative is tested), and is the same to the bit on every run of one variant.
//
// Limits: squares must not overflow; a column of a block whose norm is below 1e-145, or below 1e-20 of that in R, is
// taken for zeros.

#ifndef IDIM_CORE_STATISTICS_TRIANGULAR_FOLD_H_
#define IDIM_CORE_STATISTICS_TRIANGULAR_FOLD_H_

#include <cstddef>
#include <vector>

namespace idim {

// Eight neighbouring columns of one row: a cache line.
struct alignas(64) ColumnOctet {
  double values[8] = {};
};

// `rows` x 8 * `octets` values, an octet of columns after the other: row i of octet g is storage_[g * (rows + 1) + i].
// One cache line between the octets keeps those of a row out of one cache set.
class OctetMatrix {
 public:
  OctetMatrix(int rows, int octets)
      : rows_(rows), octets_(octets), storage_(static_cast<std::size_t>(octets) * (rows + 1)) {}
  int rows() const { return rows_; }
  int octets() const { return octets_; }
  std::ptrdiff_t octet_stride() const { return 8 * (std::ptrdiff_t{rows_} + 1); }  // in doubles
  double* octet(int g) { return storage_[At(0, 8 * g)].values; }
  double operator()(int i, int j) const { return storage_[At(i, j)].values[j % 8]; }
  double& operator()(int i, int j) { return storage_[At(i, j)].values[j % 8]; }

 private:
  std::size_t At(int i, int j) const { return static_cast<std::size_t>(j / 8) * (rows_ + 1) + i; }

  int rows_, octets_;
  std::vector<ColumnOctet> storage_;
};

enum class FoldVariant { kBaseline, kAvx2, kAvx512 };

// Those that this processor (and compiler) can run, slowest first; never empty.
const std::vector<FoldVariant>& AvailableFoldVariants();

// The upper triangle of r (8 * octets square) becomes that of [r; first `rows` rows of block]; rows <= block->rows().
// r's diagonal is not negative, before and after. Both have zeros right of column `columns` and as many octets. The
// block is destroyed but for that padding; its number of rows is a multiple of four.
void FoldIntoTriangle(FoldVariant variant, int columns, OctetMatrix* r, OctetMatrix* block, int rows);

}  // namespace idim

#endif  // IDIM_CORE_STATISTICS_TRIANGULAR_FOLD_H_
