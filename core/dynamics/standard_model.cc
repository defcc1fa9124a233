#include "core/dynamics/standard_model.h"

#include <glog/logging.h>

#include <algorithm>
#include <cmath>

namespace idim {

double ExpectedSign(double dq, double sigma) {
  if (sigma > 0.0 && std::abs(dq) < 6.0 * sigma) return std::erf(dq / (std::sqrt(2.0) * sigma));
  return static_cast<double>((dq > 0.0) - (dq < 0.0));
}

StandardModel::StandardModel(const Robot& robot, const FrictionModel& friction)
    : robot_(robot),
      drives_(robot.dof()),
      couplings_(robot.couplings.size()),
      dynamics_(robot),
      inertial_regressor_(kNumInertial * robot.dof() * robot.dof()) {
  const auto add = [this](const std::string& name, ParameterKind kind, int joint, int standard_index) {
    const bool prismatic = robot_.joints[joint].type == JointType::kPrismatic;
    parameters_.push_back({name + std::to_string(joint + 1), kind, joint + 1, StandardUnit(standard_index, prismatic)});
    return columns() - 1;
  };
  for (int j = 0; j < dof(); ++j) {
    // At most one coupling a motor: the reader refuses more.
    CouplingColumns* coupling = nullptr;
    for (size_t c = 0; c < couplings_.size(); ++c) {
      if (robot_.couplings[c].motor == j) coupling = &couplings_[c];
    }
    link_begin_.push_back(columns());
    for (int k = 0; k < kNumInertial; ++k) add(kStandardNames[k], ParameterKind::kBase, j, k);
    drives_[j].ia = add("Ia", ParameterKind::kDriveInertia, j, kIa);
    if (coupling != nullptr) coupling->iam = add("Iam", ParameterKind::kDriveInertia, j, kIa);
    if (friction.viscous) {
      drives_[j].fv = add("Fv", ParameterKind::kFriction, j, kFv);
      if (coupling != nullptr) coupling->fvm = add("Fvm", ParameterKind::kFriction, j, kFv);
    }
    if (friction.coulomb) {
      drives_[j].fs = add("Fs", ParameterKind::kFriction, j, kFs);
      if (coupling != nullptr) coupling->fsm = add("Fsm", ParameterKind::kFriction, j, kFs);
    }
    if (friction.offset) drives_[j].off = add("off", ParameterKind::kFriction, j, kOff);
  }
}

int StandardModel::Find(const std::string& name) const {
  const auto found =
      std::find_if(parameters_.begin(), parameters_.end(), [&](const Parameter& p) { return p.name == name; });
  return found == parameters_.end() ? -1 : static_cast<int>(found - parameters_.begin());
}

template <typename Add>
void StandardModel::DriveEntries(const double* dq, const double* ddq, const double* velocity_sigma, Add&& add) const {
  const auto sigma = [&](int j) { return velocity_sigma == nullptr ? 0.0 : velocity_sigma[j]; };
  for (int j = 0; j < dof(); ++j) {
    const DriveColumns& drive = drives_[j];
    add(j, drive.ia, ddq[j]);
    if (drive.fv >= 0) add(j, drive.fv, dq[j]);
    if (drive.fs >= 0) add(j, drive.fs, ExpectedSign(dq[j], sigma(j)));
    if (drive.off >= 0) add(j, drive.off, 1.0);
  }
  for (size_t c = 0; c < couplings_.size(); ++c) {
    const Coupling& coupling = robot_.couplings[c];
    const CouplingColumns& columns = couplings_[c];
    double velocity = 0.0, acceleration = 0.0, variance = 0.0;
    for (size_t k = 0; k < coupling.joints.size(); ++k) {
      const int joint = coupling.joints[k];
      velocity += coupling.weights[k] * dq[joint];
      acceleration += coupling.weights[k] * ddq[joint];
      variance += std::pow(coupling.weights[k] * sigma(joint), 2);
    }
    const double sign = ExpectedSign(velocity, std::sqrt(variance));
    for (size_t k = 0; k < coupling.joints.size(); ++k) {
      const int joint = coupling.joints[k];
      const double weight = coupling.weights[k];
      add(joint, columns.iam, weight * (acceleration - weight * ddq[joint]));
      if (columns.fvm >= 0) add(joint, columns.fvm, weight * (velocity - weight * dq[joint]));
      if (columns.fsm >= 0) add(joint, columns.fsm, weight * sign);
    }
  }
}

void StandardModel::Regressor(const double* q, const double* dq, const double* ddq, const double* velocity_sigma,
                              double* w) {
  const int n = dof();
  dynamics_.Regressor(q, dq, ddq, inertial_regressor_.data());
  std::fill(w, w + n * columns(), 0.0);
  for (int i = 0; i < n; ++i) {
    for (int j = i; j < n; ++j) {
      std::copy_n(&inertial_regressor_[(i * n + j) * kNumInertial], kNumInertial, &w[i * columns() + link_begin_[j]]);
    }
  }
  DriveEntries(dq, ddq, velocity_sigma,
               [&](int joint, int column, double value) { w[joint * columns() + column] = value; });
}

void StandardModel::PayloadColumns(double* w) const {
  const int n = dof();
  for (int i = 0; i < n; ++i) {
    std::copy_n(&inertial_regressor_[(i * n + n - 1) * kNumInertial], kNumInertial, &w[i * kNumInertial]);
  }
}

void StandardModel::Torque(const double* q, const double* dq, const double* ddq, const double* velocity_sigma,
                           const Eigen::VectorXd& chi, const InertialVector& payload, double* tau) {
  CHECK_EQ(chi.size(), columns());
  std::vector<InertialVector> inertials(dof());
  for (int j = 0; j < dof(); ++j) inertials[j] = chi.segment<kNumInertial>(link_begin_[j]);
  inertials.back() += payload;
  dynamics_.InverseDynamics(q, dq, ddq, inertials.data(), tau);
  DriveEntries(dq, ddq, velocity_sigma,
               [&](int joint, int column, double value) { tau[joint] += chi[column] * value; });
}

}  // namespace idim
