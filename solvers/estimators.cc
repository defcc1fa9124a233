#include "solvers/estimators.h"

#include <algorithm>
#include <utility>

#include "core/base/text.h"

namespace idim {
namespace {

constexpr GainEstimator kGainEstimators[] = {GainEstimator::kLs,   GainEstimator::kWls,  GainEstimator::kTls,
                                             GainEstimator::kWtls, GainEstimator::kGtls, GainEstimator::kWgtls};

}  // namespace

std::vector<std::string> EstimatorNames(GainsMode gains_mode) {
  if (gains_mode == GainsMode::kKnown) return {"ls", "wls"};
  std::vector<std::string> names;
  for (const GainEstimator estimator : kGainEstimators) names.emplace_back(GainEstimatorName(estimator));
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

Result<Identification> EstimatorRunner::Run(const std::string& estimator, double essential_ratio) const {
  const GainsMode mode = prepared_->study.gains_mode;
  const std::vector<std::string> names = EstimatorNames(mode);
  if (std::find(names.begin(), names.end(), estimator) == names.end()) {
    return Status::BadInput("--estimator=" + estimator + ": no such estimator where gains are " +
                            (mode == GainsMode::kKnown ? "known" : "identified") + " (key 'gains.mode' of " +
                            prepared_->study.path + "); expected one of " + Join(names, ", "));
  }
  std::string error;
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

}  // namespace idim
