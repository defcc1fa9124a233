// report.html of several estimators on the same data: gains and parameters side by side.

#ifndef IDIM_APPS_PAGES_COMPARISON_REPORT_H_
#define IDIM_APPS_PAGES_COMPARISON_REPORT_H_

#include <optional>
#include <string>
#include <vector>

#include "core/estimate/bias_test.h"
#include "core/estimate/estimate.h"
#include "core/estimate/monte_carlo.h"
#include "core/estimate/reference.h"

namespace idim {

// All that is compared.
struct Comparison {
  std::vector<Estimate> estimates;   // by any estimator; those without numbers have a status that says why
  std::vector<BiasTest> bias_tests;  // of least squares; empty where gains are known
  std::vector<Reference> references;
  // Gains by the baseline that finds them one joint at a time; it has no other parameters and predicts nothing.
  std::optional<Estimate> sequential = std::nullopt;
  std::optional<MonteCarlo> monte_carlo = std::nullopt;  // on data simulated from one of the estimates
};

// Errors and verdicts, then a line a parameter, and for each estimator with numbers its value, relative standard
// deviation and difference to the first in percent; (!) marks what is not to be trusted.
std::string ComparisonToText(const Comparison& comparison);

// comparison.json, schema idim.comparison.1.
std::string ComparisonToJson(const Comparison& comparison);

// One self-contained page. Deterministic.
std::string RenderComparisonReport(const Comparison& comparison);

}  // namespace idim

#endif  // IDIM_APPS_PAGES_COMPARISON_REPORT_H_
