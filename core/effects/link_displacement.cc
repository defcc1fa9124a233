#include "core/effects/link_displacement.h"

#include "core/effects/columns.h"

namespace idim {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr double kStep = 1e-4;  // [rad or m] the largest displacement of the central difference

}  // namespace

std::vector<EffectEntry> LinkTorqueAlong(const EffectMotion& motion, int joint, const VectorXd& displacement) {
  const Index count = motion.t().size();
  const double largest = count == 0 ? 0.0 : displacement.cwiseAbs().maxCoeff();
  if (!(largest > 0.0)) return {};
  const VectorXd velocity = TimeDerivative(motion.t(), displacement);
  const VectorXd acceleration = TimeDerivative(motion.t(), velocity);
  const double step = kStep / largest;
  const int n = motion.robot->dof();
  MatrixXd column(count, n);
  VectorXd moved[2];
  for (Index i = 0; i < count; ++i) {
    for (const int side : {0, 1}) {
      const double h = side == 0 ? -step : step;
      VectorXd q = motion.q().row(i), dq = motion.dq().row(i), ddq = motion.ddq().row(i);
      q[joint] += h * displacement[i];
      dq[joint] += h * velocity[i];
      ddq[joint] += h * acceleration[i];
      moved[side] = motion.link_torque(q, dq, ddq, motion.robot->gravity);
    }
    column.row(i) = (moved[1] - moved[0]) / (2.0 * step);
  }
  std::vector<EffectEntry> entries;
  for (int j = 0; j < n; ++j) entries.push_back({0, j, column.col(j)});
  return entries;
}

}  // namespace idim
