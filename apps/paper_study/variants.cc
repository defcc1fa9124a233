#include "apps/paper_study/variants.h"

#include <glog/logging.h>

#include <Eigen/QR>
#include <cmath>
#include <memory>
#include <tuple>
#include <utility>

#include "core/base/decompositions.h"
#include "core/base/random.h"
#include "solvers/linear/gain_identification.h"
#include "solvers/linear/gain_system.h"
#include "solvers/linear/least_squares.h"
#include "solvers/linear/signal_noise.h"

namespace idim {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kSlowNoiseHz = 2.0;

class ScaledInTime : public Trajectory {
 public:
  ScaledInTime(std::shared_ptr<const Trajectory> path, double speed) : path_(std::move(path)), speed_(speed) {}
  int dof() const override { return path_->dof(); }
  double duration() const override { return path_->duration() / speed_; }
  JointState At(double t) const override {
    JointState state = path_->At(speed_ * t);
    state.dq *= speed_;
    state.ddq *= speed_ * speed_;
    return state;
  }

 private:
  std::shared_ptr<const Trajectory> path_;
  double speed_;
};

// What decimation leaves of the standard deviation of white noise.
double WhiteGain(const Decimator& decimator) {
  double squares = 0.0;
  for (double tap : decimator.Taps()) squares += tap * tap;
  return std::sqrt(squares);
}

MatrixXd SlowNoise(const Truth& truth, double rate, std::uint64_t seed) {
  Random random(seed, 17);
  const double memory = std::exp(-2.0 * M_PI * kSlowNoiseHz / rate);
  MatrixXd noise(truth.signal.rows(), truth.signal.cols());
  for (Eigen::Index j = 0; j < noise.cols(); ++j) {
    double value = random.Normal();
    for (Eigen::Index k = 0; k < noise.rows(); ++k) {
      noise(k, j) = value;
      value = memory * value + std::sqrt(1.0 - memory * memory) * random.Normal();
    }
  }
  return noise;
}

// Signed square root of speed in both recordings, less what [dq, sign dq, 1] of the joint imitate over both.
std::vector<MatrixXd> FrictionError(const std::vector<Truth>& truths) {
  Eigen::Index rows = 0;
  for (const Truth& truth : truths) rows += truth.dq.rows();
  std::vector<MatrixXd> errors;
  for (const Truth& truth : truths) errors.push_back(truth.dq);
  for (Eigen::Index j = 0; j < truths[0].dq.cols(); ++j) {
    VectorXd dq(rows);
    Eigen::Index at = 0;
    for (const Truth& truth : truths) {
      dq.segment(at, truth.dq.rows()) = truth.dq.col(j);
      at += truth.dq.rows();
    }
    MatrixXd known(rows, 3);
    known << dq, dq.cwiseSign(), VectorXd::Ones(rows);
    VectorXd error = dq.cwiseAbs().cwiseSqrt().cwiseProduct(dq.cwiseSign());
    error -= known * known.colPivHouseholderQr().solve(error);
    at = 0;
    for (size_t r = 0; r < truths.size(); ++r) {
      errors[r].col(j) = error.segment(at, errors[r].rows());
      at += errors[r].rows();
    }
  }
  return errors;
}

Result<std::vector<Recording>> Logs(const Scenario& scenario, const std::vector<ScenarioRecording>& recordings,
                                    const std::vector<Truth>& truths, const Preprocessing& preprocessing,
                                    const VariantOptions& options, std::uint64_t draw) {
  std::vector<Recording> logs;
  std::vector<MatrixXd> shapes;
  if (options.disturbance == Disturbance::kFriction) shapes = FrictionError(truths);
  for (size_t r = 0; r < recordings.size(); ++r) {
    const std::uint64_t seed = recordings[r].seed + 1000 * (draw + 1);
    NoiseOptions noise = scenario.noise;
    noise.signal_percent *= options.size;
    Truth truth = truths[r];
    if (options.disturbance != Disturbance::kWhite) {
      const VectorXd sigma = AddedSignalNoise(truth, noise);
      noise.signal_percent.setZero();
      Recording clean;
      clean.t = truth.t;
      clean.q = truth.q;
      const Result<Decimator> decimator = MakeDecimator(clean, preprocessing);
      IDIM_RETURN_IF_ERROR(decimator);
      MatrixXd shape = shapes.empty() ? SlowNoise(truth, scenario.truth.rate, seed) : shapes[r];
      const MatrixXd kept = decimator->Apply(shape);
      const VectorXd rms = kept.colwise().norm().transpose() / std::sqrt(static_cast<double>(kept.rows()));
      truth.signal += shape * (WhiteGain(*decimator) * sigma.cwiseQuotient(rms)).asDiagonal();
    }
    logs.push_back(AddNoise(truth, scenario.robot, noise, seed));
    logs.back().name = recordings[r].name;
  }
  return logs;
}

// Norm of the known torque, and of what of it the other columns but the gains cannot imitate, over that of V g.
std::pair<double, double> KnownTorqueShares(const GainSystem& system, const VectorXd& gains) {
  const int n = system.dof();
  const int known = static_cast<int>(system.unknowns.size());
  TriangularFactor all(known + 1);
  for (const TriangularFactor& joint : system.joints) all.Merge(joint);
  const MatrixXd r = all.R();
  const double torque = (r.leftCols(n) * gains).norm();
  return {r.col(known).norm() / torque,
          RemainderOf(r.middleCols(n, known - n), r.col(known), GainOptions().rank_tolerance).norm / torque};
}

// Rows divided by what known gains leave of each joint's equations, before any gain is identified.
GainSystem WeightedByKnownGains(const GainSystem& system) {
  const VectorXd sigma =
      SignalNoise(system, GainOptions().rank_tolerance).diagonal().cwiseProduct(system.a_priori_gains.cwiseAbs());
  GainSystem weighted = system;
  for (int j = 0; j < system.dof(); ++j) {
    weighted.joints[j] = TriangularFactor(system.joints[j].columns());
    weighted.joints[j].Merge(system.joints[j], 1.0 / sigma[j]);
  }
  return weighted;
}

struct Solved {
  const char* name;
  GainEstimator estimator;
  PayloadKnowledge knowledge;
  bool known_gain_weights;
};

constexpr Solved kSolved[] = {{"Case 1", GainEstimator::kWls, PayloadKnowledge::kTen, false},
                              {"Case 2", GainEstimator::kWls, PayloadKnowledge::kMass, false},
                              {"Case 2, weights by known gains", GainEstimator::kLs, PayloadKnowledge::kMass, true},
                              {"Case 3", GainEstimator::kWtls, PayloadKnowledge::kTen, false},
                              {"Case 4", GainEstimator::kWtls, PayloadKnowledge::kMass, false},
                              {"Case 4, weights by known gains", GainEstimator::kTls, PayloadKnowledge::kMass, true},
                              {"Scaled TLS, ten known", GainEstimator::kWgtls, PayloadKnowledge::kTen, false},
                              {"Scaled TLS", GainEstimator::kWgtls, PayloadKnowledge::kMass, false}};

}  // namespace

Result<Variant> RunVariant(const PaperStudy& paper, const VariantOptions& options, int draws) {
  CHECK_GE(draws, 2);
  CHECK_GT(options.speed, 0.0);
  CHECK(paper.scenario.truth.signal_side == Side::kJoint);
  Scenario scenario = paper.scenario;
  std::vector<ScenarioRecording> recordings;
  for (const ScenarioRecording& recording : scenario.recordings) {
    if (recording.use != Use::kIdentification) continue;
    recordings.push_back(recording);
    ScenarioRecording& last = recordings.back();
    if (options.same_motion) last.trajectory = recordings.front().trajectory;
    last.trajectory = std::make_shared<ScaledInTime>(last.trajectory, options.speed);
    last.duration /= options.speed;
    if (options.same_motion) last.trajectory = recordings.front().trajectory;
  }
  scenario.recordings = recordings;
  std::vector<Truth> truths;
  for (const ScenarioRecording& recording : recordings) truths.push_back(SimulateTruth(scenario, recording));
  Scenario believed = scenario;
  for (size_t k = 0; k < options.believed_ten.size(); ++k) believed.payloads[0].inertial[k] = options.believed_ten[k];

  Variant variant;
  variant.title = options.title;
  constexpr int kCount = sizeof(kSolved) / sizeof(kSolved[0]);
  const int n = scenario.robot.dof();
  std::vector<MatrixXd> errors(kCount, MatrixXd(draws, n));
  std::vector<double> residuals(kCount, 0.0);
  Study study = StudyOf(scenario);
  study.preprocessing.cutoff_hz = paper.prepared.data->preprocessing.cutoff_hz;
  study.preprocessing.decimation = paper.prepared.data->preprocessing.decimation;
  for (int draw = 0; draw < draws; ++draw) {
    Result<std::vector<Recording>> logs = Logs(scenario, recordings, truths, paper.prepared.data->preprocessing,
                                               options, static_cast<std::uint64_t>(draw));
    IDIM_RETURN_IF_ERROR(logs);
    const Result<PreparedStudy> prepared = PrepareStudy(study, std::move(logs).value());
    IDIM_RETURN_IF_ERROR(prepared);
    const Result<GainSystem> ten =
        BuildGainSystem(WithPayloadKnowledge(*prepared, believed, PayloadKnowledge::kTen, true));
    IDIM_RETURN_IF_ERROR(ten);
    const Result<GainSystem> mass =
        BuildGainSystem(WithPayloadKnowledge(*prepared, believed, PayloadKnowledge::kMass, true));
    IDIM_RETURN_IF_ERROR(mass);
    if (draw == 0) {
      std::tie(variant.share_ten, variant.independent_ten) = KnownTorqueShares(*ten, scenario.gains);
      std::tie(variant.share_mass, variant.independent_mass) = KnownTorqueShares(*mass, scenario.gains);
    }
    for (int c = 0; c < kCount; ++c) {
      const GainSystem& system = kSolved[c].knowledge == PayloadKnowledge::kTen ? *ten : *mass;
      GainOptions gain_options;
      gain_options.estimator = kSolved[c].estimator;
      const GainSummary summary =
          SolveGains(kSolved[c].known_gain_weights ? WeightedByKnownGains(system) : system, gain_options);
      if (summary.values.size() == 0) return summary.status;
      const VectorXd gains = summary.values.head(n);
      errors[c].row(draw) = 100.0 * (gains.cwiseQuotient(scenario.gains) - VectorXd::Ones(n)).transpose();
      residuals[c] += 100.0 * summary.relative_residual / draws;
    }
  }
  for (int c = 0; c < kCount; ++c) {
    GainErrors result;
    result.name = kSolved[c].name;
    result.mean_percent = errors[c].colwise().mean().transpose();
    const MatrixXd centred = errors[c].rowwise() - result.mean_percent.transpose();
    result.spread_percent = (centred.colwise().squaredNorm() / (draws - 1)).cwiseSqrt().transpose();
    result.residual_percent = residuals[c];
    variant.cases.push_back(std::move(result));
  }
  return variant;
}

}  // namespace idim
