// How well the data determine each drive gain, and why not where they do not.
//
// For gain j let v_j be its column, v' what is left of it once every other unknown has taken out what it can imitate,
// and k' the known payload's torque treated alike. Only k' can hold v' to a scale:
//   independent   |v'| / |v_j|: how much of the signal no other unknown can imitate;
//   unexplained   |v''| / |v_j|, the known torque taken out too: noise and model error;
//   known_share   1 - unexplained^2 / independent^2, the squared partial correlation of v_j with the known torque. 1:
//                 all that only this gain can explain comes from the known payload. Near 0: v' is noise, to which
//                 no scale can be given.
// The regression of k' on v' (noise all in k') is the LS gain; the regression of v' on k' (noise all in v') is that
// divided by known_share. A gain whose column is the only noisy one lies between the two (Frisch 1934), so known_share
// is also what LS can have shrunk it to.
//
// Torque shares are of loaded recordings: |known torque| and its gravity part against |V g| of the joint.

#ifndef IDIM_SOLVERS_GAIN_VERDICT_H_
#define IDIM_SOLVERS_GAIN_VERDICT_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "solvers/gain_system.h"

namespace idim {

enum class GainStrength { kStrong, kWeak, kNone };

struct GainVerdict {
  std::string name;  // "g1"
  int joint = 0;     // one-based
  double independent = -1.0;
  double unexplained = -1.0;
  double known_share = -1.0;
  double least_squares = 0.0;  // [N m per signal unit], both regressions
  double reverse = 0.0;        // inf where known_share is 0
  double payload_torque_share = -1.0;
  double payload_gravity_share = -1.0;
  // kWeak: the two regressions differ by more than a factor of 1.5; kNone: by more than 10.
  GainStrength strength = GainStrength::kNone;
  std::string sentence;  // for a person: what it is and why
};

// row_sigma: n, what the rows of each joint are divided by. gains: n, for the torque shares.
std::vector<GainVerdict> JudgeGains(const GainSystem& system, const Eigen::VectorXd& row_sigma,
                                    const Eigen::VectorXd& gains, double rank_tolerance);

}  // namespace idim

#endif  // IDIM_SOLVERS_GAIN_VERDICT_H_
