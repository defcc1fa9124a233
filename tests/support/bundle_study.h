// A small study for the errors-in-variables bundle: the arm of tests/support/gain_study.h, its true joint states
// off the measured ones by draws of the state covariance, its signals noisy.
//
// The signals are moved to the true states by the torque of StandardModel, which knows nothing of the derivatives that
// the bundle uses. Coulomb friction stays that of the measured state: the bundle has no derivative of a sign.

#ifndef IDIM_TESTS_SUPPORT_BUNDLE_STUDY_H_
#define IDIM_TESTS_SUPPORT_BUNDLE_STUDY_H_

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <string>
#include <utility>

#include "core/base/decompositions.h"
#include "solvers/bundle/bundle_data.h"
#include "tests/support/edit_data.h"
#include "tests/support/gain_study.h"

namespace idim::testing {

struct BundleStudy {
  PreparedStudy prepared;
  BundleData data;
  Eigen::VectorXd truth;
  Eigen::VectorXd sigma;  // n, of the signals' noise
};

// Standard parameters whose kept ones are the base parameters at the head of `chi`, the others 0; no Coulomb friction.
inline Eigen::VectorXd SmoothStandardParameters(const BaseParameters& base, const Eigen::VectorXd& chi) {
  Eigen::VectorXd standard = Eigen::VectorXd::Zero(base.model().columns());
  for (int k = 0; k < base.size(); ++k) {
    if (base.model().parameters()[base.kept()[k]].name.rfind("Fs", 0) == 0) continue;
    standard[base.kept()[k]] = chi[k];
  }
  return standard;
}

// The payload that a recording carries, known and unknown parts. chi: BundleData::num_columns().
inline InertialVector CarriedPayload(const BundleData& data, int recording, const Eigen::VectorXd& chi) {
  InertialVector payload = InertialVector::Zero();
  const int carried = data.payload_of_recording[recording];
  if (carried < 0) return payload;
  payload = data.unknowns.known_payload(carried);
  for (int k = 0; k < kNumInertial; ++k) {
    if (data.payload_column(carried, k) >= 0) payload[k] += chi[data.payload_column(carried, k)];
  }
  return payload;
}

// position_noise: of the encoders [rad or m]; signal_noise: of each decimated sample, relative to the rms.
inline BundleStudy MakeBundleStudy(const GainScenario& scenario, double position_noise, double signal_noise) {
  GainStudy study = MakeGainStudy(scenario);
  const int n = scenario.robot.dof();
  EditData(&study.prepared, [&](Data* data) { data->position_noise.setConstant(n, position_noise); });
  Result<BundleData> built = BuildBundleData(study.prepared);
  EXPECT_TRUE(built.ok()) << built.status().message();
  BundleStudy result{std::move(study.prepared), std::move(built).value(), study.truth, Eigen::VectorXd::Zero(n)};
  BundleData& data = result.data;
  for (const BundleSample& sample : data.samples()) result.sigma += sample.signal.cwiseAbs2();
  result.sigma = signal_noise * (result.sigma / static_cast<double>(data.samples().size())).cwiseSqrt();

  const Eigen::VectorXd chi = result.truth.tail(data.num_columns());
  const Eigen::VectorXd standard = SmoothStandardParameters(result.prepared.base(), chi);
  StandardModel model = result.prepared.base().model();
  std::mt19937_64 generator(scenario.noise_seed);
  std::normal_distribution<double> normal;
  Eigen::VectorXd white(3 * n), measured(n), moved(n);
  std::vector<BundleSample> samples = data.samples();
  for (BundleSample& sample : samples) {
    for (int s = 0; s < 3 * n; ++s) white[s] = normal(generator);
    const Eigen::LLT<Eigen::MatrixXd> llt(StateCovarianceOf(data, sample.recording));
    const Eigen::VectorXd state = sample.state + llt.matrixL() * white;
    const InertialVector payload = CarriedPayload(data, sample.recording, chi);
    const auto torque = [&](const Eigen::VectorXd& x, Eigen::VectorXd* tau) {
      model.Torque(x.data(), x.data() + n, x.data() + 2 * n, nullptr, standard, payload, tau->data());
    };
    torque(sample.state, &measured);
    torque(state, &moved);
    sample.signal += (data.inverse_drive * (moved - measured)).cwiseQuotient(scenario.gains);
    for (int j = 0; j < n; ++j) sample.signal[j] += result.sigma[j] * normal(generator);
  }
  data.SetSamples(std::move(samples));
  return result;
}

}  // namespace idim::testing

#endif  // IDIM_TESTS_SUPPORT_BUNDLE_STUDY_H_
