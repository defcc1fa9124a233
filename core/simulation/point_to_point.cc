#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <sstream>
#include <utility>

#include "core/base/random.h"
#include "core/simulation/trajectory.h"
#include "core/simulation/trajectory_limits.h"

namespace idim {
namespace {

// One piece of constant jerk of the path coordinate s.
struct Piece {
  double start;  // [s] on the trajectory's clock
  double s, ds, dds, jerk;
  int motion;
};

// Durations of the law from rest to rest over a distance 1: flank of the acceleration, whole acceleration phase,
// phase of constant velocity.
struct Law {
  double flank, acceleration, cruise, jerk;
};

Law FastestLaw(double velocity, double acceleration, double jerk) {
  Law law;
  law.jerk = jerk;
  if (velocity * jerk < acceleration * acceleration) {  // the acceleration limit is not reached
    law.flank = std::sqrt(velocity / jerk);
    law.acceleration = 2.0 * law.flank;
  } else {
    law.flank = acceleration / jerk;
    law.acceleration = law.flank + velocity / acceleration;
  }
  law.cruise = 1.0 / velocity - law.acceleration;
  if (law.cruise >= 0.0) return law;
  law.cruise = 0.0;  // the velocity limit is not reached
  law.flank = acceleration / jerk;
  law.acceleration = 0.5 * law.flank + std::sqrt(0.25 * law.flank * law.flank + 1.0 / acceleration);
  if (law.acceleration < 2.0 * law.flank) {  // nor is that of the acceleration
    law.flank = std::cbrt(0.5 / jerk);
    law.acceleration = 2.0 * law.flank;
  }
  return law;
}

class PointToPoint : public Trajectory {
 public:
  explicit PointToPoint(const Eigen::VectorXd& start) : points_{start} {}

  void Dwell(double seconds) { duration_ += seconds; }

  void MoveTo(const Eigen::VectorXd& target, const JointLimits& limits, double speed) {
    const Eigen::ArrayXd distance = (target - points_.back()).array().abs();
    double velocity = std::numeric_limits<double>::infinity();
    double acceleration = velocity, jerk = velocity;
    for (int j = 0; j < distance.size(); ++j) {
      if (distance[j] == 0.0) continue;
      velocity = std::min(velocity, speed * limits.velocity[j] / distance[j]);
      acceleration = std::min(acceleration, limits.acceleration[j] / distance[j]);
      jerk = std::min(jerk, limits.jerk[j] / distance[j]);
    }
    if (!std::isfinite(velocity)) return;  // the arm is there already
    const Law law = FastestLaw(velocity, acceleration, jerk);
    const double plateau = law.acceleration - 2.0 * law.flank;
    const std::array<std::pair<double, double>, 7> phases = {{{law.flank, law.jerk},
                                                              {plateau, 0.0},
                                                              {law.flank, -law.jerk},
                                                              {law.cruise, 0.0},
                                                              {law.flank, -law.jerk},
                                                              {plateau, 0.0},
                                                              {law.flank, law.jerk}}};
    Piece piece{duration_, 0.0, 0.0, 0.0, 0.0, static_cast<int>(points_.size()) - 1};
    for (const auto& [seconds, phase_jerk] : phases) {
      piece.jerk = phase_jerk;
      pieces_.push_back(piece);
      const Piece next = After(piece, seconds);
      piece.start += seconds;
      piece.s = next.s;
      piece.ds = next.ds;
      piece.dds = next.dds;
    }
    duration_ = piece.start;
    points_.push_back(target);
    // At rest until the next motion, free of the rounding that the phases have gathered.
    pieces_.push_back({duration_, 1.0, 0.0, 0.0, 0.0, piece.motion});
  }

  int dof() const override { return static_cast<int>(points_.front().size()); }
  double duration() const override { return duration_; }

  JointState At(double t) const override {
    const auto after =
        std::upper_bound(pieces_.begin(), pieces_.end(), t, [](double time, const Piece& p) { return time < p.start; });
    if (after == pieces_.begin()) {
      const Eigen::VectorXd zero = Eigen::VectorXd::Zero(dof());
      return {points_.front(), zero, zero};
    }
    const Piece& piece = *std::prev(after);
    const Piece now = After(piece, t - piece.start);
    const Eigen::VectorXd& from = points_[piece.motion];
    const Eigen::VectorXd way = points_[piece.motion + 1] - from;
    return {from + now.s * way, now.ds * way, now.dds * way};
  }

 private:
  static Piece After(const Piece& p, double u) {
    Piece next = p;
    next.s = p.s + u * (p.ds + u * (p.dds / 2.0 + u * p.jerk / 6.0));
    next.ds = p.ds + u * (p.dds + u * p.jerk / 2.0);
    next.dds = p.dds + u * p.jerk;
    return next;
  }

  std::vector<Eigen::VectorXd> points_;
  std::vector<Piece> pieces_;
  double duration_ = 0.0;
};

}  // namespace

bool PointToPointOptions::IsValid(int n, std::string* error) const {
  if (!internal::LimitsAreValid(limits, n, /*need_position=*/random > 0, /*need_velocity=*/true, error)) return false;
  if (!internal::IsPositive("limits.jerk", limits.jerk, n, error)) return false;
  std::ostringstream message;
  if (random < 0) {
    message << "random = " << random << ", must be at least 0";
  } else if (static_cast<int>(via.size()) + random < 2) {
    message << "via and random give " << via.size() + random << " configurations, at least 2 are needed";
  } else if (!(dwell >= 0.0) || !std::isfinite(dwell)) {
    message << "dwell = " << dwell << ", must be at least 0";
  } else if (!(speed_min > 0.0 && speed_min <= speed_max && speed_max <= 1.0)) {
    message << "speed = [" << speed_min << ", " << speed_max << "], must be 0 < minimum <= maximum <= 1";
  }
  for (size_t k = 0; k < via.size() && message.str().empty(); ++k) {
    if (via[k].size() != n || !via[k].allFinite()) {
      message << "via[" << k << "] has " << via[k].size() << " numbers, must have " << n << ", all finite";
      break;
    }
    for (int j = 0; j < n && limits.lower.size() == n; ++j) {
      if (via[k][j] >= limits.lower[j] && via[k][j] <= limits.upper[j]) continue;
      message << "via[" << k << "] puts joint " << j + 1 << " at " << via[k][j] << ", outside its limits ["
              << limits.lower[j] << ", " << limits.upper[j] << "]";
      break;
    }
  }
  *error = message.str();
  return error->empty();
}

Result<std::unique_ptr<Trajectory>> MakePointToPoint(int n, const PointToPointOptions& options) {
  std::string error;
  if (!options.IsValid(n, &error)) return Status::BadInput(error);
  Random random(options.seed);
  std::vector<Eigen::VectorXd> points = options.via;
  for (int k = 0; k < options.random; ++k) {
    Eigen::VectorXd point(n);
    for (int j = 0; j < n; ++j) point[j] = random.Uniform(options.limits.lower[j], options.limits.upper[j]);
    points.push_back(point);
  }
  auto trajectory = std::make_unique<PointToPoint>(points.front());
  trajectory->Dwell(options.dwell);
  for (size_t k = 1; k < points.size(); ++k) {
    trajectory->MoveTo(points[k], options.limits, random.Uniform(options.speed_min, options.speed_max));
    trajectory->Dwell(options.dwell);
  }
  return std::unique_ptr<Trajectory>(std::move(trajectory));
}

}  // namespace idim
