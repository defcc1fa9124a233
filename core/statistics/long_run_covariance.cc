#include "core/statistics/long_run_covariance.h"

#include <algorithm>
#include <cmath>

namespace idim {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

// Windows that are summed together.
constexpr Index kWindowRows = 256;

}  // namespace

int ChooseLag(const MatrixXd& rows, const SampleRanges& recordings) {
  double above = 0.0, below = 0.0;
  Index shortest = rows.rows();
  for (const auto& [begin, end] : recordings) shortest = std::min(shortest, end - begin);
  for (Index a = 0; a < rows.cols(); ++a) {
    double lagged = 0.0;
    for (const auto& [begin, end] : recordings) {
      lagged += rows.col(a).segment(begin, end - begin - 1).dot(rows.col(a).segment(begin + 1, end - begin - 1));
    }
    const double square = rows.col(a).squaredNorm();
    if (!(square > 0.0)) continue;
    const double rho = std::clamp(lagged / square, -0.97, 0.97);
    above += 4.0 * rho * rho / (std::pow(1.0 - rho, 6) * std::pow(1.0 + rho, 2));
    below += 1.0 / std::pow(1.0 - rho, 4);
  }
  if (!(below > 0.0)) return 0;
  const double lag = 1.1447 * std::cbrt(above / below * static_cast<double>(rows.rows()));
  return static_cast<int>(std::min(std::ceil(lag), static_cast<double>(shortest) / 3.0));
}

MatrixXd LongRunCovariance(const MatrixXd& rows, const SampleRanges& recordings, int lag) {
  MatrixXd sum = MatrixXd::Zero(rows.cols(), rows.cols()), windows(kWindowRows, rows.cols());
  for (const auto& [begin, end] : recordings) {
    Eigen::RowVectorXd window = Eigen::RowVectorXd::Zero(rows.cols());
    Index filled = 0;
    for (Index w = 0; w < end - begin + lag; ++w) {
      if (begin + w < end) window += rows.row(begin + w);
      if (w > lag) window -= rows.row(begin + w - lag - 1);
      windows.row(filled++) = window;
      if (filled < kWindowRows && w + 1 < end - begin + lag) continue;
      sum.noalias() += windows.topRows(filled).transpose() * windows.topRows(filled) / (lag + 1.0);
      filled = 0;
    }
  }
  return sum;
}

}  // namespace idim
