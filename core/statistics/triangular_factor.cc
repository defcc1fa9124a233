#include "core/statistics/triangular_factor.h"

#include <glog/logging.h>

#include <cmath>

namespace idim {

TriangularFactor::TriangularFactor(int columns)
    : columns_(columns), r_(Eigen::MatrixXd::Zero(columns, columns)), block_(3 * columns + 8, columns) {
  CHECK_GT(columns, 0);
}

void TriangularFactor::AddRow(const Eigen::Ref<const Eigen::RowVectorXd, 0, Eigen::InnerStride<>>& row) {
  CHECK_EQ(row.size(), columns_);
  block_.row(buffered_++) = row;
  ++rows_;
  if (buffered_ == block_.rows()) {
    Fold(&r_, &block_, buffered_);
    buffered_ = 0;
  }
}

void TriangularFactor::Merge(const TriangularFactor& other, double scale) {
  CHECK_EQ(other.columns_, columns_);
  Fold(&r_, &block_, buffered_);
  buffered_ = 0;
  Eigen::MatrixXd rows = scale * other.R();
  Fold(&r_, &rows, columns_);
  rows_ += other.rows_;
}

Eigen::MatrixXd TriangularFactor::R() const {
  if (buffered_ == 0) return r_;
  Eigen::MatrixXd r = r_;
  Eigen::MatrixXd block = block_;
  Fold(&r, &block, buffered_);
  return r;
}

void TriangularFactor::Fold(Eigen::MatrixXd* r, Eigen::MatrixXd* block, int rows) {
  const Eigen::Index columns = r->cols();
  for (Eigen::Index j = 0; j < columns; ++j) {
    // The reflector (1; v) acts on row j of R and on the block: the triangle's other rows stay as they are.
    auto x = block->col(j).head(rows);
    const double tail = x.squaredNorm();
    if (tail == 0.0) continue;
    const double alpha = (*r)(j, j);
    const double beta = -std::copysign(std::sqrt(alpha * alpha + tail), alpha);
    const double tau = (beta - alpha) / beta;
    x /= alpha - beta;
    (*r)(j, j) = beta;
    for (Eigen::Index k = j + 1; k < columns; ++k) {
      auto y = block->col(k).head(rows);
      const double s = tau * ((*r)(j, k) + x.dot(y));
      (*r)(j, k) -= s;
      y -= s * x;
    }
  }
}

}  // namespace idim
