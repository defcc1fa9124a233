// How well the data determine each drive gain, and why not where they do not.
//
// For gain j let v_j be its column of W_tot, v' what is left of it once every other unknown has taken out what it can
// imitate, k' the known payload's torque treated alike. v' alone can be held against k' for a scale:
//   independent   |v'| / |v_j|: how much of the signal no other unknown can imitate;
//   unexplained   |v''| / |v_j|, the known torque taken out too;
//   known_share   1 - unexplained^2 / independent^2, the squared partial correlation of v_j with the known torque: the
//                 share of what only this gain can explain that comes from the known payload. Over all equations, so
//                 that the errors of every joint count against it;
//   noise         |noise of v_j| / |v_j|, from its own joint's equations (solvers/linear/signal_noise.h);
//   reliability   1 - noise^2 / independent^2: the share of |v'|^2 that is signal (reliability ratio, Fuller
//   1987, 1.1).
//                 LS, to which the regressor v_j counts as exact, gives reliability times the gain where the other
//                 columns are exact; shrunk gains of other joints shrink it further.
// Torque shares are of loaded recordings: |known torque| and its gravity part against |V g| of the joint.

#ifndef IDIM_SOLVERS_LINEAR_GAIN_VERDICT_H_
#define IDIM_SOLVERS_LINEAR_GAIN_VERDICT_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "solvers/linear/gain_system.h"

namespace idim {

enum class GainStrength { kStrong, kWeak, kNone };

struct GainVerdict {
  std::string name;  // "g1"
  int joint = 0;     // one-based
  double independent = -1.0;
  double unexplained = -1.0;
  double known_share = -1.0;
  double noise = -1.0;
  double reliability = -1.0;
  double least_squares = 0.0;  // [N.m per signal unit] the LS gain, -v'.k' / |v'|^2
  double payload_torque_share = -1.0;
  double payload_gravity_share = -1.0;
  // kStrong: reliability of at least 2/3; kNone: below 1/5.
  GainStrength strength = GainStrength::kNone;
  std::string sentence;  // for a person: what it is and why
};

// What speaks against estimated gains, "; " between the reasons, empty if nothing: a sign that contradicts the a priori
// value (n of them, or empty), a relative standard deviation above `max_percent`. covariance:
// its first n x n are the gains'.
std::string ReasonsAgainstGains(const Eigen::VectorXd& gains, const Eigen::MatrixXd& covariance,
                                const Eigen::VectorXd& a_priori, double max_percent);

// Of the data alone, whatever estimator is used later: rows as recorded, torque shares with the gains of scaled TLS
// with noise on the signals. The columns of the unknowns must be independent (DiagnoseRank) and none
// of the gains' zero.
std::vector<GainVerdict> JudgeGains(const GainSystem& system, double rank_tolerance);

}  // namespace idim

#endif  // IDIM_SOLVERS_LINEAR_GAIN_VERDICT_H_
