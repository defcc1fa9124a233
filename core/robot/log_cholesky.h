// Ten free numbers for a body that is always physically consistent (Rucker & Wensing, IEEE Robotics and Automation
// Letters 7(2), 2022): the pseudo-inertia as P = B V V' B', with B a reference body's
// factor (B B' its pseudo-inertia) and
//        | exp(d1)  s12      s13      t1 |
//   V = e^a | 0        exp(d2)  s23      t2 |     theta = (a, d1, d2, d3, s12, s23, s13, t1, t2, t3).
//        | 0        0        exp(d3)  t3 |
//        | 0        0        0        1  |
// Every positive definite P has exactly one theta, and theta = 0 is the reference. The mass is e^2a that of the
// reference; t moves the centre of mass and d stretches the body, both in units of the reference's radii.

#ifndef IDIM_CORE_ROBOT_LOG_CHOLESKY_H_
#define IDIM_CORE_ROBOT_LOG_CHOLESKY_H_

#include <Eigen/Core>
#include <cmath>

#include "core/robot/inertia.h"

namespace idim {

// Upper triangular B of a body with the given mass [kg], centre of mass [m] and root-mean-square extents of its mass
// along x, y, z about the centre of mass [m], all positive.
inline Eigen::Matrix4d PseudoInertiaFactor(double mass, const Eigen::Vector3d& centre, const Eigen::Vector3d& radii) {
  Eigen::Matrix4d factor = Eigen::Matrix4d::Zero();
  factor.diagonal() << radii, 1.0;
  factor.topRightCorner<3, 1>() = centre;
  return std::sqrt(mass) * factor;
}

// theta: 10; inertial: the ten parameters, in the order of StandardIndex. T:
// double or an automatic-differentiation scalar.
template <typename T>
void InertialFromLogCholesky(const Eigen::Matrix4d& reference, const T* theta, T* inertial) {
  using std::exp;
  Eigen::Matrix<T, 4, 4> v = Eigen::Matrix<T, 4, 4>::Zero();
  v(0, 0) = exp(theta[1]);
  v(1, 1) = exp(theta[2]);
  v(2, 2) = exp(theta[3]);
  v(3, 3) = T(1.0);
  v(0, 1) = theta[4];
  v(1, 2) = theta[5];
  v(0, 2) = theta[6];
  for (int i = 0; i < 3; ++i) v(i, 3) = theta[7 + i];
  const Eigen::Matrix<T, 4, 4> u = exp(theta[0]) * (reference.cast<T>() * v);
  const Eigen::Matrix<T, 4, 4> p = u * u.transpose();
  inertial[kXX] = p(1, 1) + p(2, 2);
  inertial[kXY] = -p(0, 1);
  inertial[kXZ] = -p(0, 2);
  inertial[kYY] = p(0, 0) + p(2, 2);
  inertial[kYZ] = -p(1, 2);
  inertial[kZZ] = p(0, 0) + p(1, 1);
  for (int i = 0; i < 3; ++i) inertial[kMX + i] = p(i, 3);
  inertial[kM] = p(3, 3);
}

}  // namespace idim

#endif  // IDIM_CORE_ROBOT_LOG_CHOLESKY_H_
