#include "solvers/linear/signal_noise.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "solvers/linear/least_squares.h"

namespace idim {
namespace {

// Noise-free data leave rounding, whose ratios mean nothing.
constexpr double kSmallestShare = 1e-8;

}  // namespace

Eigen::MatrixXd SignalNoise(const GainSystem& system, double rank_tolerance) {
  const int n = system.dof();
  std::vector<Eigen::MatrixXd> r;
  for (const TriangularFactor& joint : system.joints) r.push_back(joint.R());
  Eigen::MatrixXd noise = Eigen::MatrixXd::Zero(n, n);
  for (int k = 0; k < n; ++k) {
    Eigen::MatrixXd others(r[k].rows(), r[k].cols() - 1);
    others << r[k].leftCols(k), r[k].rightCols(r[k].cols() - 1 - k);
    const Remainder remainder = RemainderOf(others, r[k].col(k), rank_tolerance);
    const double rows = std::max(1.0, static_cast<double>(system.joints[k].rows()));
    const double norm = r[k].col(k).norm();
    if (norm == 0.0) continue;
    const double own = std::max(remainder.norm / std::sqrt(std::max(1.0, rows - remainder.rank)),
                                kSmallestShare * norm / std::sqrt(rows));
    for (int j = 0; j < n; ++j) noise(j, k) = own * r[j].col(k).norm() / norm;
  }
  return noise;
}

}  // namespace idim
