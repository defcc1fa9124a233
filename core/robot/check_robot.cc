#include "core/robot/check_robot.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <utility>

namespace idim {
namespace {

Status Refuse(const std::string& field, const std::string& problem, const std::string& expected) {
  return Status::BadInput("robot: " + field + " " + problem + "; expected " + expected);
}

std::string Item(const char* list, size_t k) { return std::string(list) + "[" + std::to_string(k) + "]"; }

Status CheckCoupling(const Coupling& coupling, const std::string& field, int n) {
  const auto outside = [&](int joint) { return joint < 0 || joint >= n; };
  if (outside(coupling.motor)) {
    return Refuse(field + ".motor", "is " + std::to_string(coupling.motor), "0 to " + std::to_string(n - 1));
  }
  for (const int joint : coupling.joints) {
    if (!outside(joint)) continue;
    return Refuse(field + ".joints", "holds " + std::to_string(joint), "0 to " + std::to_string(n - 1));
  }
  const std::set<int> joints(coupling.joints.begin(), coupling.joints.end());
  if (joints.size() != coupling.joints.size() || joints.size() < 2 || joints.count(coupling.motor) == 0) {
    return Refuse(field + ".joints", "does not couple the motor with another joint",
                  "two or more distinct joints, the motor's own among them");
  }
  if (coupling.weights.empty()) return Status::Ok();
  if (coupling.weights.size() != coupling.joints.size() ||
      !std::all_of(coupling.weights.begin(), coupling.weights.end(), [](double w) { return std::isfinite(w); })) {
    return Refuse(field + ".weights", "has " + std::to_string(coupling.weights.size()) + " numbers",
                  "one finite number a joint of the coupling, or none");
  }
  return Status::Ok();
}

}  // namespace

Result<Robot> CheckedRobot(Robot robot) {
  const int n = robot.dof();
  if (n == 0) return Refuse("joints", "is empty", "one joint or more");
  for (size_t j = 0; j < robot.joints.size(); ++j) {
    const Joint& joint = robot.joints[j];
    if (!joint.translation.allFinite()) return Refuse(Item("joints", j) + ".translation", "is not finite", "metres");
    const Eigen::Matrix3d& r = joint.rotation;
    // Written negatively, so that NaN fails.
    if (!((r * r.transpose() - Eigen::Matrix3d::Identity()).norm() < 1e-6 && r.determinant() > 0.0)) {
      return Refuse(Item("joints", j) + ".rotation", "is no rotation", "an orthonormal matrix of determinant 1");
    }
  }
  if (!robot.gravity.allFinite()) return Refuse("gravity", "is not finite", "m/s^2 in the base frame");
  if (robot.transmission.size() == 0) robot.transmission = Eigen::MatrixXd::Identity(n, n);
  const Eigen::MatrixXd& t = robot.transmission;
  if (t.rows() != n || t.cols() != n || !t.allFinite()) {
    return Refuse("transmission", "is " + std::to_string(t.rows()) + " x " + std::to_string(t.cols()),
                  std::to_string(n) + " x " + std::to_string(n) + " finite numbers, or nothing for 1");
  }
  if (!Eigen::FullPivLU<Eigen::MatrixXd>(t).isInvertible()) {
    return Refuse("transmission", "is not invertible", "one that moves every joint");
  }
  for (size_t k = 0; k < robot.couplings.size(); ++k) {
    Coupling& coupling = robot.couplings[k];
    IDIM_RETURN_IF_ERROR(CheckCoupling(coupling, Item("couplings", k), n));
    for (size_t i = 0; i < k; ++i) {
      if (robot.couplings[i].motor != coupling.motor) continue;
      return Refuse(Item("couplings", k), "is of a motor that has one already", "one coupling a motor");
    }
    if (!coupling.weights.empty()) continue;
    const double own = t(coupling.motor, coupling.motor);
    if (own == 0.0) return Refuse(Item("couplings", k), "is of a motor that its own joint does not turn", "weights");
    for (const int joint : coupling.joints) coupling.weights.push_back(t(coupling.motor, joint) / own);
  }
  if (!robot.declared_inertials.empty() && robot.declared_inertials.size() != robot.joints.size()) {
    return Refuse("declared_inertials", "has " + std::to_string(robot.declared_inertials.size()) + " bodies",
                  "one a link, or none");
  }
  return robot;
}

}  // namespace idim
