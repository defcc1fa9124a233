// The result of an identification, as estimate.json holds it (schema idim.estimate.1).

#ifndef IDIM_CORE_ESTIMATE_ESTIMATE_H_
#define IDIM_CORE_ESTIMATE_ESTIMATE_H_

#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>

#include "core/base/status.h"
#include "core/dynamics/parameters.h"

namespace idim {

struct ParameterEstimate {
  Parameter parameter;
  double value = 0.0;
  double standard_deviation = 0.0;
  double interval95[2] = {0.0, 0.0};       // by Student's t with the residual's degrees of freedom
  double model_standard_deviation = -1.0;  // where standard_deviation is a robust one: that of independent samples
  std::string regrouping;

  // Eq. (11); inf where the value is zero.
  double RelativeSigmaPercent() const;
};

// How well the model reproduces one recording. Vectors: one entry a joint; torque on the joint side.
struct RecordingFit {
  std::string name;
  std::string use;                         // "identification" or "validation"
  int samples = 0;                         // decimated
  Eigen::VectorXd relative_error_percent;  // 100 |Y_j - W_j chi| / |Y_j|, decimated, as in the paper's Table VI
  double relative_error_percent_all = 0.0;
  Eigen::VectorXd rms_torque;  // [N.m or N] of the decimated residual
  // Of the unfiltered torque less the model, at the recorded rate, between the first and last decimated instant.
  Eigen::VectorXd rms_torque_unfiltered;
  Eigen::VectorXd residual_lag1;  // autocorrelation of the decimated residual at lag 1: 0 if white
};

// How well the data determine one drive gain (solvers/linear/gain_verdict.h).
struct GainDiagnosis {
  std::string name;
  std::string strength;                // "strong", "weak" or "none"
  double reliability = 0.0;            // of the power that only this gain can explain, the share that is signal
  double independent = 0.0;            // of its column, what no other unknown can imitate, in [0, 1]
  double known_share = 0.0;            // of that, the share that the known payload explains, in [0, 1]
  double payload_torque_share = 0.0;   // |known payload's torque| / |torque| on its joint, loaded recordings
  double payload_gravity_share = 0.0;  // of gravity alone
  std::string sentence;
};

// An effect in the model of an estimate, and the shape of its columns. The values are among the parameters.
struct EstimatedEffect {
  std::string id;
  std::vector<int> joints;                                 // zero-based
  std::vector<std::pair<std::string, double>> shape = {};  // by name
};

struct Estimate {
  Status status;
  std::string robot;
  std::string estimator;
  std::vector<ParameterEstimate> parameters;
  Eigen::MatrixXd covariance;                 // in the order of `parameters`
  Eigen::MatrixXd model_covariance;           // where that is a robust one: of independent samples; else empty
  std::vector<std::string> eliminated;        // not essential, set to zero
  std::vector<std::string> without_effect;    // standard parameters that no torque depends on
  Eigen::VectorXd position_noise;             // [rad or m] a sample, joint side
  Eigen::VectorXd signal_noise;               // [signal unit] a sample
  Eigen::VectorXd signal_noise_decimated;     // [signal unit] what the bundle weighs decimated signals by, or empty
  std::vector<GainDiagnosis> gain_diagnoses;  // where gains are identified
  Eigen::VectorXd singular_values;            // of W_tot, decreasing; total least squares only
  std::vector<RecordingFit> recordings;
  std::vector<EstimatedEffect> effects;
  bool velocity_zero_at_rest = false;  // in the model's velocities (core/model/data.h)
  double condition_number = -1.0;
  double condition_number_weighted = -1.0;
  double relative_error_percent = -1.0;  // of all identification recordings together, the paper's |rho| / |Y|
  double cutoff_hz = 0.0;
  int decimation = 0;
  std::string uncertainty;    // what the standard deviations assume, a sentence; empty: white residuals
  std::string start;          // of an iterative estimator: where from, and how it ended
  std::string preprocessing;  // how the cut-off and the decimation were chosen
  double seconds = 0.0;

  // nullptr where there is no such parameter.
  const ParameterEstimate* Find(const std::string& name) const;
};

// "IDIM-WLS" of "wls".
std::string EstimatorTitle(const std::string& estimator);

// The text of the console: the paper's Table I with intervals, then the errors a recording; torque in `torque_units`
// (TorqueUnits(), core/robot/joint_units.h).
std::string EstimateToText(const Estimate& estimate, const std::string& torque_units);

// value +- factor * t(0.975, degrees_of_freedom) * standard deviation.
void SetInterval95(double degrees_of_freedom, ParameterEstimate* estimate, double factor = 1.0);

}  // namespace idim

#endif  // IDIM_CORE_ESTIMATE_ESTIMATE_H_
