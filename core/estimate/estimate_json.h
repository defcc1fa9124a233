// An estimate as a JSON object, for files that hold several (comparison.json).

#ifndef IDIM_CORE_ESTIMATE_ESTIMATE_JSON_H_
#define IDIM_CORE_ESTIMATE_ESTIMATE_JSON_H_

#include <nlohmann/json.hpp>

#include "core/estimate/estimate.h"

namespace idim {

// Keys in the order of the contract.
nlohmann::ordered_json EstimateJson(const Estimate& estimate);

}  // namespace idim

#endif  // IDIM_CORE_ESTIMATE_ESTIMATE_JSON_H_
