// Play in a transmission: the link's displacement (core/effects/link_displacement.h) is d_j = r / b, r the link's place
// within the half gap b. In contact r = -b while the motor pushes forwards, b backwards. Where the torque turns its
// sign the link is let go and flies, the transmission carries nothing:
//   r'' = -tau_link,j / M_jj,
// until the other flank stops it (no rebound). The flight takes (12 b M / tau')^(1/3), tens of milliseconds, and
// depends on b: the half gap is the shape as well as, in the true model, the value of the linear parameter. A smooth
// sign of the torque in its place misses all of a simulated backlash: it is early and far too fast.

#include <glog/logging.h>

#include <algorithm>
#include <cmath>

#include "core/effects/columns.h"
#include "core/effects/link_displacement.h"
#include "core/effects/registry.h"
#include "core/simulation/effect_equation.h"

namespace idim {
namespace {

using Eigen::Index;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr char kBacklashId[] = "backlash";

// gap [rad] (whole), contact_frequency [Hz] (100), damping_ratio (0.3): play between motor and link, with an elastic
// contact of the stiffness M (2 pi contact_frequency)^2 that does not pull; M: core/simulation/effects_drive_train.h.
class BacklashEquation : public EffectEquation {
 public:
  BacklashEquation()
      : EffectEquation(
            kBacklashId, EffectJoints::kOneOrMore,
            {EffectKey::From(0.0, 1.0, "gap", 1), EffectKey::From(1.0, 2000.0, "contact_frequency").Optional(100.0),
             EffectKey::From(0.01, 2.0, "damping_ratio").Optional(0.3)}) {}
  bool once_a_joint() const override { return true; }
  bool is_flexible() const override { return true; }

  std::map<std::string, double> DrawValues(double, Random*) const override { return {{"gap", 0.003}}; }

  Transmission TransmissionOf(const SimulatedEffect& effect, double link_inertia) const override {
    return {1.0 / (link_inertia * std::pow(2.0 * M_PI * effect.Value("contact_frequency"), 2)),
            effect.Value("damping_ratio"), effect.Value("gap")};
  }
};

// r(t) [rad or m] of the backlash. Where the links have no inertia about the joint (a poor estimate) they change sides
// at once.
VectorXd PlaceInGap(const EffectMotion& motion, int joint, double half_gap) {
  const Index count = motion.t().size();
  const VectorXd zero = VectorXd::Zero(motion.robot->dof());
  const VectorXd unit = VectorXd::Unit(motion.robot->dof(), joint);
  VectorXd place(count);
  double r = 0.0, speed = 0.0;
  for (Index i = 0; i < count; ++i) {
    const double torque = motion.link(i, joint);
    const double flank = torque > 0.0 ? -half_gap : torque < 0.0 ? half_gap : r;
    if (i == 0) {
      r = flank;
    } else if (r != flank) {
      const VectorXd q = motion.q().row(i);
      const double inertia = motion.link_torque(q, zero, unit, Vector3d::Zero())[joint];
      const double step = motion.t()[i] - motion.t()[i - 1];
      speed -= inertia > 0.0 ? step * torque / inertia : 0.0;
      r = inertia > 0.0 ? std::clamp(r + step * speed, -half_gap, half_gap) : flank;
    }
    if (std::abs(r) == half_gap) speed = 0.0;
    place[i] = r;
  }
  return place;
}

class Backlash : public Effect {
 public:
  std::string id() const override { return kBacklashId; }
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

  VectorXd TrueShape(const SimulatedEffect& effect, const Scenario&) const override {
    return VectorXd::Constant(1, 0.5 * effect.Value("gap"));
  }

  const EffectEquation* equation() const override { return &equation_; }

 private:
  const BacklashEquation equation_;
};

}  // namespace

std::unique_ptr<Effect> MakeBacklash() { return std::make_unique<Backlash>(); }

}  // namespace idim
