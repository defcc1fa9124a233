#include "solvers/judge/validation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <algorithm>
#include <nlohmann/json.hpp>

#include "apps/pages/validation_report.h"
#include "core/base/decompositions.h"
#include "tests/support/edit_data.h"
#include "tests/support/simulated_study.h"

namespace idim::validation_test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using ::testing::AllOf;
using ::testing::HasSubstr;

class ValidationTest : public ::testing::Test {
 protected:
  void SetUp() override { simulated_.Simulate(); }

  // The truth as an estimate.json would say it, in an order of its own.
  Reference Truth(const PreparedStudy& prepared, bool with_gains = true) const {
    Reference truth;
    truth.name = "truth";
    const VectorXd chi = prepared.base().projection() * simulated_.scenario.chi;
    for (int k = 0; k < prepared.base().size(); ++k) {
      truth.parameters.push_back({prepared.base().parameters()[k].name, chi[k], 0.0});
    }
    for (int k = 0; k < kNumInertial; ++k) {
      truth.parameters.push_back(
          {std::string(kStandardNames[k]) + "4", simulated_.scenario.payloads[0].inertial[k], 0});
    }
    for (int j = 0; with_gains && j < 3; ++j) {
      truth.parameters.push_back({"g" + std::to_string(j + 1), simulated_.scenario.gains[j], 0.0});
    }
    std::reverse(truth.parameters.begin(), truth.parameters.end());
    return truth;
  }

  static void Erase(const std::string& name, Reference* reference) {
    auto& p = reference->parameters;
    p.erase(std::remove_if(p.begin(), p.end(), [&](const auto& e) { return e.name == name; }), p.end());
  }

  static Validation Judge(const PreparedStudy& prepared, const Reference& estimate) {
    Result<Validation> validation = Validate(prepared, estimate);
    if (!validation.ok()) throw std::runtime_error(validation.status().message());
    return std::move(validation).value();
  }

  testing::SimulatedStudy simulated_;
};

TEST_F(ValidationTest, ParametersAreFoundByName) {
  const PreparedStudy prepared = simulated_.Prepare();
  Reference truth = Truth(prepared);
  const VectorXd chi = prepared.base().projection() * simulated_.scenario.chi;
  Result<ArmParameters> arm = ArmParametersOf(prepared, truth);
  ASSERT_TRUE(arm.ok()) << arm.status().message();
  EXPECT_EQ(arm->gains, simulated_.scenario.gains);
  EXPECT_EQ(arm->chi, chi);
  ASSERT_EQ(arm->payloads.size(), 1u);
  EXPECT_EQ(arm->payloads[0], simulated_.scenario.payloads[0].inertial);

  // Not essential: zero. The weighed mass is the study's, whatever the estimate says.
  Erase("Fv2", &truth), Erase("MX4", &truth);
  for (auto& entry : truth.parameters) entry.value *= entry.name == "M4" ? 2.0 : 1.0;
  arm = ArmParametersOf(prepared, truth);
  ASSERT_TRUE(arm.ok());
  for (int k = 0; k < prepared.base().size(); ++k) {
    EXPECT_EQ(arm->chi[k], prepared.base().parameters()[k].name == "Fv2" ? 0.0 : chi[k]);
  }
  EXPECT_EQ(arm->payloads[0][kMX], 0.0);
  EXPECT_EQ(arm->payloads[0][kM], 3.0);
  EXPECT_EQ(arm->payloads[0][kMY], simulated_.scenario.payloads[0].inertial[kMY]);

  // Without gains: the study's.
  arm = ArmParametersOf(prepared, Truth(prepared, false));
  ASSERT_TRUE(arm.ok());
  EXPECT_EQ(arm->gains, prepared.model.gains);
}

TEST_F(ValidationTest, WhatDoesNotFitTheStudyIsRefusedByName) {
  const PreparedStudy prepared = simulated_.Prepare();
  Reference partial = Truth(prepared);
  Erase("g2", &partial);
  EXPECT_THAT(ArmParametersOf(prepared, partial).status().message(),
              AllOf(HasSubstr("'truth'"), HasSubstr("2 drive gains"), HasSubstr("3 or none")));
  Reference foreign = Truth(prepared);
  foreign.parameters.push_back({"Fv33", 1.0, 0.0});
  EXPECT_THAT(ArmParametersOf(prepared, foreign).status().message(), AllOf(HasSubstr("'Fv33'"), HasSubstr("'Fv3'")));
  Reference other = Truth(prepared);
  other.robot = "four";
  EXPECT_THAT(ArmParametersOf(prepared, other).status().message(), AllOf(HasSubstr("'four'"), HasSubstr("'three'")));
  other.robot = "three";
  EXPECT_TRUE(ArmParametersOf(prepared, other).ok());
  Reference gains_only;
  gains_only.name = "gains";
  gains_only.parameters = {{"g1", 1, 0}, {"g2", 1, 0}, {"g3", 1, 0}};
  EXPECT_THAT(ArmParametersOf(prepared, gains_only).status().message(), HasSubstr("none of the base parameters"));

  PreparedStudy identify = simulated_.Prepare();
  identify.model.gains_mode = GainsMode::kIdentify;
  const Status neither = ArmParametersOf(identify, Truth(prepared, false)).status();
  EXPECT_EQ(neither.code(), StatusCode::kBadInput);
  EXPECT_THAT(neither.message(), AllOf(HasSubstr("no drive gains"), HasSubstr("gains.mode")));
  EXPECT_TRUE(ArmParametersOf(identify, Truth(prepared)).ok());

  PreparedStudy none = simulated_.Prepare();
  testing::KeepRecordings({0, 1}, &none);
  EXPECT_THAT(Validate(none, Truth(prepared)).status().message(), HasSubstr("no recording has use 'validation'"));
}

// "MX4" is of the payload that the study identifies; with two of them only "MX4_big" tells which.
TEST_F(ValidationTest, PayloadParametersBelongToTheirPayload) {
  testing::ReplaceOnce("payloads:\n", "payloads:\n  small: {M: 1}\n", &simulated_.study_text);
  PreparedStudy prepared = simulated_.Prepare();
  ASSERT_EQ(prepared.model.payloads.size(), 2u);
  const Reference plain = Truth(prepared);
  Reference named = plain;
  for (auto& entry : named.parameters) {
    if (entry.name != "M4" && entry.name.back() == '4') entry.name += "_big";
  }
  const int big = prepared.model.payloads[0].name == "big" ? 0 : 1;
  const InertialVector truth = simulated_.scenario.payloads[0].inertial;
  for (const Reference& reference : {plain, named}) {
    const Result<ArmParameters> arm = ArmParametersOf(prepared, reference);
    ASSERT_TRUE(arm.ok()) << arm.status().message();
    EXPECT_EQ(arm->payloads[big], truth);
    EXPECT_EQ(arm->payloads[1 - big], InertialVector(InertialVector::Zero())) << "nothing is known of the other";
  }
  prepared.model.roles.push_back({Use::kIdentification, 1 - big});
  prepared.model.columns = std::make_shared<const EffectColumns>(EffectColumns{{}, {{}, {}, {}, {}}});
  EXPECT_EQ((*ArmParametersOf(prepared, plain)).payloads[big], InertialVector(InertialVector::Zero()));
  EXPECT_EQ((*ArmParametersOf(prepared, named)).payloads[big], truth);
}

TEST_F(ValidationTest, TheTruthLeavesNoiseAndWeighsThePayload) {
  const PreparedStudy prepared = simulated_.Prepare();
  const Validation v = Judge(prepared, Truth(prepared));
  ASSERT_EQ(v.recordings.size(), 1u);
  const ValidationOfRecording& r = v.recordings[0];
  EXPECT_EQ(r.name, "check");
  EXPECT_EQ(r.payload, "big");
  ASSERT_TRUE(r.fit);
  // 2000 samples: 1 / sqrt(4000) = 1.6 % of a standard deviation; five of them, and 3 % for friction's reversals.
  for (int j = 0; j < 3; ++j) {
    const double noise = std::abs(simulated_.scenario.gains[j]) * simulated_.scenario.noise.signal[j];
    EXPECT_NEAR(r.fit->rms_torque_unfiltered[j] / noise, 1.0, 0.08 + 0.03) << j;
  }
  ASSERT_TRUE(r.mass);
  EXPECT_EQ(r.mass->weighed, 3.0);
  EXPECT_LT(r.mass->standard_deviation, 0.1);
  // Four standard deviations: false alarm 6e-5.
  EXPECT_NEAR(r.mass->value, 3.0, 4.0 * r.mass->standard_deviation);
  EXPECT_NEAR(*r.mass->ErrorPercent(), 100.0 * std::abs(3.0 - r.mass->value) / 3.0, 1e-12);

  // Condition number: the whole matrix, by SVD.
  const MeasuredRecording& recording = prepared.data->recordings[2];
  StandardModel model = prepared.base().model();
  MatrixXd w(3 * recording.decimator->outputs(), prepared.base().size());
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> rows(3, model.columns());
  MatrixXd columns(recording.recording->samples(), 3 * prepared.base().size());
  VectorXd q, dq, ddq;
  for (Eigen::Index i = 0; i < columns.rows(); ++i) {
    q = recording.states->q.row(i), dq = recording.states->dq.row(i), ddq = recording.states->ddq.row(i);
    model.Regressor(q.data(), dq.data(), ddq.data(), prepared.data->velocity_sigma.data(), rows.data());
    for (int j = 0; j < 3; ++j) {
      for (int k = 0; k < prepared.base().size(); ++k) {
        columns(i, j * prepared.base().size() + k) = rows(j, prepared.base().kept()[k]);
      }
    }
  }
  const MatrixXd decimated = recording.decimator->Apply(columns);
  const Eigen::Index columns_each = prepared.base().size();
  for (Eigen::Index j = 0; j < 3; ++j) {
    w.middleRows(j * decimated.rows(), decimated.rows()) = decimated.middleCols(j * columns_each, columns_each);
  }
  const VectorXd s = Eigen::JacobiSVD<MatrixXd>(w).singularValues();
  EXPECT_NEAR(r.condition_number, s[0] / s[s.size() - 1], 1e-6 * r.condition_number);
}

// Torque is proportional to the gains, and so is everything that is identified from it.
TEST_F(ValidationTest, GainsWrongByAFactorMakeTheMassWrongByIt) {
  const PreparedStudy prepared = simulated_.Prepare();
  const MassEstimate right = *Judge(prepared, Truth(prepared)).recordings[0].mass;
  for (const double k : {1.7, 0.01}) {
    Reference scaled = Truth(prepared);
    for (auto& entry : scaled.parameters) entry.value *= entry.name[0] == 'g' ? k : 1.0;
    const MassEstimate wrong = *Judge(prepared, scaled).recordings[0].mass;
    EXPECT_NEAR(wrong.value, k * right.value, 1e-9 * k);
    EXPECT_NEAR(wrong.standard_deviation, k * right.standard_deviation, 1e-9 * k);
  }
  // Only this recording's payload and the gains count, not the estimate's own parameters.
  Reference other = Truth(prepared);
  for (auto& entry : other.parameters) entry.value *= entry.name[0] == 'g' ? 1.0 : 3.0;
  EXPECT_EQ(Judge(prepared, other).recordings[0].mass->value, right.value);
}

TEST_F(ValidationTest, WhatIsNotKnownIsAbsent) {
  // Nothing of the payload in study or estimate: no fit, but a mass, of which nothing is weighed.
  testing::ReplaceOnce("big: {M: 3}", "big: {}", &simulated_.study_text);
  const PreparedStudy prepared = simulated_.Prepare();
  Reference arm_only = Truth(prepared);
  for (const char* name : kStandardNames) Erase(std::string(name) + "4", &arm_only);
  const Validation v = Judge(prepared, arm_only);
  EXPECT_FALSE(v.recordings[0].fit);
  EXPECT_TRUE(v.series.empty());
  ASSERT_TRUE(v.recordings[0].mass);
  EXPECT_FALSE(v.recordings[0].mass->weighed);
  EXPECT_FALSE(v.recordings[0].mass->ErrorPercent());
  const auto json = nlohmann::json::parse(ValidationToJson("three", {v}));
  const auto& r = json.at("estimates").at(0).at("recordings").at(0);
  EXPECT_TRUE(r.at("relative_error_percent").is_null());
  EXPECT_TRUE(r.at("mass_weighed").is_null());
  EXPECT_TRUE(r.at("mass_error_percent").is_null());
  EXPECT_DOUBLE_EQ(r.at("mass").get<double>(), v.recordings[0].mass->value);
  EXPECT_THAT(ValidationToText({v}), ::testing::Not(HasSubstr("Table VI)")));

  // No unloaded recording: arm and payload cannot be told apart.
  PreparedStudy loaded = prepared;
  testing::KeepRecordings({1, 2}, &loaded);
  EXPECT_FALSE(Judge(loaded, Truth(prepared)).recordings[0].mass);
  // No payload: nothing to weigh, and a fit that needs none.
  PreparedStudy bare = prepared;
  bare.model.roles[2].payload = -1;
  EXPECT_FALSE(Judge(bare, arm_only).recordings[0].mass);
  EXPECT_TRUE(Judge(bare, arm_only).recordings[0].fit);
}

TEST_F(ValidationTest, AnUntrustedEstimateIsJudgedWithAWarning) {
  const PreparedStudy prepared = simulated_.Prepare();
  Reference doubtful = Truth(prepared);
  doubtful.warning = "g1 is weak";
  const Validation v = Judge(prepared, doubtful);
  EXPECT_THAT(ValidationToText({v}), HasSubstr("truth is not to be trusted: g1 is weak"));
  EXPECT_THAT(RenderValidationReport(prepared.robot(), {v}), HasSubstr("truth is not to be trusted: g1 is weak"));
  EXPECT_EQ(nlohmann::json::parse(ValidationToJson("three", {v})).at("estimates").at(0).at("warning"), "g1 is weak");
}

}  // namespace
}  // namespace idim::validation_test
