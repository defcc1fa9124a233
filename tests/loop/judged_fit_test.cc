// The errors that the loop reports, against the prediction of the recordings and the definition written out.

#include "solvers/loop/judged_fit.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <tuple>
#include <vector>

#include "core/model/active_effects.h"
#include "core/model/prediction.h"
#include "tests/support/simulated_study.h"

namespace idim::testing::judged_fit_test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

JudgedFit Fitted() {
  SimulatedStudy study;
  study.Simulate();
  Result<EffectFit> fit = FitDeclared(study.Prepare());
  if (!fit.ok()) throw std::runtime_error(fit.status().message());
  return JudgedFit(*std::move(fit));
}

struct Rows {
  MatrixXd residual, torque, velocity;  // samples x n
};

Rows Predicted(const JudgedFit& model, Use use) {
  const StatedModel stated = AsStated(model.fit.prepared, model.fit.Arm());
  std::vector<RecordingSeries> series;
  std::vector<MatrixXd> velocities;
  Eigen::Index count = 0;
  for (const int r : stated.prepared.model.RecordingsFor(use)) {
    const MeasuredRecording& recording = stated.prepared.data->recordings[static_cast<size_t>(r)];
    series.push_back(Predict(stated.prepared, r, stated.arm));
    velocities.emplace_back(recording.decimator->Apply(recording.states->dq));
    count += series.back().decimated_torque.rows();
  }
  const Eigen::Index n = series.at(0).decimated_torque.cols();
  Rows rows{MatrixXd(count, n), MatrixXd(count, n), MatrixXd(count, n)};
  for (size_t k = 0, at = 0; k < series.size(); at += static_cast<size_t>(velocities[k++].rows())) {
    const auto begin = static_cast<Eigen::Index>(at), size = velocities[k].rows();
    rows.torque.middleRows(begin, size) = series[k].decimated_torque;
    rows.residual.middleRows(begin, size) = series[k].decimated_torque - series[k].decimated_model;
    rows.velocity.middleRows(begin, size) = velocities[k];
  }
  return rows;
}

// Of the samples at which the joint moves faster than `slowest`.
VectorXd Moving(const Rows& rows, const VectorXd& slowest) {
  VectorXd errors(slowest.size());
  double resting = 0.0;
  for (Eigen::Index j = 0; j < errors.size(); ++j) {
    const Eigen::ArrayXd counts = (rows.velocity.col(j).array().abs() > slowest[j]).cast<double>();
    resting += static_cast<double>(counts.size()) - counts.sum();
    errors[j] = 100.0 * (rows.residual.col(j).array() * counts).matrix().norm() /
                (rows.torque.col(j).array() * counts).matrix().norm();
  }
  EXPECT_GT(resting, 0.0) << "no joint ever rests: the case says nothing";
  return errors;
}

void ExpectSame(const VectorXd& a, const VectorXd& b) {
  ASSERT_EQ(a.size(), b.size());
  EXPECT_LT((a - b).cwiseAbs().maxCoeff(), 1e-6 * b.cwiseAbs().maxCoeff()) << a.transpose() << " for " << b.transpose();
}

TEST(LoopErrors, AreThoseOfThePrediction) {
  const JudgedFit model = Fitted();
  const LoopErrors errors = LoopErrorsOf(model, false), by_blocks = LoopErrorsOf(model, true);
  const Rows identification = Predicted(model, Use::kIdentification), validation = Predicted(model, Use::kValidation);
  const VectorXd slowest = 0.01 * identification.velocity.cwiseAbs().colwise().maxCoeff().transpose();
  const auto joints = [](const Rows& rows) {
    return VectorXd(100.0 * rows.residual.colwise().norm().cwiseQuotient(rows.torque.colwise().norm()).transpose());
  };
  for (const auto& [all, per_joint, moving, rows] :
       {std::tuple(errors.identification, errors.identification_per_joint, errors.identification_moving,
                   identification),
        std::tuple(errors.validation, errors.validation_per_joint, errors.validation_moving, validation)}) {
    EXPECT_NEAR(all, 100.0 * rows.residual.norm() / rows.torque.norm(), 1e-6 * all);
    ExpectSame(per_joint, joints(rows));
    ExpectSame(moving, Moving(rows, slowest));
  }
  // Held-out blocks: of the same samples by models that have not seen them, which are worse.
  EXPECT_EQ(by_blocks.identification, errors.identification);
  Rows held_out = identification;
  held_out.residual = model.held_out.residual;
  EXPECT_NEAR(by_blocks.validation, 100.0 * held_out.residual.norm() / held_out.torque.norm(),
              1e-6 * errors.validation);
  ExpectSame(by_blocks.validation_per_joint, joints(held_out));
  EXPECT_GT(by_blocks.validation, by_blocks.identification);
}

TEST(HeldOutByFold, SumsTheWeightedSquaresOfTheJointsNamed) {
  const JudgedFit model = Fitted();
  const MatrixXd squares = model.residual.WeightedSquares(model.held_out.signal);
  MatrixXd folds = MatrixXd::Zero(model.residual.num_folds(), squares.cols());
  for (Eigen::Index k = 0; k < squares.rows(); ++k) {
    folds.row(model.residual.folds()[static_cast<size_t>(k)]) += squares.row(k);
  }
  ExpectSame(HeldOutByFold(model.residual, model, {1}), folds.col(1));
  ExpectSame(HeldOutByFold(model.residual, model, {0, 2}), folds.col(0) + folds.col(2));
  ExpectSame(HeldOutByFold(model.residual, model, {}), folds.rowwise().sum());
}

}  // namespace
}  // namespace idim::testing::judged_fit_test
