// What the columns of several effects are made of.

#ifndef IDIM_CORE_EFFECTS_COLUMNS_H_
#define IDIM_CORE_EFFECTS_COLUMNS_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/effects/effect.h"

namespace idim {

// The joint of an effect of site kJoint.
int OnlyJoint(const std::vector<int>& joints);

bool IsPrismatic(const Robot& robot, int joint);
// "N.m", "rad" of a revolute joint, "N", "m" of a prismatic one; rate units follow from them.
std::string TorqueUnit(const Robot& robot, int joint);
std::string AngleUnit(const Robot& robot, int joint);

// stem and the one-based joint, kind kEffect.
Parameter JointParameter(const std::string& stem, int joint, const std::string& unit);

// E[sign of the true velocity | measured one], N: the column of Coulomb friction, see core/dynamics/standard_model.h.
Eigen::VectorXd ExpectedSigns(const EffectMotion& motion, int joint);

// d values / dt at the instants t (N, increasing; CHECK), N x m: central differences weighted for an uneven clock
// (exact for parabolas), at the ends of the nearest three samples. Zero where N < 3.
Eigen::MatrixXd TimeDerivative(const Eigen::VectorXd& t, const Eigen::MatrixXd& values);

// values (N, a torque along the motion) below motion.derivative_cutoff_hz, by a zero-phase low-pass; unchanged where
// that is zero or the recording too short.
Eigen::VectorXd ForDerivatives(const EffectMotion& motion, const Eigen::VectorXd& values);

// Over all motions; zero where the joint does not move.
double PositionRange(const std::vector<EffectMotion>& motions, int joint);
double LargestSpeed(const std::vector<EffectMotion>& motions, int joint);
// [s] of the longest recording.
double LongestDuration(const std::vector<EffectMotion>& motions);

// count values from lower to upper, both among them, equal ratios. 0 < lower < upper, count >= 2 (CHECK).
std::vector<double> LogGrid(double lower, double upper, int count);

}  // namespace idim

#endif  // IDIM_CORE_EFFECTS_COLUMNS_H_
