#include "core/effects/columns.h"

#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/dynamics/standard_model.h"
#include "core/robot/joint_units.h"
#include "core/signal/butterworth.h"

namespace idim {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

int OnlyJoint(const std::vector<int>& joints) {
  CHECK_EQ(joints.size(), 1u);
  CHECK_GE(joints[0], 0);
  return joints[0];
}

bool IsPrismatic(const Robot& robot, int joint) {
  CHECK_LT(joint, robot.dof());
  return robot.joints[joint].type == JointType::kPrismatic;
}

std::string TorqueUnit(const Robot& robot, int joint) { return UnitsOf(robot, joint).torque; }

std::string AngleUnit(const Robot& robot, int joint) { return UnitsOf(robot, joint).position; }

Parameter JointParameter(const std::string& stem, int joint, const std::string& unit) {
  return {stem + std::to_string(joint + 1), ParameterKind::kEffect, joint + 1, unit};
}

VectorXd ExpectedSigns(const EffectMotion& motion, int joint) {
  CHECK_EQ(motion.velocity_sigma.size(), motion.dq().cols());
  const double sigma = motion.velocity_sigma[joint];
  return motion.dq().col(joint).unaryExpr([sigma](double dq) { return ExpectedSign(dq, sigma); });
}

MatrixXd TimeDerivative(const VectorXd& t, const MatrixXd& values) {
  const Index count = t.size();
  CHECK_EQ(values.rows(), count);
  MatrixXd derivative = MatrixXd::Zero(count, values.cols());
  if (count < 3) return derivative;
  // The slope at t_i of the parabola through the three samples about `middle`.
  for (Index i = 0; i < count; ++i) {
    const Index middle = std::clamp<Index>(i, 1, count - 2);
    const double before = t[middle] - t[middle - 1];
    const double after = t[middle + 1] - t[middle];
    CHECK_GT(before, 0.0);
    CHECK_GT(after, 0.0);
    const Eigen::RowVectorXd left = (values.row(middle) - values.row(middle - 1)) / before;
    const Eigen::RowVectorXd right = (values.row(middle + 1) - values.row(middle)) / after;
    const Eigen::RowVectorXd curvature = (right - left) / (before + after);
    derivative.row(i) = left + curvature * (2.0 * t[i] - t[middle - 1] - t[middle]);
  }
  return derivative;
}

VectorXd ForDerivatives(const EffectMotion& motion, const VectorXd& values) {
  const Index count = motion.t().size();
  CHECK_EQ(values.size(), count);
  if (!(motion.derivative_cutoff_hz > 0.0) || count < 3) return values;
  const double step = (motion.t()[count - 1] - motion.t()[0]) / static_cast<double>(count - 1);
  if (motion.derivative_cutoff_hz >= 0.5 / step) return values;
  const ButterworthFilter filter(4, motion.derivative_cutoff_hz, step);
  return count > filter.padding() ? filter.ZeroPhase(values) : values;
}

double PositionRange(const std::vector<EffectMotion>& motions, int joint) {
  double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
  for (const EffectMotion& motion : motions) {
    if (motion.q().rows() == 0) continue;
    lowest = std::min(lowest, motion.q().col(joint).minCoeff());
    highest = std::max(highest, motion.q().col(joint).maxCoeff());
  }
  return std::max(0.0, highest - lowest);
}

double LargestSpeed(const std::vector<EffectMotion>& motions, int joint) {
  double speed = 0.0;
  for (const EffectMotion& motion : motions) {
    if (motion.dq().rows() > 0) speed = std::max(speed, motion.dq().col(joint).cwiseAbs().maxCoeff());
  }
  return speed;
}

double LongestDuration(const std::vector<EffectMotion>& motions) {
  double duration = 0.0;
  for (const EffectMotion& motion : motions) {
    if (motion.t().size() > 0) duration = std::max(duration, motion.t()[motion.t().size() - 1] - motion.t()[0]);
  }
  return duration;
}

std::vector<double> LogGrid(double lower, double upper, int count) {
  CHECK_GT(lower, 0.0);
  CHECK_GT(upper, lower);
  CHECK_GE(count, 2);
  std::vector<double> grid(count);
  for (int k = 0; k < count; ++k) grid[k] = lower * std::pow(upper / lower, k / (count - 1.0));
  grid.back() = upper;  // not a rounding beyond the limit
  return grid;
}

}  // namespace idim
