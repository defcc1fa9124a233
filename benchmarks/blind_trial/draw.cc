#include "benchmarks/blind_trial/draw.h"

#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "core/effects/effect.h"
#include "core/robot/inertia.h"

namespace idim::blind_trial {
namespace {

using Eigen::VectorXd;

InertialVector RandomBody(double mass, double size, Random* random) {
  Eigen::Matrix4d pseudo = Eigen::Matrix4d::Zero();
  for (int k = 0; k < 6; ++k) {
    Eigen::Vector4d point(0.0, 0.0, 0.0, 1.0);
    for (int a = 0; a < 3; ++a) point[a] = random->Uniform(-size, size) + (a == 0 ? 0.5 * size : 0.0);
    pseudo += mass / 6.0 * point * point.transpose();
  }
  return InertialFromPseudoInertia(pseudo);
}

}  // namespace

Scenario DrawArm(const ArmOptions& options, Random* random) {
  Scenario s;
  const int n = options.joints;
  s.path = "blind.yaml";
  s.robot.name = "blind";
  s.robot.gravity = Eigen::Vector3d(0.0, 0.0, -9.81);
  for (int j = 0; j < n; ++j) {
    const double twist = j == 0 ? random->Uniform(0.1, 0.5) : random->Sign() * random->Uniform(0.4, M_PI_2);
    s.robot.joints.push_back(JointFromModifiedDh(JointType::kRevolute, twist, j == 0 ? 0.0 : random->Uniform(0.1, 0.4),
                                                 0.0, random->Uniform(-0.2, 0.2)));
  }
  const StandardModel model(s.robot, FrictionModel());
  s.chi.setZero(model.columns());
  const auto set = [&](const std::string& name, int j, double value) {
    s.chi[model.Find(name + std::to_string(j + 1))] = value;
  };
  for (int j = 0; j < n; ++j) {
    const double scale = std::pow(0.6, j);
    const InertialVector body = RandomBody(random->Uniform(3.0, 8.0) * scale, 0.2 * std::sqrt(scale), random);
    for (int k = 0; k < kNumInertial; ++k) set(kStandardNames[k], j, body[k]);
    set("Ia", j, random->Uniform(0.05, 0.4) * scale);
    set("Fv", j, random->Uniform(1.0, 5.0) * scale);
    set("Fs", j, random->Uniform(1.0, 5.0) * scale);
    set("off", j, random->Uniform(-0.5, 0.5) * scale);
  }
  s.gains = VectorXd::NullaryExpr(n, [&] { return random->Sign() * random->Uniform(5.0, 40.0); });
  s.truth.rate = options.rate;
  s.noise.position = VectorXd::Constant(n, options.position_noise);
  s.noise.signal_percent = VectorXd::Constant(n, options.signal_noise);
  JointLimits limits;
  limits.lower = VectorXd::Constant(n, -2.0);
  limits.upper = VectorXd::Constant(n, 2.0);
  limits.velocity = VectorXd::Constant(n, 3.0);
  limits.acceleration = VectorXd::Constant(n, 15.0);
  limits.jerk = VectorXd::Constant(n, 300.0);
  ScenarioRecording points, series;
  points.name = "points";
  series.name = "series";
  points.duration = series.duration = options.duration;
  points.seed = 1 + static_cast<std::uint64_t>(1e9 * random->Uniform());
  series.seed = points.seed + 1;
  PointToPointOptions by_points;
  by_points.limits = limits;
  by_points.random = 60;
  by_points.seed = points.seed;
  by_points.dwell = random->Uniform(0.0, 0.3);
  by_points.speed_min = 0.2;
  FourierOptions by_series;
  by_series.limits = limits;
  by_series.frequency = 0.1;
  by_series.harmonics = 8;
  by_series.duration = options.duration;
  by_series.blend = 1.0;
  by_series.seed = series.seed;
  points.trajectory = std::move(MakePointToPoint(n, by_points)).value();
  series.trajectory = std::move(MakeFourier(n, by_series)).value();
  s.recordings = {points, series};
  if (random->Uniform() < options.identified) {
    ScenarioPayload payload;
    payload.name = "weight";
    payload.inertial = RandomBody(random->Uniform(3.0, 6.0), 0.12, random);
    payload.known = {kM};
    s.payloads.push_back(payload);
    s.recordings[1].payload = 0;
    s.gains_mode = GainsMode::kIdentify;
  }
  return s;
}

SimulatedEffect DrawEffect(const EffectEquation& equation, const Scenario& scenario, Random* random) {
  const int n = scenario.robot.dof(), joint = random->Below(n);
  SimulatedEffect effect{&equation, {joint}, {}, ""};
  if (equation.joints() == EffectJoints::kNone) effect.joints.clear();
  if (equation.joints() == EffectJoints::kTwo) {
    int other = random->Below(n - 1);
    other += other >= joint;
    effect.joints = {std::min(joint, other), std::max(joint, other)};
  }
  effect.values = equation.DrawValues(DurationOf(scenario.recordings[0]), random);
  const Effect* const columns = FindEffect(equation.id());
  CHECK(columns != nullptr) << equation.id();
  if (columns->shapes_count_recordings()) {
    effect.recording = scenario.recordings[static_cast<size_t>(random->Below(2))].name;
  }
  return effect;
}

}  // namespace idim::blind_trial
