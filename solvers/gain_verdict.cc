#include "solvers/gain_verdict.h"

#include <glog/logging.h>

#include <Eigen/QR>
#include <cmath>
#include <cstdio>
#include <limits>

#include "solvers/least_squares.h"

namespace idim {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Below this part of a torque another counts as none: far above rounding, far below any measurement.
constexpr double kNoTorque = 1e-6;

std::string Percent(double share) {
  char text[32];
  std::snprintf(text, sizeof(text), share < 0.0995 ? "%.2g %%" : "%.0f %%", 100.0 * share);
  return text;
}

std::string Number(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.3g", value);
  return text;
}

std::string Load(const GainVerdict& v) {
  const std::string joint = "joint " + std::to_string(v.joint);
  if (v.payload_torque_share < kNoTorque) {
    return "what is known of the payload puts no torque on " + joint +
           ", so that its gain hangs on parameters shared with other joints and on their gains";
  }
  const std::string share = Percent(v.payload_torque_share) + " of its torque while loaded";
  if (v.payload_gravity_share < kNoTorque * v.payload_torque_share) {
    return "gravity of the known payload puts no torque on " + joint +
           " (its axis stands parallel to gravity), so that its gain is known only through inertial and coupling "
           "terms, " +
           share;
  }
  return "what is known of the payload makes " + share + " on " + joint + " (gravity alone " +
         Percent(v.payload_gravity_share) + ")";
}

std::string Sentence(const GainVerdict& v) {
  const std::string bracket = std::isfinite(v.reverse) ? "between " + Number(v.least_squares) +
                                                             " (LS, noise shrinks it) and " + Number(v.reverse)
                                                       : "of any size above " + Number(v.least_squares);
  const std::string shares = Percent(v.known_share) + " of what only " + v.name + " can explain (" +
                             Percent(v.independent) + " of its signal) comes from the known payload";
  switch (v.strength) {
    case GainStrength::kStrong:
      return v.name + " is well determined: " + Load(v) + "; " + shares + ", the rest is noise.";
    case GainStrength::kWeak:
      return v.name + " is weak: " + Load(v) + "; only " + shares + ", the rest is noise and model error, and a gain " +
             bracket + " fits. Move a heavier payload, or move this joint faster with the payload far out.";
    case GainStrength::kNone:
      break;
  }
  return v.name + " is not determined: " + Load(v) + "; only " + shares +
         ", the rest is noise and model error, and a gain " + bracket +
         " fits. Its estimate says how the estimator shares out noise, not what the gain is. Move a heavier payload, "
         "move this joint faster with the payload far out, or take the gain as known.";
}

}  // namespace

std::vector<GainVerdict> JudgeGains(const GainSystem& system, const VectorXd& row_sigma, const VectorXd& gains,
                                    double rank_tolerance) {
  const int n = system.dof();
  CHECK_EQ(row_sigma.size(), n);
  CHECK_EQ(gains.size(), n);
  const Index unknowns = static_cast<Index>(system.unknowns.size());
  TriangularFactor factor(static_cast<int>(unknowns) + 1);
  for (int j = 0; j < n; ++j) factor.Merge(system.joints[j], 1.0 / row_sigma[j]);
  const MatrixXd r = factor.R();

  std::vector<GainVerdict> verdicts;
  for (int j = 0; j < n; ++j) {
    GainVerdict v;
    v.name = system.unknowns[j].name;
    v.joint = system.unknowns[j].joint;
    MatrixXd others(r.rows(), unknowns - 1);
    others << r.leftCols(j), r.middleCols(j + 1, unknowns - 1 - j);
    Eigen::ColPivHouseholderQR<MatrixXd> qr(others * ColumnScales(others).cwiseInverse().asDiagonal());
    qr.setThreshold(rank_tolerance);
    MatrixXd rest(r.rows(), 2);
    rest << r.col(j), r.col(unknowns);
    rest = (qr.householderQ().transpose() * rest).eval();
    const auto signal = rest.col(0).tail(r.rows() - qr.rank());
    const auto known = rest.col(1).tail(r.rows() - qr.rank());
    const double column = r.col(j).norm(), left = signal.norm(), load = known.norm();
    const double product = signal.dot(known);
    if (left > 0.0) {
      v.independent = left / column;
      v.known_share = load > 0.0 ? std::pow(product / (left * load), 2) : 0.0;
      v.unexplained = v.independent * std::sqrt(std::max(0.0, 1.0 - v.known_share));
      v.least_squares = -product / (left * left);
    } else {
      v.independent = v.unexplained = v.known_share = 0.0;
    }
    v.reverse = v.known_share > 0.0 ? v.least_squares / v.known_share : std::numeric_limits<double>::infinity();
    v.strength = v.known_share >= 2.0 / 3.0 ? GainStrength::kStrong
                 : v.known_share >= 0.1     ? GainStrength::kWeak
                                            : GainStrength::kNone;

    const MatrixXd loaded = system.loads[j].R();
    const double torque = (loaded.leftCols(n) * gains).norm();
    v.payload_torque_share = torque > 0.0 ? loaded.col(n).norm() / torque : 0.0;
    v.payload_gravity_share = torque > 0.0 ? loaded.col(n + 1).norm() / torque : 0.0;
    v.sentence = Sentence(v);
    verdicts.push_back(v);
  }
  return verdicts;
}

}  // namespace idim
