// Derivatives of inverse dynamics and of its regressor by the joint state, in closed form.
//
// Torque. For a point r of the arm let S_i = dr/dq_i = z_i x r + s_i be the field of joint i (prismatic: z_i = 0, s_i
// the axis), r'' the acceleration minus gravity, n = max(i, j). With integrals over the mass of the links from n on,
//   tau_j = int S_j . r'',   dtau_j/dddq_i = int S_j . S_i,   dtau_j/ddq_i = 2 int S_j . S_i',
//   dtau_j/dq_i = int S_j . S_i'' + int d2r/(dq_i dq_j) . r'',
// because dr'/ddq = dr/dq, dr''/ddq = 2 (dr/dq)' and dr''/dq = (dr/dq)''. Of these links together they need the
// mass, int r, r', r'' and int r r^T, r' r^T, r x r'', summed once from the tip: what the recursion of Carpentier &
// Mansard (2018, "Analytical derivatives of rigid body dynamics algorithms") carries as spatial inertias and their
// variations. Parameters enter linearly and need not be physically consistent.
//
// Regressor. An entry is bilinear in the twist of a joint and the accelerations of a link, both in the link's frame
// (core/dynamics/rigid_body_dynamics.h); each goes to the tip together with its derivative along one direction of the
// state space.
//
// Moments are about the origin of the base: a base far away in comparison with the reach costs digits.

#ifndef IDIM_CORE_DYNAMICS_RIGID_BODY_DERIVATIVES_H_
#define IDIM_CORE_DYNAMICS_RIGID_BODY_DERIVATIVES_H_

#include <Eigen/Core>
#include <vector>

#include "core/robot/robot.h"

namespace idim {

// Not thread-safe: holds the workspace of one evaluation. Make one a thread. Evaluation allocates no memory.
class RigidBodyDerivatives {
 public:
  explicit RigidBodyDerivatives(const Robot& robot);

  int dof() const { return static_cast<int>(joints_.size()); }

  // state: 3n, (q, dq, ddq) of all joints; inertials: n; d: n x 3n, column-major, dtau/d(q, dq, ddq) [N.m or N a unit],
  // joint side, without drive terms.
  void InverseDynamics(const double* state, const InertialVector* inertials, double* d);

  // direction: 3n; change: n x 10n, row-major, the derivative of RigidBodyDynamics::Regressor along `direction`. The
  // blocks of links before the row's joint, which are zero, are not written.
  void Regressor(const double* state, const double* direction, double* change);

 private:
  // In the base frame, about its origin.
  struct Body {
    Eigen::Vector3d z, dz, ddz, s, ds, dds;          // field of the joint and its rates
    double mass;                                     // of the links from this one on, once summed; the others too
    Eigen::Vector3d first, momentum, force, moment;  // int r, r', r'', r x r''
    Eigen::Matrix3d inertia, velocity;               // tr(A) 1 - A with A = int r r^T and A = int r' r^T
  };
  // A quantity in a link's frame and its derivative along the direction.
  struct Pair {
    Eigen::Vector3d value, change;
  };

  // What a link or a twist brings to its ten columns.
  struct LinkState {
    Eigen::Matrix3d rotation;  // of frame j in frame j-1
    Pair translation;          // of the origin of frame j in frame j-1
    Pair w, dw, a;             // as RigidBodyDynamics has them
    Pair twist_w, twist_v;     // of joint j, in the frame of the link being visited, about its origin
    double turn;               // change of the joint's angle
  };

  void AddBody(int j, const Eigen::Matrix3d& rotation, const Eigen::Vector3d& origin, const InertialVector& inertial,
               const Eigen::Vector3d& w, const Eigen::Vector3d& u, const Eigen::Vector3d& dw, const Eigen::Vector3d& a);
  void Forward(const double* state, const double* direction);
  static Pair RotateBack(const LinkState& s, const Eigen::Vector3d& value, const Eigen::Vector3d& change);
  static void ChangeOfColumns(const LinkState& link, const Pair& twist_w, const Pair& twist_v, double* out);

  Eigen::Vector3d gravity_;
  std::vector<Joint> joints_;
  std::vector<Body> bodies_;
  std::vector<LinkState> links_;
};

}  // namespace idim

#endif  // IDIM_CORE_DYNAMICS_RIGID_BODY_DERIVATIVES_H_
