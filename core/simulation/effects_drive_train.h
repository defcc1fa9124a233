// Joints whose link is tied to its motor by a spring, a damper and possibly play. With e
// the link's position less the motor's, the motors on the trajectory q_m and f the transmitted torque,
//   tau_i(t, q_m + e, dq_m + de, ddq_m + dde) = f_i(-e_i, -de_i)   for every flexible joint i,
// tau the inverse dynamics of the links, which is linear in dde: M_FF dde = f - tau(dde = 0), solved at every stage of
// Runge and Kutta's method of order 4. Drive inertia and friction act at the motor; springs, weight and payload on the
// link. Damping is 2 ratio sqrt(stiffness M), M the link's inertia about its joint where the first recording starts,
// without payload; in a contact it takes hold over the first 2e-5 rad.

#ifndef IDIM_CORE_SIMULATION_EFFECTS_DRIVE_TRAIN_H_
#define IDIM_CORE_SIMULATION_EFFECTS_DRIVE_TRAIN_H_

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "core/simulation/trajectory.h"

namespace idim::internal {

struct FlexibleJoint {
  int joint = 0;
  double stiffness = 0.0;  // [N m/rad]
  double damping = 0.0;    // [N m s/rad]
  double half_gap = 0.0;   // [rad]; above 0 the contact does not pull
};

class DriveTrain {
 public:
  // Torque of the links (n) at time t [s] and a state.
  using LinkTorque = std::function<Eigen::VectorXd(double t, const JointState& state)>;

  struct State {
    Eigen::VectorXd e, de;  // one a flexible joint
  };

  // `trajectory` must outlive it. CHECKs that the flexible joints' inertia is positive definite at samples of the
  // trajectory in [start, end] (InertiaIsPositive() tells beforehand).
  DriveTrain(std::vector<FlexibleJoint> joints, LinkTorque link_torque, const Trajectory& trajectory, double start,
             double end);

  // Equilibrium of the links with the motors moving as they do at t.
  State Equilibrium(double t) const;
  // From t over h > 0 seconds, in as many substeps as the fastest oscillation asks for.
  State Step(const State& state, double t, double h) const;
  // Position, velocity and acceleration of all links.
  JointState Links(const State& state, double t) const;

 private:
  Eigen::VectorXd Transmitted(const State& state) const;
  State Derivative(const State& state, double t) const;
  State RungeKutta(const State& state, double t, double h) const;
  // Whether a contact may open or close within h.
  bool NearContact(const State& state, double h) const;

  std::vector<FlexibleJoint> joints_;
  LinkTorque link_torque_;
  const Trajectory& trajectory_;
  double longest_step_ = 0.0;
};

// M_FF of the joints in `joints` at a state.
Eigen::MatrixXd LinkInertia(const std::vector<int>& joints, const DriveTrain::LinkTorque& link_torque, double t,
                            const JointState& state);

// Whether M_FF is positive definite at 50 instants of [start, end].
bool InertiaIsPositive(const std::vector<int>& joints, const DriveTrain::LinkTorque& link_torque,
                       const Trajectory& trajectory, double start, double end);

}  // namespace idim::internal

#endif  // IDIM_CORE_SIMULATION_EFFECTS_DRIVE_TRAIN_H_
