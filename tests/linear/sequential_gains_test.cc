#include "solvers/linear/sequential_gains.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "tests/support/gain_study.h"

namespace idim::sequential_gains_test {
namespace {

using ::testing::ElementsAre;
using testing::GainScenario;
using testing::GainStudy;
using ::testing::IsEmpty;
using testing::Tx40Gains;

// Three axes of the wrist meet where the mass is: joints 4 to 6 wait for what the others find of the payload.
TEST(SequentialGains, NoiseFreeMassKnown) {
  const GainStudy study = MakeGainStudy(Tx40Gains());
  const Result<GainSystem> system = BuildGainSystem(study.prepared);
  ASSERT_TRUE(system.ok());
  const SequentialGains sequential = SolveSequentialGains(*system);
  ASSERT_TRUE(sequential.status.ok()) << sequential.status.message();
  for (int j = 0; j < 6; ++j) EXPECT_NEAR(sequential.gains[j] / study.truth[j], 1.0, 1e-6) << j + 1;
  EXPECT_THAT(sequential.order, ElementsAre(0, 1, 2, 3, 4, 5));
  EXPECT_THAT(sequential.after_others, ElementsAre(3, 4, 5));
}

TEST(SequentialGains, NoiseFreeTenKnownNeedsNoOtherJoint) {
  GainScenario scenario = Tx40Gains();
  scenario.known = {kXX, kXY, kXZ, kYY, kYZ, kZZ, kMX, kMY, kMZ, kM};
  const GainStudy study = MakeGainStudy(scenario);
  const Result<GainSystem> system = BuildGainSystem(study.prepared);
  ASSERT_TRUE(system.ok());
  const SequentialGains sequential = SolveSequentialGains(*system);
  ASSERT_TRUE(sequential.status.ok()) << sequential.status.message();
  for (int j = 0; j < 6; ++j) EXPECT_NEAR(sequential.gains[j] / study.truth[j], 1.0, 1e-8) << j + 1;
  EXPECT_THAT(sequential.after_others, IsEmpty());
}

// The least squares of one joint's own equation, by the pseudo-inverse of all its rows.
TEST(SequentialGains, OneJointIsItsOwnLeastSquares) {
  GainScenario scenario = Tx40Gains();
  scenario.signal_noise = 0.1;
  const GainStudy study = MakeGainStudy(scenario);
  const Result<GainRows> rows = GainRows::Create(study.prepared);
  const Result<GainSystem> system = BuildGainSystem(study.prepared);
  ASSERT_TRUE(rows.ok() && system.ok());
  const SequentialGains sequential = SolveSequentialGains(*system);
  Eigen::MatrixXd w(system->joints[1].rows(), study.truth.size() + 1);
  Eigen::Index sample = 0;
  for (const int recording : {0, 1}) {
    rows->Stream(recording, [&](const GainRows::RowMajorMatrix& all) { w.row(sample++) = all.row(1); });
  }
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> cod;
  cod.setThreshold(1e-10);
  cod.compute(w.leftCols(study.truth.size()));
  const Eigen::VectorXd x = cod.solve(-w.rightCols<1>());
  EXPECT_NEAR(sequential.gains[1], x[1], 1e-7 * std::abs(x[1]));
  const double sigma =
      (w.leftCols(x.size()) * x + w.rightCols<1>()).norm() / std::sqrt(static_cast<double>(w.rows() - cod.rank()));
  const Eigen::MatrixXd inverse = cod.pseudoInverse();
  EXPECT_NEAR(sequential.standard_deviation[1], sigma * inverse.row(1).norm(), 1e-6 * sequential.standard_deviation[1]);
}

TEST(SequentialGains, SaysWhichGainItCannotFind) {
  GainScenario scenario = Tx40Gains();
  scenario.known = {kMZ};  // no torque on joint 6 from any of MZ, and nothing else is known
  const GainStudy study = MakeGainStudy(scenario);
  const Result<GainRows> rows = GainRows::Create(study.prepared);
  ASSERT_TRUE(rows.ok());
  GainSystem system(rows->unknowns().parameters(), 6);
  // Nothing to take over either, where the rows of the unloaded recording alone are there.
  rows->Stream(0, [&](const GainRows::RowMajorMatrix& all) {
    for (int j = 0; j < 6; ++j) system.joints[static_cast<size_t>(j)].AddRow(all.row(j));
  });
  const SequentialGains sequential = SolveSequentialGains(system);
  EXPECT_EQ(sequential.status.code(), StatusCode::kUntrusted);
  EXPECT_THAT(sequential.status.message(), ::testing::HasSubstr("g1, g2, g3, g4, g5, g6"));
  EXPECT_TRUE(std::isnan(sequential.gains[0]));
}

}  // namespace
}  // namespace idim::sequential_gains_test
