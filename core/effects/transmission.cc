// The link is not where the motor is: the position is measured at the motor, and the transmission of joint j gives way
// by p d_j(t), p the parameter:
//   q_link = q + p d_j e_j,      d_j = -tau_link,j (compliance),     d_j = -tanh(tau_link,j / tau_0) (backlash).
// tau_link is the torque that the transmission carries: links and payload, no friction, no drive inertia where the base
// parameters tell it from the links'. Motor and friction stay at the measured state; the torque of the links moves to
// first order in p,
//   column = d tau_link / dq_j d_j + d tau_link / d(dq_j) d_j' + d tau_link / d(ddq_j) d_j'',
// in the rows of all joints, by a central difference along (d_j, d_j', d_j''): exact in velocity and acceleration, of
// which torque is a polynomial of second degree. d_j' and d_j'' are central differences in time.

#include <glog/logging.h>

#include <algorithm>
#include <cmath>

#include "core/effects/columns.h"
#include "core/effects/registry.h"

namespace idim {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kStep = 1e-4;           // [rad or m] the largest displacement of the central difference
constexpr double kContactTorque = 0.02;  // tau_0 of the backlash, relative to the rms of the torque

std::vector<EffectEntry> LinkTorqueAlong(const EffectMotion& motion, int joint, const VectorXd& displacement) {
  const Index count = motion.t.size();
  const double largest = count == 0 ? 0.0 : displacement.cwiseAbs().maxCoeff();
  if (!(largest > 0.0)) return {};
  const VectorXd velocity = TimeDerivative(motion.t, displacement);
  const VectorXd acceleration = TimeDerivative(motion.t, velocity);
  const double step = kStep / largest;
  const int n = motion.robot->dof();
  MatrixXd column(count, n);
  VectorXd moved[2];
  for (Index i = 0; i < count; ++i) {
    for (const int side : {0, 1}) {
      const double h = side == 0 ? -step : step;
      VectorXd q = motion.q.row(i), dq = motion.dq.row(i), ddq = motion.ddq.row(i);
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

class JointElasticity : public Effect {
 public:
  std::string id() const override { return "joint_elasticity"; }
  EffectSite site() const override { return EffectSite::kJoint; }
  std::string physics() const override {
    return "The transmission twists by Ce times the torque it carries: the link is not where the motor's encoder says.";
  }
  std::string how_to_confirm() const override {
    return "Brake on, load the link by known weights at a known arm and read its rotation with a dial gauge: "
           "rotation over torque is Ce; or tap it and compare the resonance.";
  }

  std::vector<Parameter> Parameters(const Robot& robot, const std::vector<int>& joints) const override {
    const int joint = OnlyJoint(joints);
    return {JointParameter("Ce", joint, IsPrismatic(robot, joint) ? "m/N" : "rad/(N.m)")};
  }

  std::vector<EffectEntry> Columns(const EffectMotion& motion, const std::vector<int>& joints,
                                   const VectorXd& shape) const override {
    const int joint = OnlyJoint(joints);
    CHECK_EQ(shape.size(), 0);
    return LinkTorqueAlong(motion, joint, -motion.link.col(joint));
  }
};

class Backlash : public Effect {
 public:
  std::string id() const override { return "backlash"; }
  EffectSite site() const override { return EffectSite::kJoint; }
  std::string physics() const override {
    return "Play in the transmission: the link lies on one flank or the other by the half gap Bl as the torque it "
           "carries turns its sign.";
  }
  std::string how_to_confirm() const override {
    return "Brake on, near balance, push the link lightly to and fro with a dial gauge on it: it moves by twice Bl "
           "without resistance.";
  }

  std::vector<Parameter> Parameters(const Robot& robot, const std::vector<int>& joints) const override {
    const int joint = OnlyJoint(joints);
    return {JointParameter("Bl", joint, AngleUnit(robot, joint))};
  }

  std::vector<EffectEntry> Columns(const EffectMotion& motion, const std::vector<int>& joints,
                                   const VectorXd& shape) const override {
    const int joint = OnlyJoint(joints);
    CHECK_EQ(shape.size(), 0);
    const VectorXd torque = motion.link.col(joint);
    const double rms = torque.norm() / std::sqrt(std::max<double>(1.0, static_cast<double>(torque.size())));
    if (!(rms > 0.0)) return {};
    return LinkTorqueAlong(motion, joint, -(torque.array() / (kContactTorque * rms)).tanh());
  }
};

}  // namespace

std::unique_ptr<Effect> MakeJointElasticity() { return std::make_unique<JointElasticity>(); }
std::unique_ptr<Effect> MakeBacklash() { return std::make_unique<Backlash>(); }

}  // namespace idim
