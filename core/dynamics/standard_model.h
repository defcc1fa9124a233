// The torque of an arm as a linear function of its standard parameters: links and drives (eq. (1) and (25)).
//
//   tau_j = IDM_j X + Ia_j ddq_j + Fv_j dq_j + Fs_j sign(dq_j) + off_j
// and for a coupling of motor m with joints J and weights c, u = sum_{J} c_j dq_j, on every joint j of J
//   + Iam (c_j sum_{k != j} c_k ddq_k) + Fvm (c_j sum_{k != j} c_k dq_k) + Fsm c_j sign(u)
// (the terms k = j belong to Ia_j and Fv_j; with c = 1 this is eq. (25)). Only the declared friction is in the model;
// Ia always is.
//
// sign(dq) from measured velocity is wrong near standstill, where noise decides it. With s the standard deviation of
// the velocity, its expectation given the measurement is erf(dq / (sqrt(2) s)); that is the column used here. s = 0 is
// the plain sign.

#ifndef IDIM_CORE_DYNAMICS_STANDARD_MODEL_H_
#define IDIM_CORE_DYNAMICS_STANDARD_MODEL_H_

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "core/dynamics/parameters.h"
#include "core/dynamics/rigid_body_dynamics.h"
#include "core/robot/robot.h"

namespace idim {

// The declared drive model of every joint (study key `friction`).
struct FrictionModel {
  bool viscous = true;
  bool coulomb = true;
  bool offset = true;
};

// Not thread-safe: make one a thread (copying is cheap).
class StandardModel {
 public:
  StandardModel(const Robot& robot, const FrictionModel& friction);

  int dof() const { return robot_.dof(); }
  int columns() const { return static_cast<int>(parameters_.size()); }
  // Link by link XX XY XZ YY YZ ZZ MX MY MZ M Ia [Iam] [Fv] [Fvm] [Fs] [Fsm] [off], the paper's order.
  const std::vector<Parameter>& parameters() const { return parameters_; }
  // Index of a parameter by name, -1 if there is none.
  int Find(const std::string& name) const;
  const Robot& robot() const { return robot_; }

  // q, dq, ddq: n; velocity_sigma: n, standard deviations of dq (nullptr: all zero);
  // w: n x columns(), row-major, [N.m or N] a unit of each parameter.
  void Regressor(const double* q, const double* dq, const double* ddq, const double* velocity_sigma, double* w);

  // The columns of a body fixed to the last link, in its frame: n x 10 row-major. Call after Regressor(), of whose
  // state these are.
  void PayloadColumns(double* w) const;

  // The same torque by recursion, without the regressor. chi: columns() values in the order of parameters(); payload:
  // in the frame of the last link, zero without one; tau: n.
  void Torque(const double* q, const double* dq, const double* ddq, const double* velocity_sigma,
              const Eigen::VectorXd& chi, const InertialVector& payload, double* tau);

 private:
  // Where the parameters of a drive are among the columns; -1: not declared.
  struct DriveColumns {
    int ia = -1, fv = -1, fs = -1, off = -1;
  };
  struct CouplingColumns {
    int iam = -1, fvm = -1, fsm = -1;
  };

  // Calls add(joint, column, value) for each entry of the drives' columns.
  template <typename Add>
  void DriveEntries(const double* dq, const double* ddq, const double* velocity_sigma, Add&& add) const;

  Robot robot_;
  std::vector<Parameter> parameters_;
  std::vector<int> link_begin_;  // first of the ten inertial columns of each link
  std::vector<DriveColumns> drives_;
  std::vector<CouplingColumns> couplings_;
  RigidBodyDynamics<double> dynamics_;
  std::vector<double> inertial_regressor_;  // n x 10n
};

// E[sign of the true velocity | measured dq, standard deviation sigma].
double ExpectedSign(double dq, double sigma);

}  // namespace idim

#endif  // IDIM_CORE_DYNAMICS_STANDARD_MODEL_H_
