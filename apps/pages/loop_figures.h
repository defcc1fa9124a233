// Sections of a closed loop's page that show data: curves of effects, residuals before and after.

#ifndef IDIM_APPS_PAGES_LOOP_FIGURES_H_
#define IDIM_APPS_PAGES_LOOP_FIGURES_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/report/report.h"
#include "solvers/loop/close_loop.h"

namespace idim {

// The declared and the final model in every figure.
inline constexpr SeriesColor kBefore = SeriesColor::kOrange;
inline constexpr SeriesColor kAfter = SeriesColor::kModel;

// Without blocks where no effect is of the kind.
Section FrictionSection(const LoopResult& result);
Section OtherEffectsSection(const LoopResult& result);

// Over velocity, over position, over time in each recording.
std::vector<Section> ResidualSections(const LoopResult& result);

}  // namespace idim

#endif  // IDIM_APPS_PAGES_LOOP_FIGURES_H_
