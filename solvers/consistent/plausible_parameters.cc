#include "solvers/consistent/plausible_parameters.h"

#include <ceres/ceres.h>
#include <ceres/normal_prior.h>
#include <glog/logging.h>

#include <memory>
#include <utility>
#include <vector>

#include "residuals/base_parameter_residual.h"

namespace idim {
namespace {

bool IsOffset(const Parameter& parameter) { return parameter.name.rfind(kStandardNames[kOff], 0) == 0; }

}  // namespace

PlausibleSummary FindPlausibleParameters(const BaseParameters& base, const PlausibleRequest& request) {
  const StandardModel& model = base.model();
  const int n = model.dof();
  CHECK_EQ(static_cast<int>(request.bodies.size()), n);
  CHECK_GT(request.spread, 0.0);

  std::vector<int> link_begin, drive_columns;
  for (int c = 0; c < model.columns(); ++c) {
    const Parameter& parameter = model.parameters()[c];
    if (parameter.kind != ParameterKind::kBase) {
      drive_columns.push_back(c);
    } else if (static_cast<int>(link_begin.size()) < parameter.joint) {
      link_begin.push_back(c);
    }
  }
  const int statements = static_cast<int>(request.base.size() + request.standard.size());
  Eigen::MatrixXd map = Eigen::MatrixXd::Zero(statements, model.columns());
  Eigen::VectorXd value(statements), sigma(statements);
  Eigen::VectorXd chi = Eigen::VectorXd::Zero(model.columns());
  int row = 0;
  const auto state = [&](const StatedParameter& stated, int column) {
    value[row] = stated.value;
    sigma[row] = stated.standard_deviation;
    CHECK_GT(sigma[row], 0.0);
    chi[column] = stated.value;
    ++row;
  };
  for (const StatedParameter& stated : request.base) {
    CHECK_LT(stated.index, base.size());
    map.row(row) = base.projection().row(stated.index);
    state(stated, base.kept()[stated.index]);
  }
  for (const StatedParameter& stated : request.standard) {
    CHECK_LT(stated.index, model.columns());
    map(row, stated.index) = 1.0;
    state(stated, stated.index);
  }

  std::vector<Eigen::Matrix4d> references;
  for (const RoughBody& body : request.bodies) {
    references.push_back(PseudoInertiaFactor(body.mass, body.centre, body.radii));
  }
  std::vector<Eigen::VectorXd> blocks(n, Eigen::VectorXd::Zero(kNumInertial));
  Eigen::VectorXd drives(drive_columns.size());
  ceres::Problem problem;
  std::vector<double*> pointers;
  for (Eigen::VectorXd& block : blocks) {
    pointers.push_back(block.data());
    problem.AddParameterBlock(block.data(), kNumInertial);
    const Eigen::MatrixXd weight = Eigen::MatrixXd::Identity(kNumInertial, kNumInertial) / request.spread;
    problem.AddResidualBlock(new ceres::NormalPrior(weight, Eigen::VectorXd::Zero(kNumInertial)), nullptr,
                             block.data());
  }
  pointers.push_back(drives.data());
  problem.AddParameterBlock(drives.data(), static_cast<int>(drives.size()));
  for (size_t k = 0; k < drive_columns.size(); ++k) {
    drives[k] = chi[drive_columns[k]];
    if (IsOffset(model.parameters()[drive_columns[k]])) continue;
    drives[k] = std::max(drives[k], 0.0);
    problem.SetParameterLowerBound(drives.data(), static_cast<int>(k), 0.0);
  }
  auto residual = std::make_unique<BaseParameterResidual>(map, value, sigma, references, link_begin, drive_columns);
  problem.AddResidualBlock(BaseParameterResidual::Create(std::move(residual)), nullptr, pointers);

  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = 2000;
  options.function_tolerance = 1e-14;
  options.gradient_tolerance = 1e-12;
  options.parameter_tolerance = 1e-12;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary solved;
  ceres::Solve(options, &problem, &solved);

  PlausibleSummary summary;
  summary.message = solved.message;
  summary.converged = solved.termination_type == ceres::CONVERGENCE;
  summary.iterations = static_cast<int>(solved.iterations.size()) - 1;
  double squares = 0.0;
  for (int link = 0; link < n; ++link) {
    InertialFromLogCholesky(references[link], blocks[link].data(), &chi[link_begin[link]]);
    squares += blocks[link].squaredNorm();
  }
  for (size_t k = 0; k < drive_columns.size(); ++k) chi[drive_columns[k]] = drives[k];
  summary.chi = chi;
  summary.base = base.projection() * chi;
  const int stated = static_cast<int>(request.base.size());
  summary.distance = ((map * chi - value).cwiseQuotient(sigma)).head(stated);
  summary.largest_distance = stated > 0 ? summary.distance.cwiseAbs().maxCoeff() : 0.0;
  summary.prior_distance = std::sqrt(squares / (kNumInertial * n)) / request.spread;
  return summary;
}

}  // namespace idim
