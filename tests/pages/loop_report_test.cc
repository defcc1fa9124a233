// What the reports of a closed loop say, on a loop made by hand: a power-law friction in the data of joint 2.

#include "apps/pages/loop_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/model/active_effects.h"
#include "solvers/loop/effect_curves.h"
#include "tests/support/simulated_study.h"

namespace idim::loop_report_test {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using Json = nlohmann::json;

constexpr double kFp = 4.0, kExponent = 0.4;  // added to the data
constexpr int kJoint = 1;                     // zero-based

EffectCandidate Candidate(const std::string& id, const std::vector<int>& joints, const VectorXd& shape, double gain) {
  EffectCandidate c;
  c.effect = {FindEffect(id), joints, shape};
  c.parameters = 1;
  c.score.statistic = 123.5;
  c.p_value = 1e-30;
  c.held_out_decrease = gain;
  c.held_out_error = 0.02;
  c.held_out_gain = VectorXd::Constant(8, gain);
  return c;
}

LoopErrors Errors(double identification, double validation) {
  LoopErrors errors;
  errors.identification = identification;
  errors.validation = validation;
  errors.identification_per_joint = VectorXd::Constant(3, identification);
  errors.validation_per_joint = VectorXd::Constant(3, validation);
  return errors;
}

class LoopReport : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    testing::SimulatedStudy simulated;
    simulated.Simulate();
    PreparedStudy clean = simulated.Prepare();
    // By the law itself, at the simulated motion as it was logged.
    std::vector<Recording> recordings;
    for (const MeasuredRecording& r : clean.data->recordings) {
      recordings.push_back(*r.recording);
      for (Index i = 0; i < r.states->dq.rows(); ++i) {
        const double dq = r.states->dq(i, kJoint);
        const double torque = std::copysign(kFp * std::pow(std::abs(dq), kExponent), dq);
        recordings.back().signal(i, kJoint) += torque / clean.model.gains[kJoint];
      }
    }
    Result<std::shared_ptr<const Data>> data = MakeData(clean.data->request, std::move(recordings));
    ASSERT_TRUE(data.ok()) << data.status().message();
    const PreparedStudy prepared{*data, clean.model};
    result_ = new LoopResult(prepared);
    LoopResult& result = *result_;
    result.status = Status::Ok();
    result.held_out_by_blocks = false;
    const Result<EffectFit> declared = FitDeclared(prepared);
    ASSERT_TRUE(declared.ok()) << declared.status().message();
    result.before = IdentificationOf(*declared);
    const Result<EffectFit> fit =
        Refit(*declared, {{FindEffect("power_viscous"), {kJoint}, VectorXd::Constant(1, 0.6)}});
    ASSERT_TRUE(fit.ok()) << fit.status().message();
    result.after = IdentificationOf(*fit);
    result.prepared = fit->prepared;
    const ActiveEffect active = fit->prepared.model.effects[0];
    result.after.estimate.seconds = 3.5;

    LoopStep step;
    step.effect = active;
    step.candidate = Candidate("power_viscous", {kJoint}, active.shape, 0.31);
    step.ranking = {step.candidate, Candidate("stribeck", {kJoint}, VectorXd::Constant(1, 0.2), 0.3),
                    Candidate("base_tilt", {}, VectorXd(), 0.05)};
    step.threshold = 0.01;
    step.before = Errors(9.1, 9.7);
    step.after = Errors(7.4, 7.6);
    step.confusable_with = {{{FindEffect("motor_coupling"), {0, 2}, VectorXd()}, 7.7}};
    step.moved = {{{"Fs2", ParameterKind::kFriction, 2, "N.m"}, 3.0, 2.0, 0.1}};
    result.steps = {step};
    result.declared = Errors(9.1, 9.7);
    result.final = Errors(7.4, 7.6);
    result.dropped = {"joint_spring on joint 1 was found and is not needed any more."};
    result.unexplained = {{2, {"q2", "dq3"}, 22.0, 0.005}};
  }
  static void TearDownTestSuite() {
    delete result_;
    result_ = nullptr;
  }

  static LoopResult* result_;
};

LoopResult* LoopReport::result_ = nullptr;

// What the contract fixes: keys, joints counted from one, percentages.
TEST_F(LoopReport, JsonIsTheContract) {
  const Json json = Json::parse(LoopToJson(*result_));
  EXPECT_EQ(json.at("schema"), "idim.loop.1");
  EXPECT_EQ(json.at("status"), "ok");
  EXPECT_EQ(json.at("declared").at("identification_error_percent"), 9.1);
  EXPECT_EQ(json.at("declared").at("validation_error_percent"), 9.7);
  EXPECT_THAT(json.at("declared").at("per_joint").at("identification"), ElementsAre(9.1, 9.1, 9.1));
  EXPECT_THAT(json.at("declared").at("per_joint").at("validation"), ElementsAre(9.7, 9.7, 9.7));
  EXPECT_EQ(json.at("final").at("identification_error_percent"), 7.4);
  EXPECT_EQ(json.at("final").at("validation_error_percent"), 7.6);
  EXPECT_THAT(json.at("final").at("per_joint").at("validation"), ElementsAre(7.6, 7.6, 7.6));
  EXPECT_EQ(json.at("seconds"), 3.5);

  ASSERT_EQ(json.at("steps").size(), 1u);
  const Json& step = json.at("steps").at(0);
  EXPECT_EQ(step.at("effect"), "power_viscous");
  EXPECT_THAT(step.at("joints"), ElementsAre(2));
  EXPECT_EQ(step.at("statistic"), 123.5);
  EXPECT_EQ(step.at("p_value"), 1e-30);
  EXPECT_EQ(step.at("threshold"), 0.01);
  EXPECT_EQ(step.at("error_before").at("identification"), 9.1);
  EXPECT_EQ(step.at("error_before").at("validation"), 9.7);
  EXPECT_EQ(step.at("error_after").at("identification"), 7.4);
  EXPECT_EQ(step.at("error_after").at("validation"), 7.6);
  // The linear parameter as estimated, then the shape.
  ASSERT_EQ(step.at("parameters").size(), 2u);
  const Json& fp = step.at("parameters").at(0);
  EXPECT_EQ(fp.at("name"), "Fp2");
  EXPECT_EQ(fp.at("unit"), "N.m.(s/rad)^a");
  EXPECT_NEAR(fp.at("value").get<double>(), kFp, 6.0 * fp.at("standard_deviation").get<double>());
  EXPECT_GT(fp.at("standard_deviation").get<double>(), 0.0);
  EXPECT_EQ(step.at("parameters").at(1).at("name"), "power_viscous_a_2");
  const Json& a = step.at("parameters").at(1);
  EXPECT_NEAR(a.at("value").get<double>(), kExponent, 6.0 * a.at("standard_deviation").get<double>());
  EXPECT_NEAR(a.at("value").get<double>(), step.at("shape").at(0).at("value").get<double>(),
              0.1 * a.at("standard_deviation").get<double>())
      << "a shape, not its last step";
  ASSERT_EQ(step.at("confusable_with").size(), 1u);
  const Json& rival = step.at("confusable_with").at(0);
  EXPECT_EQ(rival.at("effect"), "motor_coupling");
  EXPECT_THAT(rival.at("joints"), ElementsAre(1, 3));
  EXPECT_EQ(rival.at("held_out_error_percent"), 7.7);
  EXPECT_THAT(step.at("how_to_confirm").get<std::string>(), HasSubstr("constant speeds"));
  ASSERT_EQ(step.at("ranking").size(), 3u);
  EXPECT_EQ(step.at("ranking").at(1).at("effect"), "stribeck");
  EXPECT_EQ(step.at("ranking").at(1).at("shape").at(0).at("name"), "vs");
  EXPECT_EQ(step.at("ranking").at(1).at("shape").at(0).at("value"), 0.2);
  EXPECT_TRUE(step.at("ranking").at(2).at("joints").empty()) << "of the whole arm";
  EXPECT_EQ(step.at("moved").at(0).at("name"), "Fs2");

  ASSERT_EQ(json.at("unexplained").size(), 1u);
  const Json& left = json.at("unexplained").at(0);
  EXPECT_EQ(left.at("joint"), 3);
  EXPECT_THAT(left.at("depends_on"), ElementsAre("q2", "dq3"));
  EXPECT_EQ(left.at("share_of_residual_percent"), 22.0);
  EXPECT_EQ(left.at("p_value"), 0.005);
}

TEST_F(LoopReport, JsonOfALoopThatFailed) {
  LoopResult failed(result_->prepared);
  failed.status = Status::Untrusted("no rank");
  const Json json = Json::parse(LoopToJson(failed));
  EXPECT_EQ(json.at("status"), "untrusted");
  EXPECT_EQ(json.at("message"), "no rank");
  EXPECT_TRUE(json.at("steps").empty());
  EXPECT_TRUE(json.at("declared").at("identification_error_percent").is_null()) << "not -1 for what was not computed";
  EXPECT_THAT(LoopToText(failed), HasSubstr("NOT TO BE TRUSTED: no rank"));
  EXPECT_NE(RenderLoopReport(failed).find("Not to be trusted: no rank"), std::string::npos);
}

// The final estimate may be untrusted where the loop itself went well.
TEST_F(LoopReport, StatusIsThatOfTheFinalEstimateToo) {
  LoopResult doubtful = *result_;
  EXPECT_TRUE(StatusOf(doubtful).ok());
  doubtful.after.estimate.status = Status::Untrusted("g1 is weak");
  EXPECT_EQ(StatusOf(doubtful).message(), "g1 is weak");
  EXPECT_EQ(Json::parse(LoopToJson(doubtful)).at("message"), "g1 is weak");
}

TEST_F(LoopReport, TextSaysWhatWhereHowSureAndWhatToDo) {
  const std::string text = LoopToText(*result_);
  for (const char* part :
       {"1. power_viscous on joint 2\n", "Drive the joint at five or more constant speeds", "p = 1.0e-30",
        "falls by 31.0 +- 2.0 %", "identification 9.10 -> 7.40 % (joint 2: 9.10 -> 7.40 %)\n",
        "validation recordings 9.70 -> 7.60 %", "Fp2 = ", "motor_coupling on joints 1 and 3 (7.70 %",
        "joint_spring on joint 1 was found and is not needed",
        "joint 3 still depends on q2 and dq3: 22 % of its square, p = 5.0e-03"}) {
    EXPECT_THAT(text, HasSubstr(part));
  }
  EXPECT_THAT(text, Not(HasSubstr("Held-out blocks")));
  LoopResult blocks = *result_;
  blocks.held_out_by_blocks = true;
  EXPECT_THAT(LoopToText(blocks), HasSubstr("held-out blocks 9.70 -> 7.60 %"));
}

TEST_F(LoopReport, NothingFound) {
  LoopResult nothing = *result_;
  nothing.steps.clear();
  nothing.unexplained.clear();
  nothing.dropped.clear();
  nothing.prepared.model = WithoutEffects(nothing.prepared.model);
  nothing.after = nothing.before;
  const std::string text = LoopToText(nothing);
  EXPECT_THAT(text, HasSubstr("No effect was found"));
  EXPECT_THAT(text, Not(HasSubstr("interval")));
  EXPECT_TRUE(Json::parse(LoopToJson(nothing)).at("steps").empty());
  EXPECT_TRUE(EffectCurves(nothing).empty());
  EXPECT_EQ(RenderLoopReport(nothing).find("Friction curves"), std::string::npos);
}

// The friction that the report draws against the law that made the data, 1.5 dq + 2 sign(dq) - 0.2 + Fp |dq|^a. Noise
// of the signal 0.05 x 11 N m, halved by decimation, over more than 100 samples a side: the mean of the data is right
// to 0.03 N m, which 0.13 leaves five times over; a lost term of the friction, or one counted twice,
// is off by 0.2 or more.
TEST_F(LoopReport, FrictionCurveIsTheLawBehindTheData) {
  const std::vector<EffectCurve> curves = EffectCurves(*result_);
  ASSERT_EQ(curves.size(), 1u);
  const EffectCurve& curve = curves[0];
  EXPECT_EQ(curve.joint, kJoint);
  EXPECT_EQ(curve.over, EffectCurve::Over::kVelocity);
  EXPECT_EQ(curve.effects, "power_viscous");
  ASSERT_EQ(curve.data.size(), curve.abscissa.size());
  double sum[2] = {0.0, 0.0}, count[2] = {0.0, 0.0}, worst_model = 0.0, worst_declared = 0.0;
  for (Index k = 0; k < curve.abscissa.size(); ++k) {
    const double dq = curve.abscissa[k];
    if (std::abs(dq) < 1.0) continue;  // what a reversal at 25 rad/s^2 smears over a decimated sample of 25 ms
    const double law = 1.5 * dq + std::copysign(2.0 + kFp * std::pow(std::abs(dq), kExponent), dq) - 0.2;
    const int side = dq > 0.0;
    sum[side] += curve.data[k] - law;
    count[side] += 1.0;
    worst_model = std::max(worst_model, std::abs(curve.model[k] - law));
    worst_declared = std::max(worst_declared, std::abs(curve.declared[k] - law));
  }
  RecordProperty("worst_model", std::to_string(worst_model));
  ASSERT_GT(count[0], 100);
  ASSERT_GT(count[1], 100);
  EXPECT_NEAR(sum[0] / count[0], 0.0, 0.13);
  EXPECT_NEAR(sum[1] / count[1], 0.0, 0.13);
  EXPECT_LT(worst_model, 0.25);
  EXPECT_GT(worst_declared, worst_model) << "a line in place of the curve";
  EXPECT_EQ(curve.driving_share, 0.0);
}

// Friction that falls below zero with speed is a fit, not friction: with Fp = -50 and an exponent below one the torque
// 1.5 dq + 2 - 50 |dq|^a drives the joint at every speed of these data.
TEST_F(LoopReport, WarnsOfFrictionThatDrives) {
  EXPECT_TRUE(Json::parse(LoopToJson(*result_)).at("warnings").empty());
  EXPECT_THAT(LoopToText(*result_), Not(HasSubstr("WARNING")));
  LoopResult driving = *result_;
  for (ParameterEstimate& p : driving.after.estimate.parameters) {
    if (p.parameter.name == "Fp2") p.value = -50.0;
    if (p.parameter.name == "off2") p.value = 1e4;  // an offset is no friction of motion
  }
  EXPECT_EQ(EffectCurves(driving).at(0).driving_share, 1.0);
  EXPECT_THAT(Json::parse(LoopToJson(driving)).at("warnings").at(0).get<std::string>(),
              HasSubstr("friction of joint 2"));
  EXPECT_THAT(LoopToText(driving), HasSubstr("WARNING: The friction of joint 2"));
  EXPECT_NE(RenderLoopReport(driving).find("drives the joint at 100 %"), std::string::npos);
}

// Data and model differ by the final residual, whatever the effect and however many there are on the joint.
TEST_F(LoopReport, DataLessModelIsTheResidual) {
  LoopResult two = *result_;
  const ArmParameters arm{
      two.prepared.model.gains, VectorXd::Zero(two.prepared.base().size() + 1), {InertialVector::Zero()}};
  std::vector<ActiveEffect> effects = two.prepared.model.effects;
  effects.push_back({FindEffect("joint_spring"), {kJoint}, VectorXd(), {}});
  effects.push_back({FindEffect("motor_coupling"), {0, kJoint}, VectorXd(), {}});
  two.prepared.model = WithEffects(two.prepared, effects, MotionsOf(two.prepared, arm));
  const std::vector<EffectCurve> curves = EffectCurves(two);
  ASSERT_EQ(curves.size(), 3u);  // friction of joint 2; coupling of joint 1; spring and coupling of joint 2
  EXPECT_EQ(curves[0].over, EffectCurve::Over::kVelocity);
  EXPECT_EQ(curves[0].effects, "power_viscous");
  EXPECT_EQ(curves[1].joint, 0);
  EXPECT_EQ(curves[1].effects, "motor_coupling");
  EXPECT_EQ(curves[1].over, EffectCurve::Over::kModel);
  EXPECT_TRUE(curves[1].abscissa == curves[1].model);
  EXPECT_EQ(curves[2].effects, "joint_spring, motor_coupling");
  EXPECT_EQ(curves[2].declared.size(), 0);
  for (const EffectCurve& curve : curves) {
    Index at = 0;
    for (const RecordingSeries& s : two.after.series) {
      const VectorXd residual = s.decimated_torque.col(curve.joint) - s.decimated_model.col(curve.joint);
      EXPECT_LT(((curve.data - curve.model).segment(at, residual.size()) - residual).cwiseAbs().maxCoeff(), 1e-9);
      at += residual.size();
    }
    EXPECT_EQ(at, curve.data.size());
  }
}

TEST_F(LoopReport, PageHasEveryPart) {
  const std::string html = RenderLoopReport(*result_);
  for (const char* part :
       {"What was found", "Effect 1: power viscous on joint 2", "To confirm at the robot", "Friction curves",
        "Added parameters", "What moved when the effects were added", "What is left", "Residual over velocity",
        "Residual over position", "Residual over time in free (identification)",
        "Residual over time in check (validation)", "stribeck on joint 2", "base tilt"}) {
    EXPECT_NE(html.find(part), std::string::npos) << part;
  }
  EXPECT_TRUE(html == RenderLoopReport(*result_));
}

}  // namespace
}  // namespace idim::loop_report_test
