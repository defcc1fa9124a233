#include "core/dynamics/rigid_body_derivatives.h"

#include <Eigen/Geometry>
#include <cmath>

namespace idim {

using Eigen::Matrix3d;
using Eigen::Vector3d;

RigidBodyDerivatives::RigidBodyDerivatives(const Robot& robot)
    : gravity_(robot.gravity), joints_(robot.joints), bodies_(robot.joints.size()), links_(robot.joints.size()) {}

// rotation, origin: pose of the link. Its points move with r' = u + w x r and r'' = a + dw x r + w x (w x r).
void RigidBodyDerivatives::AddBody(int j, const Matrix3d& rotation, const Vector3d& origin,
                                   const InertialVector& inertial, const Vector3d& w, const Vector3d& u,
                                   const Vector3d& dw, const Vector3d& a) {
  Body& body = bodies_[j];
  const double mass = inertial[kM];
  const Vector3d centre = rotation.lazyProduct(inertial.segment<3>(kMX));  // first moment about the link's origin
  const Vector3d first = mass * origin + centre;
  Matrix3d tensor;
  tensor << inertial[kXX], inertial[kXY], inertial[kXZ], inertial[kXY], inertial[kYY], inertial[kYZ], inertial[kXZ],
      inertial[kYZ], inertial[kZZ];
  const Matrix3d half = rotation.lazyProduct(tensor);
  Matrix3d inertia = half.lazyProduct(rotation.transpose());
  // Steiner: tr(A) 1 - A with A = centre origin' + origin first'.
  inertia -= centre.lazyProduct(origin.transpose()) + origin.lazyProduct(first.transpose());
  inertia.diagonal().array() += centre.dot(origin) + origin.dot(first);

  // int r r^T of the link, then int r' r^T = u first' + [w] int r r^T.
  Matrix3d second = -inertia;
  second.diagonal().array() += 0.5 * inertia.trace();
  Matrix3d velocity = u.lazyProduct(first.transpose());
  for (int c = 0; c < 3; ++c) velocity.col(c) += w.cross(second.col(c));
  body.mass = mass;
  body.first = first;
  body.momentum = mass * u + w.cross(first);
  body.force = mass * a + dw.cross(first) + w.cross(w.cross(first));
  body.moment = first.cross(a) + inertia.lazyProduct(dw) + w.cross(inertia.lazyProduct(w));
  body.inertia = inertia;
  body.velocity = -velocity;
  body.velocity.diagonal().array() += velocity.trace();
}

void RigidBodyDerivatives::InverseDynamics(const double* state, const InertialVector* inertials, double* d) {
  const int n = dof();
  const double* q = state;
  const double* dq = state + n;
  const double* ddq = state + 2 * n;
  Matrix3d rotation = Matrix3d::Identity();
  Vector3d origin = Vector3d::Zero();
  // Velocity and acceleration fields of the link: r' = u + w x r, r'' = a + dw x r + w x (w x r), a = b + w x u with
  // b the sum of the joints' shares alone.
  Vector3d w = Vector3d::Zero(), u = Vector3d::Zero(), dw = Vector3d::Zero(), b = -gravity_;
  for (int j = 0; j < n; ++j) {
    const Joint& joint = joints_[j];
    Body& body = bodies_[j];
    const bool revolute = joint.type == JointType::kRevolute;
    origin += rotation.lazyProduct(joint.translation);
    const Matrix3d fixed = rotation.lazyProduct(joint.rotation);
    const Vector3d axis = fixed.col(2);
    const Vector3d daxis = w.cross(axis);
    const Vector3d ddaxis = dw.cross(axis) + w.cross(daxis);
    if (revolute) {
      const double c = std::cos(q[j]), s = std::sin(q[j]);
      rotation.col(0) = fixed.col(0) * c + fixed.col(1) * s;
      rotation.col(1) = fixed.col(1) * c - fixed.col(0) * s;
      rotation.col(2) = axis;
      const Vector3d velocity = u + w.cross(origin);
      const Vector3d acceleration = b + dw.cross(origin) + w.cross(velocity);
      body.z = axis;
      body.dz = daxis;
      body.ddz = ddaxis;
      body.s = origin.cross(axis);
      body.ds = velocity.cross(axis) + origin.cross(daxis);
      // Only the difference of accelerations of two points matters, so that gravity may stay in.
      body.dds = acceleration.cross(axis) + 2.0 * velocity.cross(daxis) + origin.cross(ddaxis);
      w += axis * dq[j];
      dw += axis * ddq[j] + daxis * dq[j];
    } else {
      rotation = fixed;
      origin += axis * q[j];
      body.z.setZero();
      body.dz.setZero();
      body.ddz.setZero();
      body.s = axis;
      body.ds = daxis;
      body.dds = ddaxis;
    }
    u += body.s * dq[j];
    b += body.s * ddq[j] + body.ds * dq[j];
    AddBody(j, rotation, origin, inertials[j], w, u, dw, b + w.cross(u));
  }
  for (int m = n - 1; m >= 0; --m) {
    Body& body = bodies_[m];
    if (m < n - 1) {
      const Body& next = bodies_[m + 1];
      body.mass += next.mass;
      body.first += next.first;
      body.momentum += next.momentum;
      body.force += next.force;
      body.moment += next.moment;
      body.inertia += next.inertia;
      body.velocity += next.velocity;
    }
    // What S_m makes of the fields of joints i <= m: row m.
    const Vector3d by_z = body.inertia.lazyProduct(body.z) + body.first.cross(body.s);
    const Vector3d by_s = body.z.cross(body.first) + body.mass * body.s;
    const Vector3d turning = body.velocity.transpose().lazyProduct(body.z) + body.momentum.cross(body.s);
    for (int i = 0; i <= m; ++i) {
      const Body& other = bodies_[i];
      d[i * n + m] = other.ddz.dot(by_z) + other.dds.dot(by_s) + 2.0 * other.dz.dot(turning);
      d[(n + i) * n + m] = 2.0 * (other.dz.dot(by_z) + other.ds.dot(by_s) + other.z.dot(turning));
      d[(2 * n + i) * n + m] = d[(2 * n + m) * n + i] = other.z.dot(by_z) + other.s.dot(by_s);
    }
    // Moment and force of the rates of S_m, for the joints j < m: columns m.
    const Vector3d moment_dq =
        body.inertia.lazyProduct(body.dz) + body.velocity.lazyProduct(body.z) + body.first.cross(body.ds);
    const Vector3d force_dq = body.dz.cross(body.first) + body.z.cross(body.momentum) + body.mass * body.ds;
    const Vector3d moment_q = body.inertia.lazyProduct(body.ddz) + 2.0 * body.velocity.lazyProduct(body.dz) +
                              body.z.cross(body.moment) + body.first.cross(body.dds) + body.s.cross(body.force);
    const Vector3d force_q = body.ddz.cross(body.first) + 2.0 * body.dz.cross(body.momentum) +
                             body.z.cross(body.force) + body.mass * body.dds;
    for (int j = 0; j < m; ++j) {
      const Body& other = bodies_[j];
      d[m * n + j] = other.z.dot(moment_q) + other.s.dot(force_q);
      d[(n + m) * n + j] = 2.0 * (other.z.dot(moment_dq) + other.s.dot(force_dq));
    }
  }
}

RigidBodyDerivatives::Pair RigidBodyDerivatives::RotateBack(const LinkState& s, const Vector3d& value,
                                                            const Vector3d& change) {
  Pair result{s.rotation.transpose().lazyProduct(value), s.rotation.transpose().lazyProduct(change)};
  result.change[0] += result.value[1] * s.turn;
  result.change[1] -= result.value[0] * s.turn;
  return result;
}

void RigidBodyDerivatives::Forward(const double* state, const double* direction) {
  const int n = dof();
  const Vector3d zero = Vector3d::Zero();
  Pair w{zero, zero}, dw{zero, zero}, a{-gravity_, zero};
  for (int j = 0; j < n; ++j) {
    LinkState& s = links_[j];
    const Joint& joint = joints_[j];
    const bool revolute = joint.type == JointType::kRevolute;
    const double dq = state[n + j], ddq = state[2 * n + j];
    const double change_dq = direction[n + j], change_ddq = direction[2 * n + j];
    s.translation = {joint.translation, zero};
    s.turn = 0.0;
    s.rotation = joint.rotation;
    if (revolute) {
      const double c = std::cos(state[j]), sn = std::sin(state[j]);
      s.rotation.col(0) = joint.rotation.col(0) * c + joint.rotation.col(1) * sn;
      s.rotation.col(1) = joint.rotation.col(1) * c - joint.rotation.col(0) * sn;
      s.turn = direction[j];
    } else {
      s.translation.value += joint.rotation.col(2) * state[j];
      s.translation.change = joint.rotation.col(2) * direction[j];
    }
    const Pair& p = s.translation;
    const Vector3d speed = w.value.cross(p.value);
    const Vector3d change_speed = w.change.cross(p.value) + w.value.cross(p.change);
    s.a = RotateBack(s, a.value + dw.value.cross(p.value) + w.value.cross(speed),
                     a.change + dw.change.cross(p.value) + dw.value.cross(p.change) + w.change.cross(speed) +
                         w.value.cross(change_speed));
    s.w = RotateBack(s, w.value, w.change);
    s.dw = RotateBack(s, dw.value, dw.change);
    // w x (dq z) = dq (w_y, -w_x, 0), once for the angular acceleration, twice for the linear one.
    Pair& accelerated = revolute ? s.dw : s.a;
    const double times = revolute ? 1.0 : 2.0;
    accelerated.value += Vector3d(times * s.w.value[1] * dq, -times * s.w.value[0] * dq, ddq);
    accelerated.change += Vector3d(times * (s.w.change[1] * dq + s.w.value[1] * change_dq),
                                   -times * (s.w.change[0] * dq + s.w.value[0] * change_dq), change_ddq);
    if (revolute) {
      s.w.value[2] += dq;
      s.w.change[2] += change_dq;
    }
    w = s.w;
    dw = s.dw;
    a = s.a;
  }
}

// Of v . f + tw . n, column by column of the ten parameters.
void RigidBodyDerivatives::ChangeOfColumns(const LinkState& link, const Pair& twist_w, const Pair& twist_v,
                                           double* out) {
  const Vector3d &w = link.w.value, &dw = link.dw.value, &a = link.a.value;
  const Vector3d &cw = link.w.change, &cdw = link.dw.change, &ca = link.a.change;
  const Vector3d &t = twist_w.value, &v = twist_v.value, &ct = twist_w.change, &cv = twist_v.change;
  const Vector3d u = t.cross(w);  // tw . (w x I w) = u . (I w)
  const Vector3d cu = ct.cross(w) + t.cross(cw);
  const auto tensor = [&](int x, int y) { return ct[x] * dw[y] + t[x] * cdw[y] + cu[x] * w[y] + u[x] * cw[y]; };
  out[kXX] = tensor(0, 0);
  out[kXY] = tensor(0, 1) + tensor(1, 0);
  out[kXZ] = tensor(0, 2) + tensor(2, 0);
  out[kYY] = tensor(1, 1);
  out[kYZ] = tensor(1, 2) + tensor(2, 1);
  out[kZZ] = tensor(2, 2);
  // v . (dw x h + w x (w x h)) + tw . (h x a) = h . (v x dw + (v x w) x w + a x tw)
  const Vector3d speed = v.cross(w);
  const Vector3d h =
      cv.cross(dw) + v.cross(cdw) + (cv.cross(w) + v.cross(cw)).cross(w) + speed.cross(cw) + ca.cross(t) + a.cross(ct);
  out[kMX] = h[0];
  out[kMY] = h[1];
  out[kMZ] = h[2];
  out[kM] = cv.dot(a) + v.dot(ca);
}

void RigidBodyDerivatives::Regressor(const double* state, const double* direction, double* change) {
  const int n = dof();
  const Vector3d zero = Vector3d::Zero(), z = Vector3d::UnitZ();
  Forward(state, direction);
  for (int j = 0; j < n; ++j) {
    LinkState& s = links_[j];
    for (int i = 0; i < j; ++i) {
      Pair &t = links_[i].twist_w, &v = links_[i].twist_v;
      v = RotateBack(s, v.value + t.value.cross(s.translation.value),
                     v.change + t.change.cross(s.translation.value) + t.value.cross(s.translation.change));
      t = RotateBack(s, t.value, t.change);
    }
    const bool revolute = joints_[j].type == JointType::kRevolute;
    s.twist_w = {revolute ? z : zero, zero};
    s.twist_v = {revolute ? zero : z, zero};
    for (int i = 0; i <= j; ++i) {
      ChangeOfColumns(s, links_[i].twist_w, links_[i].twist_v, change + kNumInertial * (i * n + j));
    }
  }
}

}  // namespace idim
