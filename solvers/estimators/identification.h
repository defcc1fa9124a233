// What every estimator answers with.

#ifndef IDIM_SOLVERS_ESTIMATORS_IDENTIFICATION_H_
#define IDIM_SOLVERS_ESTIMATORS_IDENTIFICATION_H_

#include <vector>

#include "core/estimate/estimate.h"
#include "core/estimate/series.h"

namespace idim {

struct Identification {
  Estimate estimate;  // status not ok: only names and the status are set
  std::vector<RecordingSeries> series;
};

}  // namespace idim

#endif  // IDIM_SOLVERS_ESTIMATORS_IDENTIFICATION_H_
