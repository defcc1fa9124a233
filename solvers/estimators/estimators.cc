#include "solvers/estimators/estimators.h"

#include <cmath>
#include <utility>

#include "core/base/text.h"
#include "solvers/estimators/assemble_estimate.h"
#include "solvers/linear/exogeneity.h"
#include "solvers/linear/gain_identification.h"
#include "solvers/linear/sequential_gains.h"

namespace idim {

Result<EstimatorRunner> EstimatorRunner::Create(const PreparedStudy* prepared) {
  EstimatorRunner runner(prepared);
  if (prepared->model.IdentifiesGains()) {
    Result<GainSystem> system = BuildGainSystem(*prepared);
    IDIM_RETURN_IF_ERROR(system);
    runner.gain_system_ = std::move(system).value();
  }
  return runner;
}

Result<Identification> EstimatorRunner::Run(const std::string& name, double essential_ratio, double huber) const {
  const GainsMode mode = prepared_->model.gains_mode;
  const Estimator* const estimator = FindEstimator(name, mode);
  if (estimator == nullptr) {
    return Status::BadInput("--estimator=" + name + ": no such estimator where gains are " +
                            (mode == GainsMode::kKnown ? "known" : "identified") + " (key 'gains.mode' of " +
                            prepared_->path() + "); expected one of " + Join(EstimatorNames(mode), ", "));
  }
  EstimatorOptions options;
  options.essential_ratio = essential_ratio;
  options.huber_threshold = huber;
  if (huber != 0.0 && !estimator->has_robust_loss()) {
    std::vector<std::string> robust;
    for (const Estimator* other : AllEstimators()) {
      if (other->Takes(mode) && other->has_robust_loss()) robust.push_back(other->name());
    }
    return Status::BadInput("--huber: " + name +
                            " has no robust loss; expected 0, or an estimator that has one: " + Join(robust, ", "));
  }
  if (std::string error; !estimator->IsValid(options, &error)) {
    return Status::BadInput((estimator->has_robust_loss() ? "--r_sigma, --huber: " : "--r_sigma: ") + error);
  }
  const Result<FitSummary> fit = estimator->Fit(*prepared_, gain_system_ ? &*gain_system_ : nullptr, options);
  IDIM_RETURN_IF_ERROR(fit);
  return ToIdentification(*prepared_, *fit);
}

std::optional<Estimate> EstimatorRunner::RunSequential() const {
  if (!gain_system_) return std::nullopt;
  const SequentialGains gains = SolveSequentialGains(*gain_system_);
  Estimate estimate;
  estimate.status = gains.status;
  estimate.robot = prepared_->robot().name;
  estimate.estimator = "sequential";
  std::vector<int> found;
  for (int j = 0; j < gain_system_->dof(); ++j) {
    if (std::isfinite(gains.gains[j])) found.push_back(j);
  }
  estimate.covariance = Eigen::MatrixXd::Zero(found.size(), found.size());
  for (size_t k = 0; k < found.size(); ++k) {
    const int j = found[k];
    ParameterEstimate p;
    p.parameter = gain_system_->unknowns[j];
    p.value = gains.gains[j];
    p.standard_deviation = gains.standard_deviation[j];
    SetInterval95(static_cast<double>(gain_system_->joints[j].rows()), &p);
    estimate.covariance(k, k) = p.standard_deviation * p.standard_deviation;
    estimate.parameters.push_back(p);
  }
  return estimate;
}

Result<std::vector<BiasTest>> EstimatorRunner::TestBias() const {
  std::vector<BiasTest> tests;
  if (!gain_system_) return tests;
  const Result<LaggedSystem> lagged = BuildLaggedSystem(*prepared_, LaggedOptions());
  IDIM_RETURN_IF_ERROR(lagged);
  const auto add = [&](const std::string& equations, const ExogeneityTest& test) {
    tests.push_back(
        {test.status, equations, test.biased, test.f, test.numerator, test.denominator, test.p_value, test.sargan_p});
  };
  for (int j = 0; j < lagged->dof; ++j) add("joint " + std::to_string(j + 1), TestJointExogeneity(*lagged, j));
  GainOptions options;
  options.estimator = GainEstimator::kWgtls;
  add("all joints", TestAllExogeneity(*lagged, SolveGains(*gain_system_, options).joint_sigma));
  return tests;
}

}  // namespace idim
