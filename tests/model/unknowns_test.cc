// The order of the unknowns against the documented one, and both ways between a vector and an arm.

#include "core/model/unknowns.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>
#include <string>
#include <vector>

#include "core/model/active_effects.h"
#include "core/model/prediction.h"
#include "core/model/sample_stream.h"
#include "tests/support/simulated_study.h"

namespace idim::unknowns_test {
namespace {

using Eigen::VectorXd;
using ::testing::ElementsAre;

std::vector<std::string> Names(const Unknowns& unknowns, int from, int count) {
  std::vector<std::string> names;
  for (int k = from; k < from + count; ++k) names.push_back(unknowns[k].name);
  return names;
}

class UnknownsTest : public ::testing::Test {
 protected:
  void SetUp() override {
    testing::ReplaceOnce("known: [M]", "known: [M, XX]", &simulated_.scenario_text);
    simulated_.Simulate();
    prepared_ = simulated_.Prepare();
    // A free shape (its effect has values), one that is not, and an effect without shape.
    const std::vector<ActiveEffect> effects = {
        {FindEffect("stribeck"), {1}, VectorXd::Constant(1, 0.2), VectorXd::Constant(1, 1.5)},
        {FindEffect("power_viscous"), {2}, VectorXd::Constant(1, 0.6)},
        {FindEffect("motor_coupling"), {0, 2}, VectorXd()}};
    ArmParameters arm;
    arm.gains = simulated_.scenario.gains;
    arm.chi = prepared_.base().projection() * simulated_.scenario.chi;
    arm.payloads = {simulated_.scenario.payloads[0].inertial};
    prepared_.model = WithEffects(prepared_, effects, MotionsOf(prepared_, arm));
  }

  testing::SimulatedStudy simulated_;
  PreparedStudy prepared_;
};

TEST_F(UnknownsTest, StandInTheirOrder) {
  Model identified = prepared_.model;
  identified.gains_mode = GainsMode::kIdentify;
  const Unknowns unknowns(identified, UncertainPayload::kExact);
  EXPECT_EQ(unknowns.num_gains(), 3);
  EXPECT_THAT(Names(unknowns, 0, 3), ElementsAre("g1", "g2", "g3"));
  EXPECT_EQ(unknowns.num_base(), prepared_.base().size());
  for (int k = 0; k < unknowns.num_base(); ++k) {
    EXPECT_EQ(unknowns[unknowns.first_base() + k].name, prepared_.base().parameters()[static_cast<size_t>(k)].name);
  }
  // Stribeck's torque and the step of its shape, the power law's factor, three coefficients of the coupling.
  ASSERT_EQ(unknowns.num_effects(), 3u);
  EXPECT_EQ(unknowns.effect(0).at, unknowns.first_effect());
  EXPECT_EQ(unknowns.effect(0).linear, 1);
  EXPECT_EQ(unknowns.effect(0).shapes, 1);
  EXPECT_EQ(unknowns.effect(1).at, unknowns.effect(0).end());
  EXPECT_EQ(unknowns.effect(1).shapes, 0);
  EXPECT_EQ(unknowns.effect(2).at, unknowns.effect(1).end());
  EXPECT_EQ(unknowns.effect(2).end(), unknowns.first_effect() + unknowns.num_effect_parameters());
  EXPECT_EQ(unknowns[unknowns.effect(0).at].name, "Fst2");
  EXPECT_EQ(unknowns[unknowns.effect(0).at + 1].kind, ParameterKind::kEffectShape);
  // An estimate states a shape, not its step.
  EXPECT_EQ(unknowns.Offset(unknowns.effect(0).at + 1), 0.2);
  EXPECT_EQ(unknowns.Offset(unknowns.effect(1).at), 0.0);
  // Eight of the payload's ten, as link 4.
  EXPECT_THAT(Names(unknowns, unknowns.effect(2).end(), 8),
              ElementsAre("XY4", "XZ4", "YY4", "YZ4", "ZZ4", "MX4", "MY4", "MZ4"));
  EXPECT_EQ(unknowns.size(), unknowns.effect(2).end() + 8);
  EXPECT_EQ(unknowns.payload(0, kXX), -1);
  EXPECT_EQ(unknowns.payload(0, kXY), unknowns.effect(2).end());
  EXPECT_EQ(unknowns.payload(-1, kXY), -1);
  EXPECT_EQ(unknowns.known_payload(0)[kM], 3.0);
  EXPECT_EQ(unknowns.known_payload(0)[kMX], 0.0);
  for (int k = 0; k < unknowns.size(); ++k) EXPECT_EQ(unknowns.Find(unknowns[k].name), k);
  EXPECT_FALSE(unknowns.Find("XX4"));
}

TEST_F(UnknownsTest, KnownGainsAreNoUnknowns) {
  Model identified = prepared_.model;
  identified.gains_mode = GainsMode::kIdentify;
  const Unknowns known(prepared_.model, UncertainPayload::kExact);
  const Unknowns with(identified, UncertainPayload::kExact);
  EXPECT_EQ(known.num_gains(), 0);
  EXPECT_EQ(known.num_columns(), with.num_columns());
  const Unknowns fixed = with.WithKnownGains(prepared_.model.gains);
  ASSERT_EQ(fixed.size(), known.size());
  for (int k = 0; k < known.size(); ++k) {
    EXPECT_EQ(fixed[k].name, known[k].name);
    EXPECT_EQ(fixed.Offset(k), known.Offset(k));
  }
  EXPECT_EQ(fixed.payload(0, kMZ), known.payload(0, kMZ));
  EXPECT_EQ(fixed.effect(1).at, known.effect(1).at);
  const VectorXd theta = VectorXd::LinSpaced(known.size(), 1.0, 2.0);
  EXPECT_EQ(fixed.Arm(theta).gains, simulated_.scenario.gains);
  EXPECT_EQ(known.Gains(theta), simulated_.scenario.gains);
}

TEST_F(UnknownsTest, ThereAndBack) {
  for (const GainsMode mode : {GainsMode::kKnown, GainsMode::kIdentify}) {
    Model model = prepared_.model;
    model.gains_mode = mode;
    const Unknowns unknowns(model, UncertainPayload::kExact);
    const VectorXd theta = VectorXd::LinSpaced(unknowns.size(), 1.0, 2.0);
    const ArmParameters arm = unknowns.Arm(theta);
    EXPECT_EQ(unknowns.Values(arm), theta);
    EXPECT_EQ(arm.payloads[0][kM], 3.0);
    EXPECT_EQ(arm.payloads[0][kMZ], theta[unknowns.size() - 1]);
    EXPECT_EQ(arm.chi, theta.segment(unknowns.first_base(), unknowns.num_base() + unknowns.num_effect_parameters()));
  }
}

// A weighed mass: exact for the closed forms, an unknown (to be given a prior) for the bundle.
TEST_F(UnknownsTest, AnUncertainPayloadParameterIsAnUnknownWhereAsked) {
  Model model = prepared_.model;
  model.payloads[0].standard_deviation[kM] = 0.1;
  const Unknowns exact(model, UncertainPayload::kExact), released(model, UncertainPayload::kUnknown);
  EXPECT_EQ(exact.payload(0, kM), -1);
  EXPECT_EQ(released.payload(0, kM), exact.size());
  EXPECT_EQ(released.size(), exact.size() + 1);
  EXPECT_EQ(released.known_payload(0)[kM], 0.0);
  EXPECT_EQ(released.known_payload(0)[kXX], exact.known_payload(0)[kXX]);
}

// Where two payloads are carried names tell them apart; where a payload is carried by no identification recording
// nothing of it is unknown.
TEST_F(UnknownsTest, PayloadsAreNamedWhereThereAreSeveral) {
  Model model = prepared_.model;
  model.payloads.push_back(Payload());
  model.payloads[1].name = "other";
  EXPECT_FALSE(Unknowns(model, UncertainPayload::kExact).Find("MX4_big"));
  EXPECT_EQ(Unknowns(model, UncertainPayload::kExact).payload(1, kMX), -1);
  model.roles[0].payload = 1;
  const Unknowns both(model, UncertainPayload::kExact);
  EXPECT_EQ(both.Find("MX4_big"), both.payload(0, kMX));
  EXPECT_EQ(both.Find("MX4_other"), both.payload(1, kMX));
  EXPECT_FALSE(both.Find("MX4"));
}

// Two routes to the decimated torque: columns of the stream times parameters, and recursive dynamics, decimated.
TEST_F(UnknownsTest, StreamedSamplesTimesParametersAreThePredictedTorque) {
  const Unknowns unknowns(prepared_.model, UncertainPayload::kExact);
  VectorXd theta = VectorXd::LinSpaced(unknowns.size(), -1.0, 2.0);
  const ArmParameters arm = unknowns.Arm(theta);
  for (int r = 0; r < 3; ++r) {
    const RecordingSeries series = Predict(prepared_, r, arm);
    Eigen::Index sample = 0;
    StreamSamples(prepared_, unknowns, r, [&](const Sample& s) {
      ASSERT_LT(sample, series.decimated_t.size());
      EXPECT_EQ(s.t, series.decimated_t[sample]);
      const VectorXd torque = s.columns * theta + s.known, predicted = series.decimated_model.row(sample).transpose();
      ASSERT_LT((torque - predicted).norm(), 1e-9 * (1.0 + predicted.norm())) << r << " " << sample;
      const VectorXd measured = prepared_.data->drive.Matrix(arm.gains) * s.signal;
      ASSERT_LT((measured - series.decimated_torque.row(sample).transpose()).norm(), 1e-9 * (1.0 + measured.norm()));
      ++sample;
    });
    EXPECT_EQ(sample, series.decimated_t.size());
  }
}

}  // namespace
}  // namespace idim::unknowns_test
