// What the trial prints.

#ifndef IDIM_BENCHMARKS_BLIND_TRIAL_TABLE_H_
#define IDIM_BENCHMARKS_BLIND_TRIAL_TABLE_H_

#include <vector>

#include "benchmarks/blind_trial/run_case.h"

namespace idim::blind_trial {

void PrintCase(int number, const Case& c);
void PrintSummary(const std::vector<Case>& cases);

}  // namespace idim::blind_trial

#endif  // IDIM_BENCHMARKS_BLIND_TRIAL_TABLE_H_
