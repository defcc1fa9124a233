// Joint trajectories with exact position, velocity and acceleration at any time.
//
// Point to point, as the motion generators of industrial controllers move: every motion is a straight line in joint
// space, q(t) = a + s(t) (b - a), from rest to rest, with trapezoidal acceleration (constant jerk at its flanks). All
// joints are synchronised: they share s(t), the fastest seven-phase law for which no joint exceeds its velocity,
// acceleration or jerk limit (Biagiotti & Melchiorri, Trajectory Planning for Automatic Machines and Robots, 2008,
// section 3.4). Acceleration is continuous, jerk is not.
//
// Fourier series of base frequency f (Swevers et al., IEEE Trans. Robotics and Automation 13(5), 1997), with w = 2 pi
// f:
//   q_j(t) = centre_j + b(t) sum_l [ sine_lj / (w l) sin(w l t) - cosine_lj / (w l) cos(w l t) ],  l = 1, 2, ...
// where b = 1, or, to start and to end at rest (velocity and acceleration zero), b rises and falls as the polynomial
// 10 u^3 - 15 u^4 + 6 u^5 within the blend time.

#ifndef IDIM_CORE_SIMULATION_TRAJECTORY_H_
#define IDIM_CORE_SIMULATION_TRAJECTORY_H_

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/base/status.h"

namespace idim {

struct JointState {
  Eigen::VectorXd q;    // n [rad or m]
  Eigen::VectorXd dq;   // n [rad/s or m/s]
  Eigen::VectorXd ddq;  // n [rad/s^2 or m/s^2]
};

class Trajectory {
 public:
  virtual ~Trajectory() = default;
  virtual int dof() const = 0;
  virtual double duration() const = 0;  // [s]
  // Before 0 and after the duration the arm rests where it starts or ends (a Fourier series without blend goes on).
  virtual JointState At(double t) const = 0;
};

// n each; velocity, acceleration and jerk are positive bounds on the magnitude. Position bounds serve the random
// trajectories, and given ones are checked against them; both empty: unbounded.
struct JointLimits {
  Eigen::VectorXd lower;         // [rad or m]
  Eigen::VectorXd upper;         // [rad or m], > lower
  Eigen::VectorXd velocity;      // [rad/s]
  Eigen::VectorXd acceleration;  // [rad/s^2]
  Eigen::VectorXd jerk;          // [rad/s^3], point-to-point motion only
};

struct PointToPointOptions {
  JointLimits limits;
  std::vector<Eigen::VectorXd> via;  // configurations, each n; they come before the random ones
  int random = 0;                    // number of configurations drawn uniformly within the position limits
  std::uint64_t seed = 0;            // of the random configurations and speeds
  double dwell = 0.0;                // [s] >= 0, rest at every configuration, the first and last included
  // The velocity limit of every motion is multiplied by a factor drawn uniformly between these, 0 < min <= max <= 1.
  double speed_min = 1.0;
  double speed_max = 1.0;

  // n >= 1 joints. On failure `error` names the field, its value and the constraint.
  bool IsValid(int n, std::string* error) const;
};

// At least two configurations in all.
Result<std::unique_ptr<Trajectory>> MakePointToPoint(int n, const PointToPointOptions& options);

struct FourierOptions {
  double frequency = 0.1;        // [Hz] > 0, of the base period
  double duration = 0.0;         // [s] > 0
  double blend = 0.0;            // [s] >= 0, at most half the duration; 0: no blend
  Eigen::VectorXd centre;        // n; empty: the middle of the position limits
  Eigen::MatrixXd sine, cosine;  // n x harmonics [rad/s]; empty: drawn
  // When they are drawn: normal, then scaled joint by joint to the largest size that keeps position, velocity and
  // acceleration within `fill` of their limits.
  JointLimits limits;
  int harmonics = 5;       // >= 1
  double fill = 0.95;      // (0, 1)
  std::uint64_t seed = 0;  // of the coefficients

  bool IsValid(int n, std::string* error) const;
};

// Refuses given coefficients that leave the position, velocity or acceleration limits, where limits are given.
Result<std::unique_ptr<Trajectory>> MakeFourier(int n, const FourierOptions& options);

}  // namespace idim

#endif  // IDIM_CORE_SIMULATION_TRAJECTORY_H_
