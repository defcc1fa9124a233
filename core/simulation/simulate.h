// What a robot does and what is logged of it: truth and noise, kept apart.
//
// Truth: along a trajectory the joint torque is that of the standard model (core/dynamics/standard_model.h) with true
// parameters, and the control signal is what the drives need for it: v = diag(g)^-1 tau on the joint side,
// v = diag(g)^-1 T^-T tau on the motor side, T the transmission. The control loop is ideal: the arm moves exactly along
// the trajectory.
//
// Noise: independent from sample to sample and from joint to joint. Joint position: white normal noise, then the
// encoder's quantisation (rounding to the nearest step). Signal: white normal noise, then quantisation. The clock is
// not noise: samples are taken at jittering instants, and the recorded time is the true one.

#ifndef IDIM_CORE_SIMULATION_SIMULATE_H_
#define IDIM_CORE_SIMULATION_SIMULATE_H_

#include <Eigen/Core>
#include <cstdint>
#include <string>

#include "core/dynamics/standard_model.h"
#include "core/recording/recording.h"
#include "core/recording/study.h"
#include "core/robot/robot.h"
#include "core/simulation/trajectory.h"

namespace idim {

// The clock that logs has microseconds.
inline constexpr double kClockTick = 1e-6;  // [s]

struct TruthOptions {
  double rate = 500.0;    // [Hz] in (0, 1e5]
  double duration = 0.0;  // [s]; 0: that of the trajectory
  // [s] >= 0 and below 0.49 / rate: instants are moved by uniform numbers in [-jitter, jitter], the first excepted.
  double clock_jitter = 0.0;
  std::uint64_t seed = 0;  // of the jitter
  Side signal_side = Side::kJoint;

  bool IsValid(std::string* error) const;
};

// N samples, n joints; exact.
struct Truth {
  Eigen::VectorXd t;  // [s], on the clock's ticks
  Eigen::MatrixXd q, dq, ddq;
  Eigen::MatrixXd torque;  // joint side [N m or N]
  Eigen::MatrixXd signal;  // on the side asked for [signal unit]
};

// chi: model->columns() standard parameters; payload: in the frame of the last link, zero without one; gains: n,
// none of them zero. CHECKs sizes and options.
Truth SimulateTruth(StandardModel* model, const Eigen::VectorXd& chi, const InertialVector& payload,
                    const Eigen::VectorXd& gains, const Trajectory& trajectory, const TruthOptions& options);

// Each of n numbers >= 0, or empty for none.
struct NoiseOptions {
  Eigen::VectorXd position;        // [rad or m] standard deviation, joint side
  Eigen::VectorXd position_step;   // [rad or m] encoders on the joints
  Eigen::VectorXd encoder_counts;  // a turn: encoders on the motors, step 2 pi / counts; not with position_step
  Eigen::VectorXd signal;          // [signal unit] standard deviation
  Eigen::VectorXd signal_percent;  // standard deviation in % of the RMS of the joint's true signal
  Eigen::VectorXd signal_step;     // [signal unit]

  bool IsValid(int n, std::string* error) const;
};

// As logged; `seed` decides every draw. q is on the joint side whatever the encoder's. CHECKs the options.
Recording AddNoise(const Truth& truth, const Robot& robot, const NoiseOptions& options, std::uint64_t seed);

// The standard deviation of the signal noise that AddNoise() adds to each joint [signal unit], n; quantisation apart.
Eigen::VectorXd AddedSignalNoise(const Truth& truth, const NoiseOptions& options);

}  // namespace idim

#endif  // IDIM_CORE_SIMULATION_SIMULATE_H_
