#include "core/simulation/simulate.h"

#include <glog/logging.h>

#include <Eigen/LU>
#include <cmath>
#include <sstream>
#include <utility>

#include "core/base/decompositions.h"
#include "core/base/random.h"

namespace idim {
namespace {

enum Stream : std::uint32_t { kJitter = 1, kPosition, kSignal };

Eigen::VectorXd OrZero(const Eigen::VectorXd& values, Eigen::Index n) {
  return values.size() > 0 ? values : Eigen::VectorXd(Eigen::VectorXd::Zero(n));
}

void AddWhite(Eigen::MatrixXd* samples, const Eigen::VectorXd& sigma, Random* random) {
  for (Eigen::Index k = 0; k < samples->rows(); ++k) {
    for (Eigen::Index j = 0; j < samples->cols(); ++j) (*samples)(k, j) += sigma[j] * random->Normal();
  }
}

void Quantise(Eigen::MatrixXd* samples, const Eigen::VectorXd& step) {
  for (Eigen::Index j = 0; j < samples->cols(); ++j) {
    if (step[j] == 0.0) continue;
    samples->col(j) = step[j] * (samples->col(j) / step[j]).array().round();
  }
}

Eigen::VectorXd SampleInstants(double duration, const TruthOptions& options) {
  Random random(options.seed, kJitter);
  const int samples = static_cast<int>(std::floor(duration * options.rate + 1e-9)) + 1;
  Eigen::VectorXd t(samples);
  for (int k = 0; k < samples; ++k) {
    t[k] = k / options.rate;
    if (k > 0 && options.clock_jitter > 0.0) t[k] += random.Uniform(-options.clock_jitter, options.clock_jitter);
    t[k] = std::round(t[k] / kClockTick) / std::round(1.0 / kClockTick);
  }
  return t;
}

}  // namespace

bool TruthOptions::IsValid(std::string* error) const {
  std::ostringstream message;
  if (!(rate > 0.0 && rate <= 1e5)) {
    message << "rate = " << rate << ", must be positive and at most 100000";
  } else if (!(duration >= 0.0) || !std::isfinite(duration)) {
    message << "duration = " << duration << ", must be at least 0";
  } else if (!(clock_jitter >= 0.0 && clock_jitter < 0.49 / rate)) {
    message << "clock_jitter = " << clock_jitter << ", must be at least 0 and below 0.49 / rate = " << 0.49 / rate;
  }
  *error = message.str();
  return error->empty();
}

Truth SimulateTruth(StandardModel* model, const Eigen::VectorXd& chi, const InertialVector& payload,
                    const Eigen::VectorXd& gains, const Trajectory& trajectory, const TruthOptions& options) {
  const int n = model->dof();
  std::string error;
  CHECK(options.IsValid(&error)) << error;
  CHECK_EQ(chi.size(), model->columns());
  CHECK_EQ(gains.size(), n);
  CHECK_EQ(trajectory.dof(), n);
  CHECK((gains.array() != 0.0).all());

  Truth truth;
  truth.t = SampleInstants(options.duration > 0.0 ? options.duration : trajectory.duration(), options);
  const Eigen::Index samples = truth.t.size();
  for (Eigen::MatrixXd* m : {&truth.q, &truth.dq, &truth.ddq, &truth.torque}) m->resize(samples, n);
  Eigen::VectorXd tau(n);
  for (Eigen::Index k = 0; k < samples; ++k) {
    const JointState state = trajectory.At(truth.t[k]);
    model->Torque(state.q.data(), state.dq.data(), state.ddq.data(), nullptr, chi, payload, tau.data());
    truth.q.row(k) = state.q;
    truth.dq.row(k) = state.dq;
    truth.ddq.row(k) = state.ddq;
    truth.torque.row(k) = tau;
  }
  truth.signal = truth.torque;
  // In rows, T^-T tau is tau' T^-1.
  if (options.signal_side == Side::kMotor) truth.signal *= model->robot().transmission.inverse();
  truth.signal *= gains.cwiseInverse().asDiagonal();
  return truth;
}

bool NoiseOptions::IsValid(int n, std::string* error) const {
  std::ostringstream message;
  const std::pair<const char*, const Eigen::VectorXd*> fields[] = {
      {"position", &position}, {"position_step", &position_step},   {"encoder_counts", &encoder_counts},
      {"signal", &signal},     {"signal_percent", &signal_percent}, {"signal_step", &signal_step}};
  for (const auto& [name, values] : fields) {
    if (values->size() == 0) continue;
    if (values->size() != n) {
      message << name << " has " << values->size() << " numbers, must have " << n << ", one a joint";
      break;
    }
    for (int j = 0; j < n && message.str().empty(); ++j) {
      const double value = (*values)[j];
      const bool count = values == &encoder_counts;
      if (value >= (count ? 1.0 : 0.0) && std::isfinite(value)) continue;
      message << name << "[" << j << "] = " << value << ", must be at least " << (count ? 1 : 0);
    }
    if (!message.str().empty()) break;
  }
  if (message.str().empty() && position_step.size() > 0 && encoder_counts.size() > 0) {
    message << "position_step and encoder_counts are both given, only one of them can be";
  }
  *error = message.str();
  return error->empty();
}

Eigen::VectorXd AddedSignalNoise(const Truth& truth, const NoiseOptions& options) {
  const Eigen::Index n = truth.signal.cols();
  const Eigen::VectorXd rms = (truth.signal.colwise().squaredNorm() / truth.signal.rows()).cwiseSqrt().transpose();
  const Eigen::VectorXd relative = 0.01 * OrZero(options.signal_percent, n).cwiseProduct(rms);
  return (OrZero(options.signal, n).cwiseAbs2() + relative.cwiseAbs2()).cwiseSqrt();
}

Recording AddNoise(const Truth& truth, const Robot& robot, const NoiseOptions& options, std::uint64_t seed) {
  const Eigen::Index n = truth.q.cols();
  std::string error;
  CHECK(options.IsValid(static_cast<int>(n), &error)) << error;
  Recording recording;
  recording.t = truth.t;
  recording.q = truth.q;
  recording.signal = truth.signal;
  Random position(seed, kPosition), signal(seed, kSignal);
  AddWhite(&recording.q, OrZero(options.position, n), &position);
  if (options.encoder_counts.size() > 0) {
    Eigen::MatrixXd motor = recording.q * robot.transmission.transpose();
    Quantise(&motor, 2.0 * M_PI * options.encoder_counts.cwiseInverse());
    recording.q = motor * robot.transmission.inverse().transpose();
  } else {
    Quantise(&recording.q, OrZero(options.position_step, n));
  }
  AddWhite(&recording.signal, AddedSignalNoise(truth, options), &signal);
  Quantise(&recording.signal, OrZero(options.signal_step, n));
  return recording;
}

}  // namespace idim
