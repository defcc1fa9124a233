// An estimate as JSON.

#ifndef IDIM_CORE_ESTIMATE_ESTIMATE_JSON_H_
#define IDIM_CORE_ESTIMATE_ESTIMATE_JSON_H_

#include <nlohmann/json.hpp>
#include <string>

#include "core/estimate/estimate.h"

namespace idim {

// Keys in the order of the contract; for files that hold several (comparison.json).
nlohmann::ordered_json EstimateJson(const Estimate& estimate);

// The text of estimate.json. Deterministic but for "seconds".
std::string EstimateToJson(const Estimate& estimate);

}  // namespace idim

#endif  // IDIM_CORE_ESTIMATE_ESTIMATE_JSON_H_
