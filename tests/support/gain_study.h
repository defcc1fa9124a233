// An arm that moves smoothly with and without a payload of known mass, signals made from true parameters and gains: a
// prepared study without files. The joint states are exact; torque and regressor pass the same decimator, so that
// without signal noise W_tot x = 0 holds to rounding.

#ifndef IDIM_TESTS_SUPPORT_GAIN_STUDY_H_
#define IDIM_TESTS_SUPPORT_GAIN_STUDY_H_

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "core/base/decompositions.h"
#include "core/model/model.h"
#include "solvers/linear/gain_system.h"
#include "tests/support/random_arm.h"

namespace idim::testing {

struct GainScenario {
  Robot robot;
  Eigen::VectorXd gains;
  std::vector<int> known = {kM};  // of the payload's ten
  int samples = 4000;             // a recording, at 500 Hz
  int decimation = 10;
  double signal_noise = 0.0;  // standard deviation a recorded sample, relative to the rms of the signal
  unsigned seed = 1;
  unsigned noise_seed = 1;
  double mass = 4.59;
  double speed = 1.0;      // times 0.1 to 1 Hz
  double amplitude = 0.5;  // [rad] or [m] of each harmonic at most
  FrictionModel friction;
};

struct GainStudy {
  PreparedStudy prepared;
  Eigen::VectorXd truth;  // of the unknowns of BuildGainSystem, in its order
};

inline GainStudy MakeGainStudy(const GainScenario& scenario) {
  Random random(scenario.seed);
  const int n = scenario.robot.dof();
  Study study;
  study.path = "study.yaml";
  study.robot = scenario.robot;
  study.gains_mode = GainsMode::kIdentify;
  study.friction = scenario.friction;
  if (study.robot.transmission.size() > 0) study.signal_side = Side::kMotor;
  // The payload of the paper's Table I, scaled to the mass.
  InertialVector body;
  body << 0.064, -0.018, 0.026, 0.064, 0.026, 0.044, -0.29, -0.29, 0.41, 4.59;
  body *= scenario.mass / 4.59;
  Payload payload;
  payload.name = "calibrated";
  for (const int k : scenario.known) payload.known[k] = body[k];
  study.payloads.push_back(payload);
  for (const int carried : {-1, 0}) {
    RecordingEntry entry;
    entry.name = carried < 0 ? "free" : "load";
    entry.payload = carried;
    study.recordings.push_back(entry);
  }

  StandardModel model(study.robot, study.friction);
  Eigen::VectorXd chi(model.columns());
  for (int j = 0; j < n; ++j) {
    const InertialVector link = RandomBody(&random);
    for (int k = 0; k < kNumInertial; ++k) {
      chi[model.Find(kStandardNames[k] + std::to_string(j + 1))] = link[k] * (j < 3 ? 1.0 : 0.2);
    }
  }
  for (int c = 0; c < model.columns(); ++c) {
    const Parameter& p = model.parameters()[c];
    if (p.kind == ParameterKind::kDriveInertia) chi[c] = random.Uniform(0.02, 0.2);
    if (p.kind == ParameterKind::kFriction) chi[c] = random.Uniform(0.3, 5.0);
  }

  Result<Model> supposed = MakeModel(study);
  EXPECT_TRUE(supposed.ok()) << supposed.status().message();
  Data data{DataRequestOf(study), DriveMap(study.robot, study.signal_side), {}, {}, {}, {}, {}};
  data.preprocessing.cutoff_hz = 20.0;
  data.preprocessing.decimation = scenario.decimation;
  data.position_noise = data.velocity_sigma = Eigen::VectorXd::Zero(n);
  std::mt19937_64 generator(scenario.noise_seed);
  std::normal_distribution<double> normal;
  for (const RecordingEntry& entry : study.recordings) {
    Recording recording;
    const int samples = scenario.samples;
    recording.name = entry.name;
    recording.t = Eigen::VectorXd::LinSpaced(samples, 0.0, (samples - 1) * 0.002);
    recording.signal.resize(samples, n);
    JointStates states;
    states.clock = AnalyzeClock(recording.t);
    states.t = recording.t;
    states.q = states.dq = states.ddq = Eigen::MatrixXd::Zero(samples, n);
    for (int j = 0; j < n; ++j) {
      for (int h = 0; h < 4; ++h) {
        const double w = 2.0 * M_PI * scenario.speed * random.Uniform(0.1, 1.0);
        const double a = random.Uniform(0.3, 1.0) * scenario.amplitude, phase = random.Uniform(0.0, 2.0 * M_PI);
        const Eigen::ArrayXd angle = w * recording.t.array() + phase;
        states.q.col(j).array() += a * angle.sin();
        states.dq.col(j).array() += a * w * angle.cos();
        states.ddq.col(j).array() -= a * w * w * angle.sin();
      }
    }
    Eigen::VectorXd q, dq, ddq, tau(n);
    const Eigen::PartialPivLU<Eigen::MatrixXd> inverse(data.drive.Matrix(scenario.gains));
    const InertialVector load = entry.payload < 0 ? InertialVector(InertialVector::Zero()) : body;
    for (int i = 0; i < samples; ++i) {
      q = states.q.row(i);
      dq = states.dq.row(i);
      ddq = states.ddq.row(i);
      model.Torque(q.data(), dq.data(), ddq.data(), data.velocity_sigma.data(), chi, load, tau.data());
      recording.signal.row(i) = inverse.solve(tau).transpose();
    }
    const Eigen::VectorXd rms = recording.signal.colwise().norm() / std::sqrt(static_cast<double>(samples));
    for (int j = 0; scenario.signal_noise > 0.0 && j < n; ++j) {
      for (int i = 0; i < samples; ++i) recording.signal(i, j) += scenario.signal_noise * rms[j] * normal(generator);
    }
    recording.q = states.q;
    Result<Decimator> decimator = MakeDecimator(recording, data.preprocessing);
    EXPECT_TRUE(decimator.ok()) << decimator.status().message();
    data.recordings.push_back({entry, std::make_shared<const Recording>(recording),
                               std::make_shared<const JointStates>(states),
                               std::make_shared<const Decimator>(std::move(decimator).value())});
  }

  GainStudy result{{std::make_shared<const Data>(std::move(data)), *std::move(supposed)}, {}};
  const Eigen::VectorXd base = result.prepared.base().projection() * chi;
  std::vector<double> unknown;
  for (int k = 0; k < kNumInertial; ++k) {
    if (!payload.known[k]) unknown.push_back(body[k]);
  }
  const auto unknowns = static_cast<Eigen::Index>(unknown.size());
  result.truth.resize(n + base.size() + unknowns);
  result.truth << scenario.gains, base, Eigen::Map<Eigen::VectorXd>(unknown.data(), unknowns);
  return result;
}

// The paper's Table IV, last column.
inline GainScenario Tx40Gains() {
  GainScenario scenario;
  scenario.robot = Tx40();
  scenario.gains = Eigen::VectorXd{{33.9, 32.4, 24.2, -9.21, 16.3, 6.79}};
  return scenario;
}

}  // namespace idim::testing

#endif  // IDIM_TESTS_SUPPORT_GAIN_STUDY_H_
