// Another project: a robot, its recordings and a study built in code, identified and judged without any file. Exit code
// 0 if every parameter is within four standard deviations of the truth.

#include <Eigen/Core>
#include <cmath>
#include <iostream>
#include <vector>

#include "solvers/idim.h"

namespace {

constexpr double kInertia = 0.5, kMoment = 1.2, kViscous = 0.8;  // of one pendulum about a horizontal axis
constexpr double kGravity = 9.81;

idim::Recording Swing(double frequency) {
  constexpr int kSamples = 2000;
  idim::Recording recording;
  recording.t = Eigen::VectorXd::LinSpaced(kSamples, 0.0, (kSamples - 1) * 0.005);
  recording.q.resize(kSamples, 1);
  recording.signal.resize(kSamples, 1);
  for (int i = 0; i < kSamples; ++i) {
    double q = 0.0, dq = 0.0, ddq = 0.0;
    for (int h = 1; h <= 3; ++h) {
      const double w = 2.0 * M_PI * frequency * h, a = 0.9 / h, angle = w * recording.t[i] + 0.3 * h;
      q += a * std::sin(angle), dq += a * w * std::cos(angle), ddq -= a * w * w * std::sin(angle);
    }
    // Noise that any platform repeats: 1e-6 rad and 0.01 N m.
    const double noise = std::sin(12345.678 * i * i);
    recording.q(i, 0) = q + 1e-6 * noise;
    // z of the joint is -y of the base: gravity pulls along -y of frame 1 at q = 0.
    recording.signal(i, 0) =
        kInertia * ddq + kViscous * dq + kGravity * kMoment * std::cos(q) + 0.01 * std::cos(54321.0 * i * i);
  }
  return recording;
}

}  // namespace

int main() {
  idim::Study study;
  study.robot.name = "pendulum";
  study.robot.joints = {idim::JointFromModifiedDh(idim::JointType::kRevolute, M_PI / 2, 0.0, 0.0, 0.0)};
  study.friction = {true, false, false};
  study.recordings.resize(2);
  study.recordings[1].use = idim::Use::kValidation;
  study.preprocessing = {20.0, 5};
  const idim::Result<idim::PreparedStudy> prepared = idim::PrepareStudy(study, {Swing(0.2), Swing(0.27)});
  if (!prepared.ok()) {
    std::cerr << prepared.status().message() << "\n";
    return 1;
  }
  const idim::Result<idim::EstimatorRunner> runner = idim::EstimatorRunner::Create(&*prepared);
  const idim::Result<idim::Identification> found = runner->Run("wls", 0.0);
  if (!found.ok() || !found->estimate.status.ok()) return 2;
  const struct {
    const char* name;
    double value;
  } truth[] = {{"ZZ1R", kInertia}, {"MX1", kMoment}, {"MY1", 0.0}, {"Fv1", kViscous}};
  for (const auto& [name, value] : truth) {
    const idim::ParameterEstimate* p = found->estimate.Find(name);
    if (p == nullptr) {
      std::cerr << "no parameter " << name << "\n";
      return 3;
    }
    std::cout << name << " " << p->value << " +- " << p->standard_deviation << ", true " << value << "\n";
    if (std::abs(p->value - value) > 4.0 * p->standard_deviation) return 4;
  }
  const idim::Result<idim::Validation> validation = idim::Validate(*prepared, idim::ReferenceOf(found->estimate));
  if (!validation.ok() || validation->recordings.size() != 1) return 5;
  const double error = validation->recordings[0].fit->relative_error_percent_all;
  std::cout << "error on the other swing: " << error << " %\n";
  return error < 2.0 ? 0 : 6;
}
