// All estimators, by name.

#ifndef IDIM_SOLVERS_ESTIMATORS_REGISTRY_H_
#define IDIM_SOLVERS_ESTIMATORS_REGISTRY_H_

#include <string>
#include <vector>

#include "solvers/estimators/estimator.h"

namespace idim {

// In the order in which programs list them. Never freed.
const std::vector<const Estimator*>& AllEstimators();

// What can be run on a study: ls wls eiv with known gains; ls wls tls wtls gtls wgtls eiv where gains are identified.
std::vector<std::string> EstimatorNames(GainsMode gains_mode);

// nullptr where none of the name takes this mode.
const Estimator* FindEstimator(const std::string& name, GainsMode gains_mode);

}  // namespace idim

#endif  // IDIM_SOLVERS_ESTIMATORS_REGISTRY_H_
