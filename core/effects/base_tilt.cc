// Gravity that does not lie along the declared axis: its direction, seen in the base frame, is turned by small angles
// about two axes e of the base, those least parallel to it (x and y of an upright arm). To first order
//   g' = g + sum_e tilt_e (e x g),
// and since torque is affine in gravity, the column of tilt_e is the static torque in the gravity e x g, exactly.
//
// Gravity along axis 1 hides the first moments of the whole arm about it from the base parameters. Tilted, they turn
// with link 1 and load joint 1 by a cos q1 + b sin q1 (moment times tilt), two parameters more.

#include <glog/logging.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>

#include "core/effects/columns.h"
#include "core/effects/registry.h"
#include "core/simulation/effect_equation.h"

namespace idim {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr char kBaseTiltId[] = "base_tilt";

// angle_1, angle_2 [rad]: gravity turned by the rotation vector angle_1 e1 + angle_2 e2. e1 is the base's x axis made
// normal to gravity g (y where g lies along x), e2 = e1 x g / |g| (y for gravity along -z).
class BaseTiltEquation : public EffectEquation {
 public:
  BaseTiltEquation()
      : EffectEquation(kBaseTiltId, EffectJoints::kNone,
                       {EffectKey::From(-M_PI, M_PI, "angle_1", 1).Optional(),
                        EffectKey::From(-M_PI, M_PI, "angle_2", 1).Optional()},
                       {"angle_1", "angle_2"}) {}
  std::string Problem(const SimulatedEffect&, const Robot& robot) const override {
    return robot.gravity.isZero() ? "the robot has no gravity to be tilted" : "";
  }

  std::map<std::string, double> DrawValues(double, Random* random) const override {
    return {{"angle_1", random->Uniform(-0.05, 0.05)}, {"angle_2", random->Uniform(-0.05, 0.05)}};
  }

  void TurnGravity(const SimulatedEffect& effect, Vector3d* gravity) const override {
    const Vector3d down = gravity->normalized();
    const Vector3d start = std::abs(down.x()) < 0.9 ? Vector3d::UnitX() : Vector3d::UnitY();
    const Vector3d e1 = (start - start.dot(down) * down).normalized();
    const Vector3d turn = effect.Value("angle_1") * e1 + effect.Value("angle_2") * e1.cross(down);
    if (!turn.isZero(0.0)) *gravity = Eigen::AngleAxisd(turn.norm(), turn.normalized()) * *gravity;
  }
};

// Axes of the base, increasing: all but that nearest to gravity.
std::array<int, 2> TiltAxes(const Robot& robot) {
  Index along = 2;
  if (!robot.gravity.isZero()) robot.gravity.cwiseAbs().maxCoeff(&along);
  return {along == 0 ? 1 : 0, along == 2 ? 1 : 2};
}

bool AxisOneHidesMoments(const Robot& robot) {
  if (IsPrismatic(robot, 0)) return false;
  return robot.joints[0].rotation.col(2).cross(robot.gravity).norm() <= 1e-6 * robot.gravity.norm();
}

class BaseTilt : public Effect {
 public:
  std::string id() const override { return kBaseTiltId; }
  EffectSite site() const override { return EffectSite::kArm; }
  std::string physics() const override {
    return "Gravity is not along the declared axis of the base: a floor or pedestal out of level, a frame turned in "
           "the "
           "model.";
  }
  std::string how_to_confirm() const override {
    return "Put a spirit level or inclinometer on the base flange along its x and y: the angles are tiltY and tiltX; "
           "shim it level and record again.";
  }

  std::vector<Parameter> Parameters(const Robot& robot, const std::vector<int>& joints) const override {
    CHECK(joints.empty());
    std::vector<Parameter> parameters;
    for (const int axis : TiltAxes(robot)) {
      parameters.push_back({std::string("tilt") + "XYZ"[axis], ParameterKind::kEffect, 0, "rad"});
    }
    if (AxisOneHidesMoments(robot)) {
      parameters.push_back({"tiltC1", ParameterKind::kEffect, 0, "N.m"});
      parameters.push_back({"tiltS1", ParameterKind::kEffect, 0, "N.m"});
    }
    return parameters;
  }

  std::vector<EffectEntry> Columns(const EffectMotion& motion, const std::vector<int>& joints,
                                   const VectorXd& shape) const override {
    CHECK(joints.empty());
    CHECK_EQ(shape.size(), 0);
    const Robot& robot = *motion.robot;
    const int n = robot.dof();
    const Index count = motion.t().size();
    const VectorXd zero = VectorXd::Zero(n);
    std::vector<EffectEntry> entries;
    int parameter = 0;
    for (const int axis : TiltAxes(robot)) {
      const Vector3d gravity = Vector3d::Unit(axis).cross(robot.gravity);
      MatrixXd column(count, n);
      for (Index i = 0; i < count; ++i) column.row(i) = motion.rigid_torque(motion.q().row(i), zero, zero, gravity);
      for (int j = 0; j < n; ++j) entries.push_back({parameter, j, column.col(j)});
      ++parameter;
    }
    if (AxisOneHidesMoments(robot)) {
      entries.push_back({parameter, 0, motion.q().col(0).array().cos()});
      entries.push_back({parameter + 1, 0, motion.q().col(0).array().sin()});
    }
    return entries;
  }

  const EffectEquation* equation() const override { return &equation_; }

 private:
  const BaseTiltEquation equation_;
};

}  // namespace

std::unique_ptr<Effect> MakeBaseTilt() { return std::make_unique<BaseTilt>(); }

}  // namespace idim
