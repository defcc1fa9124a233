#include "core/statistics/triangular_factor.h"

#include <glog/logging.h>

#include <cstddef>
#include <cstring>

namespace idim {
namespace {

// Few enough for a panel of 8 columns and a strip of 24 to stay in a first-level cache of 48 kB; between 128 and 512
// the time differs by a few per cent.
constexpr int kBlockRows = 192;

int Octets(int columns) {
  CHECK_GT(columns, 0);
  return (columns + 7) / 8;
}

}  // namespace

TriangularFactor::TriangularFactor(int columns) : TriangularFactor(columns, AvailableFoldVariants().back()) {}

TriangularFactor::TriangularFactor(int columns, FoldVariant variant)
    : columns_(columns),
      variant_(variant),
      r_(8 * Octets(columns), Octets(columns)),
      block_(kBlockRows, Octets(columns)) {}

void TriangularFactor::AddRow(const Eigen::Ref<const Eigen::RowVectorXd, 0, Eigen::InnerStride<>>& row) {
  CHECK_EQ(row.size(), columns_);
  Buffer(row.data(), row.innerStride());
  ++rows_;
}

void TriangularFactor::AddRows(const Eigen::Ref<const RowMajorMatrix, 0, Eigen::OuterStride<>>& rows) {
  CHECK_EQ(rows.cols(), columns_);
  for (Eigen::Index i = 0; i < rows.rows(); ++i) Buffer(rows.data() + i * rows.outerStride(), 1);
  rows_ += rows.rows();
}

void TriangularFactor::Merge(const TriangularFactor& other, double scale) {
  CHECK_EQ(other.columns_, columns_);
  const Eigen::MatrixXd r = scale * other.R();
  for (Eigen::Index i = 0; i < columns_; ++i) Buffer(&r(i, 0), r.outerStride());
  rows_ += other.rows_;
}

Eigen::MatrixXd TriangularFactor::R() const {
  OctetMatrix folded = r_;
  if (buffered_ > 0) {
    OctetMatrix block = block_;
    FoldIntoTriangle(variant_, columns_, &folded, &block, buffered_);
  }
  Eigen::MatrixXd r = Eigen::MatrixXd::Zero(columns_, columns_);
  for (int j = 0; j < columns_; ++j) {
    for (int i = 0; i <= j; ++i) r(i, j) = folded(i, j);
  }
  return r;
}

void TriangularFactor::Buffer(const double* values, Eigen::Index stride) {
  double* to = block_.octet(0) + 8 * std::ptrdiff_t{buffered_};
  for (int left = columns_; left > 0; left -= 8, values += 8 * stride, to += block_.octet_stride()) {
    if (left >= 8 && stride == 1) {
      std::memcpy(to, values, sizeof(ColumnOctet));
    } else {
      for (int k = 0; k < 8 && k < left; ++k) to[k] = values[k * stride];
    }
  }
  if (++buffered_ == kBlockRows) {
    FoldIntoTriangle(variant_, columns_, &r_, &block_, buffered_);
    buffered_ = 0;
  }
}

}  // namespace idim
