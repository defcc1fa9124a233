// Torque periodic in the position of joint or motor: Rc cos(k q) + Rs sin(k q), k the order (1: once a turn of a
// revolute joint; rad/m of a prismatic one).
//
// Which orders a recording shows: two periods within the range of q at least; faster than half the sampling rate at no
// speed (else samples alias). Orders closer than pi / range are not told apart, so the grid steps by half of that.

#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/effects/columns.h"
#include "core/effects/registry.h"
#include "core/simulation/effect_equation.h"
#include "core/simulation/scenario.h"

namespace idim {
namespace {

using Eigen::ArrayXd;
using Eigen::VectorXd;

constexpr char kTorqueRippleId[] = "torque_ripple";

// amplitude [N m], phase [rad], order or motor_order: amplitude cos(order q + phase), q the motor's position in joint
// coordinates, or cos(motor_order (T q)_j + phase), T the transmission.
class TorqueRippleEquation : public EffectEquation {
 public:
  TorqueRippleEquation()
      : EffectEquation(kTorqueRippleId, EffectJoints::kOneOrMore,
                       {EffectKey::Any("amplitude", 1), EffectKey::Any("phase").Optional(),
                        EffectKey::Positive("order").Alternative(), EffectKey::Positive("motor_order").Alternative()},
                       {"order", "motor_order"}) {}
  std::string Problem(const SimulatedEffect& effect, const Robot&) const override {
    const bool both = effect.values.count("order") + effect.values.count("motor_order") == 2;
    return both ? "order and motor_order are both given, only one of them can be" : "";
  }

  std::map<std::string, double> DrawValues(double, Random* random) const override {
    return {{"amplitude", 1.0}, {"phase", random->Uniform(-M_PI, M_PI)}, {"order", random->LogUniform(5.0, 25.0)}};
  }

  void AddMotorTorque(const SimulatedEffect& effect, const Robot& robot, const JointState& motor,
                      VectorXd* torque) const override {
    const bool of_motor = effect.values.count("motor_order") > 0;
    const VectorXd turns = of_motor ? VectorXd(robot.transmission * motor.q) : motor.q;
    const double order = effect.Value(of_motor ? "motor_order" : "order");
    for (int j : effect.joints) {
      (*torque)[j] += effect.Value("amplitude") * std::cos(order * turns[j] + effect.Value("phase"));
    }
  }
};

constexpr double kLargestOrder = 300.0;            // above it: only the orders of the motor
constexpr double kLargestOrderPrismatic = 3000.0;  // [rad/m], a pitch of 2 mm

// The slowest mean sampling rate [rad/s] of all recordings.
double SamplingRate(const std::vector<EffectMotion>& motions) {
  double rate = std::numeric_limits<double>::infinity();
  for (const EffectMotion& motion : motions) {
    const Eigen::Index count = motion.t().size();
    if (count > 1)
      rate = std::min(rate, 2.0 * M_PI * static_cast<double>(count - 1) / (motion.t()[count - 1] - motion.t()[0]));
  }
  return rate;
}

class TorqueRipple : public Effect {
 public:
  std::string id() const override { return kTorqueRippleId; }
  EffectSite site() const override { return EffectSite::kJoint; }
  EffectDomain domain() const override { return EffectDomain::kPosition; }
  std::string physics() const override {
    return "Torque periodic in the position of joint or motor: cogging, teeth of the gear, torque sensors, current "
           "offsets.";
  }
  std::string how_to_confirm() const override {
    return "Drive the joint slowly over its range at two constant speeds: the torque's spectrum against position has "
           "its "
           "line at the same order k both times (against time it moves).";
  }

  std::vector<Parameter> Parameters(const Robot& robot, const std::vector<int>& joints) const override {
    const int joint = OnlyJoint(joints);
    const std::string torque = TorqueUnit(robot, joint);
    return {JointParameter("Rc", joint, torque), JointParameter("Rs", joint, torque)};
  }

  std::vector<ShapeParameter> Shapes(const std::vector<EffectMotion>& motions,
                                     const std::vector<int>& joints) const override {
    const int joint = OnlyJoint(joints);
    CHECK(!motions.empty());
    const Robot& robot = *motions[0].robot;
    const std::string unit = IsPrismatic(robot, joint) ? "rad/m" : "1";
    const double range = PositionRange(motions, joint);
    // A joint at rest shows no order; one value keeps the list usable, and its columns are constant.
    if (!(range > 0.0)) return {{"k", unit, 0.5, 1.0, {1.0}}};
    const double lower = 4.0 * M_PI / range;
    const double alias = 0.5 * SamplingRate(motions) / LargestSpeed(motions, joint);
    const double cap = IsPrismatic(robot, joint) ? kLargestOrderPrismatic : kLargestOrder;
    const double upper = std::max(lower, std::min(alias, cap));
    const int steps = static_cast<int>(std::ceil((upper - lower) / (0.5 * M_PI / range)));
    std::vector<double> grid = {lower};
    for (int k = 1; k <= steps; ++k) grid.push_back(lower + (upper - lower) * k / steps);
    if (robot.transmission.size() > 0) {
      const double ratio = std::abs(robot.transmission(joint, joint));
      for (const double multiple : {1.0, 2.0, 4.0}) {
        const double order = multiple * ratio;
        if (order >= lower && order < alias) grid.push_back(order);
      }
      std::sort(grid.begin(), grid.end());
      grid.erase(std::unique(grid.begin(), grid.end()), grid.end());
    }
    const double resolution = M_PI / range;
    return {{"k", unit, std::max(0.5 * lower, lower - resolution), grid.back() + resolution, grid}};
  }

  std::vector<EffectEntry> Columns(const EffectMotion& motion, const std::vector<int>& joints,
                                   const VectorXd& shape) const override {
    const int joint = OnlyJoint(joints);
    CHECK_EQ(shape.size(), 1);
    const ArrayXd angle = shape[0] * motion.q().col(joint).array();
    return {{0, joint, angle.cos()}, {1, joint, angle.sin()}};
  }

  VectorXd TrueShape(const SimulatedEffect& effect, const Scenario& scenario) const override {
    if (effect.values.count("motor_order") == 0) return VectorXd::Constant(1, effect.Value("order"));
    const int joint = OnlyJoint(effect.joints);
    return VectorXd::Constant(1, effect.Value("motor_order") * std::abs(scenario.robot.transmission(joint, joint)));
  }

  const EffectEquation* equation() const override { return &equation_; }

 private:
  const TorqueRippleEquation equation_;
};

}  // namespace

std::unique_ptr<Effect> MakeTorqueRipple() { return std::make_unique<TorqueRipple>(); }

}  // namespace idim
