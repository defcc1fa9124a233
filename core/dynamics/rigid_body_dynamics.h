// Inverse dynamics of a serial arm and its regressor, by the recursive Newton-Euler scheme.
//
// tau = IDM(q, dq, ddq) X, with X the ten inertial parameters of every link about its frame's origin
// (eq. (1) of Gautier & Briot 2014 without the drive terms, which are core/dynamics/standard_model.h).
// With w, dw, a the angular velocity, angular acceleration and linear acceleration minus gravity of frame j, in
// frame j, and I, h, M the parameters of link j, the wrench of link j about its origin is
//   f = M a + U h,   n = I dw + w x (I w) + h x a,   U = [dw]x + [w]x [w]x.
// Inverse dynamics sums wrenches from the tip (Luh, Walker & Paul 1980). The regressor does not move wrenches:
// it moves the unit twists (z_i; 0) of the joints forward to each link, where they meet the parameters in their own
// frame, which costs 6 numbers a pair of joint and link in place of 6 x 10.
//
// T is double, or an automatic-differentiation scalar for derivatives by (q, dq, ddq).

#ifndef IDIM_CORE_DYNAMICS_RIGID_BODY_DYNAMICS_H_
#define IDIM_CORE_DYNAMICS_RIGID_BODY_DYNAMICS_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "core/robot/robot.h"

namespace idim {

// Not thread-safe: holds the workspace of one evaluation. Make one a thread.
template <typename T>
class RigidBodyDynamics {
 public:
  using Vector3 = Eigen::Matrix<T, 3, 1>;
  using Matrix3 = Eigen::Matrix<T, 3, 3>;

  explicit RigidBodyDynamics(const Robot& robot)
      : gravity_(robot.gravity.cast<T>()), joints_(robot.joints), links_(robot.joints.size()) {}

  int dof() const { return static_cast<int>(joints_.size()); }

  // q, dq, ddq: n; inertials: n; tau: n [N.m or N], joint side, without drive terms.
  void InverseDynamics(const T* q, const T* dq, const T* ddq, const InertialVector* inertials, T* tau) {
    const int n = dof();
    Forward(q, dq, ddq);
    Vector3 force = Vector3::Zero();  // of the links from j on, in frame j, about its origin
    Vector3 moment = Vector3::Zero();
    for (int j = n - 1; j >= 0; --j) {
      const LinkState& s = links_[j];
      const InertialVector& x = inertials[j];
      if (j < n - 1) {
        const LinkState& child = links_[j + 1];
        force = Rotate(child.rotation, force);
        moment = Rotate(child.rotation, moment) + child.translation.cross(force);
      }
      const Vector3 h = x.template segment<3>(kMX).template cast<T>();
      const Vector3 momentum = TensorTimes(x, s.w);
      force += s.a * T(x[kM]) + s.dw.cross(h) + s.w.cross(s.w.cross(h));
      moment += TensorTimes(x, s.dw) + s.w.cross(momentum) + h.cross(s.a);
      tau[j] = joints_[j].type == JointType::kRevolute ? moment[2] : force[2];
    }
  }

  // regressor: n x (10 n), row-major: row i holds the torque of joint i by the parameters of links 1..n in the order
  // of StandardIndex; the blocks of links before joint i are zero.
  void Regressor(const T* q, const T* dq, const T* ddq, T* regressor) {
    const int n = dof();
    const int columns = kNumInertial * n;
    Forward(q, dq, ddq);
    for (int j = 0; j < n; ++j) {
      const LinkState& s = links_[j];
      MoveTwists(j);
      for (int i = 0; i <= j; ++i) {
        TwistTimesWrench(links_[i].twist_w, links_[i].twist_v, s, regressor + i * columns + kNumInertial * j);
      }
      for (int i = j + 1; i < n; ++i) {
        T* block = regressor + i * columns + kNumInertial * j;
        for (int k = 0; k < kNumInertial; ++k) block[k] = T(0);
      }
    }
  }

 private:
  struct LinkState {
    Matrix3 rotation;          // of frame j in frame j-1
    Vector3 translation;       // of the origin of frame j in frame j-1
    Vector3 w, dw, a;          // in frame j; a is of the origin, minus gravity
    Vector3 twist_w, twist_v;  // of joint j, in the frame of the link being visited, about its origin
  };

  static Vector3 Rotate(const Matrix3& r, const Vector3& v) { return r.lazyProduct(v); }
  static Vector3 RotateBack(const Matrix3& r, const Vector3& v) { return r.transpose().lazyProduct(v); }

  static Vector3 TensorTimes(const InertialVector& x, const Vector3& v) {
    return Vector3(v[0] * x[kXX] + v[1] * x[kXY] + v[2] * x[kXZ], v[0] * x[kXY] + v[1] * x[kYY] + v[2] * x[kYZ],
                   v[0] * x[kXZ] + v[1] * x[kYZ] + v[2] * x[kZZ]);
  }

  void Forward(const T* q, const T* dq, const T* ddq) {
    Vector3 w = Vector3::Zero(), dw = Vector3::Zero();
    Vector3 a = -gravity_;
    for (int j = 0; j < dof(); ++j) {
      LinkState& s = links_[j];
      const Joint& joint = joints_[j];
      const auto fixed = joint.rotation.template cast<T>();
      s.translation = joint.translation.template cast<T>();
      if (joint.type == JointType::kRevolute) {
        using std::cos;
        using std::sin;
        const T c = cos(q[j]);
        const T sn = sin(q[j]);
        s.rotation.col(0) = fixed.col(0) * c + fixed.col(1) * sn;
        s.rotation.col(1) = fixed.col(1) * c - fixed.col(0) * sn;
        s.rotation.col(2) = fixed.col(2);
      } else {
        s.rotation = fixed;
        s.translation += fixed.col(2) * q[j];
      }
      const Vector3& p = s.translation;
      s.a = RotateBack(s.rotation, a + dw.cross(p) + w.cross(w.cross(p)));
      s.w = RotateBack(s.rotation, w);
      s.dw = RotateBack(s.rotation, dw);
      if (joint.type == JointType::kRevolute) {
        // w x (dq z) = dq (w_y, -w_x, 0), with w still without the joint's own velocity.
        s.dw[0] += s.w[1] * dq[j];
        s.dw[1] -= s.w[0] * dq[j];
        s.dw[2] += ddq[j];
        s.w[2] += dq[j];
      } else {
        s.a[0] += T(2) * s.w[1] * dq[j];
        s.a[1] -= T(2) * s.w[0] * dq[j];
        s.a[2] += ddq[j];
      }
      w = s.w;
      dw = s.dw;
      a = s.a;
    }
  }

  // Twists of joints 0..j-1 from frame j-1 to frame j; the twist of joint j starts there.
  void MoveTwists(int j) {
    const LinkState& s = links_[j];
    for (int i = 0; i < j; ++i) {
      LinkState& t = links_[i];
      const Vector3 v = t.twist_v + t.twist_w.cross(s.translation);
      t.twist_v = RotateBack(s.rotation, v);
      t.twist_w = RotateBack(s.rotation, t.twist_w);
    }
    const bool revolute = joints_[j].type == JointType::kRevolute;
    links_[j].twist_w = Vector3(T(0), T(0), T(revolute ? 1 : 0));
    links_[j].twist_v = Vector3(T(0), T(0), T(revolute ? 0 : 1));
  }

  // v . f + tw . n, column by column of the ten parameters.
  static void TwistTimesWrench(const Vector3& tw, const Vector3& v, const LinkState& s, T* out) {
    const Vector3& w = s.w;
    const Vector3& dw = s.dw;
    const Vector3 u = tw.cross(w);  // tw . (w x I w) = u . (I w)
    out[kXX] = tw[0] * dw[0] + u[0] * w[0];
    out[kXY] = tw[0] * dw[1] + tw[1] * dw[0] + u[0] * w[1] + u[1] * w[0];
    out[kXZ] = tw[0] * dw[2] + tw[2] * dw[0] + u[0] * w[2] + u[2] * w[0];
    out[kYY] = tw[1] * dw[1] + u[1] * w[1];
    out[kYZ] = tw[1] * dw[2] + tw[2] * dw[1] + u[1] * w[2] + u[2] * w[1];
    out[kZZ] = tw[2] * dw[2] + u[2] * w[2];
    // v . (dw x h + w x (w x h)) + tw . (h x a) = h . (v x dw + (v x w) x w + a x tw)
    const Vector3 h = v.cross(dw) + v.cross(w).cross(w) + s.a.cross(tw);
    out[kMX] = h[0];
    out[kMY] = h[1];
    out[kMZ] = h[2];
    out[kM] = v.dot(s.a);
  }

  Vector3 gravity_;
  std::vector<Joint> joints_;
  std::vector<LinkState> links_;
};

}  // namespace idim

#endif  // IDIM_CORE_DYNAMICS_RIGID_BODY_DYNAMICS_H_
