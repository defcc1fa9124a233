// The link is not where the motor is: the position is measured at the motor, and the transmission of joint j gives way
// by p d_j(t), p the parameter: q_link = q + p d_j e_j. Motor, drive inertia (where the base parameters tell it from
// the links') and friction stay at the measured state; the torque of the links moves to first order in p,
//   column = d tau_link / dq_j d_j + d tau_link / d(dq_j) d_j' + d tau_link / d(ddq_j) d_j'',
// in the rows of all joints, by a central difference along (d_j, d_j', d_j''): exact in velocity and acceleration, of
// which torque is a polynomial of second degree. d_j' and d_j'' are central differences in time.
//
// Compliance: d_j = -tau_link,j, the torque that the transmission carries.
//
// Backlash: d_j = r / b, r the link's place within the half gap b. In contact r = -b while the motor pushes forwards, b
// backwards. Where the torque turns its sign the link is let go and flies, the transmission carries nothing:
//   r'' = -tau_link,j / M_jj,
// until the other flank stops it (no rebound). The flight takes (12 b M / tau')^(1/3), tens of milliseconds, and
// depends on b: the half gap is the shape as well as, in the true model, the value of the linear parameter. A smooth
// sign of the torque in its place misses all of a simulated backlash: it is early and far too fast.

#include <glog/logging.h>

#include <algorithm>
#include <cmath>

#include "core/effects/columns.h"
#include "core/effects/registry.h"

namespace idim {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kStep = 1e-4;  // [rad or m] the largest displacement of the central difference

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

// r(t) [rad or m] of the backlash. Where the links have no inertia about the joint (a poor estimate) they change sides
// at once.
VectorXd PlaceInGap(const EffectMotion& motion, int joint, double half_gap) {
  const Index count = motion.t.size();
  const VectorXd rest = VectorXd::Zero(motion.robot->dof());
  const VectorXd unit = VectorXd::Unit(motion.robot->dof(), joint);
  VectorXd place(count);
  double r = 0.0, speed = 0.0;
  for (Index i = 0; i < count; ++i) {
    const double torque = motion.link(i, joint);
    const double flank = torque > 0.0 ? -half_gap : torque < 0.0 ? half_gap : r;
    if (i == 0) {
      r = flank;
    } else if (r != flank) {
      const VectorXd q = motion.q.row(i);
      const double inertia = motion.link_torque(q, rest, unit, Vector3d::Zero())[joint];
      const double step = motion.t[i] - motion.t[i - 1];
      speed -= inertia > 0.0 ? step * torque / inertia : 0.0;
      r = inertia > 0.0 ? std::clamp(r + step * speed, -half_gap, half_gap) : flank;
    }
    if (std::abs(r) == half_gap) speed = 0.0;
    place[i] = r;
  }
  return place;
}

class JointElasticity : public Effect {
 public:
  std::string id() const override { return "joint_elasticity"; }
  EffectSite site() const override { return EffectSite::kJoint; }
  bool non_negative() const override { return true; }
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
    return LinkTorqueAlong(motion, joint, ForDerivatives(motion, -motion.link.col(joint)));
  }
};

class Backlash : public Effect {
 public:
  std::string id() const override { return "backlash"; }
  EffectSite site() const override { return EffectSite::kJoint; }
  bool non_negative() const override { return true; }
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

  std::vector<ShapeParameter> Shapes(const std::vector<EffectMotion>& motions,
                                     const std::vector<int>& joints) const override {
    const int joint = OnlyJoint(joints);
    CHECK(!motions.empty());
    const double largest = IsPrismatic(*motions[0].robot, joint) ? 1e-3 : 1e-2;
    return {{"half_gap", AngleUnit(*motions[0].robot, joint), 1e-3 * largest, largest,
             LogGrid(1e-3 * largest, largest, 7)}};
  }

  std::vector<EffectEntry> Columns(const EffectMotion& motion, const std::vector<int>& joints,
                                   const VectorXd& shape) const override {
    const int joint = OnlyJoint(joints);
    CHECK_EQ(shape.size(), 1);
    CHECK_GT(shape[0], 0.0);
    return LinkTorqueAlong(motion, joint, PlaceInGap(motion, joint, shape[0]) / shape[0]);
  }
};

}  // namespace

std::unique_ptr<Effect> MakeJointElasticity() { return std::make_unique<JointElasticity>(); }
std::unique_ptr<Effect> MakeBacklash() { return std::make_unique<Backlash>(); }

}  // namespace idim
