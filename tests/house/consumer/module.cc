// What a Python module would be: C functions of a shared library with idim inside.

#include "core/report/report.h"
#include "solvers/estimators/estimators.h"

// The number of estimators that find gains; 0 where a report lacks what is embedded in it.
extern "C" int CountEstimators() {
  if (idim::RenderReport(idim::Report()).find("Apache ECharts") == std::string::npos) return 0;
  return static_cast<int>(idim::EstimatorNames(idim::GainsMode::kIdentify).size());
}
