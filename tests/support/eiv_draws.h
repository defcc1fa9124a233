// Repeated draws of decimated samples with errors in every variable: the bundle's data as an experiment gives them, but
// for the filter.
//
// The arm moves through the same true states in every draw; the signals are those of the true states, by the recursion
// of StandardModel with the sign of the true velocity; the measured states are the true ones plus noise of a known
// 3 x 3 covariance a joint; columns are evaluated at the measured states. Errors of the columns therefore are
// independent of the true columns and attenuate whatever takes the columns for exact. (MakeBundleStudy of
// bundle_study.h puts the noise on the true states instead, about columns that are exact at the measured ones: there,
// nothing attenuates.)

#ifndef IDIM_TESTS_SUPPORT_EIV_DRAWS_H_
#define IDIM_TESTS_SUPPORT_EIV_DRAWS_H_

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "core/base/decompositions.h"
#include "core/simulation/scenario.h"
#include "core/simulation/simulate_scenario.h"
#include "solvers/bundle/bundle_data.h"
#include "solvers/linear/gain_system.h"
#include "tests/support/bundle_study.h"
#include "tests/support/edit_data.h"
#include "tests/support/gain_study.h"

namespace idim::testing {

// The columns and the known torque of every sample, at its measured state and unfiltered. velocity_sigma:
// of that state.
inline void EvaluateColumns(const BaseParameters& base, double velocity_sigma, BundleData* data) {
  const int n = data->dof;
  StandardModel model = base.model();
  const Eigen::VectorXd sigma = Eigen::VectorXd::Constant(n, velocity_sigma);
  StateDerivatives::RowMajorMatrix standard(n, model.columns()), payload(n, kNumInertial);
  std::vector<BundleSample> samples = data->samples();
  for (BundleSample& sample : samples) {
    const double* x = sample.state.data();
    model.Regressor(x, x + n, x + 2 * n, sigma.data(), standard.data());
    sample.sign_variance.resize(n);
    for (int j = 0; j < n; ++j) sample.sign_variance[j] = 1.0 - std::pow(ExpectedSign(x[n + j], velocity_sigma), 2);
    sample.columns.setZero();
    for (int k = 0; k < data->unknowns.num_base(); ++k) sample.columns.col(k) = standard.col(base.kept()[k]);
    sample.known.setZero();
    const int carried = data->payload_of_recording[sample.recording];
    if (carried < 0) continue;
    model.PayloadColumns(payload.data());
    for (int k = 0; k < kNumInertial; ++k) {
      const int column = data->payload_column(carried, k);
      if (column >= 0) sample.columns.col(column) = payload.col(k);
    }
    sample.known = payload * data->unknowns.known_payload(carried);
  }
  data->SetSamples(std::move(samples));
}

struct EivNoise {
  Eigen::Vector3d state;            // standard deviations of q, dq, ddq; correlated as the study's filter makes them
  double signal = 0.1;              // of each decimated sample, relative to the rms
  double signal_correlation = 0.0;  // of the signal noise with the sample before: AR(1)
  unsigned seed = 1;
};

class EivDraws {
 public:
  // study: its joint states, decimated, are the true ones; its signals do not matter.
  EivDraws(GainStudy study, const EivNoise& noise) : noise_(noise), study_(std::move(study)) {
    const int n = study_.prepared.robot().dof();
    EditData(&study_.prepared, [&](Data* data) { data->position_noise.setOnes(n); });
    Result<BundleData> built = BuildBundleData(study_.prepared);
    EXPECT_TRUE(built.ok()) << built.status().message();
    exact_ = std::move(built).value();
    for (auto& joints : exact_.state_covariance) {
      for (Eigen::Matrix3d& covariance : joints) {
        const Eigen::Vector3d scale = noise.state.cwiseQuotient(covariance.diagonal().cwiseSqrt());
        covariance = scale.asDiagonal() * Eigen::Matrix3d(covariance) * scale.asDiagonal();
        half_.emplace_back(covariance.llt().matrixL());
      }
    }
    const Eigen::VectorXd chi = truth().tail(exact_.num_columns());
    Eigen::VectorXd standard = Eigen::VectorXd::Zero(base().model().columns());
    for (int k = 0; k < base().size(); ++k) standard[base().kept()[k]] = chi[k];
    StandardModel model = base().model();
    Eigen::VectorXd tau(n);
    sigma_ = Eigen::VectorXd::Zero(n);
    std::vector<BundleSample> samples = exact_.samples();
    for (BundleSample& sample : samples) {
      const double* x = sample.state.data();
      model.Torque(x, x + n, x + 2 * n, nullptr, standard, CarriedPayload(exact_, sample.recording, chi), tau.data());
      sample.signal = (exact_.inverse_drive * tau).cwiseQuotient(truth().head(n));
      sigma_ += sample.signal.cwiseAbs2();
    }
    sigma_ = noise.signal * (sigma_ / static_cast<double>(samples.size())).cwiseSqrt();
    exact_.SetSamples(std::move(samples));
  }

  const BaseParameters& base() const { return study_.prepared.base(); }
  const Eigen::VectorXd& truth() const { return study_.truth; }
  const Eigen::VectorXd& sigma() const { return sigma_; }  // of the signals' noise
  std::vector<std::string> names() const {
    std::vector<std::string> names;
    for (const Parameter& unknown : exact_.unknowns.parameters()) names.push_back(unknown.name);
    return names;
  }

  BundleData Draw(int run) const {
    BundleData data = exact_;
    const int n = data.dof;
    std::seed_seq seed{noise_.seed, static_cast<unsigned>(run)};
    std::mt19937_64 generator(seed);
    std::normal_distribution<double> normal;
    Eigen::VectorXd correlated(n);
    const double rho = noise_.signal_correlation;
    int recording = -1;
    std::vector<BundleSample> samples = data.samples();
    for (BundleSample& sample : samples) {
      for (int j = 0; j < n; ++j) {
        Eigen::Vector3d white;
        for (double& w : white) w = normal(generator);
        const Eigen::Vector3d error = half_[static_cast<size_t>(sample.recording * n + j)] * white;
        for (int a = 0; a < 3; ++a) sample.state[a * n + j] += error[a];
      }
      const bool first = sample.recording != recording;
      recording = sample.recording;
      for (int j = 0; j < n; ++j) {
        const double fresh = normal(generator);
        correlated[j] = first ? fresh : rho * correlated[j] + std::sqrt(1.0 - rho * rho) * fresh;
      }
      sample.signal += sigma_.cwiseProduct(correlated);
    }
    data.SetSamples(std::move(samples));
    EvaluateColumns(base(), noise_.state[1], &data);
    return data;
  }

 private:
  EivNoise noise_;
  GainStudy study_;
  BundleData exact_;                   // true states, exact signals
  std::vector<Eigen::Matrix3d> half_;  // a recording and joint: L of the covariance of its state
  Eigen::VectorXd sigma_;
};

// True values of the unknowns of BuildGainSystem.
inline Eigen::VectorXd TrueValues(const Scenario& scenario, const BaseParameters& base_parameters) {
  std::vector<double> unknown;
  for (const ScenarioPayload& payload : scenario.payloads) {
    for (int k = 0; k < kNumInertial; ++k) {
      const bool known = std::count(payload.known.begin(), payload.known.end(), k) > 0;
      if (!known) unknown.push_back(payload.inertial[k]);
    }
  }
  const Eigen::VectorXd base = base_parameters.projection() * scenario.chi;
  Eigen::VectorXd truth(scenario.gains.size() + base.size() + static_cast<Eigen::Index>(unknown.size()));
  truth << scenario.gains, base, Eigen::Map<Eigen::VectorXd>(unknown.data(), static_cast<Eigen::Index>(unknown.size()));
  return truth;
}

// A scenario's motion as a study whose joint states are exact, at the scenario's own rate (no decimation). The filter's
// cut-off, at 0.4 of the rate, says how state noise is correlated and nothing else. gains mode identify.
inline GainStudy ExactStudy(const Scenario& scenario) {
  const Study study = StudyOf(scenario);
  const int n = study.robot.dof();
  Result<Model> supposed = MakeModel(study);
  EXPECT_TRUE(supposed.ok()) << supposed.status().message();
  Data data{DataRequestOf(study), DriveMap(study.robot, study.signal_side), {}, {}, {}, {}, {}};
  data.preprocessing.cutoff_hz = 0.4 * scenario.truth.rate;
  data.preprocessing.decimation = 1;
  data.position_noise = data.velocity_sigma = Eigen::VectorXd::Zero(n);
  for (size_t r = 0; r < scenario.recordings.size(); ++r) {
    const Truth truth = SimulateTruth(scenario, scenario.recordings[r]);
    Recording recording;
    recording.name = study.recordings[r].name;
    recording.t = truth.t;
    recording.q = truth.q;
    recording.signal = truth.signal;
    Result<Decimator> decimator = MakeDecimator(recording, data.preprocessing);
    EXPECT_TRUE(decimator.ok()) << decimator.status().message();
    JointStates states{AnalyzeClock(truth.t), truth.t, truth.q, truth.dq, truth.ddq};
    data.recordings.push_back({study.recordings[r], std::make_shared<const Recording>(std::move(recording)),
                               std::make_shared<const JointStates>(std::move(states)),
                               std::make_shared<const Decimator>(std::move(decimator).value())});
  }
  GainStudy result{{std::make_shared<const Data>(std::move(data)), *std::move(supposed)}, {}};
  result.truth = TrueValues(scenario, result.prepared.base());
  return result;
}

// The same samples as the rows of W_tot (solvers/linear/gain_system.h), signals on the joint side.
// Not for verdicts on gains.
inline GainSystem GainSystemOf(const BundleData& data) {
  const int n = data.dof;
  GainSystem system(data.unknowns.parameters(), n);
  Eigen::RowVectorXd row(data.num_unknowns() + 1), load = Eigen::RowVectorXd::Zero(n + 2);
  for (const BundleSample& sample : data.samples()) {
    for (int j = 0; j < n; ++j) {
      row.setZero();
      row[j] = sample.signal[j];
      row.segment(n, data.num_columns()) = -sample.columns.row(j);
      row[data.num_unknowns()] = -sample.known[j];
      system.joints[j].AddRow(row);
    }
  }
  for (int j = 0; j < n; ++j) {
    load.setZero();
    load[j] = load[n] = 1.0;
    system.loads[j].AddRow(load);
  }
  return system;
}

}  // namespace idim::testing

#endif  // IDIM_TESTS_SUPPORT_EIV_DRAWS_H_
