// The main job on a simulated arm, against dense matrices that the test builds by another route.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/QR>
#include <cmath>
#include <fstream>
#include <sstream>

#include "core/base/decompositions.h"
#include "core/model/unknowns.h"
#include "solvers/estimators/closed_forms.h"
#include "solvers/estimators/estimators.h"
#include "tests/support/edit_data.h"
#include "tests/support/simulated_study.h"

namespace idim::identification_test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using ::testing::AllOf;
using ::testing::HasSubstr;

const ParameterEstimate* Find(const Estimate& estimate, const std::string& name) {
  for (const ParameterEstimate& p : estimate.parameters) {
    if (p.parameter.name == name) return &p;
  }
  return nullptr;
}

// Rows of one joint over all identification recordings, whole: W of base parameters and of the payload's ten, and the
// decimated signals. Columns at the recorded instants first, then the decimator: not the streaming of the library.
struct Dense {
  MatrixXd base, payload, signal;
};

Dense DenseRows(const PreparedStudy& prepared, int joint) {
  StandardModel model = prepared.base().model();
  const int n = model.dof();
  Dense all;
  for (const MeasuredRecording& r : prepared.data->recordings) {
    if (r.entry.use != Use::kIdentification) continue;
    const Eigen::Index samples = r.recording->samples();
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> w(n, model.columns()), load(n, 10);
    MatrixXd base(samples, prepared.base().size()), payload = MatrixXd::Zero(samples, 10);
    VectorXd q, dq, ddq;
    for (Eigen::Index i = 0; i < samples; ++i) {
      q = r.states->q.row(i), dq = r.states->dq.row(i), ddq = r.states->ddq.row(i);
      model.Regressor(q.data(), dq.data(), ddq.data(), prepared.data->velocity_sigma.data(), w.data());
      for (int k = 0; k < prepared.base().size(); ++k) base(i, k) = w(joint, prepared.base().kept()[k]);
      if (r.entry.payload < 0) continue;
      model.PayloadColumns(load.data());
      payload.row(i) = load.row(joint);
    }
    const auto append = [](const MatrixXd& rows, MatrixXd* to) {
      MatrixXd longer(to->rows() + rows.rows(), rows.cols());
      if (to->rows() > 0) longer.topRows(to->rows()) = *to;
      longer.bottomRows(rows.rows()) = rows;
      *to = longer;
    };
    append(r.decimator->Apply(base), &all.base);
    append(r.decimator->Apply(payload), &all.payload);
    append(r.decimator->Apply(r.recording->signal), &all.signal);
  }
  return all;
}

struct DenseSolution {
  VectorXd values, standard_deviation;
};

DenseSolution Solve(const MatrixXd& w, const VectorXd& y) {
  const Eigen::HouseholderQR<MatrixXd> qr(w);
  DenseSolution solution;
  solution.values = qr.solve(y);
  const double s2 = (y - w * solution.values).squaredNorm() / static_cast<double>(w.rows() - w.cols());
  const MatrixXd inverse = (w.transpose() * w).inverse();
  solution.standard_deviation = (s2 * inverse.diagonal()).cwiseSqrt();
  return solution;
}

void ExpectSame(const Estimate& estimate, const DenseSolution& dense) {
  ASSERT_EQ(static_cast<Eigen::Index>(estimate.parameters.size()), dense.values.size());
  for (Eigen::Index k = 0; k < dense.values.size(); ++k) {
    const ParameterEstimate& p = estimate.parameters[static_cast<size_t>(k)];
    EXPECT_NEAR(p.value, dense.values[k], 1e-5 * dense.standard_deviation[k]) << p.parameter.name;
    EXPECT_NEAR(p.standard_deviation, dense.standard_deviation[k], 1e-5 * dense.standard_deviation[k])
        << p.parameter.name;
  }
}

class IdentificationTest : public ::testing::Test {
 protected:
  void IdentifyGainsInStudy() { testing::ReplaceOnce("mode: known", "mode: identify", &simulated_.study_text); }

  static Identification Run(const PreparedStudy& prepared, const std::string& estimator, double ratio = 0.0) {
    const Result<EstimatorRunner> runner = EstimatorRunner::Create(&prepared);
    if (!runner.ok()) throw std::runtime_error(runner.status().message());
    Result<Identification> identification = runner->Run(estimator, ratio);
    if (!identification.ok()) throw std::runtime_error(identification.status().message());
    return std::move(identification).value();
  }

  testing::SimulatedStudy simulated_;
};

// noise.signal and a transmission that mixes motors: the weight of a joint is what its motors' noise makes together,
// 1 / sqrt(sum_m (T_mj g_m s_m)^2). The known mass goes to the side of the torque.
TEST_F(IdentificationTest, APrioriNoiseOfMotorsWeighsTheRowsOfJoints) {
  simulated_.robot += "transmission: [[2, 0, 0], [0.5, -3, 0], [0, 1.5, 4]]\n";
  simulated_.scenario_text += "signal_side: motor\n";
  simulated_.Simulate();
  const double s[] = {0.3, 0.01, 0.2};  // not the true ones, so that other weights would show
  simulated_.study_text += "noise: {signal: [0.3, 0.01, 0.2]}\n";
  const PreparedStudy prepared = simulated_.Prepare();
  ASSERT_EQ(prepared.data->request.signal_side, Side::kMotor);
  const MatrixXd t = prepared.robot().transmission;
  const VectorXd g = prepared.model.gains;
  const int m = static_cast<int>(kM);
  for (const bool weighted : {true, false}) {
    MatrixXd w;
    VectorXd y;
    for (int j = 0; j < 3; ++j) {
      const Dense rows = DenseRows(prepared, j);
      double variance = 0.0;
      VectorXd torque = VectorXd::Zero(rows.base.rows());
      for (int motor = 0; motor < 3; ++motor) {
        torque += t(motor, j) * g[motor] * rows.signal.col(motor);
        variance += std::pow(t(motor, j) * g[motor] * s[motor], 2);
      }
      torque -= 3.0 * rows.payload.col(m);
      const double weight = weighted ? 1.0 / std::sqrt(variance) : 1.0;
      if (w.size() == 0) w.resize(3 * rows.base.rows(), rows.base.cols() + 9), y.resize(w.rows());
      w.middleRows(j * rows.base.rows(), rows.base.rows()) << weight * rows.base, weight * rows.payload.leftCols(9);
      y.segment(j * rows.base.rows(), rows.base.rows()) = weight * torque;
    }
    static_assert(kM == 9, "the nine unknown payload parameters come first");
    const Identification found = Run(prepared, weighted ? "wls" : "ls");
    ASSERT_TRUE(found.estimate.status.ok()) << found.estimate.status.message();
    ExpectSame(found.estimate, Solve(w, y));
  }
}

// Gains by ordinary LS, motor side: tau_j = sum_m T_mj g_m v_m on one side, the known mass's torque on the other.
TEST_F(IdentificationTest, GainsOfMotorsAreThoseOfTheDenseSystem) {
  simulated_.robot += "transmission: [[2, 0, 0], [0.5, -3, 0], [0, 1.5, 4]]\n";
  simulated_.scenario_text += "signal_side: motor\n";
  simulated_.Simulate();
  IdentifyGainsInStudy();
  const PreparedStudy prepared = simulated_.Prepare();
  const MatrixXd t = prepared.robot().transmission;
  MatrixXd w;
  VectorXd y;
  for (int j = 0; j < 3; ++j) {
    const Dense rows = DenseRows(prepared, j);
    const Eigen::Index count = rows.base.rows();
    if (w.size() == 0) w.resize(3 * count, 3 + rows.base.cols() + 9), y.resize(w.rows());
    for (int motor = 0; motor < 3; ++motor)
      w.col(motor).segment(j * count, count) = t(motor, j) * rows.signal.col(motor);
    w.middleRows(j * count, count).rightCols(w.cols() - 3) << -rows.base, -rows.payload.leftCols(9);
    y.segment(j * count, count) = 3.0 * rows.payload.col(kM);
  }
  const Identification found = Run(prepared, "ls");
  ASSERT_TRUE(found.estimate.status.ok()) << found.estimate.status.message();
  ExpectSame(found.estimate, Solve(w, y));
}

// With a diagonal transmission the motors' signals times T_jj are joint signals: every estimator must give the same
// gains from either file, and the signal noise of the motor side is that of the joint side divided by T_jj.
TEST_F(IdentificationTest, MotorSideEqualsJointSideMappedByHand) {
  simulated_.robot += "transmission: [[2, 0, 0], [0, -3, 0], [0, 0, 4]]\n";
  simulated_.scenario_text += "signal_side: motor\n";
  simulated_.Simulate();
  IdentifyGainsInStudy();
  const PreparedStudy motor = simulated_.Prepare();
  PreparedStudy joint = motor;
  testing::EditRecordings(&joint, [](Recording* r, JointStates*) {
    r->signal.col(0) *= 2.0, r->signal.col(1) *= -3.0, r->signal.col(2) *= 4.0;
  });
  testing::EditData(&joint, [](Data* data) { data->drive = DriveMap(data->robot(), Side::kJoint); });
  for (const std::string& name : EstimatorNames(GainsMode::kIdentify)) {
    if (name == "tls" || name == "wtls") continue;  // one noise for all columns: not invariant to the unit of a signal
    const Estimate a = Run(motor, name).estimate, b = Run(joint, name).estimate;
    ASSERT_FALSE(a.parameters.empty()) << name << ": " << a.status.message();
    ASSERT_EQ(a.parameters.size(), b.parameters.size());
    for (size_t k = 0; k < a.parameters.size(); ++k) {
      EXPECT_NEAR(a.parameters[k].value, b.parameters[k].value, 1e-6 * b.parameters[k].standard_deviation) << name;
    }
    const double t[] = {2.0, 3.0, 4.0};
    for (int j = 0; j < 3; ++j) EXPECT_NEAR(a.signal_noise[j] * t[j], b.signal_noise[j], 1e-6 * b.signal_noise[j]);
  }
}

// Little noise: every estimator is at the truth, which sits in the gains, the parameters and the payload alike. LS
// shrinks a gain by known_share, which is near 1 here.
TEST_F(IdentificationTest, EveryEstimatorFindsTheTruth) {
  testing::ReplaceOnce("signal: [0.02, 0.05, 0.1]", "signal: [2.0e-5, 5.0e-5, 1.0e-4]", &simulated_.scenario_text);
  testing::ReplaceOnce("position: 1.0e-6", "position: 1.0e-8", &simulated_.scenario_text);
  simulated_.Simulate();
  IdentifyGainsInStudy();
  const PreparedStudy prepared = simulated_.Prepare();
  const VectorXd chi = prepared.base().projection() * simulated_.scenario.chi;
  for (const std::string& name : EstimatorNames(GainsMode::kIdentify)) {
    const Identification found = Run(prepared, name);
    EXPECT_EQ(found.estimate.estimator, name);
    ASSERT_EQ(found.estimate.parameters.size(), static_cast<size_t>(3 + chi.size() + 9)) << name;
    // The instants of friction's reversals, known to a sample, are the error here: 5 % of a gain at the most.
    for (int j = 0; j < 3; ++j) {
      EXPECT_NEAR(found.estimate.parameters[j].value / simulated_.scenario.gains[j], 1.0, 0.05)
          << name << " g" << j + 1;
    }
    EXPECT_LT(found.estimate.relative_error_percent, 2.0) << name;
    EXPECT_EQ(found.estimate.recordings.size(), 3u);
    EXPECT_EQ(found.estimate.gain_diagnoses.size(), 3u);
    EXPECT_EQ(found.estimate.singular_values.size() > 0, name.find("tls") != std::string::npos) << name;
  }
}

// A priori noise of the signals is the noise of the gains' columns in scaled total least squares: of it only ratios
// count, and without it the data decide.
TEST_F(IdentificationTest, APrioriNoiseScalesTheColumnsOfTheGains) {
  simulated_.Simulate();
  IdentifyGainsInStudy();
  const std::string plain = simulated_.study_text;
  simulated_.study_text = plain + "noise: {signal: [0.02, 0.05, 0.1]}\n";
  const PreparedStudy prepared = simulated_.Prepare();
  simulated_.study_text = plain + "noise: {signal: [0.2, 0.5, 1.0]}\n";
  const PreparedStudy tenfold = simulated_.Prepare();
  simulated_.study_text = plain + "noise: {signal: [2.0, 0.05, 0.1]}\n";
  const PreparedStudy other = simulated_.Prepare();
  const Estimate found = Run(prepared, "gtls").estimate;
  const Estimate same = Run(tenfold, "gtls").estimate;
  const Estimate different = Run(other, "gtls").estimate;

  // By hand: on the joint side the noise of a signal is in its own joint's rows.
  const Result<GainSystem> system = BuildGainSystem(prepared);
  ASSERT_TRUE(system.ok());
  GainOptions options;
  options.estimator = GainEstimator::kGtls;
  options.column_noise = MatrixXd::Zero(3, static_cast<Eigen::Index>(system->unknowns.size()) + 1);
  options.column_noise.leftCols(3).diagonal() << 0.02, 0.05, 0.1;
  const GainSummary summary = SolveGains(*system, options);
  ASSERT_EQ(static_cast<Eigen::Index>(found.parameters.size()), summary.values.size());
  double moved = 0.0;
  for (size_t k = 0; k < found.parameters.size(); ++k) {
    const double sigma = found.parameters[k].standard_deviation;
    EXPECT_NEAR(found.parameters[k].value, summary.values[static_cast<Eigen::Index>(k)], 1e-9 * sigma);
    EXPECT_NEAR(found.parameters[k].value, same.parameters[k].value, 1e-5 * sigma);
    moved = std::max(moved, std::abs(found.parameters[k].value - different.parameters[k].value) / sigma);
  }
  EXPECT_GT(moved, 0.01) << "the key has an effect";
}

TEST_F(IdentificationTest, UntrustedGainsComeWithTheirNumbers) {
  simulated_.Simulate();
  IdentifyGainsInStudy();
  testing::ReplaceOnce("values: [20, -11, 5]", "values: [20, 11, 5]", &simulated_.study_text);
  const PreparedStudy prepared = simulated_.Prepare();
  const Identification found = Run(prepared, "wgtls");
  EXPECT_EQ(found.estimate.status.code(), StatusCode::kUntrusted);
  EXPECT_THAT(found.estimate.status.message(), AllOf(HasSubstr("g2"), HasSubstr("opposite sign")));
  ASSERT_NE(Find(found.estimate, "g2"), nullptr);
  EXPECT_LT(Find(found.estimate, "g2")->value, 0.0);
  EXPECT_EQ(found.series.size(), 3u);
}

// Parameters of the estimate and eliminated ones are all there are, and none is both.
TEST_F(IdentificationTest, EliminatedParametersAreNotAmongTheEstimates) {
  simulated_.Simulate();
  for (const bool identify : {false, true}) {
    if (identify) IdentifyGainsInStudy();
    const PreparedStudy prepared = simulated_.Prepare();
    const Estimate e = Run(prepared, "wls", 20.0).estimate;
    ASSERT_FALSE(e.eliminated.empty());
    EXPECT_EQ(e.parameters.size() + e.eliminated.size(),
              static_cast<size_t>(prepared.base().size() + 9 + (identify ? 3 : 0)));
    EXPECT_EQ(e.covariance.rows(), static_cast<Eigen::Index>(e.parameters.size()));
    for (const std::string& name : e.eliminated) EXPECT_EQ(Find(e, name), nullptr) << name;
    for (size_t k = 0; k < e.parameters.size(); ++k) {
      const auto i = static_cast<Eigen::Index>(k);
      EXPECT_DOUBLE_EQ(std::sqrt(e.covariance(i, i)), e.parameters[k].standard_deviation);
    }
    // The relation belongs to its own parameter.
    for (int k = 0; k < prepared.base().size(); ++k) {
      const ParameterEstimate* p = Find(e, prepared.base().parameters()[k].name);
      if (p != nullptr) {
        EXPECT_EQ(p->regrouping, prepared.base().regroupings()[k]);
      }
    }
  }
}

TEST_F(IdentificationTest, AValidationPayloadThatNothingTells) {
  simulated_.Simulate();
  testing::ReplaceOnce("load.csv, name: load, payload: big", "load.csv, name: load", &simulated_.study_text);
  const PreparedStudy prepared = simulated_.Prepare();
  const Result<Identification> found = IdentifyLinear(prepared, LinearOptions());
  ASSERT_FALSE(found.ok());
  EXPECT_THAT(found.status().message(), AllOf(HasSubstr("'check'"), HasSubstr("'big'"), HasSubstr("all ten")));
}

TEST_F(IdentificationTest, EstimatorsByName) {
  EXPECT_THAT(EstimatorNames(GainsMode::kKnown), ::testing::ElementsAre("ls", "wls", "eiv"));
  EXPECT_THAT(EstimatorNames(GainsMode::kIdentify),
              ::testing::ElementsAre("ls", "wls", "tls", "wtls", "gtls", "wgtls", "eiv"));
  simulated_.Simulate();
  PreparedStudy prepared = simulated_.Prepare();
  const Result<EstimatorRunner> known = EstimatorRunner::Create(&prepared);
  ASSERT_TRUE(known.ok());
  const Result<Identification> tls = known->Run("tls", 0.0);
  ASSERT_FALSE(tls.ok());
  EXPECT_EQ(tls.status().code(), StatusCode::kBadInput);
  EXPECT_THAT(tls.status().message(), AllOf(HasSubstr("--estimator=tls"), HasSubstr("known"), HasSubstr("ls, wls")));
  EXPECT_THAT(known->Run("ls", 0.5).status().message(), HasSubstr("--r_sigma"));
  // What was asked for is what ran: ls and wls differ here.
  const Result<Identification> ls = known->Run("ls", 0.0), wls = known->Run("wls", 0.0);
  ASSERT_TRUE(ls.ok() && wls.ok());
  LinearOptions options;
  options.weighted = false;
  const Result<Identification> direct = IdentifyLinear(prepared, options);
  EXPECT_EQ(ls->estimate.parameters[0].value, direct->estimate.parameters[0].value);
  EXPECT_NE(ls->estimate.parameters[0].value, wls->estimate.parameters[0].value);

  prepared.model.gains_mode = GainsMode::kIdentify;
  const Result<EstimatorRunner> identify = EstimatorRunner::Create(&prepared);
  ASSERT_TRUE(identify.ok());
  EXPECT_THAT(identify->Run("eiv2", 0.0).status().message(), HasSubstr("ls, wls, tls, wtls, gtls, wgtls"));
  EXPECT_THAT(identify->Run("tls", 0.5).status().message(), HasSubstr("--r_sigma"));
}

}  // namespace
}  // namespace idim::identification_test
