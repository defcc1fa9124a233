// The closed-form bundle against the explicit one in Ceres: minimum, values, covariance, bad starts.

#include "solvers/bundle/ceres_bundle.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <string>

#include "core/base/decompositions.h"
#include "tests/support/bundle_study.h"

namespace idim::ceres_bundle_test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using testing::BundleStudy;
using testing::EditSamples;
using testing::GainScenario;
using testing::MakeBundleStudy;

GainScenario Arm3() {
  Random random(21);
  GainScenario scenario;
  scenario.robot = testing::RandomArm("RRR", &random);
  scenario.gains = VectorXd{{33.9, -24.2, 6.79}};
  scenario.samples = 1600;
  scenario.decimation = 40;
  return scenario;
}

GainScenario SmallTx40() {
  GainScenario scenario = testing::Tx40Gains();
  scenario.samples = 3000;
  scenario.decimation = 50;
  return scenario;
}

// Joint noise that the torque feels as much as the signals' noise of 3 %.
BundleStudy NoisyStudy(const GainScenario& scenario) { return MakeBundleStudy(scenario, 2e-4, 0.03); }

BundleOptions ClosedForm(const BundleStudy& study) {
  BundleOptions options;
  options.max_weight_iterations = 0;
  options.signal_sigma = study.sigma;
  options.step_tolerance = 1e-9;
  return options;
}

CeresBundleOptions Explicit(const BundleStudy& study) {
  CeresBundleOptions options;
  options.signal_sigma = study.sigma;
  return options;
}

// In standard deviations of `covariance`.
double Distance(const VectorXd& a, const VectorXd& b, const MatrixXd& covariance) {
  return (a - b).cwiseQuotient(covariance.diagonal().cwiseSqrt()).cwiseAbs().maxCoeff();
}

// Largest difference of two covariances, relative to the standard deviations.
double CovarianceDifference(const MatrixXd& a, const MatrixXd& b) {
  const VectorXd scale = b.diagonal().cwiseSqrt().cwiseInverse();
  return (scale.asDiagonal() * (a - b) * scale.asDiagonal()).cwiseAbs().maxCoeff();
}

// The cost's rounding, 1e-16 of it, leaves the minimum uncertain by 1e-8 times the root of the cost, 2e-7 standard
// deviations, and curvature carries that into the covariance. Covariances are therefore compared at the same unknowns.
void ExpectSame(const BundleStudy& study) {
  const BundleSummary closed = SolveBundle(study.prepared.base(), study.data, study.truth, ClosedForm(study));
  const CeresBundleSummary reference =
      SolveCeresBundle(study.prepared.base(), study.data, study.truth, Explicit(study));
  ASSERT_TRUE(closed.IsSolutionUsable()) << closed.status.message();
  ASSERT_TRUE(reference.IsSolutionUsable()) << reference.status.message();
  EXPECT_LT(closed.final_cost, 0.99 * closed.initial_cost);
  EXPECT_NEAR(closed.final_cost, reference.final_cost, 1e-9 * reference.final_cost);
  EXPECT_LT(Distance(closed.values, reference.values, reference.covariance), 1e-5);
  CeresBundleOptions there = Explicit(study);
  there.hold_unknowns = true;
  const CeresBundleSummary held = SolveCeresBundle(study.prepared.base(), study.data, closed.values, there);
  ASSERT_TRUE(held.IsSolutionUsable()) << held.status.message();
  ASSERT_EQ(held.values, closed.values);
  EXPECT_NEAR(held.final_cost, closed.final_cost, 1e-12 * closed.final_cost);
  EXPECT_LT(CovarianceDifference(closed.covariance, held.covariance), 1e-8);
}

TEST(CeresBundle, ClosedFormReachesTheSameMinimumArm3) { ExpectSame(NoisyStudy(Arm3())); }

TEST(CeresBundle, ClosedFormReachesTheSameMinimumTx40) { ExpectSame(NoisyStudy(SmallTx40())); }

// The closed form's cost is that of the explicit form with its latents at their best, whatever the unknowns.
TEST(CeresBundle, ClosedFormHasTheProfileCost) {
  const BundleStudy study = NoisyStudy(Arm3());
  Random random(8);
  for (int trial = 0; trial < 5; ++trial) {
    const VectorXd scale =
        VectorXd::Ones(study.truth.size()) + random.Vector(static_cast<int>(study.truth.size()), 0.5);
    const VectorXd theta = study.truth.cwiseProduct(scale);
    CeresBundleOptions options = Explicit(study);
    options.hold_unknowns = true;
    options.covariance = false;
    options.priors = {{0, 30.0, 0.5}, {5, 1.0, 0.1}};
    BundleOptions closed = ClosedForm(study);
    closed.max_iterations = 1;
    closed.priors = options.priors;
    const double expected = SolveCeresBundle(study.prepared.base(), study.data, theta, options).final_cost;
    const double cost = SolveBundle(study.prepared.base(), study.data, theta, closed).initial_cost;
    EXPECT_NEAR(cost, expected, 1e-11 * expected);
  }
}

// Priors move both alike: of a gain and of a payload's parameter, three standard deviations off.
TEST(CeresBundle, PriorsPullBothToTheSameMinimum) {
  const BundleStudy study = NoisyStudy(Arm3());
  const BundleSummary without = SolveBundle(study.prepared.base(), study.data, study.truth, ClosedForm(study));
  BundleOptions options = ClosedForm(study);
  for (const int unknown : {1, study.data.num_unknowns() - 1}) {
    const double deviation = std::sqrt(without.covariance(unknown, unknown));
    options.priors.push_back({unknown, without.values[unknown] + 3.0 * deviation, deviation});
  }
  CeresBundleOptions explicit_options = Explicit(study);
  explicit_options.priors = options.priors;
  const BundleSummary closed = SolveBundle(study.prepared.base(), study.data, study.truth, options);
  const CeresBundleSummary reference =
      SolveCeresBundle(study.prepared.base(), study.data, study.truth, explicit_options);
  ASSERT_TRUE(closed.IsSolutionUsable() && reference.IsSolutionUsable());
  EXPECT_GT(Distance(closed.values, without.values, without.covariance), 1.0);
  EXPECT_NEAR(closed.final_cost, reference.final_cost, 1e-9 * reference.final_cost);
  EXPECT_LT(Distance(closed.values, reference.values, reference.covariance), 1e-5);
  EXPECT_LT(CovarianceDifference(closed.covariance, reference.covariance), 1e-6);
}

// Numeric gradient of the cost by every unknown, over 1e-3 of its standard deviation with the others held. Its Newton
// decrement is the distance of the true minimum in standard deviations. Without the change of the columns along the
// deviations in the Jacobian, iteration stops elsewhere.
TEST(CeresBundle, GradientVanishesAtTheClosedFormsMinimum) {
  const BundleStudy study = NoisyStudy(Arm3());
  const BundleSummary best = SolveBundle(study.prepared.base(), study.data, study.truth, ClosedForm(study));
  ASSERT_TRUE(best.IsSolutionUsable());
  BundleOptions options = ClosedForm(study);
  options.max_iterations = 1;
  const auto cost = [&](const VectorXd& theta) {
    return SolveBundle(study.prepared.base(), study.data, theta, options).initial_cost;
  };
  const VectorXd held = best.covariance.inverse().diagonal().cwiseSqrt().cwiseInverse();
  constexpr double kStep = 1e-3;
  VectorXd gradient(best.values.size());
  for (int k = 0; k < best.values.size(); ++k) {
    const auto at = [&](double steps) {
      return cost(best.values + steps * kStep * held[k] * VectorXd::Unit(best.values.size(), k));
    };
    gradient[k] = (at(1.0) - at(-1.0)) / (2.0 * kStep * held[k]);
    // The curvature is there: otherwise no gradient would say nothing.
    EXPECT_NEAR(at(1.0) + at(-1.0) - 2.0 * at(0.0), 2.0 * kStep * kStep, 0.5 * kStep * kStep)
        << study.data.unknowns[k].name;
  }
  const double decrement = 0.5 * std::sqrt(gradient.dot(best.covariance * gradient));
  EXPECT_LT(decrement, 1e-5);
}

// Gains wrong by a factor of 3: both arrive. Of the wrong sign: the closed form arrives, for it steps in 1/g; the
// explicit form, which steps in g, meets the pole and says that it has not converged. Everything of the wrong sign fits
// all but the known payload, and neither finds back: said, not hidden.
TEST(CeresBundle, BadStartsEndAtTheMinimumOrAreReported) {
  for (const GainScenario& scenario : {Arm3(), SmallTx40()}) {
    const BundleStudy study = NoisyStudy(scenario);
    const int n = study.data.dof;
    const BundleSummary best = SolveBundle(study.prepared.base(), study.data, study.truth, ClosedForm(study));
    ASSERT_TRUE(best.IsSolutionUsable());
    CeresBundleOptions options = Explicit(study);
    options.max_iterations = 30;
    options.covariance = false;
    const auto check = [&](const std::string& name, const VectorXd& start, bool closed_arrives, bool explicit_arrives) {
      SCOPED_TRACE(scenario.robot.name + ", " + name);
      const BundleSummary closed = SolveBundle(study.prepared.base(), study.data, start, ClosedForm(study));
      if (closed_arrives || closed.IsSolutionUsable()) {
        EXPECT_TRUE(closed.IsSolutionUsable()) << closed.status.message();
        EXPECT_LT(Distance(closed.values, best.values, best.covariance), 1e-5);
      }
      const CeresBundleSummary reference = SolveCeresBundle(study.prepared.base(), study.data, start, options);
      if (explicit_arrives || reference.IsSolutionUsable()) {
        EXPECT_TRUE(reference.IsSolutionUsable()) << reference.status.message();
        EXPECT_LT(Distance(reference.values, best.values, best.covariance), 1e-5);
      }
    };
    VectorXd start = study.truth;
    start.head(n) *= 3.0;
    check("gains times 3", start, true, true);
    start.head(n) /= 9.0;
    check("gains a third", start, true, true);
    start = study.truth;
    start.head(n) *= -1.0;
    check("gains of the wrong sign", start, true, false);
    for (int j = 0; j < n; ++j) {
      start = study.truth;
      start[j] *= j % 2 == 0 ? -1.0 : -3.0;
      check("g" + std::to_string(j + 1) + " of the wrong sign", start, true, false);
    }
    check("everything of the wrong sign", -study.truth, false, false);
  }
}

// One signal in 12 off by 100 standard deviations: Huber's loss keeps the gains, squares lose them.
TEST(CeresBundle, HuberLossBearsOutliers) {
  BundleStudy study = NoisyStudy(Arm3());
  const CeresBundleSummary clean = SolveCeresBundle(study.prepared.base(), study.data, study.truth, Explicit(study));
  EditSamples(&study.data, [&](std::vector<BundleSample>* samples) {
    for (size_t k = 5; k < samples->size(); k += 12) (*samples)[k].signal += 100.0 * study.sigma;
  });
  const CeresBundleSummary squares = SolveCeresBundle(study.prepared.base(), study.data, study.truth, Explicit(study));
  CeresBundleOptions options = Explicit(study);
  options.huber_threshold = 1.0;
  const CeresBundleSummary huber = SolveCeresBundle(study.prepared.base(), study.data, study.truth, options);
  ASSERT_TRUE(clean.IsSolutionUsable() && squares.IsSolutionUsable() && huber.IsSolutionUsable());
  const double off = Distance(squares.values, clean.values, clean.covariance);
  EXPECT_GT(off, 20.0);
  EXPECT_LT(Distance(huber.values, clean.values, clean.covariance), 0.1 * off);
}

TEST(CeresBundle, AGainOfZeroIsRefusedByBoth) {
  const BundleStudy study = NoisyStudy(Arm3());
  VectorXd start = study.truth;
  start[1] = 0.0;
  EXPECT_FALSE(SolveBundle(study.prepared.base(), study.data, start, ClosedForm(study)).IsSolutionUsable());
  EXPECT_FALSE(SolveCeresBundle(study.prepared.base(), study.data, start, Explicit(study)).IsSolutionUsable());
}

TEST(CeresBundle, OptionsThatMeanNothingAreInvalid) {
  CeresBundleOptions good;
  good.signal_sigma = VectorXd::Ones(2);
  std::string error;
  EXPECT_TRUE(good.IsValid(&error)) << error;
  const auto expect_invalid = [&](auto change) {
    CeresBundleOptions options = good;
    change(&options);
    error.clear();
    EXPECT_FALSE(options.IsValid(&error));
    EXPECT_FALSE(error.empty());
  };
  expect_invalid([](CeresBundleOptions* o) { o->signal_sigma = VectorXd(); });
  expect_invalid([](CeresBundleOptions* o) { o->signal_sigma[1] = 0.0; });
  expect_invalid([](CeresBundleOptions* o) { o->priors = {{0, 1.0, 0.0}}; });
  expect_invalid([](CeresBundleOptions* o) { o->huber_threshold = -1.0; });
  expect_invalid([](CeresBundleOptions* o) { o->max_iterations = 0; });
  expect_invalid([](CeresBundleOptions* o) { o->function_tolerance = 0.0; });
}

}  // namespace
}  // namespace idim::ceres_bundle_test
