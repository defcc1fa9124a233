#include "solvers/bundle/ceres_bundle.h"

#include <ceres/ceres.h>
#include <glog/logging.h>

#include <memory>
#include <utility>

#include "residuals/joint_state_residual.h"
#include "residuals/parameter_prior_residual.h"
#include "residuals/torque_residual.h"

namespace idim {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using RowMajorMatrix = TorqueResidual::RowMajorMatrix;

ceres::CostFunction* MakeTorqueResidual(const BundleData& data, size_t k, const VectorXd& sigma,
                                        StateDerivatives* derivatives) {
  const int n = data.dof, c = data.num_columns();
  const BundleSample& sample = data.samples()[k];
  RowMajorMatrix columns(n, c + 1), scratch;
  columns << data.Columns(k, &scratch), sample.known;
  // What is left of D(chi) at chi = 0 is of the known payload.
  MatrixXd of_known;
  derivatives->Torque(sample, VectorXd::Zero(c), &of_known);
  std::vector<RowMajorMatrix> changes;
  RowMajorMatrix change;
  for (int s = 0; s < 3 * n; ++s) {
    derivatives->Columns(sample, VectorXd::Unit(3 * n, s), &change);
    changes.emplace_back(n, c + 1);
    changes.back() << change, of_known.col(s);
  }
  return TorqueResidual::Create(columns, changes, sample.signal, sigma, data.inverse_drive);
}

// Of theta, latents marginalised. Empty where the Jacobian is rank deficient.
MatrixXd CovarianceOf(const VectorXd& theta, ceres::Problem* problem) {
  ceres::Covariance::Options options;
  options.algorithm_type = ceres::SPARSE_QR;
  options.sparse_linear_algebra_library_type = ceres::SUITE_SPARSE;
  ceres::Covariance covariance(options);
  const std::vector<const double*> blocks = {theta.data()};
  if (!covariance.Compute(blocks, problem)) return {};
  RowMajorMatrix result(theta.size(), theta.size());
  CHECK(covariance.GetCovarianceMatrix(blocks, result.data()));
  return result;
}

}  // namespace

bool CeresBundleOptions::IsValid(std::string* error) const {
  if (signal_sigma.size() == 0 || !(signal_sigma.array() > 0.0).all()) {
    *error = "signal_sigma: expected a positive standard deviation for every joint";
    return false;
  }
  if (!AreValid(priors, error)) return false;
  if (!(huber_threshold >= 0.0)) {
    *error = "huber_threshold is " + std::to_string(huber_threshold) + "; expected 0 or more";
    return false;
  }
  if (max_iterations < 1) {
    *error = "max_iterations is " + std::to_string(max_iterations) + "; expected at least 1";
    return false;
  }
  if (!(function_tolerance > 0.0)) {
    *error = "function_tolerance must be positive";
    return false;
  }
  return true;
}

CeresBundleSummary SolveCeresBundle(const BaseParameters& base, const BundleData& data, const VectorXd& start,
                                    const CeresBundleOptions& options) {
  std::string error;
  CHECK(options.IsValid(&error)) << error;
  CHECK_EQ(start.size(), data.num_unknowns());
  CHECK_EQ(options.signal_sigma.size(), data.dof);
  CHECK_GT(data.num_gains(), 0) << "the explicit form has no known gains";
  CeresBundleSummary summary;
  summary.given = options;
  if (!(start.head(data.dof).cwiseAbs().minCoeff() > 0.0) || !start.allFinite()) {
    summary.status = Status::Untrusted("the bundle cannot start: a gain is zero or not a number");
    return summary;
  }

  VectorXd theta = start;
  RowMajorMatrix deviations = RowMajorMatrix::Zero(data.samples().size(), 3 * data.dof);
  std::unique_ptr<ceres::LossFunction> loss;
  if (options.huber_threshold > 0.0) loss = std::make_unique<ceres::HuberLoss>(options.huber_threshold);
  // Declared after `loss`, so that it goes first; cost functions are its own, the shared ones too.
  ceres::Problem::Options ownership;
  ownership.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(ownership);
  auto ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  ordering->AddElementToGroup(theta.data(), 1);
  std::vector<ceres::CostFunction*> joint_data(data.state_covariance.size(), nullptr);
  StateDerivatives derivatives(base, data);
  for (size_t k = 0; k < data.samples().size(); ++k) {
    const BundleSample& sample = data.samples()[k];
    double* deviation = deviations.row(static_cast<Eigen::Index>(k)).data();
    problem.AddResidualBlock(MakeTorqueResidual(data, k, options.signal_sigma, &derivatives), loss.get(), theta.data(),
                             deviation);
    ceres::CostFunction*& prior = joint_data[sample.recording];
    if (prior == nullptr) prior = JointStateResidual::Create(data.state_covariance[sample.recording]);
    problem.AddResidualBlock(prior, nullptr, deviation);
    ordering->AddElementToGroup(deviation, 0);
  }
  for (const BundlePrior& prior : options.priors) {
    problem.AddResidualBlock(
        ParameterPriorResidual::Create(data.num_unknowns(), prior.unknown, prior.value, prior.standard_deviation),
        nullptr, theta.data());
  }

  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::DENSE_SCHUR;
  solver.linear_solver_ordering = ordering;
  if (options.hold_unknowns) {
    problem.SetParameterBlockConstant(theta.data());
    solver.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
    solver.linear_solver_ordering = nullptr;
  }
  solver.max_num_iterations = options.max_iterations;
  solver.function_tolerance = options.function_tolerance;
  solver.gradient_tolerance = 1e-14;
  solver.parameter_tolerance = 1e-14;
  solver.logging_type = ceres::SILENT;
  ceres::Solver::Summary report;
  ceres::Solve(solver, &problem, &report);
  summary.brief = report.BriefReport();
  summary.values = theta;
  summary.deviations = deviations;
  summary.initial_cost = 2.0 * report.initial_cost;
  summary.final_cost = 2.0 * report.final_cost;
  summary.converged = report.termination_type == ceres::CONVERGENCE;
  if (!summary.converged) {
    summary.status = Status::Untrusted("the bundle has not converged: " + report.message);
    return summary;
  }
  if (options.covariance) {
    problem.SetParameterBlockVariable(theta.data());
    summary.covariance = CovarianceOf(theta, &problem);
    if (summary.covariance.size() == 0) {
      summary.status = Status::Untrusted("the bundle's Jacobian is rank deficient: some unknowns are not determined");
      return summary;
    }
  }
  summary.status = Status::Ok();
  return summary;
}

}  // namespace idim
