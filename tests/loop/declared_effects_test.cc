#include "solvers/loop/declared_effects.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/estimate/estimate_json.h"
#include "core/model/active_effects.h"
#include "solvers/estimators/estimators.h"
#include "solvers/judge/monte_carlo.h"
#include "solvers/judge/validation.h"
#include "solvers/loop/effect_scan.h"
#include "tests/support/simulated_study.h"

namespace idim::testing::declared_effects_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

// A Stribeck effect on joint 2, a large load friction on joint 1.
constexpr char kTrueEffects[] =
    "effects:\n"
    "  - {id: stribeck, joints: [2], Fst: 1.5, vs: 0.3}\n"
    "  - {id: load_friction, joints: [1], mu: 0.06}\n";
const std::map<std::string, double> kTruth = {{"Fst2", 1.5}, {"stribeck_vs_2", 0.3}, {"Fl1", 0.06}};
constexpr char kBoth[] = "effects: [{id: stribeck, joints: [2]}, {id: load_friction, joints: [1]}]\n";

const SimulatedStudy& Arm() {
  static const SimulatedStudy* const arm = [] {
    auto* study = new SimulatedStudy;
    ReplaceOnce("recordings:\n", std::string(kTrueEffects) + "recordings:\n", &study->scenario_text);
    study->Simulate();
    return study;
  }();
  return *arm;
}

PreparedStudy PreparedWith(const std::string& keys,
                           const std::vector<std::pair<std::string, std::string>>& changes = {}) {
  std::string text = Arm().study_text + keys;
  for (const auto& [from, to] : changes) ReplaceOnce(from, to, &text);
  const Result<Study> study = ReadStudy(Arm().folder.Write("with.yaml", text));
  if (!study.ok()) throw std::runtime_error(study.status().message());
  Result<PreparedStudy> prepared = PrepareStudy(*study);
  if (!prepared.ok()) throw std::runtime_error(prepared.status().message());
  return std::move(prepared).value();
}

Estimate EstimateOf(const PreparedStudy& plain, const std::string& estimator, double r_sigma = 0.0) {
  const Result<PreparedStudy> prepared = DeclareEffects(plain);
  if (!prepared.ok()) throw std::runtime_error(prepared.status().message());
  const Result<EstimatorRunner> runner = EstimatorRunner::Create(&*prepared);
  if (!runner.ok()) throw std::runtime_error(runner.status().message());
  Result<Identification> result = runner->Run(estimator, r_sigma);
  if (!result.ok()) throw std::runtime_error(result.status().message());
  return result->estimate;
}

Reference RoundTrip(const Estimate& estimate) {
  const Result<Reference> reference = ReadReference(Arm().folder.Write("estimate.json", EstimateToJson(estimate)));
  if (!reference.ok()) throw std::runtime_error(reference.status().message());
  return *reference;
}

// Tolerance of 4.5 standard deviations (false alarm 1e-5 a value); Fst2 without its load on the right joint, or a shape
// of which the step is stated, is off by more than 20.
void ExpectTruth(const Estimate& with) {
  ASSERT_TRUE(with.status.ok()) << with.status.message();
  for (const auto& [name, truth] : kTruth) {
    const ParameterEstimate* p = with.Find(name);
    ASSERT_NE(p, nullptr) << with.estimator << " " << name;
    EXPECT_STREQ(ParameterKindName(p->parameter.kind), "effect") << name;
    EXPECT_NEAR(p->value, truth, 4.5 * p->standard_deviation) << with.estimator << " " << name;
    EXPECT_LT(p->standard_deviation, 0.1 * std::abs(truth)) << with.estimator << " " << name;
    EXPECT_NEAR(0.5 * (p->interval95[0] + p->interval95[1]), p->value, 1e-9) << with.estimator << " " << name;
  }
}

TEST(DeclaredEffects, EveryEstimatorFindsTheTruthAndALowerError) {
  for (const std::string estimator : {"ls", "wls", "eiv"}) {
    const Estimate with = EstimateOf(PreparedWith(kBoth), estimator);
    const Estimate without = EstimateOf(PreparedWith(""), estimator);
    ExpectTruth(with);
    ASSERT_EQ(with.recordings.size(), without.recordings.size());
    for (size_t r = 0; r < with.recordings.size(); ++r) {
      for (const int j : {0, 1}) {
        EXPECT_LT(with.recordings[r].relative_error_percent[j], 0.8 * without.recordings[r].relative_error_percent[j])
            << estimator << " " << with.recordings[r].name << " joint " << j + 1;
      }
    }
  }
}

TEST(DeclaredEffects, GainsAreIdentifiedWithThem) {
  const PreparedStudy plain = PreparedWith(kBoth, {{"mode: known", "mode: identify"}});
  for (const std::string estimator : {"wgtls", "eiv"}) {
    const Estimate with = EstimateOf(plain, estimator);
    ExpectTruth(with);
    const double gains[] = {20.0, -11.0, 5.0};
    for (int j = 0; j < 3; ++j) {
      const ParameterEstimate* gain = with.Find("g" + std::to_string(j + 1));
      ASSERT_NE(gain, nullptr);
      EXPECT_NEAR(gain->value, gains[j], 4.5 * gain->standard_deviation) << estimator;
    }
  }
}

// Torque itself logged: the same equations.
TEST(DeclaredEffects, TorqueInPlaceOfSignalsIsTheSame) {
  const std::string torque =
      "columns: {tau1: {column: v1, scale: 20}, tau2: {column: v2, scale: -11}, tau3: {column: v3, scale: 5}}\n";
  const PreparedStudy logged = PreparedWith(kBoth + torque, {{"values: [20, -11, 5]", "values: [1, 1, 1]"}});
  ASSERT_TRUE(logged.data->recordings[0].recording->signal_is_torque);
  const Estimate a = EstimateOf(PreparedWith(kBoth), "wls"), b = EstimateOf(logged, "wls");
  ASSERT_EQ(a.parameters.size(), b.parameters.size());
  for (size_t k = 0; k < a.parameters.size(); ++k) {
    EXPECT_NEAR(a.parameters[k].value, b.parameters[k].value, 1e-4 * a.parameters[k].standard_deviation);
  }
}

// From the same start, the minimum that the loop's own steps find.
TEST(DeclaredEffects, EivIsRefitByHand) {
  const PreparedStudy plain =
      PreparedWith("effects: [{id: stribeck, joints: [2], shape: {vs: 0.45}}, {id: load_friction, joints: [1]}]\n");
  const Estimate declared = EstimateOf(plain, "eiv");
  const Result<EffectFit> without = FitDeclared(plain);
  ASSERT_TRUE(without.ok()) << without.status().message();
  const Result<EffectFit> with = Refit(*without, {{FindEffect("stribeck"), {1}, Eigen::VectorXd::Constant(1, 0.45)},
                                                  {FindEffect("load_friction"), {0}, Eigen::VectorXd()}});
  ASSERT_TRUE(with.ok()) << with.status().message();
  const Estimate by_hand = IdentificationOf(*with).estimate;
  ASSERT_EQ(declared.parameters.size(), by_hand.parameters.size());
  for (size_t k = 0; k < by_hand.parameters.size(); ++k) {
    const ParameterEstimate &a = declared.parameters[k], &b = by_hand.parameters[k];
    EXPECT_EQ(a.parameter.name, b.parameter.name);
    EXPECT_NEAR(a.value, b.value, 1e-3 * b.standard_deviation) << a.parameter.name;
    EXPECT_NEAR(a.standard_deviation, b.standard_deviation, 1e-3 * b.standard_deviation) << a.parameter.name;
    EXPECT_NEAR(a.interval95[1], b.interval95[1], 2e-3 * b.standard_deviation) << a.parameter.name;
  }
  // A start that is far off and the search end at the same shape.
  const Estimate found = EstimateOf(PreparedWith(kBoth), "eiv");
  const ParameterEstimate* vs = found.Find("stribeck_vs_2");
  ASSERT_NE(vs, nullptr);
  EXPECT_NEAR(vs->value, declared.Find("stribeck_vs_2")->value, 0.1 * vs->standard_deviation);
}

// By a line search between points of the grid; its middle is another one.
TEST(DeclaredEffects, TheShapeIsFoundOnTheResidual) {
  const Result<EffectFit> without = FitDeclared(PreparedWith(""));
  ASSERT_TRUE(without.ok()) << without.status().message();
  const ResidualModel residual(without->prepared.base(), without->data, without->summary);
  const ActiveEffect found =
      FindShape(without->prepared, residual, without->Arm(), {FindEffect("stribeck"), {1}, Eigen::VectorXd()});
  ASSERT_EQ(found.shape.size(), 1);
  EXPECT_EQ(found.joints, std::vector<int>{1});
  EXPECT_NEAR(found.shape[0], 0.3, 0.09);
}

// What an estimate states predicts what the fit found, by columns of its own: to a part of the residual's noise; and
// where a shape is moved, to the second order what its column says.
TEST(DeclaredEffects, TheStatedModelIsTheFittedOne) {
  const Result<EffectFit> fit = FitWithDeclaredEffects(PreparedWith(kBoth));
  ASSERT_TRUE(fit.ok()) << fit.status().message();
  ArmParameters arm = fit->Arm();
  const auto model = [](const PreparedStudy& prepared, const ArmParameters& a, size_t r) {
    return Predict(prepared, static_cast<int>(r), a).decimated_model;
  };
  const StatedModel stated = AsStated(fit->prepared, arm);
  EXPECT_EQ(stated.arm.chi.size(), arm.chi.size() - 1) << "no step of a shape";
  int shape = -1;
  for (size_t k = 0; k < fit->prepared.model.columns->parameters.size(); ++k) {
    if (fit->prepared.model.columns->parameters[k].kind != ParameterKind::kEffectShape) continue;
    shape = fit->prepared.base().size() + static_cast<int>(k);
  }
  ASSERT_GE(shape, 0);
  for (size_t r = 0; r < 3; ++r) {
    const RecordingSeries series = Predict(fit->prepared, static_cast<int>(r), arm);
    const double noise = (series.decimated_torque - series.decimated_model).norm();
    EXPECT_LT((model(stated.prepared, stated.arm, r) - series.decimated_model).norm(), 0.01 * noise) << r;
    ArmParameters moved = arm;
    moved.chi[shape] += 0.02;
    const Eigen::MatrixXd straight = model(fit->prepared, moved, r) - series.decimated_model;
    const StatedModel other = AsStated(fit->prepared, moved);
    const Eigen::MatrixXd change = model(other.prepared, other.arm, r) - model(stated.prepared, stated.arm, r);
    EXPECT_GT(straight.norm(), 0.0);
    EXPECT_LT((change - straight).norm(), 0.15 * straight.norm()) << r;
  }
}

TEST(DeclaredEffects, NoneDeclaredNothingChanged) {
  const PreparedStudy plain = PreparedWith("");
  const Result<PreparedStudy> prepared = DeclareEffects(plain);
  ASSERT_TRUE(prepared.ok());
  EXPECT_TRUE(prepared->model.columns->parameters.empty());
  EXPECT_TRUE(EstimateOf(plain, "wls").effects.empty());
}

// The step of a shape is about zero: its relative deviation says nothing. Others go.
TEST(DeclaredEffects, WhatIsDeclaredIsNotCancelled) {
  for (const std::string estimator : {"wls", "eiv"}) {
    const Estimate essential = EstimateOf(PreparedWith(kBoth), estimator, 15.0);
    EXPECT_FALSE(essential.eliminated.empty());
    ExpectTruth(essential);
  }
}

TEST(DeclaredEffects, PriorsHoldTheirParameters) {
  const PreparedStudy plain = PreparedWith(std::string(kBoth) +
                                           "priors: [{parameter: Fst2, value: 1.2, standard_deviation: 1.0e-4},\n"
                                           "         {parameter: Fv3, value: 0.9, standard_deviation: 1.0e-4}]\n");
  const Estimate with = EstimateOf(plain, "eiv");
  EXPECT_NEAR(with.Find("Fst2")->value, 1.2, 1e-3);
  EXPECT_NEAR(with.Find("Fv3")->value, 0.9, 1e-3);
}

// Simulated from an estimate with effects, each run declares them anew. Bias: t of 23 degrees, 5.5 of its standard
// errors (1e-5 a value). Spread: s / sigma of 24 runs has a standard deviation of 0.15, 0.66 is 4.5 of them. A shape
// that is left out of truth, or of the torque, is off by hundreds of deviations.
TEST(DeclaredEffects, MonteCarloKnowsThem) {
  const Result<PreparedStudy> prepared = DeclareEffects(PreparedWith(kBoth));
  ASSERT_TRUE(prepared.ok()) << prepared.status().message();
  const Estimate reference = EstimateOf(PreparedWith(kBoth), "wls");
  MonteCarloOptions options;
  options.runs = 24;
  options.threads = 2;
  const Result<MonteCarlo> result = RunMonteCarlo(*prepared, reference, {"wls"}, options, nullptr);
  ASSERT_TRUE(result.ok()) << result.status().message();
  const EstimatorStatistics& wls = result->estimators.at(0);
  EXPECT_EQ(wls.failures, 0) << wls.first_failure;
  int seen = 0;
  for (const ParameterStatistics& p : wls.parameters) {
    if (kTruth.count(p.parameter.name) == 0) continue;
    ++seen;
    EXPECT_NEAR(p.truth, reference.Find(p.parameter.name)->value, 1e-9) << p.parameter.name;
    EXPECT_EQ(p.runs, 24) << p.parameter.name;
    EXPECT_LT(std::abs(p.bias), 5.5 * p.bias_standard_error) << p.parameter.name;
    EXPECT_NEAR(p.standard_deviation / p.mean_standard_deviation, 1.0, 0.66) << p.parameter.name;
  }
  EXPECT_EQ(seen, 3);
}

// An exponent of one is viscous friction once more.
TEST(DeclaredEffects, NamesTheOneThatCannotBeFitted) {
  const Result<PreparedStudy> prepared = DeclareEffects(PreparedWith(
      "effects: [{id: stribeck, joints: [2], shape: {vs: 0.3}}, {id: power_viscous, joints: [3], shape: {a: 1.0}}]\n"));
  ASSERT_FALSE(prepared.ok());
  EXPECT_EQ(prepared.status().code(), StatusCode::kUntrusted);
  EXPECT_THAT(prepared.status().message(),
              AllOf(HasSubstr("'effects'"), HasSubstr("power_viscous on joint 3"), Not(HasSubstr("stribeck"))));
}

// estimate.json -> Validate() finds what the estimate says of its validation recording: by columns anew, from the
// stated model alone.
TEST(DeclaredEffects, AnEstimateIsJudgedAsItSays) {
  const PreparedStudy plain = PreparedWith(""), declares = PreparedWith(kBoth);
  for (const std::string estimator : {"ls", "eiv"}) {
    const Estimate with = EstimateOf(declares, estimator);
    const Reference reference = RoundTrip(with);
    ASSERT_EQ(reference.effects.size(), 2u);
    for (const PreparedStudy* study : {&plain, &declares}) {
      const Result<Validation> validation = Validate(*study, reference);
      ASSERT_TRUE(validation.ok()) << validation.status().message();
      ASSERT_EQ(validation->recordings.size(), 1u);
      ASSERT_TRUE(validation->recordings[0].fit.has_value());
      EXPECT_LT((validation->recordings[0].fit->relative_error_percent - with.recordings[2].relative_error_percent)
                    .cwiseAbs()
                    .maxCoeff(),
                1e-9)
          << estimator;
    }
  }
  // Each statement counts.
  const Estimate with = EstimateOf(declares, "eiv");
  const auto error_of = [&](const std::function<void(Reference*)>& change) {
    Reference reference = RoundTrip(with);
    change(&reference);
    const Result<Validation> validation = Validate(plain, reference);
    if (!validation.ok()) throw std::runtime_error(validation.status().message());
    return Eigen::VectorXd(validation->recordings[0].fit->relative_error_percent);
  };
  const Eigen::VectorXd before = error_of([](Reference*) {});
  EXPECT_GT(error_of([](Reference* r) { r->effects[0].shape[0].second *= 2.0; })[1], 1.01 * before[1]);
  const auto set = [](const std::string& name, double value) {
    return [=](Reference* r) {
      for (Reference::Entry& entry : r->parameters) {
        if (entry.name == name) entry.value = value;
      }
    };
  };
  EXPECT_GT(error_of(set("Fst2", 0.0))[1], 1.01 * before[1]);
  EXPECT_GT(error_of(set("Fl1", 0.0))[0], 1.01 * before[0]);
}

TEST(DeclaredEffects, EffectsOfAnEstimateThatDoNotFitAreRefused) {
  const PreparedStudy plain = PreparedWith("");
  const Reference good = RoundTrip(EstimateOf(PreparedWith(kBoth), "wls"));
  const auto message = [&](const std::function<void(Reference*)>& change) {
    Reference reference = good;
    change(&reference);
    const Status status = Validate(plain, reference).status();
    EXPECT_EQ(status.code(), StatusCode::kBadInput);
    return status.message();
  };
  EXPECT_THAT(message([](Reference* r) { r->effects[0].id = "magic"; }), HasSubstr("'magic': no such effect"));
  EXPECT_THAT(message([](Reference* r) { r->effects[0].id = "coulomb"; }), HasSubstr("no such effect"));
  EXPECT_THAT(message([](Reference* r) { r->effects[0].joints = {3}; }), HasSubstr("1 increasing joints of the 3"));
  EXPECT_THAT(message([](Reference* r) { r->effects[0].joints = {0, 1}; }), HasSubstr("'joints'"));
  EXPECT_THAT(message([](Reference* r) { r->effects[0].shape.clear(); }), HasSubstr("'shape.vs'"));
  EXPECT_THAT(message([](Reference* r) { r->effects[0].shape[0].second = -0.1; }), HasSubstr("'shape.vs'"));
  EXPECT_THAT(message([](Reference* r) { r->effects[0].shape.emplace_back("b", 1.0); }), HasSubstr("has 2 numbers"));
  EXPECT_THAT(message([](Reference* r) { r->effects.push_back(r->effects[0]); }), HasSubstr("given twice"));
  EXPECT_THAT(message([](Reference* r) { r->effects.clear(); }), HasSubstr("'Fst2'"));
}

}  // namespace
}  // namespace idim::testing::declared_effects_test
