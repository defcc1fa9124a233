#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <utility>

#include "core/base/random.h"
#include "core/simulation/trajectory.h"
#include "core/simulation/trajectory_limits.h"

namespace idim {
namespace {

// Value, first and second derivative of a scalar function of time.
using Jet = std::array<double, 3>;

Jet SmoothStep(double t, double blend) {
  const double u = std::clamp(t / blend, 0.0, 1.0);
  return {u * u * u * (10.0 + u * (-15.0 + 6.0 * u)), 30.0 * u * u * (1.0 + u * (-2.0 + u)) / blend,
          60.0 * u * (1.0 + u * (-3.0 + 2.0 * u)) / (blend * blend)};
}

Jet Product(const Jet& a, const Jet& b) {
  return {a[0] * b[0], a[1] * b[0] + a[0] * b[1], a[2] * b[0] + 2.0 * a[1] * b[1] + a[0] * b[2]};
}

class Fourier : public Trajectory {
 public:
  Fourier(const FourierOptions& options, Eigen::VectorXd centre, Eigen::MatrixXd sine, Eigen::MatrixXd cosine)
      : pulsation_(2.0 * M_PI * options.frequency),
        duration_(options.duration),
        blend_(options.blend),
        centre_(std::move(centre)),
        sine_(std::move(sine)),
        cosine_(std::move(cosine)) {}

  int dof() const override { return static_cast<int>(centre_.size()); }
  double duration() const override { return duration_; }

  JointState At(double t) const override {
    JointState state{centre_, Eigen::VectorXd(dof()), Eigen::VectorXd(dof())};
    for (int j = 0; j < dof(); ++j) {
      const Jet deviation = Deviation(j, t);
      state.q[j] += deviation[0];
      state.dq[j] = deviation[1];
      state.ddq[j] = deviation[2];
    }
    return state;
  }

  // Largest magnitude over the motion, on a grid of 256 points a period of the highest harmonic; what lies between
  // the grid points is higher by less than (2 pi / 256)^2 / 8 < 1e-4 of the sum of the amplitudes.
  Jet Peak(int j) const {
    const int harmonics = static_cast<int>(sine_.cols());
    const double period = 2.0 * M_PI / pulsation_;
    const double span = blend_ > 0.0 ? duration_ : std::min(duration_, period);
    const int points = static_cast<int>(std::ceil(256.0 * harmonics * span / period)) + 1;
    Jet peak = {0.0, 0.0, 0.0};
    for (int k = 0; k < points; ++k) {
      const Jet value = Deviation(j, span * k / (points - 1));
      for (int i = 0; i < 3; ++i) peak[i] = std::max(peak[i], std::abs(value[i]));
    }
    return peak;
  }

  void Scale(int j, double factor) {
    sine_.row(j) *= factor;
    cosine_.row(j) *= factor;
  }

 private:
  Jet Deviation(int j, double t) const {
    Jet series = {0.0, 0.0, 0.0};
    for (int l = 0; l < sine_.cols(); ++l) {
      const double w = (l + 1) * pulsation_;
      const double s = std::sin(w * t), c = std::cos(w * t);
      series[0] += (sine_(j, l) * s - cosine_(j, l) * c) / w;
      series[1] += sine_(j, l) * c + cosine_(j, l) * s;
      series[2] += (cosine_(j, l) * c - sine_(j, l) * s) * w;
    }
    if (blend_ == 0.0) return series;
    if (2.0 * t <= duration_) return Product(SmoothStep(t, blend_), series);
    Jet fall = SmoothStep(duration_ - t, blend_);
    fall[1] = -fall[1];
    return Product(fall, series);
  }

  double pulsation_, duration_, blend_;
  Eigen::VectorXd centre_;
  Eigen::MatrixXd sine_, cosine_;
};

// How far a deviation from the centre may go on both sides.
double Reach(const JointLimits& limits, const Eigen::VectorXd& centre, int j) {
  return std::min(limits.upper[j] - centre[j], centre[j] - limits.lower[j]);
}

Status CheckLimits(const Fourier& trajectory, const JointLimits& limits, const Eigen::VectorXd& centre) {
  for (int j = 0; j < trajectory.dof(); ++j) {
    const Jet peak = trajectory.Peak(j);
    const auto refuse = [j](const char* what, double value, double limit) {
      std::ostringstream message;
      message << "sine and cosine make joint " << j + 1 << " reach " << what << " " << value << ", its limit is "
              << limit;
      return Status::BadInput(message.str());
    };
    if (limits.lower.size() > 0 && peak[0] > Reach(limits, centre, j)) {
      return refuse("a deviation from the centre of", peak[0], Reach(limits, centre, j));
    }
    if (limits.velocity.size() > 0 && peak[1] > limits.velocity[j]) {
      return refuse("a velocity of", peak[1], limits.velocity[j]);
    }
    if (limits.acceleration.size() > 0 && peak[2] > limits.acceleration[j]) {
      return refuse("an acceleration of", peak[2], limits.acceleration[j]);
    }
  }
  return Status::Ok();
}

}  // namespace

bool FourierOptions::IsValid(int n, std::string* error) const {
  const bool drawn = sine.size() == 0 && cosine.size() == 0;
  const bool need_position = drawn || centre.size() == 0;
  if (!internal::LimitsAreValid(limits, n, need_position, /*need_velocity=*/drawn, error)) return false;
  std::ostringstream message;
  if (!(frequency > 0.0) || !std::isfinite(frequency)) {
    message << "frequency = " << frequency << ", must be positive";
  } else if (!(duration > 0.0) || !std::isfinite(duration)) {
    message << "duration = " << duration << ", must be positive";
  } else if (!(blend >= 0.0 && 2.0 * blend <= duration)) {
    message << "blend = " << blend << ", must be between 0 and half the duration";
  } else if (centre.size() != 0 && (centre.size() != n || !centre.allFinite())) {
    message << "centre has " << centre.size() << " numbers, must have " << n << ", one a joint";
  } else if (!drawn && (sine.rows() != n || cosine.rows() != n || sine.cols() != cosine.cols() || sine.cols() < 1)) {
    message << "sine is " << sine.rows() << " x " << sine.cols() << " and cosine " << cosine.rows() << " x "
            << cosine.cols() << ", both must have " << n << " rows, one a joint, and as many columns as harmonics";
  } else if (!drawn && !(sine.allFinite() && cosine.allFinite())) {
    message << "sine and cosine must be finite";
  } else if (drawn && (harmonics < 1 || harmonics > 1000)) {
    message << "harmonics = " << harmonics << ", must be between 1 and 1000";
  } else if (drawn && !(fill > 0.0 && fill < 1.0)) {
    message << "fill = " << fill << ", must be above 0 and below 1";
  } else if (frequency * duration * static_cast<double>(drawn ? harmonics : sine.cols()) > 1e5) {
    message << "frequency x duration x harmonics = " << frequency * duration * (drawn ? harmonics : sine.cols())
            << " periods, must be at most 100000";
  }
  for (int j = 0; j < n && message.str().empty() && limits.lower.size() > 0 && centre.size() > 0; ++j) {
    if (centre[j] > limits.lower[j] && centre[j] < limits.upper[j]) continue;
    message << "centre[" << j << "] = " << centre[j] << ", outside its limits [" << limits.lower[j] << ", "
            << limits.upper[j] << "]";
  }
  *error = message.str();
  return error->empty();
}

Result<std::unique_ptr<Trajectory>> MakeFourier(int n, const FourierOptions& options) {
  std::string error;
  if (!options.IsValid(n, &error)) return Status::BadInput(error);
  const JointLimits& limits = options.limits;
  const Eigen::VectorXd centre = options.centre.size() > 0 ? options.centre : 0.5 * (limits.lower + limits.upper);
  if (options.sine.size() > 0) {
    auto given = std::make_unique<Fourier>(options, centre, options.sine, options.cosine);
    IDIM_RETURN_IF_ERROR(CheckLimits(*given, limits, centre));
    return std::unique_ptr<Trajectory>(std::move(given));
  }
  Random random(options.seed);
  Eigen::MatrixXd sine(n, options.harmonics), cosine(n, options.harmonics);
  for (int j = 0; j < n; ++j) {
    for (int l = 0; l < options.harmonics; ++l) {
      sine(j, l) = random.Normal();
      cosine(j, l) = random.Normal();
    }
  }
  auto trajectory = std::make_unique<Fourier>(options, centre, sine, cosine);
  for (int j = 0; j < n; ++j) {
    const Jet peak = trajectory->Peak(j);
    trajectory->Scale(j, options.fill * std::min({Reach(limits, centre, j) / peak[0], limits.velocity[j] / peak[1],
                                                  limits.acceleration[j] / peak[2]}));
  }
  return std::unique_ptr<Trajectory>(std::move(trajectory));
}

}  // namespace idim
