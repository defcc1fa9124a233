#include "solvers/estimators/estimators.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/text.h"
#include "solvers/estimators/closed_forms.h"
#include "solvers/estimators/eiv_identification.h"
#include "solvers/linear/exogeneity.h"
#include "solvers/linear/sequential_gains.h"

namespace idim {
namespace {

constexpr GainEstimator kGainEstimators[] = {GainEstimator::kLs,   GainEstimator::kWls,  GainEstimator::kTls,
                                             GainEstimator::kWtls, GainEstimator::kGtls, GainEstimator::kWgtls};

}  // namespace

std::vector<std::string> EstimatorNames(GainsMode gains_mode) {
  if (gains_mode == GainsMode::kKnown) return {"ls", "wls", "eiv"};
  std::vector<std::string> names;
  for (const GainEstimator estimator : kGainEstimators) names.emplace_back(GainEstimatorName(estimator));
  names.emplace_back("eiv");
  return names;
}

Result<EstimatorRunner> EstimatorRunner::Create(const PreparedStudy* prepared) {
  EstimatorRunner runner(prepared);
  if (prepared->study.gains_mode == GainsMode::kIdentify) {
    Result<GainSystem> system = BuildGainSystem(*prepared);
    if (!system.ok()) return system.status();
    runner.gain_system_ = std::move(system).value();
  }
  return runner;
}

Result<Identification> EstimatorRunner::Run(const std::string& estimator, double essential_ratio, double huber) const {
  const GainsMode mode = prepared_->study.gains_mode;
  const std::vector<std::string> names = EstimatorNames(mode);
  if (std::find(names.begin(), names.end(), estimator) == names.end()) {
    return Status::BadInput("--estimator=" + estimator + ": no such estimator where gains are " +
                            (mode == GainsMode::kKnown ? "known" : "identified") + " (key 'gains.mode' of " +
                            prepared_->study.path + "); expected one of " + Join(names, ", "));
  }
  std::string error;
  if (estimator == "eiv") {
    EivOptions options;
    options.essential_ratio = essential_ratio;
    options.huber_threshold = huber;
    if (!options.IsValid(&error)) return Status::BadInput("--r_sigma, --huber: " + error);
    return IdentifyEiv(*prepared_, gain_system_ ? &*gain_system_ : nullptr, options);
  }
  if (huber != 0.0) return Status::BadInput("--huber: only eiv has a robust loss; expected 0 with " + estimator);
  if (mode == GainsMode::kKnown) {
    LinearOptions options;
    options.weighted = estimator == "wls";
    options.essential_ratio = essential_ratio;
    if (!options.IsValid(&error)) return Status::BadInput("--r_sigma: " + error);
    return IdentifyLinear(*prepared_, options);
  }
  GainOptions options;
  for (const GainEstimator candidate : kGainEstimators) {
    if (estimator == GainEstimatorName(candidate)) options.estimator = candidate;
  }
  options.essential_ratio = essential_ratio;
  if (!options.IsValid(&error)) return Status::BadInput("--r_sigma: " + error);
  return IdentifyGains(*prepared_, *gain_system_, options);
}

std::optional<Estimate> EstimatorRunner::RunSequential() const {
  if (!gain_system_) return std::nullopt;
  const SequentialGains gains = SolveSequentialGains(*gain_system_);
  Estimate estimate;
  estimate.status = gains.status;
  estimate.robot = prepared_->study.robot.name;
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
  if (!lagged.ok()) return lagged.status();
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
