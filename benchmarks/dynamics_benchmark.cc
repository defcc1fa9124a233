// Inverse dynamics, regressor, base columns and derivatives of a 6R arm, a sample at a time; each with the largest
// relative difference to the other route as its accuracy. `counter` in nanoseconds a sample.
//
// With two arguments it runs nothing but COUNT evaluations, for counting instructions from outside:
//   dynamics_benchmark inverse_dynamics|regressor|none COUNT      (scripts: benchmarks/count_instructions.sh)

#include <benchmark/benchmark.h>
#include <glog/logging.h>

#include <cstdlib>
#include <string>

#include "core/dynamics/base_parameters.h"
#include "core/dynamics/rigid_body_derivatives.h"
#include "core/dynamics/rigid_body_dynamics.h"
#include "core/robot/robot_reader.h"

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using RowMajorMatrix = Eigen::Matrix<double, -1, -1, Eigen::RowMajor>;

// The Staubli TX-40, with its 5-6 coupling.
idim::Robot Tx40() {
  idim::Result<idim::Robot> robot = idim::ReadRobot(IDIM_SOURCE_DIR "/datasets/tx40/robot.yaml");
  CHECK(robot.ok()) << robot.status().message();
  return *robot;
}

struct Fixture {
  idim::Robot robot = Tx40();
  idim::RigidBodyDynamics<double> dynamics{robot};
  VectorXd q, dq, ddq, chi = VectorXd(60), tau = VectorXd(6);
  VectorXd state = VectorXd(18), direction = VectorXd::LinSpaced(18, -1.0, 1.3);
  std::vector<idim::InertialVector> bodies;
  RowMajorMatrix w = RowMajorMatrix::Zero(6, 60);

  Fixture() {
    for (int j = 0; j < 6; ++j) {
      bodies.push_back(idim::InertialFromCentreOfMass(6.0 - j, Eigen::Vector3d(0.1, 0.02 * j, -0.05),
                                                      Eigen::Vector3d(0.1, 0.08, 0.05).asDiagonal()));
      chi.segment<10>(10 * j) = bodies.back();
    }
    q = VectorXd::LinSpaced(6, -2.0, 2.7);
    dq = VectorXd::LinSpaced(6, 3.0, -1.9);
    ddq = VectorXd::LinSpaced(6, -7.0, 9.0);
    state << q, dq, ddq;
  }
  // Of `function` along `direction` at `state`.
  template <typename Function>
  VectorXd Difference(const Function& function) {
    constexpr double kStep = 1e-5;
    const VectorXd after = function(state + kStep * direction), before = function(state - kStep * direction);
    return (after - before) / (2.0 * kStep);
  }
  void InverseDynamics() {
    q[0] += 1e-3;
    dynamics.InverseDynamics(q.data(), dq.data(), ddq.data(), bodies.data(), tau.data());
  }
  void Regressor() {
    q[0] += 1e-3;
    dynamics.Regressor(q.data(), dq.data(), ddq.data(), w.data());
  }
  double Error() {
    dynamics.InverseDynamics(q.data(), dq.data(), ddq.data(), bodies.data(), tau.data());
    dynamics.Regressor(q.data(), dq.data(), ddq.data(), w.data());
    return (w * chi - tau).norm() / tau.norm();
  }
};

void BM_InverseDynamics(benchmark::State& state) {
  Fixture f;
  for (auto unused : state) {
    f.InverseDynamics();
    benchmark::DoNotOptimize(f.tau.data());
  }
  state.counters["relative_error"] = f.Error();
}
BENCHMARK(BM_InverseDynamics);

void BM_Regressor(benchmark::State& state) {
  Fixture f;
  for (auto unused : state) {
    f.Regressor();
    benchmark::DoNotOptimize(f.w.data());
  }
  state.counters["relative_error"] = f.Error();
}
BENCHMARK(BM_Regressor);

// Errors of the derivatives: along a random direction, against central differences of step 1e-5,
// which are good to 1e-9.
void BM_InverseDynamicsDerivatives(benchmark::State& state) {
  Fixture f;
  idim::RigidBodyDerivatives derivatives(f.robot);
  MatrixXd d(6, 18);
  for (auto unused : state) {
    f.state[0] += 1e-3;
    derivatives.InverseDynamics(f.state.data(), f.bodies.data(), d.data());
    benchmark::DoNotOptimize(d.data());
  }
  const VectorXd numeric = f.Difference([&](const VectorXd& x) {
    f.dynamics.InverseDynamics(x.data(), x.data() + 6, x.data() + 12, f.bodies.data(), f.tau.data());
    return f.tau;
  });
  state.counters["relative_error"] = (d * f.direction - numeric).norm() / numeric.norm();
}
BENCHMARK(BM_InverseDynamicsDerivatives);

void BM_RegressorDerivative(benchmark::State& state) {
  Fixture f;
  idim::RigidBodyDerivatives derivatives(f.robot);
  RowMajorMatrix change = RowMajorMatrix::Zero(6, 60);
  for (auto unused : state) {
    f.state[0] += 1e-3;
    derivatives.Regressor(f.state.data(), f.direction.data(), change.data());
    benchmark::DoNotOptimize(change.data());
  }
  const VectorXd numeric = f.Difference([&](const VectorXd& x) -> VectorXd {
    f.dynamics.Regressor(x.data(), x.data() + 6, x.data() + 12, f.w.data());
    return Eigen::Map<const VectorXd>(f.w.data(), f.w.size());
  });
  state.counters["relative_error"] =
      (Eigen::Map<const VectorXd>(change.data(), change.size()) - numeric).norm() / numeric.norm();
}
BENCHMARK(BM_RegressorDerivative);

// With drives and the 5-6 coupling: what identification evaluates.
void BM_StandardModelRegressor(benchmark::State& state) {
  Fixture f;
  idim::StandardModel model(f.robot, idim::FrictionModel{});
  RowMajorMatrix w(6, model.columns());
  for (auto unused : state) {
    f.q[0] += 1e-3;
    model.Regressor(f.q.data(), f.dq.data(), f.ddq.data(), nullptr, w.data());
    benchmark::DoNotOptimize(w.data());
  }
  const VectorXd chi = VectorXd::LinSpaced(model.columns(), -1.0, 1.0);
  model.Torque(f.q.data(), f.dq.data(), f.ddq.data(), nullptr, chi, idim::InertialVector::Zero(), f.tau.data());
  state.counters["relative_error"] = (w * chi - f.tau).norm() / f.tau.norm();
}
BENCHMARK(BM_StandardModelRegressor);

void BM_BaseParameters(benchmark::State& state) {
  for (auto unused : state) {
    const idim::BaseParameters base{idim::StandardModel(Tx40(), idim::FrictionModel{})};
    benchmark::DoNotOptimize(base.size());
  }
}
BENCHMARK(BM_BaseParameters)->Unit(benchmark::kMillisecond);

int RunForCounting(const std::string& what, long count) {
  Fixture f;
  for (long k = 0; k < count; ++k) {
    if (what == "inverse_dynamics") f.InverseDynamics();
    if (what == "regressor") f.Regressor();
    benchmark::ClobberMemory();
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 3 && argv[1][0] != '-') return RunForCounting(argv[1], std::strtol(argv[2], nullptr, 10));
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
