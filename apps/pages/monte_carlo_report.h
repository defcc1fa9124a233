// A Monte-Carlo study as tables and pictures, for the console and for report.html.
//
// Where gains are identified the pictures are of the gains, in percent of their truth, and the other parameters are
// summed up; with known gains they are of all parameters.

#ifndef IDIM_APPS_PAGES_MONTE_CARLO_REPORT_H_
#define IDIM_APPS_PAGES_MONTE_CARLO_REPORT_H_

#include <string>
#include <vector>

#include "core/estimate/monte_carlo.h"
#include "core/report/report.h"

namespace idim {

// What was simulated; a line an estimator with failures, NEES and coverage; bias, spread and coverage of each gain.
std::string MonteCarloToText(const MonteCarlo& monte_carlo);

// Sections "Monte Carlo: ..." in the order in which they are read.
std::vector<Section> MonteCarloSections(const MonteCarlo& monte_carlo);

}  // namespace idim

#endif  // IDIM_APPS_PAGES_MONTE_CARLO_REPORT_H_
