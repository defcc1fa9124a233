// From noisy encoder samples through filter and decimation to the bundle: its errors over repeated noise.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <string>
#include <vector>

#include "core/base/decompositions.h"
#include "core/model/model.h"
#include "core/simulation/simulate.h"
#include "solvers/bundle/bundle.h"
#include "tests/support/draws.h"
#include "tests/support/eiv_draws.h"
#include "tests/support/monte_carlo.h"
#include "tests/support/tx40_scenario.h"

namespace idim::full_chain_slow_test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using testing::Draws;
using ::testing::IsEmpty;
using testing::MonteCarloRun;
using testing::MonteCarloStatistics;
using testing::Print;
using testing::ReportedCovariance;
using testing::RunMonteCarlo;
using testing::Summarize;

// Whitened residuals V^-1/2 r, samples x n.
MatrixXd Whitened(const BaseParameters& base, const BundleData& data, const BundleSummary& summary) {
  const int n = data.dof;
  StateDerivatives derivatives(base, data);
  const VectorXd inverse_gains = summary.values.head(n).cwiseInverse(), chi = summary.values.tail(data.num_columns());
  MatrixXd result(data.samples().size(), n), d;
  for (size_t k = 0; k < data.samples().size(); ++k) {
    const BundleSample& sample = data.samples()[k];
    derivatives.Torque(sample, chi, &d);
    const MatrixXd b = inverse_gains.asDiagonal() * data.inverse_drive * d;
    MatrixXd v = b * StateCovarianceOf(data, sample.recording) * b.transpose();
    v.diagonal() += summary.signal_sigma.cwiseAbs2();
    const VectorXd r =
        sample.signal - inverse_gains.cwiseProduct(data.inverse_drive * (sample.columns * chi + sample.known));
    result.row(static_cast<Eigen::Index>(k)) = v.llt().matrixL().solve(r).transpose();
  }
  return result;
}

VectorXd LagOne(const MatrixXd& w) {
  const Eigen::Index k = w.rows() - 1;
  return w.topRows(k)
      .cwiseProduct(w.bottomRows(k))
      .colwise()
      .sum()
      .cwiseQuotient(w.colwise().squaredNorm())
      .transpose();
}

constexpr double kAlarm = 1e-4;
constexpr unsigned kSeed = 1000;

// A scenario's noise-free truth, logged anew in each run.
struct Chain {
  Scenario scenario;
  Study study;
  std::vector<Truth> truths;

  Chain(const testing::Tx40Log& log, double cutoff, int decimation) : scenario(testing::Tx40Scenario(log)) {
    study = StudyOf(scenario);
    study.preprocessing.cutoff_hz = cutoff;
    study.preprocessing.decimation = decimation;
    for (const ScenarioRecording& recording : scenario.recordings) truths.push_back(SimulateTruth(scenario, recording));
  }

  Result<PreparedStudy> Prepare(int run) const {
    std::vector<Recording> recordings;
    for (size_t r = 0; r < truths.size(); ++r) {
      recordings.push_back(AddNoise(truths[r], scenario.robot, scenario.noise, kSeed + 2 * run + r));
    }
    return PrepareStudy(study, std::move(recordings));
  }
};

struct ChainResult {
  std::vector<MonteCarloRun> runs;
  std::vector<std::string> names;
  std::vector<VectorXd> lag_one;
};

// unfiltered_columns: evaluated at the decimated states instead of filtered in parallel with the signals.
ChainResult RunChain(const Chain& chain, int runs, bool unfiltered_columns) {
  ChainResult result;
  result.lag_one.resize(runs);
  const BaseParameters base(StandardModel(chain.study.robot, chain.study.friction));
  const VectorXd truth = testing::TrueValues(chain.scenario, base);
  result.runs = RunMonteCarlo(runs, [&](int r) {
    Result<PreparedStudy> prepared = chain.Prepare(r);
    EXPECT_TRUE(prepared.ok()) << prepared.status().message();
    Result<BundleData> built = BuildBundleData(*prepared);
    EXPECT_TRUE(built.ok()) << built.status().message();
    BundleData data = std::move(built).value();
    if (unfiltered_columns) {
      testing::EvaluateColumns(base, std::sqrt(data.state_covariance[0][0](1, 1)), &data);
    }
    if (r == 0) {
      std::cout << data.samples().size() << " samples; " << prepared->data->preprocessing.cutoff_hz << " Hz, "
                << prepared->data->preprocessing.decimation << "; position noise "
                << prepared->data->position_noise.transpose() << "\nstate noise of joint 1 "
                << data.state_covariance[0][0].diagonal().cwiseSqrt().transpose() << "\n";
      for (const Parameter& unknown : data.unknowns.parameters()) result.names.push_back(unknown.name);
    }
    const BundleSummary summary = SolveBundle(base, data, truth);
    if (summary.IsSolutionUsable()) result.lag_one[r] = LagOne(Whitened(base, data, summary));
    return testing::RunOf(summary, truth, VectorXd::Ones(6));
  });
  return result;
}

struct Reports {
  MonteCarloStatistics gains, gains_robust, all, all_robust;
};

Reports Report(const ChainResult& result) {
  const std::vector<std::string> gain_names = {"g1", "g2", "g3", "g4", "g5", "g6"};
  const std::vector<int> gains = {0, 1, 2, 3, 4, 5};
  const Reports reports{Summarize(result.runs, gains, gain_names, ReportedCovariance::kSchur),
                        Summarize(result.runs, gains, gain_names, ReportedCovariance::kRobust),
                        Summarize(result.runs, result.names, ReportedCovariance::kSchur),
                        Summarize(result.runs, result.names, ReportedCovariance::kRobust)};
  Print("gains, Schur", reports.gains);
  Print("gains, robust", reports.gains_robust);
  Print("all, Schur", reports.all);
  Print("all, robust", reports.all_robust);
  VectorXd lag = VectorXd::Zero(6);
  int count = 0;
  for (const VectorXd& one : result.lag_one) {
    if (one.size() == 0) continue;
    lag += one;
    ++count;
  }
  std::cout << "lag-1 correlation of the whitened residual: " << (lag / count).transpose() << "\n";
  return reports;
}

testing::Tx40Log EncoderLog() {
  testing::Tx40Log log;
  log.rate = 1000.0;
  log.duration = 16.0;
  // Encoders of 8192 counts a motor turn (1.6e-5 to 2.4e-5 rad) and 1e-5 rad of white noise; white noise of the
  // signals of which the decimation by 20 leaves 10 %.
  log.noise = "{encoder_counts: 8192, position: 1.0e-5, signal_percent: 45}";
  return log;
}

// Gains: bias, spread, coverage and NEES are what the sandwich says, at a false alarm of 1e-4. Decimation leaves a
// lag-1 correlation of 0.03 in the whitened residual, and the motion's rests a variance that changes: the Schur
// complement is too small, over 120 runs by 8 to 20 % of the gains' standard deviations jointly (NEES / p 1.45
// against 1.03).
TEST(FullChain, EncoderAtOneKilohertz) {
  const Chain chain(EncoderLog(), 20.0, 20);
  const ChainResult result = RunChain(chain, Draws(120, 24, kSeed), false);
  ASSERT_THAT(testing::Failures(result.runs), IsEmpty());
  EXPECT_THAT(Inconsistencies(Report(result).gains_robust, kAlarm), IsEmpty());
}

// The columns at the decimated states instead of the parallel-filtered ones: the signals' filter is missing from the
// model. The same draws as above, for their figures beside each other; the residual's noise is larger on every joint.
TEST(FullChain, UnfilteredColumnsLeaveMoreResidual) {
  const Chain chain(EncoderLog(), 20.0, 20);
  const int runs = Draws(24, 8, kSeed);
  const ChainResult filtered = RunChain(chain, runs, false), unfiltered = RunChain(chain, runs, true);
  ASSERT_THAT(testing::Failures(filtered.runs), IsEmpty());
  ASSERT_THAT(testing::Failures(unfiltered.runs), IsEmpty());
  Report(unfiltered);
  const VectorXd ratio =
      testing::MeanVarianceRatio(unfiltered.runs).cwiseQuotient(testing::MeanVarianceRatio(filtered.runs));
  std::cout << "residual variance, unfiltered over filtered columns: " << ratio.transpose() << "\n";
  // The same noise on both sides: what differs is the model.
  for (int j = 0; j < 6; ++j) EXPECT_GT(ratio[j], 1.01) << j + 1;
}

// Long rests, an encoder of 1e-4 rad at 100 Hz, a jittering clock: gains keep their coverage by the sandwich, biased by
// up to 0.6 of their spread (40 runs). Friction, which is not judged here, does not: biased by 5 to 12 of the
// sandwich's standard deviations.
TEST(FullChain, DwellsCoarseEncoderJitteringClock) {
  testing::Tx40Log log;
  log.rate = 100.0;
  log.duration = 60.0;
  log.clock_jitter = 0.001;
  log.noise = "{position_step: 1.0e-4, signal_percent: 15}";
  log.trajectory = "{type: point_to_point, random: 150, dwell: 1.0, speed: [0.5, 1.0]}";
  const Chain chain(log, 10.0, 4);
  const ChainResult result = RunChain(chain, Draws(40, 12, kSeed), false);
  ASSERT_THAT(testing::Failures(result.runs), IsEmpty());
  EXPECT_THAT(Inconsistencies(Report(result).gains_robust, kAlarm), IsEmpty());
}

}  // namespace
}  // namespace idim::full_chain_slow_test
