// Colours of series: those with a meaning, and as many that stay apart as there are series to compare.

#ifndef IDIM_CORE_REPORT_COLOR_H_
#define IDIM_CORE_REPORT_COLOR_H_

#include <cstddef>
#include <string>

namespace idim {

// Colours by meaning, so that a curve looks the same in every figure of every report. Measured red and model blue are
// those of Fig. 2 of Gautier & Briot (2014), in tones that stay apart for the colour-blind (Tol's vibrant scheme).
// Values from kFirstOfSets on are those of ColorOfSet() that have no name.
enum class SeriesColor { kMeasured, kModel, kResidual, kOrange, kTeal, kPurple, kCyan, kFirstOfSets };

// For what is compared side by side: another colour for every k. The first ten are easily told apart.
SeriesColor ColorOfSet(std::size_t k);

// "#0077bb".
std::string ColorHex(SeriesColor color);

}  // namespace idim

#endif  // IDIM_CORE_REPORT_COLOR_H_
