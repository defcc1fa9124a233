#include "core/report/color.h"

#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace idim {
namespace {

constexpr std::size_t kNumNamed = static_cast<std::size_t>(SeriesColor::kFirstOfSets);

// In the order of SeriesColor, then those without a name: Tol's vibrant scheme, grey darkened, and what lies farthest
// from it in CIELAB. Any two differ by at least 23 there.
constexpr const char* kTable[] = {"#cc3311", "#0077bb", "#666b70", "#ee7733", "#009988", "#882277", "#33bbee",
                                  "#999933", "#ee3377", "#332288", "#33cc33", "#c319e6", "#5c180a", "#1f5214",
                                  "#1919e6", "#272145", "#33cc80", "#bd7599", "#bd9975", "#d65cd6"};
constexpr std::size_t kNumTable = sizeof(kTable) / sizeof(kTable[0]);

// Hues a golden section apart, never twice the same, in three tones.
std::string MadeColor(std::size_t k) {
  constexpr double kGolden = 0.6180339887498949, kSaturation = 0.5, kLightness[] = {0.27, 0.42, 0.57};
  const double lightness = kLightness[k % 3];
  const double hue = 12.0 * std::fmod(static_cast<double>(k) * kGolden, 1.0);
  const double chroma = kSaturation * std::min(lightness, 1.0 - lightness);
  const auto channel = [&](double offset) {
    const double place = std::fmod(offset + hue, 12.0);
    const double level = lightness - chroma * std::max(-1.0, std::min({place - 3.0, 9.0 - place, 1.0}));
    return static_cast<int>(std::lround(255.0 * level));
  };
  char text[8];
  std::snprintf(text, sizeof(text), "#%02x%02x%02x", static_cast<unsigned char>(channel(0.0)),
                static_cast<unsigned char>(channel(8.0)), static_cast<unsigned char>(channel(4.0)));
  return text;
}

}  // namespace

SeriesColor ColorOfSet(std::size_t k) {
  constexpr SeriesColor kNamed[] = {SeriesColor::kModel, SeriesColor::kMeasured, SeriesColor::kOrange,
                                    SeriesColor::kTeal,  SeriesColor::kPurple,   SeriesColor::kResidual,
                                    SeriesColor::kCyan};
  static_assert(sizeof(kNamed) / sizeof(kNamed[0]) == kNumNamed);
  return k < kNumNamed ? kNamed[k] : static_cast<SeriesColor>(k);
}

std::string ColorHex(SeriesColor color) {
  CHECK_GE(static_cast<int>(color), 0);
  const auto k = static_cast<std::size_t>(color);
  return k < kNumTable ? kTable[k] : MadeColor(k);
}

}  // namespace idim
