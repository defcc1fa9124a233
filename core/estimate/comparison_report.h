// report.html of several estimators on the same data: gains and parameters side by side.

#ifndef IDIM_CORE_ESTIMATE_COMPARISON_REPORT_H_
#define IDIM_CORE_ESTIMATE_COMPARISON_REPORT_H_

#include <string>
#include <vector>

#include "core/estimate/estimate.h"
#include "core/estimate/reference.h"

namespace idim {

// Errors and verdicts, then a line a parameter, and for each estimator with numbers its value, relative standard
// deviation and difference to the first in percent; (!) marks what is not to be trusted.
std::string ComparisonToText(const std::vector<Estimate>& estimates, const std::vector<Reference>& references);

// comparison.json, schema idim.comparison.1.
std::string ComparisonToJson(const std::vector<Estimate>& estimates);

// One self-contained page. Deterministic.
std::string RenderComparisonReport(const std::vector<Estimate>& estimates, const std::vector<Reference>& references);

}  // namespace idim

#endif  // IDIM_CORE_ESTIMATE_COMPARISON_REPORT_H_
