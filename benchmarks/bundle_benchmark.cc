// Seconds, bytes and estimates of the errors-in-variables bundle, one solver a process (benchmarks/compare_bundle.sh).
//
//   bundle_benchmark --write --arm=2r|6r --samples=N --data=PREFIX
// makes PREFIX.json and PREFIX.bin (and --seed, --joint_noise);
//   bundle_benchmark --solver=closed|ceres --data=PREFIX --result=FILE.json
// solves it and says what that took.
//
// Samples are random joint states, the second half with a payload of known mass; measured states carry the noise of a
// 3 x 3 covariance a joint, signals white noise, and both standard deviations are given to every solver. The signals
// are those of the true states: nothing is linearised in making them. No Coulomb friction, whose derivative no solver
// has. PREFIX.bin: a row of doubles a sample, measured q, dq, ddq of all joints, then the signals.
//   2r: planar, horizontal, 12 unknowns: 2 gains, ZZ1 Fv1 ZZ2 MX2 MY2 Ia2 Fv2 of the arm, ZZ MX MY of the payload.
//   6r: the TX-40 with its coupling, viscous friction and offsets.
//
// closed: SolveBundle. ceres: the same residuals (linearised about the measured state as there), every latent
// a parameter block, AutoDiffCostFunction and SPARSE_NORMAL_CHOLESKY, as one would write it down.

#include <ceres/ceres.h>
#include <gflags/gflags.h>
#include <glog/logging.h>
#include <sys/resource.h>
#include <time.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "apps/program.h"
#include "core/base/random.h"
#include "core/robot/robot_reader.h"
#include "solvers/bundle/bundle.h"

DEFINE_string(arm, "2r", "2r or 6r, with --write");
DEFINE_int32(samples, 100000, "with --write, at least 100");
DEFINE_int32(seed, 1, "of the states and the noise");
DEFINE_string(data, "", "prefix of the data's two files");
DEFINE_double(joint_noise, 1.0, "with --write, times 2e-5 rad, 1.5e-3 rad/s, 0.7 rad/s^2");
DEFINE_bool(write, false, "make the data");
DEFINE_string(solver, "closed", "closed or ceres");
DEFINE_string(result, "", "JSON file for times, memory and estimates");

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using Json = nlohmann::ordered_json;
using RowMajorMatrix = idim::StateDerivatives::RowMajorMatrix;

double Seconds(clockid_t clock) {
  timespec t;
  CHECK_EQ(clock_gettime(clock, &t), 0);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

// Peak of resident memory so far [bytes]. Not ru_maxrss, which begins with that of the caller.
double PeakMemory() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.rfind("VmHWM:", 0) == 0) return 1024.0 * std::stod(line.substr(6));
  }
  LOG(FATAL) << "/proc/self/status has no VmHWM";
}

// An arm, its unknowns and their true values; no samples yet.
struct Problem {
  idim::BaseParameters base;
  idim::BundleData data;
  VectorXd standard;             // true standard parameters
  idim::InertialVector payload;  // true one of the second half of the samples
  VectorXd truth;                // of data.unknowns
  double position_range = 2.5, velocity_range = 3.0, acceleration_range = 10.0;
};

idim::Robot Planar2R() {
  idim::Robot robot;
  robot.name = "planar_2r";
  robot.joints = {idim::JointFromModifiedDh(idim::JointType::kRevolute, 0.0, 0.0, 0.0, 0.0),
                  idim::JointFromModifiedDh(idim::JointType::kRevolute, 0.0, 0.5, 0.0, 0.0)};
  robot.transmission = MatrixXd::Identity(2, 2);
  return robot;
}

// joint_noise: times the standard deviations below.
Problem MakeProblem(const std::string& arm, double joint_noise) {
  CHECK(arm == "2r" || arm == "6r") << "--arm=" << arm;
  idim::Robot robot = Planar2R();
  idim::FrictionModel friction{true, false, false};
  if (arm == "6r") {
    idim::Result<idim::Robot> tx40 = idim::ReadRobot(IDIM_SOURCE_DIR "/datasets/tx40/robot.yaml");
    CHECK(tx40.ok()) << tx40.status().message();
    robot = *tx40;
    friction.offset = true;
  }
  const int n = robot.dof();
  Problem problem{idim::BaseParameters(idim::StandardModel(robot, friction)), {}, {}, {}, {}};
  const idim::StandardModel& model = problem.base.model();

  problem.standard.setZero(model.columns());
  for (int k = 0; k < model.columns(); ++k) {
    const idim::Parameter& parameter = model.parameters()[k];
    if (parameter.kind == idim::ParameterKind::kDriveInertia) problem.standard[k] = 0.3;
    if (parameter.kind == idim::ParameterKind::kFriction) problem.standard[k] = 0.5 + parameter.joint;
  }
  for (int j = 0; j < n; ++j) {
    const idim::InertialVector body = idim::InertialFromCentreOfMass(6.0 - j, Eigen::Vector3d(0.1, 0.02 * j, -0.05),
                                                                     Eigen::Vector3d(0.1, 0.08, 0.05).asDiagonal());
    problem.standard.segment<10>(model.Find("XX" + std::to_string(j + 1))) = body;
  }
  problem.payload = idim::InertialFromCentreOfMass(5.0, Eigen::Vector3d(0.08, 0.03, 0.1),
                                                   Eigen::Vector3d(0.03, 0.02, 0.025).asDiagonal());

  idim::BundleData& data = problem.data;
  data.dof = n;
  idim::Model supposed;
  supposed.base_parameters = std::make_shared<const idim::BaseParameters>(problem.base);
  supposed.gains_mode = idim::GainsMode::kIdentify;
  supposed.roles = {{idim::Use::kIdentification, -1}, {idim::Use::kIdentification, 0}};
  supposed.payloads.resize(1);
  for (int k = 0; k < idim::kNumInertial; ++k) {
    const bool has_effect = arm == "6r" || k == idim::kZZ || k == idim::kMX || k == idim::kMY;
    if (!has_effect) supposed.payloads[0].known[k] = 0.0;
  }
  supposed.payloads[0].known[idim::kM] = problem.payload[idim::kM];
  supposed.columns = std::make_shared<const idim::EffectColumns>(idim::EffectColumns{{}, {{}, {}}});
  data.unknowns = idim::Unknowns(supposed, idim::UncertainPayload::kExact);
  data.inverse_drive.setIdentity(n, n);
  data.payload_of_recording = {-1, 0};
  // Encoders of 2e-5 rad, filtered and decimated: position and acceleration of the same samples are correlated.
  const Eigen::Vector3d deviation(joint_noise * 2e-5, joint_noise * 1.5e-3, joint_noise * 0.7);
  Eigen::Matrix3d correlation = Eigen::Matrix3d::Identity();
  correlation(0, 2) = correlation(2, 0) = -0.5;
  data.state_covariance.assign(
      2, std::vector<Eigen::Matrix3d>(n, deviation.asDiagonal() * correlation * deviation.asDiagonal()));

  problem.truth.resize(data.num_unknowns());
  for (int j = 0; j < n; ++j) problem.truth[j] = (j % 2 == 0 ? 30.0 : -20.0) / (1.0 + 0.5 * j);
  problem.truth.segment(n, problem.base.size()) = problem.base.projection() * problem.standard;
  for (int k = 0; k < idim::kNumInertial; ++k) {
    if (const int unknown = data.unknowns.payload(0, k); unknown >= 0) problem.truth[unknown] = problem.payload[k];
  }
  return problem;
}

std::vector<double> Numbers(const VectorXd& v) { return {v.data(), v.data() + v.size()}; }

void Write() {
  Problem problem = MakeProblem(FLAGS_arm, FLAGS_joint_noise);
  idim::StandardModel model = problem.base.model();
  const int n = problem.data.dof;
  idim::Random random(static_cast<std::uint64_t>(FLAGS_seed));
  const Eigen::Matrix3d root = problem.data.state_covariance[0][0].llt().matrixL();
  MatrixXd rows(FLAGS_samples, 4 * n);
  VectorXd state(3 * n), tau(n);
  for (int k = 0; k < FLAGS_samples; ++k) {
    for (int j = 0; j < n; ++j) {
      state[j] = problem.position_range * random.Uniform(-1.0, 1.0);
      state[n + j] = problem.velocity_range * random.Uniform(-1.0, 1.0);
      state[2 * n + j] = problem.acceleration_range * random.Uniform(-1.0, 1.0);
    }
    model.Torque(state.data(), state.data() + n, state.data() + 2 * n, nullptr, problem.standard,
                 2 * k < FLAGS_samples ? idim::InertialVector::Zero() : problem.payload, tau.data());
    for (int j = 0; j < n; ++j) {
      Eigen::Vector3d white;
      for (double& w : white) w = random.Normal();
      const Eigen::Vector3d noise = root * white;
      for (int a = 0; a < 3; ++a) rows(k, a * n + j) = state[a * n + j] + noise[a];
      rows(k, 3 * n + j) = tau[j] / problem.truth[j];
    }
  }
  const VectorXd sigma = 0.05 * (rows.rightCols(n).colwise().squaredNorm() / FLAGS_samples).cwiseSqrt().transpose();
  for (int k = 0; k < FLAGS_samples; ++k) {
    for (int j = 0; j < n; ++j) rows(k, 3 * n + j) += sigma[j] * random.Normal();
  }
  VectorXd start = problem.truth;
  for (Eigen::Index i = 0; i < start.size(); ++i) start[i] *= i % 2 == 0 ? 1.2 : 0.8;

  std::ofstream binary(FLAGS_data + ".bin", std::ios::binary);
  const RowMajorMatrix row_major = rows;
  binary.write(reinterpret_cast<const char*>(row_major.data()),
               static_cast<std::streamsize>(sizeof(double)) * row_major.size());
  Json json;
  json["arm"] = FLAGS_arm;
  json["samples"] = FLAGS_samples;
  json["joint_noise"] = FLAGS_joint_noise;
  for (const idim::Parameter& parameter : problem.data.unknowns.parameters())
    json["unknowns"].push_back(parameter.name);
  json["truth"] = Numbers(problem.truth);
  json["start"] = Numbers(start);
  json["sigma"] = Numbers(sigma);
  json["payload_mass"] = problem.payload[idim::kM];
  const RowMajorMatrix covariance = idim::StateCovarianceOf(problem.data, 0);
  json["state_covariance"] = std::vector<double>(covariance.data(), covariance.data() + covariance.size());
  std::ofstream(FLAGS_data + ".json") << json.dump(1) << "\n";
  CHECK(binary.good()) << "cannot write " << FLAGS_data;
}

// Reads row by row, so that nothing but the samples is held.
void ReadSamples(int samples, Problem* problem) {
  idim::BundleData& data = problem->data;
  idim::StandardModel model = problem->base.model();
  const int n = data.dof;
  std::ifstream file(FLAGS_data + ".bin", std::ios::binary);
  VectorXd row(4 * n);
  RowMajorMatrix w(n, model.columns()), payload(n, idim::kNumInertial);
  std::vector<idim::BundleSample> all;
  all.reserve(samples);
  for (int k = 0; k < samples; ++k) {
    CHECK(file.read(reinterpret_cast<char*>(row.data()), static_cast<std::streamsize>(sizeof(double)) * row.size()))
        << FLAGS_data << ".bin is too short";
    idim::BundleSample sample;
    sample.recording = 2 * k < samples ? 0 : 1;
    sample.state = row.head(3 * n);
    sample.signal = row.tail(n);
    model.Regressor(row.data(), row.data() + n, row.data() + 2 * n, nullptr, w.data());
    sample.columns.setZero(n, data.num_columns());
    for (int c = 0; c < problem->base.size(); ++c) sample.columns.col(c) = w.col(problem->base.kept()[c]);
    sample.known.setZero(n);
    if (sample.recording == 1) {
      model.PayloadColumns(payload.data());
      sample.known = payload * data.unknowns.known_payload(0);
      for (int c = 0; c < idim::kNumInertial; ++c) {
        if (const int column = data.payload_column(0, c); column >= 0) sample.columns.col(column) = payload.col(c);
      }
    }
    all.push_back(std::move(sample));
  }
  data.SetSamples(std::move(all));
}

// (v - diag(1/g) (W + sum_s d_s W_s) (chi; 1)) / sigma of N joints and C columns, W_s the derivative by state s.
template <int N, int C>
struct TorqueFunctor {
  Eigen::Matrix<double, N, C + 1, Eigen::RowMajor> columns;
  std::array<Eigen::Matrix<double, N, C + 1, Eigen::RowMajor>, 3 * N> changes;
  Eigen::Matrix<double, N, 1> signal, sigma;

  template <typename T>
  bool operator()(const T* theta, const T* deviation, T* residual) const {
    for (int i = 0; i < N; ++i) {
      T torque(columns(i, C));
      for (int s = 0; s < 3 * N; ++s) torque += deviation[s] * changes[s](i, C);
      for (int c = 0; c < C; ++c) {
        T column(columns(i, c));
        for (int s = 0; s < 3 * N; ++s) {
          if (changes[s](i, c) != 0.0) column += deviation[s] * changes[s](i, c);
        }
        torque += column * theta[N + c];
      }
      residual[i] = (signal[i] - torque / theta[i]) / sigma[i];
    }
    return true;
  }
};

template <int N>
struct JointStateFunctor {
  Eigen::Matrix<double, 3 * N, 3 * N> whitening;

  template <typename T>
  bool operator()(const T* deviation, T* residual) const {
    for (int a = 0; a < 3 * N; ++a) {
      residual[a] = T(0);
      for (int b = 0; b <= a; ++b) {
        if (whitening(a, b) != 0.0) residual[a] += whitening(a, b) * deviation[b];
      }
    }
    return true;
  }
};

struct Solution {
  VectorXd values, standard_deviation;  // the latter empty where not computed
  double cost = 0.0;                    // sum of squares
  int iterations = 0;
  std::string message;
};

Solution SolveClosed(const Problem& problem, const VectorXd& start, const VectorXd& sigma) {
  idim::BundleOptions options;
  options.signal_sigma = sigma;
  options.max_weight_iterations = 0;
  const idim::BundleSummary summary = idim::SolveBundle(problem.base, problem.data, start, options);
  return {summary.values, summary.covariance.diagonal().cwiseSqrt(), summary.final_cost, summary.iterations,
          summary.status.ok() ? "converged" : summary.status.message()};
}

template <int N, int C>
Solution SolveCeres(const Problem& problem, const VectorXd& start, const VectorXd& sigma) {
  const idim::BundleData& data = problem.data;
  CHECK_EQ(data.dof, N);
  CHECK_EQ(data.num_columns(), C);
  idim::StateDerivatives derivatives(problem.base, data);
  MatrixXd of_known;
  RowMajorMatrix change;
  VectorXd theta = start;
  RowMajorMatrix deviations = RowMajorMatrix::Zero(data.samples().size(), 3 * N);
  ceres::Problem least_squares;
  const MatrixXd covariance = idim::StateCovarianceOf(data, 0);
  const Eigen::Matrix<double, 3 * N, 3 * N> whitening =
      covariance.llt().matrixL().solve(MatrixXd::Identity(3 * N, 3 * N));
  for (std::size_t k = 0; k < data.samples().size(); ++k) {
    const idim::BundleSample& sample = data.samples()[k];
    auto* torque = new TorqueFunctor<N, C>;
    torque->columns << sample.columns, sample.known;
    derivatives.Torque(sample, VectorXd::Zero(C), &of_known);
    for (int s = 0; s < 3 * N; ++s) {
      derivatives.Columns(sample, VectorXd::Unit(3 * N, s), &change);
      torque->changes[s] << change, of_known.col(s);
    }
    torque->signal = sample.signal;
    torque->sigma = sigma;
    double* deviation = deviations.row(static_cast<Eigen::Index>(k)).data();
    least_squares.AddResidualBlock(new ceres::AutoDiffCostFunction<TorqueFunctor<N, C>, N, N + C, 3 * N>(torque),
                                   nullptr, theta.data(), deviation);
    least_squares.AddResidualBlock(
        new ceres::AutoDiffCostFunction<JointStateFunctor<N>, 3 * N, 3 * N>(new JointStateFunctor<N>{whitening}),
        nullptr, deviation);
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.function_tolerance = 1e-10;  // the default of 1e-6 stops where unknowns still move
  options.max_num_iterations = 200;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &least_squares, &summary);
  return {theta,
          {},
          2.0 * summary.final_cost,
          static_cast<int>(summary.iterations.size()) - 1,
          summary.termination_type == ceres::CONVERGENCE ? "converged" : summary.message};
}

void Solve() {
  Json given;
  std::ifstream(FLAGS_data + ".json") >> given;
  Problem problem = MakeProblem(given["arm"], given["joint_noise"]);
  const double program = PeakMemory();
  ReadSamples(given["samples"], &problem);
  const double held = PeakMemory();
  const auto vector = [&](const char* key) {
    const std::vector<double> values = given[key];
    return VectorXd(Eigen::Map<const VectorXd>(values.data(), static_cast<Eigen::Index>(values.size())));
  };
  const VectorXd start = vector("start"), sigma = vector("sigma");

  const double cpu = Seconds(CLOCK_PROCESS_CPUTIME_ID), wall = Seconds(CLOCK_MONOTONIC);
  Solution solution;
  if (FLAGS_solver == "closed") {
    solution = SolveClosed(problem, start, sigma);
  } else if (given["arm"] == "2r") {
    solution = SolveCeres<2, 10>(problem, start, sigma);
  } else {
    solution = SolveCeres<6, 63>(problem, start, sigma);
  }
  Json json;
  json["solver"] = FLAGS_solver;
  json["arm"] = given["arm"];
  json["samples"] = given["samples"];
  json["cpu_s"] = Seconds(CLOCK_PROCESS_CPUTIME_ID) - cpu;
  json["wall_s"] = Seconds(CLOCK_MONOTONIC) - wall;
  json["program_bytes"] = program;
  json["held_bytes"] = held;
  json["peak_bytes"] = PeakMemory();
  json["iterations"] = solution.iterations;
  json["cost"] = solution.cost;
  json["message"] = solution.message;
  json["unknowns"] = given["unknowns"];
  json["truth"] = given["truth"];
  json["values"] = Numbers(solution.values);
  json["standard_deviation"] = Numbers(solution.standard_deviation);
  std::ofstream(FLAGS_result) << json.dump(1) << "\n";
}

}  // namespace

int main(int argc, char** argv) {
  google::InitGoogleLogging(argv[0]);
  idim::ParseFlags({"bundle_benchmark",
                    {},
                    {"--data=DIR", "(--write | --result=FILE.json)"},
                    "the errors-in-variables bundle: seconds, bytes and estimates of one solver"},
                   &argc, &argv);
  const bool solver = FLAGS_solver == "closed" || FLAGS_solver == "ceres";
  if (FLAGS_data.empty() || FLAGS_samples < 100 || !(FLAGS_joint_noise > 0.0) || !solver ||
      (!FLAGS_write && FLAGS_result.empty())) {
    std::fprintf(
        stderr,
        "expected --data, --samples >= 100, --joint_noise > 0, --solver=closed|ceres, and --write or --result\n");
    return 1;
  }
  FLAGS_write ? Write() : Solve();
  return 0;
}
