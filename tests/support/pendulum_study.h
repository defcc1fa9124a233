// A study built in code: two revolute joints, their motion a sum of sines, torque by StandardModel, nothing in a file.

#ifndef IDIM_TESTS_SUPPORT_PENDULUM_STUDY_H_
#define IDIM_TESTS_SUPPORT_PENDULUM_STUDY_H_

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "core/dynamics/base_parameters.h"
#include "core/recording/study.h"

namespace idim::testing {

struct PendulumStudy {
  Study study;
  std::vector<Recording> recordings;
  Eigen::VectorXd base;  // true base parameters
};

inline PendulumStudy MakePendulumStudy(double noise = 0.01) {
  PendulumStudy result;
  Study& study = result.study;
  study.robot.name = "pendulum";
  study.robot.joints = {JointFromModifiedDh(JointType::kRevolute, M_PI / 2, 0.0, 0.0, 0.0),
                        JointFromModifiedDh(JointType::kRevolute, 0.0, 0.4, 0.0, 0.0)};
  study.recordings.resize(2);
  study.recordings[1].use = Use::kValidation;
  study.preprocessing = {20.0, 5};
  Robot robot = study.robot;
  robot.transmission = Eigen::MatrixXd::Identity(2, 2);
  StandardModel model(robot, study.friction);
  Eigen::VectorXd chi = Eigen::VectorXd::Zero(model.columns());
  const struct {
    const char* name;
    double value;
  } truth[] = {{"ZZ1", 0.9}, {"MX1", 1.2}, {"M1", 5.0},  {"Ia1", 0.4}, {"Fv1", 2.0}, {"Fs1", 3.0}, {"off1", 0.2},
               {"ZZ2", 0.3}, {"MX2", 0.6}, {"MY2", 0.1}, {"M2", 3.0},  {"Ia2", 0.2}, {"Fv2", 1.0}, {"Fs2", 1.5}};
  for (const auto& [name, value] : truth) chi[model.Find(name)] = value;
  result.base = BaseParameters(model).projection() * chi;
  std::mt19937_64 generator(7);
  std::normal_distribution<double> normal;
  const Eigen::VectorXd sigma = Eigen::VectorXd::Constant(2, 1e-9);
  for (int r = 0; r < 2; ++r) {
    const int samples = 2000;
    Recording recording;
    recording.t = Eigen::VectorXd::LinSpaced(samples, 0.0, (samples - 1) * 0.005);
    recording.q.resize(samples, 2);
    recording.signal.resize(samples, 2);
    for (int i = 0; i < samples; ++i) {
      Eigen::VectorXd q = Eigen::VectorXd::Zero(2), dq = q, ddq = q, tau(2);
      for (int j = 0; j < 2; ++j) {
        for (int h = 1; h <= 3; ++h) {
          const double w = 2.0 * M_PI * (0.17 * h + 0.05 * j + 0.03 * r), a = 0.7 / h, phase = 0.4 * h + j;
          q[j] += a * std::sin(w * recording.t[i] + phase);
          dq[j] += a * w * std::cos(w * recording.t[i] + phase);
          ddq[j] -= a * w * w * std::sin(w * recording.t[i] + phase);
        }
        recording.q(i, j) = q[j] + 1e-6 * normal(generator);
      }
      model.Torque(q.data(), dq.data(), ddq.data(), sigma.data(), chi, InertialVector::Zero(), tau.data());
      for (int j = 0; j < 2; ++j) recording.signal(i, j) = tau[j] + noise * normal(generator);
    }
    result.recordings.push_back(std::move(recording));
  }
  return result;
}

}  // namespace idim::testing

#endif  // IDIM_TESTS_SUPPORT_PENDULUM_STUDY_H_
