#include "solvers/estimators/registry.h"

namespace idim {

// Each is defined beside its estimator.
void AddClosedForms(std::vector<const Estimator*>* estimators);
void AddEiv(std::vector<const Estimator*>* estimators);

const std::vector<const Estimator*>& AllEstimators() {
  static const auto* const all = [] {
    auto* const estimators = new std::vector<const Estimator*>();
    AddClosedForms(estimators);
    AddEiv(estimators);
    return estimators;
  }();
  return *all;
}

std::vector<std::string> EstimatorNames(GainsMode gains_mode) {
  std::vector<std::string> names;
  for (const Estimator* estimator : AllEstimators()) {
    if (estimator->Takes(gains_mode)) names.push_back(estimator->name());
  }
  return names;
}

const Estimator* FindEstimator(const std::string& name, GainsMode gains_mode) {
  for (const Estimator* estimator : AllEstimators()) {
    if (estimator->name() == name && estimator->Takes(gains_mode)) return estimator;
  }
  return nullptr;
}

}  // namespace idim
