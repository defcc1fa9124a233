#include "core/effects/effect.h"

#include <algorithm>

namespace idim {

double ShapeParameter::Within(double from, double to) const {
  const bool has_gap = gap_lower < gap_upper;
  const double lowest = has_gap && from >= gap_upper ? gap_upper : lower;
  const double highest = has_gap && from <= gap_lower ? gap_lower : upper;
  return std::clamp(to, lowest, highest);
}

std::vector<ShapeParameter> Effect::Shapes(const std::vector<EffectMotion>&, const std::vector<int>&) const {
  return {};
}

Eigen::VectorXd Effect::TrueShape(const SimulatedEffect&, const Scenario&) const { return {}; }

}  // namespace idim
