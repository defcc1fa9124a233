// Blind trial of the closed loop: simulated arms, each with no effect, one or two that the study does not declare, of
// random id, joint and size; does CloseLoop find them?
//
//   blind_trial --cases 220 --seed 4 --threads 2
//
// An arm: random bodies, twists and friction, two recordings (point to point and a Fourier series), white noise on
// signal and position. The effect is simulated by its own route (core/simulation/effects.h) and scaled to a share of
// its joint's signal, drawn evenly in its logarithm from --smallest to --largest. Some cases have unknown gains and a
// payload of known mass in the second recording. Every case has its own stream of random numbers: the result depends on
// --seed and on the case's number alone.
//
// Held-out errors are those of folds of contiguous blocks. `truth`: the model that is told ids, joints and shapes of
// the simulated effects (Refit with the columns that identification has for them). `worth`: by how much the effect
// lowers the held-out error of that model, of the joints where it acts [%]. Found: the id at the joint is in the final
// model. A false alarm: an effect in the final model that was not simulated.
//
// Seeds: 1 is that of development, cases of 2 and 3 were looked into as well; figures are reported for 4.

#include <gflags/gflags.h>
#include <glog/logging.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <map>
#include <mutex>
#include <random>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "apps/program.h"
#include "core/base/text.h"
#include "core/model/active_effects.h"
#include "core/robot/inertia.h"
#include "core/simulation/effects_truth.h"
#include "core/simulation/scenario.h"
#include "core/simulation/simulate_scenario.h"
#include "solvers/bundle/residual_model.h"
#include "solvers/loop/close_loop.h"
#include "solvers/loop/effect_fit.h"

DEFINE_int32(cases, 200, "number of simulated arms");
DEFINE_int32(first, 0, "number of the first one: a single case again with --first K --cases 1");
DEFINE_int32(seed, 1, "1 is for development, 4 for figures to report");
DEFINE_int32(threads, 2, "cases at a time");
DEFINE_int32(joints, 3, "of each arm");
DEFINE_double(duration, 12.0, "[s] of each of the two recordings");
DEFINE_double(rate, 250.0, "[Hz]");
DEFINE_int32(decimation, 5, "samples kept: one in so many");
DEFINE_double(smallest, 0.01, "smallest effect: share of its joint's signal");
DEFINE_double(largest, 0.3, "largest effect");
DEFINE_double(signal_noise, 2.0, "[%] of a joint's signal, each recorded sample");
DEFINE_double(position_noise, 2e-5, "[rad]");
DEFINE_double(none, 0.25, "share of cases without effect");
DEFINE_double(two, 0.15, "share of cases with two effects");
DEFINE_double(identified, 0.15, "share of cases with gains to be identified");
DEFINE_bool(verbose, false, "what the loop is about, to standard error");
DEFINE_string(only, "", "ids to draw from, with commas between them; empty: all");

namespace idim {
namespace {

using Eigen::VectorXd;

class Random {
 public:
  Random(int seed, int number) {
    std::seed_seq sequence{seed, number};
    generator_.seed(sequence);
  }
  double Uniform(double low, double high) { return low + (high - low) * Unit(); }
  double LogUniform(double low, double high) { return low * std::pow(high / low, Unit()); }
  double Sign() { return Unit() < 0.5 ? -1.0 : 1.0; }
  int Below(int count) { return std::min(count - 1, static_cast<int>(count * Unit())); }
  double Unit() { return static_cast<double>(generator_() >> 11) * 0x1p-53; }

 private:
  std::mt19937_64 generator_;
};

InertialVector RandomBody(double mass, double size, Random* random) {
  Eigen::Matrix4d pseudo = Eigen::Matrix4d::Zero();
  for (int k = 0; k < 6; ++k) {
    Eigen::Vector4d point(0.0, 0.0, 0.0, 1.0);
    for (int a = 0; a < 3; ++a) point[a] = random->Uniform(-size, size) + (a == 0 ? 0.5 * size : 0.0);
    pseudo += mass / 6.0 * point * point.transpose();
  }
  return InertialFromPseudoInertia(pseudo);
}

Scenario DrawArm(Random* random) {
  Scenario s;
  const int n = FLAGS_joints;
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
  s.truth.rate = FLAGS_rate;
  s.noise.position = VectorXd::Constant(n, FLAGS_position_noise);
  s.noise.signal_percent = VectorXd::Constant(n, FLAGS_signal_noise);
  JointLimits limits;
  limits.lower = VectorXd::Constant(n, -2.0);
  limits.upper = VectorXd::Constant(n, 2.0);
  limits.velocity = VectorXd::Constant(n, 3.0);
  limits.acceleration = VectorXd::Constant(n, 15.0);
  limits.jerk = VectorXd::Constant(n, 300.0);
  ScenarioRecording points, series;
  points.name = "points";
  series.name = "series";
  points.duration = series.duration = FLAGS_duration;
  points.seed = 1 + static_cast<std::uint64_t>(1e9 * random->Unit());
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
  by_series.duration = FLAGS_duration;
  by_series.blend = 1.0;
  by_series.seed = series.seed;
  points.trajectory = std::move(MakePointToPoint(n, by_points)).value();
  series.trajectory = std::move(MakeFourier(n, by_series)).value();
  s.recordings = {points, series};
  if (random->Unit() < FLAGS_identified) {
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

SimulatedEffect DrawEffect(const std::string& id, const Scenario& scenario, Random* random) {
  const int n = scenario.robot.dof(), joint = random->Below(n);
  SimulatedEffect effect{id, {joint}, {}, ""};
  auto& v = effect.values;
  if (id == "stribeck") {
    v = {{"Fst", 1.0}, {"vs", random->LogUniform(0.05, 0.5)}};
  } else if (id == "power_viscous") {
    v = {{"coefficient", 1.0},
         {"exponent", random->Unit() < 0.7 ? random->Uniform(0.3, 0.7) : random->Uniform(1.6, 2.4)}};
  } else if (id == "asymmetric_friction") {
    v = {{"viscous_difference", random->Sign() * random->Uniform(0.2, 1.0)},
         {"coulomb_difference", random->Sign() * random->Uniform(0.2, 1.0)}};
  } else if (id == "load_friction") {
    v = {{"mu", 0.05}};
  } else if (id == "presliding") {
    v = {{"displacement", random->LogUniform(1e-3, 0.1)}};
  } else if (id == "thermal_drift") {
    v = {{"viscous_share", -random->Uniform(0.1, 0.5)},
         {"coulomb_share", -random->Uniform(0.05, 0.3)},
         {"time_constant", FLAGS_duration * random->LogUniform(0.15, 1.0)}};
  } else if (id == "torque_ripple") {
    v = {{"amplitude", 1.0}, {"phase", random->Uniform(-M_PI, M_PI)}, {"order", random->LogUniform(5.0, 25.0)}};
  } else if (id == "joint_spring") {
    v = {{"stiffness", 2.0}, {"rest", random->Uniform(-1.0, 1.0)}};
  } else if (id == "motor_coupling") {
    int other = random->Below(n - 1);
    other += other >= joint;
    effect.joints = {std::min(joint, other), std::max(joint, other)};
    v = {{"inertia", random->Uniform(0.02, 0.1)},
         {"viscous", random->Uniform(0.1, 0.5)},
         {"coulomb", random->Uniform(0.1, 0.5)}};
  } else if (id == "base_tilt") {
    effect.joints.clear();
    v = {{"angle_1", random->Uniform(-0.05, 0.05)}, {"angle_2", random->Uniform(-0.05, 0.05)}};
  } else if (id == "payload_change") {
    effect.joints.clear();
    v = {{"M", 0.5},
         {"x", random->Uniform(-0.1, 0.1)},
         {"y", random->Uniform(-0.1, 0.1)},
         {"z", random->Uniform(0.0, 0.2)},
         {"from", FLAGS_duration * (random->Unit() < 0.5 ? 0.0 : random->Uniform(0.2, 0.8))}};
    effect.recording = scenario.recordings[static_cast<size_t>(random->Below(2))].name;
  } else if (id == "time_delay") {
    v = {{"delay", 0.003}};
  } else if (id == "gain_saturation") {
    v = {{"loss", 0.1}, {"signal", 2.0}};
  } else if (id == "joint_elasticity") {
    v = {{"stiffness", 3000.0}};
  } else {
    CHECK_EQ(id, "backlash");
    v = {{"gap", 0.003}};
  }
  return effect;
}

// As identification has it, at the true shape.
ActiveEffect ToldOf(const SimulatedEffect& effect, const PreparedStudy& prepared,
                    const std::vector<EffectMotion>& motions) {
  ActiveEffect told{FindEffect(effect.id), effect.joints, {}};
  const std::vector<ShapeParameter> shapes = told.effect->Shapes(motions, told.joints);
  told.shape.resize(static_cast<Eigen::Index>(shapes.size()));
  const std::map<std::string, std::pair<std::string, double>> keys = {{"stribeck", {"vs", 1.0}},
                                                                      {"power_viscous", {"exponent", 1.0}},
                                                                      {"presliding", {"displacement", 1.0}},
                                                                      {"thermal_drift", {"time_constant", 1.0}},
                                                                      {"torque_ripple", {"order", 1.0}},
                                                                      {"backlash", {"gap", 0.5}}};
  if (effect.id == "payload_change") {
    const int r = prepared.data->recordings[0].entry.name == effect.recording ? 0 : 1;
    told.shape[0] = r + effect.Value("from") / FLAGS_duration;
  } else if (!shapes.empty()) {
    const auto& [key, factor] = keys.at(effect.id);
    told.shape[0] = factor * effect.Value(key);
  }
  for (size_t k = 0; k < shapes.size(); ++k) {
    double& value = told.shape[static_cast<Eigen::Index>(k)];
    value = std::clamp(value, shapes[k].lower, shapes[k].upper);
  }
  return told;
}

struct HeldOut {
  Eigen::MatrixXd residual, torque;
  double Percent() const { return 100.0 * residual.norm() / torque.norm(); }
  // Of the joints named; all: none.
  double Percent(const std::vector<int>& joints) const {
    if (joints.empty()) return Percent();
    double sum = 0.0, of = 0.0;
    for (const int j : joints) {
      sum += residual.col(j).squaredNorm();
      of += torque.col(j).squaredNorm();
    }
    return 100.0 * std::sqrt(sum / of);
  }
};

HeldOut HeldOutOf(const EffectFit& fit) {
  const ResidualModel model(fit.prepared.base(), fit.data, fit.summary);
  return {model.CrossValidate(Eigen::MatrixXd(model.residual().size(), 0)).residual, model.torque()};
}

struct Planted {
  SimulatedEffect effect;
  double share = 0.0;  // asked for
  double worth = 0.0;  // [%]
  bool found = false, id = false, joint = false;
};

struct Case {
  std::string problem;
  bool identify = false;
  std::vector<Planted> planted;
  std::vector<std::string> found, false_alarms, dropped;
  double before = 0.0, after = 0.0, truth = 0.0, seconds = 0.0;
  std::vector<std::string> unexplained;
};

std::string Title(const SimulatedEffect& effect) { return EffectTitle({FindEffect(effect.id), effect.joints, {}}); }

std::vector<std::string> Ids() {
  std::vector<std::string> ids;
  for (const SimulatedEffectKind& kind : SimulatedEffectKinds()) {
    if (FLAGS_only.empty() || ("," + FLAGS_only + ",").find("," + kind.id + ",") != std::string::npos) {
      ids.push_back(kind.id);
    }
  }
  CHECK(!ids.empty()) << "--only names no effect";
  return ids;
}

Result<PreparedStudy> Log(const Scenario& scenario) {
  Study study = StudyOf(scenario);
  study.preprocessing.cutoff_hz = 0.4 * FLAGS_rate / FLAGS_decimation;
  study.preprocessing.decimation = FLAGS_decimation;
  std::vector<Recording> logs;
  for (const ScenarioRecording& recording : scenario.recordings) {
    logs.push_back(SimulateLog(scenario, recording, SimulateTruth(scenario, recording)));
  }
  Result<PreparedStudy> prepared = PrepareStudy(study, std::move(logs));
  // As the loop does it, so that the model that knows the truth is fitted to the same velocities.
  if (prepared.ok()) prepared->data = WithVelocityZeroAtRest(*prepared->data);
  return prepared;
}

Case Run(int number) {
  Case result;
  Random random(FLAGS_seed, number);
  Scenario scenario = DrawArm(&random);
  result.identify = scenario.gains_mode == GainsMode::kIdentify;
  const double draw = random.Unit();
  const int effects = draw < FLAGS_none ? 0 : draw < FLAGS_none + FLAGS_two ? 2 : 1;
  const std::vector<std::string> ids = Ids();
  while (static_cast<int>(result.planted.size()) < effects) {
    // By turns, so that each id has its share of the cases.
    const size_t turn = static_cast<size_t>(number) + result.planted.size() * static_cast<size_t>(1 + random.Below(14));
    const SimulatedEffect effect = DrawEffect(ids[turn % ids.size()], scenario, &random);
    const double share = random.LogUniform(FLAGS_smallest, FLAGS_largest);
    scenario.effects.push_back(effect);
    const size_t last = scenario.effects.size() - 1;
    double size = share;
    Status scaled = Status::Ok();
    if (effect.id == "presliding") {
      // A joint at rest holds its torque however small the displacement: the share has no power law to follow.
      size = EffectShare(scenario, last);
    } else {
      scaled = ScaleEffect(&scenario, last, size);
      // Some effects have a largest size.
      for (int k = 0; !scaled.ok() && k < 4; ++k) scaled = ScaleEffect(&scenario, last, size *= 0.6);
    }
    if (!scaled.ok()) {
      result.problem = scaled.message();
      scenario.effects.pop_back();
      return result;
    }
    result.planted.push_back({scenario.effects[last], size});
  }

  const auto start = std::chrono::steady_clock::now();
  const Result<PreparedStudy> prepared = Log(scenario);
  if (!prepared.ok()) {
    result.problem = prepared.status().message();
    return result;
  }
  LoopOptions options;
  if (FLAGS_verbose) options.progress = [](const std::string& text) { std::fprintf(stderr, "%s\n", text.c_str()); };
  const Result<LoopResult> loop = CloseLoop(*prepared, options);
  if (!loop.ok() || !loop->status.ok()) {
    result.problem = loop.ok() ? loop->status.message() : loop.status().message();
    if (!loop.ok() || loop->prepared.model.effects.empty()) return result;
  }
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  result.before = loop->declared.validation;
  result.after = loop->final.validation;
  result.dropped = loop->dropped;
  for (const Unexplained& u : loop->unexplained) {
    result.unexplained.push_back(
        Format("joint %d by %s (%.1f %%)", u.joint + 1, Join(u.depends_on, " and ").c_str(), u.share_percent));
  }
  for (const ActiveEffect& active : loop->prepared.model.effects) {
    const std::string title = EffectTitle(active);
    bool planted = false;
    for (Planted& p : result.planted) {
      const bool id = p.effect.id == active.effect->id(), joint = p.effect.joints == active.joints;
      p.id |= id;
      p.joint |= joint;
      p.found |= id && joint;
      planted |= id && joint;
    }
    result.found.push_back(title);
    if (!planted) result.false_alarms.push_back(title);
  }

  const Result<EffectFit> declared = FitDeclared(*prepared);
  CHECK(declared.ok());
  const std::vector<EffectMotion> motions = MotionsOf(declared->prepared, declared->Arm());
  std::vector<ActiveEffect> told;
  for (const Planted& p : result.planted) told.push_back(ToldOf(p.effect, *prepared, motions));
  const Result<EffectFit> truth = told.empty() ? declared : Refit(*declared, told);
  if (!truth.ok()) {
    result.problem = "truth: " + truth.status().message();
    return result;
  }
  const HeldOut with = HeldOutOf(*truth);
  result.truth = with.Percent();
  for (size_t k = 0; k < told.size(); ++k) {
    std::vector<ActiveEffect> others = told;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(k));
    const Result<EffectFit> without = others.empty() ? declared : Refit(*declared, others);
    if (!without.ok()) continue;
    const std::vector<int>& joints = told[k].joints;
    result.planted[k].worth = 100.0 * (1.0 - with.Percent(joints) / HeldOutOf(*without).Percent(joints));
  }
  return result;
}

std::string List(const std::vector<std::string>& names) { return names.empty() ? "-" : Join(names, ", "); }

void Print(int number, const Case& c) {
  std::string planted;
  for (const Planted& p : c.planted) {
    planted += (planted.empty() ? "" : ", ") + Title(p.effect) +
               Format(" (share %.3f, worth %.1f %%%s)", p.share, p.worth, p.found ? "" : ", MISSED");
  }
  std::printf("%4d %s %s\n       found %s; held out %.3f -> %.3f, truth %.3f %%; unexplained: %s; %.1f s\n", number,
              c.identify ? "g" : " ", planted.empty() ? "none" : planted.c_str(), List(c.found).c_str(), c.before,
              c.after, c.truth, List(c.unexplained).c_str(), c.seconds);
  for (const std::string& name : c.false_alarms) std::printf("       FALSE ALARM %s\n", name.c_str());
  for (const std::string& text : c.dropped) std::printf("       dropped: %s\n", text.c_str());
  if (!c.problem.empty()) std::printf("       PROBLEM %s\n", c.problem.c_str());
}

constexpr double kWorthFinding = 3.0;  // [%]

struct Tally {
  int planted = 0, worth = 0, worth_found = 0, worth_joint = 0, worth_id = 0, found = 0;
};

void Summarise(const std::vector<Case>& cases) {
  std::map<std::string, Tally> by_id;
  Tally all;
  int none = 0, alarmed_none = 0, alarmed = 0, run = 0, close = 0, problems = 0;
  double before = 0.0, after = 0.0, truth = 0.0, seconds = 0.0;
  std::vector<double> ratio;
  for (const Case& c : cases) {
    problems += !c.problem.empty();
    if (!(c.truth > 0.0)) continue;
    ++run;
    seconds += c.seconds;
    before += c.before, after += c.after, truth += c.truth;
    none += c.planted.empty();
    alarmed_none += c.planted.empty() && !c.false_alarms.empty();
    alarmed += !c.planted.empty() && !c.false_alarms.empty();
    ratio.push_back(c.after / c.truth);
    close += ratio.back() <= 1.03;
    for (const Planted& p : c.planted) {
      for (Tally* t : {&by_id[p.effect.id], &all}) {
        ++t->planted;
        t->found += p.found;
        if (p.worth <= kWorthFinding) continue;
        ++t->worth;
        t->worth_found += p.found;
        t->worth_joint += p.joint;
        t->worth_id += p.id;
      }
    }
  }
  std::printf("\n%-22s %8s %8s | worth more than %.0f %%: %6s %6s %6s %6s\n", "id", "planted", "found", kWorthFinding,
              "cases", "both", "joint", "id");
  const auto row = [](const std::string& id, const Tally& t) {
    std::printf("%-22s %8d %8d | %22s %6d %6d %6d %6d\n", id.c_str(), t.planted, t.found, "", t.worth, t.worth_found,
                t.worth_joint, t.worth_id);
  };
  for (const auto& [id, tally] : by_id) row(id, tally);
  row("all", all);
  if (run == 0) return;
  std::sort(ratio.begin(), ratio.end());
  std::printf("\n%d cases run, %d with a problem; %.1f s each\n", run, problems, seconds / run);
  std::printf("without effect: %d, of which with a false alarm %d\n", none, alarmed_none);
  std::printf("with effects: %d, of which with one more that was not simulated %d\n", run - none, alarmed);
  std::printf("held-out error, mean: before %.3f, after %.3f, truth known %.3f %%\n", before / run, after / run,
              truth / run);
  std::printf("after / truth: median %.4f, 90th percentile %.4f, largest %.4f; within 3 %%: %d of %d\n",
              ratio[ratio.size() / 2], ratio[ratio.size() * 9 / 10], ratio.back(), close, run);
}

int Main() {
  if (FLAGS_cases < 1 || FLAGS_threads < 1 || FLAGS_joints < 2 || !(FLAGS_smallest > 0.0) ||
      !(FLAGS_largest >= FLAGS_smallest)) {
    std::fprintf(stderr, "cases and threads must be at least 1, joints 2, 0 < smallest <= largest\n");
    return 1;
  }
  std::vector<Case> cases(static_cast<size_t>(FLAGS_cases));
  std::vector<bool> done(cases.size(), false);
  std::atomic<int> next{0};
  std::mutex mutex;
  size_t printed = 0;
  const auto work = [&] {
    for (int k = next++; k < FLAGS_cases; k = next++) {
      Case one = Run(FLAGS_first + k);
      const std::lock_guard<std::mutex> lock(mutex);
      cases[static_cast<size_t>(k)] = std::move(one);
      done[static_cast<size_t>(k)] = true;
      while (printed < cases.size() && done[printed]) {
        Print(FLAGS_first + static_cast<int>(printed), cases[printed]);
        std::fflush(stdout);
        ++printed;
      }
    }
  };
  std::vector<std::thread> threads;
  for (int t = 1; t < FLAGS_threads; ++t) threads.emplace_back(work);
  work();
  for (std::thread& thread : threads) thread.join();
  Summarise(cases);
  return 0;
}

}  // namespace
}  // namespace idim

int main(int argc, char** argv) {
  google::InitGoogleLogging(argv[0]);
  idim::ParseFlags(
      {"blind_trial", {}, {}, "does the closed loop find what simulated arms have and the study does not declare?"},
      &argc, &argv);
  return idim::Main();
}
