#include "core/simulation/effects_drive_train.h"

#include <glog/logging.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/decompositions.h"

namespace idim::internal {
namespace {

constexpr int kSamples = 50;
// Of a substep, times the fastest angular frequency: RK4's error of phase is then below 1e-6 a radian.
constexpr double kPhasePerStep = 0.1;
// [rad or m] over which the damper of a contact takes hold, so that the torque is continuous.
constexpr double kContactDepth = 2e-5;
// Substeps in which a contact may open or close are so many times shorter.
constexpr int kContactSubsteps = 16;

double Instant(int sample, double start, double end) { return start + (end - start) * sample / (kSamples - 1.0); }

}  // namespace

Eigen::MatrixXd LinkInertia(const std::vector<int>& joints, const DriveTrain::LinkTorque& link_torque, double t,
                            const JointState& state) {
  const Eigen::Index size = static_cast<Eigen::Index>(joints.size());
  Eigen::MatrixXd inertia(size, size);
  JointState moved = state;
  moved.ddq.setZero();
  const Eigen::VectorXd bias = link_torque(t, moved);
  for (Eigen::Index c = 0; c < size; ++c) {
    moved.ddq.setZero();
    moved.ddq[joints[c]] = 1.0;
    const Eigen::VectorXd torque = link_torque(t, moved) - bias;
    for (Eigen::Index r = 0; r < size; ++r) inertia(r, c) = torque[joints[r]];
  }
  return 0.5 * (inertia + inertia.transpose());
}

bool InertiaIsPositive(const std::vector<int>& joints, const DriveTrain::LinkTorque& link_torque,
                       const Trajectory& trajectory, double start, double end) {
  for (int k = 0; k < kSamples; ++k) {
    const double t = Instant(k, start, end);
    const Eigen::MatrixXd inertia = LinkInertia(joints, link_torque, t, trajectory.At(t));
    const Eigen::LLT<Eigen::MatrixXd> factor(inertia);
    // A pivot that is rounding of the torques' difference is no inertia.
    if (factor.info() != Eigen::Success || factor.matrixLLT().diagonal().minCoeff() < 1e-5) return false;
  }
  return true;
}

DriveTrain::DriveTrain(std::vector<FlexibleJoint> joints, LinkTorque link_torque, const Trajectory& trajectory,
                       double start, double end)
    : joints_(std::move(joints)), link_torque_(std::move(link_torque)), trajectory_(trajectory) {
  std::vector<int> indices;
  Eigen::VectorXd stiffness(joints_.size()), damping(joints_.size());
  for (size_t i = 0; i < joints_.size(); ++i) {
    indices.push_back(joints_[i].joint);
    stiffness[i] = joints_[i].stiffness;
    damping[i] = joints_[i].damping;
  }
  CHECK(InertiaIsPositive(indices, link_torque_, trajectory, start, end));
  double fastest = 0.0;
  for (int k = 0; k < kSamples; ++k) {
    const double t = Instant(k, start, end);
    const Eigen::MatrixXd inertia = LinkInertia(indices, link_torque_, t, trajectory.At(t));
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> squared(stiffness.asDiagonal(), inertia,
                                                                            Eigen::EigenvaluesOnly);
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> decay(damping.asDiagonal(), inertia,
                                                                          Eigen::EigenvaluesOnly);
    fastest = std::max({fastest, std::sqrt(squared.eigenvalues().maxCoeff()), decay.eigenvalues().maxCoeff()});
  }
  longest_step_ = kPhasePerStep / fastest;
}

Eigen::VectorXd DriveTrain::Transmitted(const State& state) const {
  Eigen::VectorXd torque(joints_.size());
  for (size_t i = 0; i < joints_.size(); ++i) {
    const FlexibleJoint& joint = joints_[i];
    const double twist = -state.e[i];
    const double rate = -state.de[i];
    if (joint.half_gap == 0.0) {
      torque[i] = joint.stiffness * twist + joint.damping * rate;
      continue;
    }
    const double side = twist > 0.0 ? 1.0 : -1.0;
    const double depth = std::abs(twist) - joint.half_gap;  // of the contact
    const double share = std::clamp(depth / kContactDepth, 0.0, 1.0);
    torque[i] =
        depth <= 0.0 ? 0.0 : side * std::max(0.0, joint.stiffness * depth + share * joint.damping * side * rate);
  }
  return torque;
}

JointState DriveTrain::Links(const State& state, double t) const {
  JointState links = trajectory_.At(t);
  std::vector<int> indices;
  for (size_t i = 0; i < joints_.size(); ++i) {
    indices.push_back(joints_[i].joint);
    links.q[joints_[i].joint] += state.e[i];
    links.dq[joints_[i].joint] += state.de[i];
  }
  const Eigen::VectorXd now = link_torque_(t, links);
  Eigen::VectorXd missing = Transmitted(state);
  Eigen::MatrixXd inertia(missing.size(), missing.size());
  for (size_t c = 0; c < indices.size(); ++c) {
    JointState moved = links;
    moved.ddq[indices[c]] += 1.0;
    const Eigen::VectorXd torque = link_torque_(t, moved);
    for (size_t r = 0; r < indices.size(); ++r) inertia(r, c) = torque[indices[r]] - now[indices[r]];
    missing[c] -= now[indices[c]];
  }
  const Eigen::VectorXd more = inertia.ldlt().solve(missing);
  for (size_t i = 0; i < indices.size(); ++i) links.ddq[indices[i]] += more[i];
  return links;
}

DriveTrain::State DriveTrain::Derivative(const State& state, double t) const {
  const JointState links = Links(state, t);
  const Eigen::VectorXd motor = trajectory_.At(t).ddq;
  State derivative = {state.de, Eigen::VectorXd(joints_.size())};
  for (size_t i = 0; i < joints_.size(); ++i) {
    derivative.de[i] = links.ddq[joints_[i].joint] - motor[joints_[i].joint];
  }
  return derivative;
}

DriveTrain::State DriveTrain::Equilibrium(double t) const {
  const Eigen::Index size = static_cast<Eigen::Index>(joints_.size());
  State state = {Eigen::VectorXd::Zero(size), Eigen::VectorXd::Zero(size)};
  // The links' torque changes little over the twist, so that each step gains digits; what may remain is an oscillation
  // of that size, which damping ends before the recording begins.
  for (int iteration = 0; iteration < 20; ++iteration) {
    JointState links = trajectory_.At(t);
    for (Eigen::Index i = 0; i < size; ++i) links.q[joints_[i].joint] += state.e[i];
    const Eigen::VectorXd torque = link_torque_(t, links);
    for (Eigen::Index i = 0; i < size; ++i) {
      const double tau = torque[joints_[i].joint];
      const double play = tau > 0.0 ? joints_[i].half_gap : tau < 0.0 ? -joints_[i].half_gap : 0.0;
      state.e[i] = -tau / joints_[i].stiffness - play;
    }
  }
  return state;
}

DriveTrain::State DriveTrain::RungeKutta(const State& now, double t, double s) const {
  const auto moved = [](const State& from, const State& along, double by) {
    return State{from.e + by * along.e, from.de + by * along.de};
  };
  const State k1 = Derivative(now, t);
  const State k2 = Derivative(moved(now, k1, s / 2.0), t + s / 2.0);
  const State k3 = Derivative(moved(now, k2, s / 2.0), t + s / 2.0);
  const State k4 = Derivative(moved(now, k3, s), t + s);
  return {now.e + s / 6.0 * (k1.e + 2.0 * k2.e + 2.0 * k3.e + k4.e),
          now.de + s / 6.0 * (k1.de + 2.0 * k2.de + 2.0 * k3.de + k4.de)};
}

bool DriveTrain::NearContact(const State& state, double h) const {
  for (size_t i = 0; i < joints_.size(); ++i) {
    if (joints_[i].half_gap == 0.0) continue;
    const double depth = std::abs(state.e[i]) - joints_[i].half_gap;
    const double way = h * std::abs(state.de[i]);
    // A link that leans on the contact and hardly moves needs no shorter steps.
    if (way > kContactDepth / 50.0 && depth > -2.0 * way && depth < kContactDepth + 2.0 * way) return true;
  }
  return false;
}

DriveTrain::State DriveTrain::Step(const State& state, double t, double h) const {
  const int substeps = std::max(1, static_cast<int>(std::ceil(h / longest_step_)));
  const double s = h / substeps;
  State now = state;
  for (int k = 0; k < substeps; ++k) {
    const int parts = NearContact(now, s) ? kContactSubsteps : 1;
    for (int part = 0; part < parts; ++part) now = RungeKutta(now, t + (k + part * 1.0 / parts) * s, s / parts);
  }
  return now;
}

}  // namespace idim::internal
