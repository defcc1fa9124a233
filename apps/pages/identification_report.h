// report.html of an identification: measured against modelled torque (the paper's Fig. 2), residuals,
// parameters with intervals.

#ifndef IDIM_APPS_PAGES_IDENTIFICATION_REPORT_H_
#define IDIM_APPS_PAGES_IDENTIFICATION_REPORT_H_

#include <string>
#include <vector>

#include "core/estimate/estimate.h"
#include "core/estimate/reference.h"
#include "core/estimate/series.h"
#include "core/robot/robot.h"

namespace idim {

// One self-contained page. Deterministic: no time, no path.
std::string RenderIdentificationReport(const Robot& robot, const Estimate& estimate,
                                       const std::vector<RecordingSeries>& series,
                                       const std::vector<Reference>& references);

}  // namespace idim

#endif  // IDIM_APPS_PAGES_IDENTIFICATION_REPORT_H_
