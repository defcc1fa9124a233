// scenario.yaml: a robot, its true parameters, how it moves and what is logged of it. Keys (SI units, angles in rad;
// paths are relative to the file; every list of n numbers may be one number for all joints):
//
//   robot: robot.yaml
//   parameters:                  # one mapping a link, 1 to n, what is left out is 0; or a file with this key
//     - {XX: 0.1, XY: 0, ..., MZ: 0.2, M: 4, Ia: 0.3, Fv: 7, Fs: 5, off: 0.1}   # inertia about the ORIGIN of the frame
//     - {..., Iam: 0.01, Fvm: 0.5, Fsm: 2}                                   # of a coupling whose motor is this joint
//   payloads:                    # optional; all ten parameters in the frame of the last link
//     calibrated: {XX: .., .., M: 4.59, known: [M]}       # known: those that the study is told; default none
//   gains: {values: [..], mode: known}     # true gains (default 1); the study is told them (mode known, the default)
//                                          # or only a_priori: [..] (mode identify; may be left out)
//   position_side: joint         # joint | motor: what the q columns are; signal_side likewise
//   signal_side: joint
//   rate: 500                    # [Hz]
//   clock_jitter: 0              # [s], see TruthOptions
//   noise:                       # optional, see NoiseOptions
//     {position: .., position_step: .., encoder_counts: .., signal: .., signal_percent: .., signal_step: ..}
//   limits: {lower: [..], upper: [..], velocity: [..], acceleration: [..], jerk: [..]}    # see JointLimits
//   effects:                     # optional: what the standard model lacks; see below
//     - {id: stribeck, joints: [3], Fst: 2.0, vs: 0.1}
//     - {id: payload_change, M: 0.5, z: 0.1, from: 4, recording: free}     # recording: in this one alone; default all
//   recordings:
//     - name: free               # letters, digits, _ and -; the file is free.csv
//       use: identification      # identification | validation
//       payload: calibrated      # optional
//       seed: 1                  # of the trajectory, the clock and the noise
//       motion_seed: 1           # optional: of the trajectory alone, so that two recordings move alike
//       duration: 8              # [s] optional: logging stops then (rest beyond the end of the motion)
//       trajectory: {type: point_to_point, via: [[..], ..], random: 20, dwell: 0.1, speed: [0.5, 1.0]}
//     - ...
//       trajectory: {type: fourier, frequency: 0.1, duration: 10, blend: 1, harmonics: 5, fill: 0.95}
//                   # or given: centre: [..], sine: [[..] a joint], cosine: [[..] a joint]
// The meaning of a trajectory's keys is that of PointToPointOptions and FourierOptions; equation and keys of an effect
// stand in core/effects, in the file of its id.

#ifndef IDIM_CORE_SIMULATION_SCENARIO_H_
#define IDIM_CORE_SIMULATION_SCENARIO_H_

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/base/status.h"
#include "core/recording/study.h"
#include "core/robot/robot.h"
#include "core/simulation/effect_equation.h"
#include "core/simulation/simulate.h"
#include "core/simulation/trajectory.h"

namespace idim {

struct ScenarioPayload {
  std::string name;
  InertialVector inertial = InertialVector::Zero();
  std::vector<int> known;  // InertialIndex, increasing
};

struct ScenarioRecording {
  std::string name;
  Use use = Use::kIdentification;
  int payload = -1;  // index into Scenario::payloads, -1: none
  std::uint64_t seed = 0;
  double duration = 0.0;  // [s] 0: that of the trajectory
  std::shared_ptr<const Trajectory> trajectory;
};

// [s]
inline double DurationOf(const ScenarioRecording& recording) {
  return recording.duration > 0.0 ? recording.duration : recording.trajectory->duration();
}

struct Scenario {
  std::string path;
  std::string robot_path;
  Robot robot;
  Eigen::VectorXd chi;  // in the order of StandardModel(robot, FrictionModel()).parameters()
  std::vector<ScenarioPayload> payloads;
  Eigen::VectorXd gains;  // n, true
  GainsMode gains_mode = GainsMode::kKnown;
  Eigen::VectorXd a_priori_gains;  // n or empty
  Side position_side = Side::kJoint;
  TruthOptions truth;  // rate, clock_jitter and signal_side; the rest is the recording's
  NoiseOptions noise;
  std::vector<ScenarioRecording> recordings;
  std::vector<SimulatedEffect> effects;
  double effect_step = 1e-4;  // [s] at which effects with memory are integrated between the recorded instants
};

// One message with file, line and key on bad input. `equations`: those that its effects may have; they must outlive
// the result.
Result<Scenario> ReadScenario(const std::string& yaml_path, const EffectEquationList& equations);

}  // namespace idim

#endif  // IDIM_CORE_SIMULATION_SCENARIO_H_
