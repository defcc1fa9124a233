#include "solvers/loop/effect_fit.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/model/active_effects.h"
#include "solvers/bundle/bundle_data.h"
#include "tests/support/simulated_study.h"

namespace idim::testing::effect_fit_test {
namespace {

EffectFit Declared(const std::string& effects) {
  SimulatedStudy study;
  ReplaceOnce("recordings:\n", "effects:\n" + effects + "recordings:\n", &study.scenario_text);
  study.Simulate();
  Result<EffectFit> fit = FitDeclared(study.Prepare());
  if (!fit.ok()) throw std::runtime_error(fit.status().message());
  return std::move(fit).value();
}

// From an order a quarter of a period over the range off.
TEST(EffectFit, MovesAShapeToTheTruthAndTakesTheEffectOutAgain) {
  const EffectFit declared = Declared("  - {id: torque_ripple, joints: [3], amplitude: 0.5, order: 11, phase: 0.0}\n");
  const Result<EffectFit> with =
      Refit(declared, {{FindEffect("torque_ripple"), {2}, Eigen::VectorXd::Constant(1, 11.2)}});
  ASSERT_TRUE(with.ok()) << with.status().message();
  ASSERT_EQ(with->prepared.model.effects.size(), 1u);
  const int at = with->data.num_unknowns();
  int seen = 0;
  for (const ParameterEstimate& p : IdentificationOf(*with).estimate.parameters) {
    const double truth = p.parameter.name == "Rc3"                 ? 0.5
                         : p.parameter.name == "Rs3"               ? 0.0
                         : p.parameter.name == "torque_ripple_k_3" ? 11.0
                                                                   : NAN;
    if (std::isnan(truth)) continue;
    ++seen;
    EXPECT_NEAR(p.value, truth, 4.5 * p.standard_deviation) << p.parameter.name;
    EXPECT_LT(p.standard_deviation, 0.1) << p.parameter.name;
  }
  EXPECT_EQ(seen, 3);
  EXPECT_EQ(at, declared.data.num_unknowns() + 3);
  EXPECT_LT(with->summary.signal_sigma[2], 0.8 * declared.summary.signal_sigma[2]);
  const Result<EffectFit> again = Refit(*with, {});
  ASSERT_TRUE(again.ok()) << again.status().message();
  EXPECT_NEAR(again->summary.deviance, declared.summary.deviance, 1e-3);
}

// An instant between two samples moves no torque when it changes a little: it is held, and the mass is found.
TEST(EffectFit, HoldsAShapeThatNoSampleTells) {
  const EffectFit declared = Declared("  - {id: payload_change, M: 0.8, z: 0.1, from: 5, recording: free}\n");
  const Result<EffectFit> with =
      Refit(declared, {{FindEffect("payload_change"), {}, Eigen::VectorXd::Constant(1, 0.5001)}});
  ASSERT_TRUE(with.ok()) << with.status().message();
  ASSERT_EQ(with->prepared.model.effects.size(), 1u);
  EXPECT_TRUE(with->prepared.model.effects[0].held);
  bool seen = false;
  for (const ParameterEstimate& p : IdentificationOf(*with).estimate.parameters) {
    if (p.parameter.name != "dM") continue;
    seen = true;
    EXPECT_NEAR(p.value, 0.8, 0.05);
  }
  EXPECT_TRUE(seen);
}

// With |dq|^0.95 and |dq| both free, Fp and Fv would grow without bound against each other.
TEST(EffectFit, HoldsAnExponentThatRunsIntoViscousFriction) {
  const EffectFit declared = Declared("  - {id: power_viscous, joints: [2], coefficient: 4.0, exponent: 0.95}\n");
  const Result<EffectFit> with =
      Refit(declared, {{FindEffect("power_viscous"), {1}, Eigen::VectorXd::Constant(1, 0.7)}});
  ASSERT_TRUE(with.ok()) << with.status().message();
  const ActiveEffect& effect = with->prepared.model.effects.at(0);
  EXPECT_LE(effect.shape[0], 0.8);
  EXPECT_TRUE(effect.held);
  EXPECT_LT(std::abs(IdentificationOf(*with).estimate.Find("Fp2")->value), 40.0);
}

TEST(EffectFit, NamesAnEffectOfTheWrongSign) {
  const EffectFit declared = Declared("  - {id: load_friction, joints: [2], mu: -0.05}\n");
  const Result<EffectFit> negative = Refit(declared, {{FindEffect("load_friction"), {1}, Eigen::VectorXd()}});
  ASSERT_TRUE(negative.ok()) << negative.status().message();
  EXPECT_NEAR(IdentificationOf(*negative).estimate.Find("Fl2")->value, -0.05, 0.01);
  ASSERT_EQ(OfWrongSign(*negative).size(), 1u);
  EXPECT_EQ(EffectTitle(OfWrongSign(*negative)[0]), "load_friction on joint 2");
  EXPECT_TRUE(OfWrongSign(declared).empty());
}

TEST(EffectFit, EveryEffectHasTheValuesOfTheLastSolution) {
  const EffectFit declared =
      Declared("  - {id: torque_ripple, joints: [2, 3], amplitude: 0.5, order: 11, phase: 0.3}\n");
  const Result<EffectFit> with =
      Refit(declared, {{FindEffect("torque_ripple"), {1}, Eigen::VectorXd::Constant(1, 11.1)},
                       {FindEffect("torque_ripple"), {2}, Eigen::VectorXd::Constant(1, 11.1)}});
  ASSERT_TRUE(with.ok()) << with.status().message();
  for (size_t e = 0; e < 2; ++e) {
    const Unknowns::EffectRange& range = with->data.unknowns.effect(e);
    ASSERT_EQ(range.linear, 2);
    EXPECT_EQ(with->prepared.model.effects[e].values, Eigen::VectorXd(with->summary.values.segment(range.at, 2))) << e;
  }
}

// Columns set by WithEffectColumnsOf() while fitting are those of a pass over the recordings.
TEST(EffectFit, HasTheDataOfItsStudy) {
  const EffectFit declared = Declared("  - {id: torque_ripple, joints: [3], amplitude: 0.5, order: 11, phase: 0.0}\n");
  const Result<EffectFit> with =
      Refit(declared, {{FindEffect("base_tilt"), {}, Eigen::VectorXd()},
                       {FindEffect("torque_ripple"), {2}, Eigen::VectorXd::Constant(1, 11.1)}});
  ASSERT_TRUE(with.ok()) << with.status().message();
  const Result<BundleData> anew = BuildBundleData(with->prepared);
  ASSERT_TRUE(anew.ok()) << anew.status().message();
  ASSERT_EQ(with->data.num_unknowns(), anew->num_unknowns());
  ASSERT_EQ(with->data.samples().size(), anew->samples().size());
  for (int k = 0; k < anew->num_unknowns(); ++k) EXPECT_EQ(with->data.unknowns[k].name, anew->unknowns[k].name);
  for (int k = 0; k < kNumInertial; ++k) EXPECT_EQ(with->data.payload_column(0, k), anew->payload_column(0, k));
  BundleData::RowMajorMatrix refitted, built;
  for (size_t k = 0; k < anew->samples().size(); ++k) {
    const auto& columns = anew->Columns(k, &built);
    EXPECT_LT((with->data.Columns(k, &refitted) - columns).cwiseAbs().maxCoeff(),
              1e-12 * columns.cwiseAbs().maxCoeff());
  }
  // Those that no effect has a part in are the same, not copies.
  EXPECT_EQ(&with->data.samples(), &declared.data.samples());
}

}  // namespace
}  // namespace idim::testing::effect_fit_test
