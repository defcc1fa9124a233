// The one-pass stream against the dense route: every column at full rate, then the decimator's matrix form.

#include "core/model/observation_stream.h"

#include <gtest/gtest.h>

#include "tests/support/random_arm.h"

namespace idim::observation_stream_test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

JointStates SmoothStates(const VectorXd& t, int n) {
  JointStates states;
  states.t = t;
  states.clock = AnalyzeClock(t);
  for (MatrixXd* m : {&states.q, &states.dq, &states.ddq}) m->resize(t.size(), n);
  for (Eigen::Index i = 0; i < t.size(); ++i) {
    for (int j = 0; j < n; ++j) {
      const double w = 2.0 + 0.7 * j;
      states.q(i, j) = std::sin(w * t[i] + j);
      states.dq(i, j) = w * std::cos(w * t[i] + j);
      states.ddq(i, j) = -w * w * std::sin(w * t[i] + j);
    }
  }
  return states;
}

class Clocks : public ::testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(UniformAndJittering, Clocks, ::testing::Bool());

TEST_P(Clocks, EqualsDenseColumnsThroughTheDecimator) {
  Random random(2);
  const int samples = 700, n = 6;
  VectorXd t(samples);
  for (int i = 0; i < samples; ++i) t[i] = 0.005 * (i + (GetParam() ? random.Uniform(-0.4, 0.4) : 0.0));
  const JointStates states = SmoothStates(t, n);
  const MatrixXd signal = MatrixXd::NullaryExpr(samples, n, [&] { return random.Uniform(-1.0, 1.0); });
  const VectorXd sigma = VectorXd::Constant(n, 0.5);
  DecimatorOptions options;
  options.decimation = 7;
  const Result<Decimator> decimator = Decimator::Create(t, states.clock, options);
  ASSERT_TRUE(decimator.ok()) << decimator.status().message();

  const BaseParameters base{StandardModel(testing::Tx40(), FrictionModel{})};
  StandardModel model = base.model();
  const int columns = base.size() + 10;
  MatrixXd dense(samples, n * columns);  // entry (row j, column c) of W in column j * columns + c
  Observation::RowMajorMatrix w(n, model.columns()), payload(n, 10);
  for (int i = 0; i < samples; ++i) {
    const VectorXd q = states.q.row(i), dq = states.dq.row(i), ddq = states.ddq.row(i);
    model.Regressor(q.data(), dq.data(), ddq.data(), sigma.data(), w.data());
    model.PayloadColumns(payload.data());
    for (int j = 0; j < n; ++j) {
      for (int k = 0; k < base.size(); ++k) dense(i, j * columns + k) = w(j, base.kept()[k]);
      for (int k = 0; k < 10; ++k) dense(i, j * columns + base.size() + k) = payload(j, k);
    }
  }
  const MatrixXd expected = decimator->Apply(dense);
  const MatrixXd expected_signal = decimator->Apply(signal);

  int output = 0;
  StreamObservations(base, states, signal, sigma, *decimator, [&](const Observation& o) {
    ASSERT_LT(output, decimator->outputs());
    EXPECT_EQ(o.t, decimator->times()[output]);
    for (int j = 0; j < n; ++j) {
      const auto row = expected.row(output).segment(j * columns, columns);
      EXPECT_LT((o.columns.row(j) - row.head(base.size())).norm(), 1e-12 * row.norm());
      EXPECT_LT((o.payload.row(j) - row.tail(10)).norm(), 1e-12 * row.norm());
    }
    EXPECT_LT((o.signal.transpose() - expected_signal.row(output)).norm(), 1e-13);
    ++output;
  });
  EXPECT_EQ(output, decimator->outputs());
  EXPECT_GT(output, 80);
}

}  // namespace
}  // namespace idim::observation_stream_test
