#include "solvers/effect_fit.h"

#include <gtest/gtest.h>

#include <cmath>

#include "solvers/active_effects.h"
#include "tests/solvers/simulated_study.h"

namespace idim::testing {
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
  ASSERT_EQ(with->prepared.effects.size(), 1u);
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
  ASSERT_EQ(with->prepared.effects.size(), 1u);
  bool seen = false;
  for (const ParameterEstimate& p : IdentificationOf(*with).estimate.parameters) {
    if (p.parameter.name != "dM") continue;
    seen = true;
    EXPECT_NEAR(p.value, 0.8, 0.05);
  }
  EXPECT_TRUE(seen);
}

}  // namespace
}  // namespace idim::testing
