// Where velocities count as zero, and where not.

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/simulated_study.h"

namespace idim::testing::velocity_at_rest_test {
namespace {

// Points with half a second of rest between them, an encoder of 1e-4 rad.
TEST(VelocityAtRest, IsZeroWhereAJointStandsAndUntouchedWhereItMoves) {
  SimulatedStudy study;
  const std::string fourier = "use: identification, seed: 1, trajectory: {type: fourier, frequency: 0.2, duration: 10}";
  ReplaceOnce(fourier, "use: identification, seed: 1, trajectory: {type: point_to_point, random: 8, dwell: 0.5}",
              &study.scenario_text);
  ReplaceOnce("position: 1.0e-6", "position: 3.0e-5", &study.scenario_text);
  study.Simulate();
  const PreparedStudy before = study.Prepare();
  const std::shared_ptr<const Data> after = WithVelocityZeroAtRest(*before.data);
  const Eigen::MatrixXd was = before.data->recordings[0].states->dq, is = after->recordings[0].states->dq;
  int at_rest = 0, moving = 0;
  for (Eigen::Index j = 0; j < was.cols(); ++j) {
    const double sigma = before.data->velocity_sigma[j];
    for (Eigen::Index k = 0; k < was.rows(); ++k) {
      // Either as it was or zero, and zero only where it was noise.
      ASSERT_TRUE(is(k, j) == was(k, j) || (is(k, j) == 0.0 && std::abs(was(k, j)) < 4.0 * sigma)) << k << " " << j;
      at_rest += is(k, j) == 0.0;
      moving += std::abs(was(k, j)) > 10.0 * sigma;
    }
  }
  // 8 dwells of 0.5 s on three joints at 200 Hz, less the corners that the filter rounds.
  EXPECT_GT(at_rest, 8 * 3 * 40);
  EXPECT_GT(moving, 1000);
  EXPECT_EQ(after->recordings[0].states->q, before.data->recordings[0].states->q);
  EXPECT_EQ(after->recordings[0].states->ddq, before.data->recordings[0].states->ddq);
  // A joint that passes a reversal without resting is not touched: the Fourier motion of the other recording, but for
  // its blends from and to rest.
  const Eigen::MatrixXd &smooth_was = before.data->recordings[1].states->dq,
                        &smooth_is = after->recordings[1].states->dq;
  const Eigen::Index middle = smooth_was.rows() / 2, part = smooth_was.rows() / 4;
  EXPECT_EQ(smooth_is.middleRows(middle - part, 2 * part), smooth_was.middleRows(middle - part, 2 * part));
}

}  // namespace
}  // namespace idim::testing::velocity_at_rest_test
