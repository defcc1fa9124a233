// What the errors-in-variables bundle works on: decimated samples with their filtered columns, and how the torque of
// each moves with its joint state.
//
// Sample k has the parallel-filtered columns Wbar_k (unknown base and payload parameters), the filtered torque of what
// is known of the payload, the filtered signal v_k, and the decimated joint state xhat_k = (q, dq, ddq). The true state
// deviates from xhat_k by a latent d_k; the torque there is
//   tau_k(chi, d_k) = Wbar_k chi + known_k + D_k(chi) d_k,     D = d(tau)/d(q, dq, ddq) at xhat_k,
// so that the columns keep the filter that the signal has passed (IDM at decimated instants against a filtered signal
// is a model error at every reversal), and only the deviation is linearised. The Coulomb columns have no part in D: the
// derivative of a sign is zero but at the reversal, where it is no number; what the velocity's noise does to them
// is in their expectation already (core/dynamics/standard_model.h).
//
// v = diag(1/g) M^-1 tau with M = 1 (signals on the joint side) or T' (motor side).

#ifndef IDIM_SOLVERS_BUNDLE_BUNDLE_DATA_H_
#define IDIM_SOLVERS_BUNDLE_BUNDLE_DATA_H_

#include <Eigen/Core>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/base/status.h"
#include "core/dynamics/rigid_body_derivatives.h"
#include "core/model/model.h"
#include "core/model/unknowns.h"
#include "core/statistics/long_run_covariance.h"

namespace idim {

// theta_unknown = value, give or take a standard deviation: a weighed mass, CAD data, a priori gains.
struct BundlePrior {
  int unknown = -1;
  double value = 0.0;
  double standard_deviation = 0.0;  // > 0
};

// False with a sentence in *error unless each names an unknown and has a positive standard deviation.
bool AreValid(const std::vector<BundlePrior>& priors, std::string* error);

struct BundleSample {
  using RowMajorMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  int recording = 0;       // index into BundleData::payload_of_recording and ::state_covariance
  RowMajorMatrix columns;  // n x (base + payload unknowns): without those of effects
  Eigen::VectorXd known;   // n [N m or N]
  Eigen::VectorXd signal;  // n [signal unit]
  Eigen::VectorXd state;   // 3n: q, dq, ddq
  // n: variance of the sign of each velocity given its measurement, 1 - E[sign]^2, filtered; empty: zero.
  Eigen::VectorXd sign_variance;
};

struct BundleData {
  using RowMajorMatrix = BundleSample::RowMajorMatrix;

  Unknowns unknowns;  // payload parameters with a standard deviation among them
  int dof = 0;
  // A recording: the 3 x 3 covariance of (q, dq, ddq) of each joint, [rad, rad/s, rad/s^2]^2.
  std::vector<std::vector<Eigen::Matrix3d>> state_covariance;
  std::vector<int> payload_of_recording;  // index of the model's payload, -1: none
  Eigen::MatrixXd inverse_drive;          // M^-1, n x n
  std::vector<int> coulomb_columns;       // n: column of each joint's Coulomb friction, -1: not declared
  std::vector<BundlePrior> priors;        // of the model, for BundleOptions::priors

  // Recording by recording, in order of time. Shared by all data that differ in their effects alone.
  const std::vector<BundleSample>& samples() const { return *samples_; }
  void SetSamples(std::vector<BundleSample> samples) {
    samples_ = std::make_shared<const std::vector<BundleSample>>(std::move(samples));
  }
  // n rows a sample, a column a parameter of the effects.
  void SetEffectColumns(RowMajorMatrix columns) { effects_ = std::move(columns); }
  // n x num_columns() of sample k, in *scratch where there are effects.
  const RowMajorMatrix& Columns(size_t k, RowMajorMatrix* scratch) const;

  int num_unknowns() const { return unknowns.size(); }
  int num_gains() const { return unknowns.num_gains(); }
  int num_columns() const { return unknowns.num_columns(); }
  // The column of parameter k of a payload (-1: none); -1: known or not carried.
  int payload_column(int payload, int k) const {
    const int unknown = unknowns.payload(payload, k);
    return unknown < 0 ? -1 : unknown - unknowns.num_gains();
  }
  Eigen::VectorXd Gains(const Eigen::VectorXd& theta) const { return unknowns.Gains(theta); }

 private:
  std::shared_ptr<const std::vector<BundleSample>> samples_ = std::make_shared<const std::vector<BundleSample>>();
  RowMajorMatrix effects_;
};

// One pass over the identification recordings, of a model with known or with unknown gains. BadInput: as
// BuildGainSystem where gains are unknown; a prior on a parameter that is not among the unknowns.
Result<BundleData> BuildBundleData(const PreparedStudy& prepared);

// The same for a model whose effects alone have changed since `before` was built, without a pass over the recordings.
// Its priors are on unknowns that are there (CHECK).
BundleData WithEffectColumnsOf(const PreparedStudy& prepared, const BundleData& before);

// Begin and end of the samples of each recording.
SampleRanges RecordingsOf(const BundleData& data);

// The covariance of the whole state vector of a sample, 3n x 3n in the order of BundleSample::state.
Eigen::MatrixXd StateCovarianceOf(const BundleData& data, int recording);

// Derivatives of the torque by the joint state. Not thread-safe: one a thread.
class StateDerivatives {
 public:
  using RowMajorMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  StateDerivatives(const BaseParameters& base, const BundleData& data);

  // D(chi) at the sample's state: n x 3n. chi: num_columns() parameters.
  void Torque(const BundleSample& sample, const Eigen::VectorXd& chi, Eigen::MatrixXd* d);

  // (dW/dx) deviation: n x num_columns(), how the columns change along a deviation (3n) of the state.
  void Columns(const BundleSample& sample, const Eigen::VectorXd& deviation, RowMajorMatrix* change);

 private:
  // d(column)/d(dq), d(column)/d(ddq) of the drives' columns, which are linear: [joint row, base column] of each.
  struct DriveEntry {
    int row, column, variable;  // variable: index into the state
    double value;
  };
  // A link's inertial parameter among the columns.
  struct InertialEntry {
    int link, parameter, column;
  };

  const BundleData& data_;
  RigidBodyDerivatives dynamics_;
  std::vector<DriveEntry> drive_entries_;
  std::vector<InertialEntry> base_entries_;
  std::vector<std::vector<InertialEntry>> payload_entries_;  // of each payload of the model
  std::vector<InertialVector> inertials_;
  std::vector<double> regressor_;  // n x 10n
};

}  // namespace idim

#endif  // IDIM_SOLVERS_BUNDLE_BUNDLE_DATA_H_
