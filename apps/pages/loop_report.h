// What closing the loop found, as loop.json (schema idim.loop.1), as text for the console and as one HTML page.

#ifndef IDIM_APPS_PAGES_LOOP_REPORT_H_
#define IDIM_APPS_PAGES_LOOP_REPORT_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "solvers/loop/close_loop.h"

namespace idim {

// Of the loop, else of the final estimate: what the program answers with.
Status StatusOf(const LoopResult& result);

// Deterministic but for "seconds", that of the final estimate; the same for any number of threads, as all below.
std::string LoopToJson(const LoopResult& result);

std::string LoopToText(const LoopResult& result);

// The page; without numbers where the declared model could not be fitted.
std::string RenderLoopReport(const LoopResult& result);

}  // namespace idim

#endif  // IDIM_APPS_PAGES_LOOP_REPORT_H_
