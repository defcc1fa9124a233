// Validations as text, JSON (schema idim.validation.1) and report.

#ifndef IDIM_APPS_PAGES_VALIDATION_REPORT_H_
#define IDIM_APPS_PAGES_VALIDATION_REPORT_H_

#include <string>
#include <vector>

#include "core/robot/robot.h"
#include "solvers/judge/validation.h"

namespace idim {

// All take at least one validation (CHECK), all of the same study.

// The paper's Tables VI (relative error), V (condition number), VII and VIII (payload mass), a column an estimate.
std::string ValidationToText(const std::vector<Validation>& validations);

// {"schema", "robot", "estimates": [{"name", "warning", "gains", "recordings": [{"name", "payload", "condition_number",
// "relative_error_percent", "relative_error_percent_all", "rms_torque", "rms_torque_unfiltered", "mass",
// "mass_weighed", "mass_standard_deviation", "mass_error_percent"}]}]}; what is not known is null.
std::string ValidationToJson(const std::string& robot, const std::vector<Validation>& validations);

// One self-contained page. Deterministic.
std::string RenderValidationReport(const Robot& robot, const std::vector<Validation>& validations);

}  // namespace idim

#endif  // IDIM_APPS_PAGES_VALIDATION_REPORT_H_
