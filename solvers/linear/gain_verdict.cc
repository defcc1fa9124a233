#include "solvers/linear/gain_verdict.h"

#include <glog/logging.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/base/decompositions.h"
#include "core/base/text.h"
#include "solvers/linear/least_squares.h"
#include "solvers/linear/signal_noise.h"
#include "solvers/linear/total_least_squares.h"

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
           " (as on an axis parallel to gravity), so that its gain is known only through inertial and coupling "
           "terms, " +
           share;
  }
  return "what is known of the payload makes " + share + " on " + joint + " (gravity alone " +
         Percent(v.payload_gravity_share) + ")";
}

std::string Sentence(const GainVerdict& v) {
  const std::string noise = "no other parameter can imitate " + Percent(v.independent) + " of its signal, and " +
                            Percent(std::min(1.0, 1.0 - v.reliability)) + " of the power of that is noise";
  const std::string remedy =
      " Use a heavier payload, or move this joint faster with the payload far out and more often.";
  switch (v.strength) {
    case GainStrength::kStrong:
      return v.name + " is well determined: " + Load(v) + "; " + noise + ".";
    case GainStrength::kWeak:
      return v.name + " is weak: " + Load(v) + "; " + noise + ", which makes LS find " + Percent(v.reliability) +
             " of the gain or less (here " + Number(v.least_squares) +
             ") and plain TLS depend on units; an estimator that knows the noise of each column is needed (gtls)." +
             remedy;
    case GainStrength::kNone:
      break;
  }
  return v.name + " is not determined: " + Load(v) + "; " + noise +
         ", so that its estimate says how the estimator shares out noise, not what the gain is." + remedy +
         " Or take the gain as known.";
}

}  // namespace

std::string ReasonsAgainstGains(const VectorXd& gains, const MatrixXd& covariance, const VectorXd& a_priori,
                                double max_percent) {
  std::string why;
  for (Index j = 0; j < gains.size(); ++j) {
    const std::string name = Format("g%d = %.4g", static_cast<int>(j) + 1, gains[j]);
    if (a_priori.size() > 0 && gains[j] * a_priori[j] < 0.0) {
      why +=
          (why.empty() ? "" : "; ") + name + Format(" has the opposite sign of its a priori value %.4g", a_priori[j]);
    }
    const double percent = 100.0 * std::sqrt(covariance(j, j)) / std::abs(gains[j]);
    if (!(percent <= max_percent)) {
      why += (why.empty() ? "" : "; ") + name +
             Format(" has a relative standard deviation of %.3g %%, above %.3g %%", percent, max_percent);
    }
  }
  return why;
}

std::vector<GainVerdict> JudgeGains(const GainSystem& system, double rank_tolerance) {
  const int n = system.dof();
  const Index unknowns = static_cast<Index>(system.unknowns.size());
  TriangularFactor factor(static_cast<int>(unknowns) + 1);
  for (const TriangularFactor& joint : system.joints) factor.Merge(joint);
  const MatrixXd r = factor.R();
  // Squared norm of the noise of each gain's column.
  const MatrixXd signal_noise = SignalNoise(system, rank_tolerance);
  VectorXd noise = VectorXd::Zero(n);
  for (int i = 0; i < n; ++i) {
    noise += static_cast<double>(system.joints[i].rows()) * signal_noise.row(i).cwiseAbs2().transpose();
  }
  TotalLeastSquaresOptions options;
  options.noise = VectorXd::Zero(unknowns + 1);
  options.noise.head(n) = noise.cwiseSqrt();
  const VectorXd x = SolveTotalLeastSquares(r, factor.rows(), options).singular_vector;
  const VectorXd gains = x.head(n);
  const double known_scale = x[unknowns];

  std::vector<GainVerdict> verdicts;
  for (int j = 0; j < n; ++j) {
    GainVerdict v;
    v.name = system.unknowns[j].name;
    v.joint = system.unknowns[j].joint;
    MatrixXd others(r.rows(), unknowns - 1);
    others << r.leftCols(j), r.middleCols(j + 1, unknowns - 1 - j);
    Eigen::ColPivHouseholderQR<MatrixXd> qr(others * ColumnScales(others).cwiseInverse().asDiagonal());
    qr.setThreshold(rank_tolerance);
    MatrixXd remainder(r.rows(), 2);
    remainder << r.col(j), r.col(unknowns);
    remainder = (qr.householderQ().transpose() * remainder).eval();
    const auto signal = remainder.col(0).tail(r.rows() - qr.rank());
    const auto known = remainder.col(1).tail(r.rows() - qr.rank());
    const double column = r.col(j).norm(), norm_left = signal.norm(), load = known.norm();
    const double product = signal.dot(known);
    if (norm_left > 0.0) {
      v.independent = norm_left / column;
      v.known_share = load > 0.0 ? std::pow(product / (norm_left * load), 2) : 0.0;
      v.unexplained = v.independent * std::sqrt(std::max(0.0, 1.0 - v.known_share));
      v.least_squares = -product / (norm_left * norm_left);
    } else {
      v.independent = v.unexplained = v.known_share = 0.0;
    }
    v.noise = column > 0.0 ? std::sqrt(noise[j]) / column : 0.0;
    v.reliability = norm_left > 0.0 ? std::max(0.0, 1.0 - noise[j] / (norm_left * norm_left)) : 0.0;
    v.strength = v.reliability >= 2.0 / 3.0 ? GainStrength::kStrong
                 : v.reliability >= 0.2     ? GainStrength::kWeak
                                            : GainStrength::kNone;

    const MatrixXd loaded = system.loads[j].R();
    const double torque = (loaded.leftCols(n) * gains).norm();
    const double scale = known_scale > 0.0 && torque > 0.0 ? known_scale / torque : 0.0;
    v.payload_torque_share = loaded.col(n).norm() * scale;
    v.payload_gravity_share = loaded.col(n + 1).norm() * scale;
    v.sentence = Sentence(v);
    verdicts.push_back(v);
  }
  return verdicts;
}

}  // namespace idim
