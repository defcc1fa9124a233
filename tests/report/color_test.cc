// Colours of sets: as many as there are sets, and those of a usual page easily told apart.

#include "core/report/color.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <set>
#include <string>

#include "core/report/report.h"

namespace idim::color_test {
namespace {

// CIELAB of "#rrggbb" in sRGB, white point D65 (IEC 61966-2-1, CIE 15).
std::array<double, 3> Lab(const std::string& hex) {
  std::array<double, 3> rgb;
  for (int i = 0; i < 3; ++i) {
    const double c = std::stoi(hex.substr(1 + 2 * i, 2), nullptr, 16) / 255.0;
    rgb[i] = c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
  }
  const auto f = [](double t) { return t > 0.008856 ? std::cbrt(t) : 7.787 * t + 16.0 / 116.0; };
  const double x = f((0.4124 * rgb[0] + 0.3576 * rgb[1] + 0.1805 * rgb[2]) / 0.9505);
  const double y = f(0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2]);
  const double z = f((0.0193 * rgb[0] + 0.1192 * rgb[1] + 0.9505 * rgb[2]) / 1.089);
  return {116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)};
}

double Distance(const std::string& a, const std::string& b) {
  const auto p = Lab(a), q = Lab(b);
  return std::sqrt(std::pow(p[0] - q[0], 2) + std::pow(p[1] - q[1], 2) + std::pow(p[2] - q[2], 2));
}

// 2.3 is what an eye just notices side by side; ten times that is seen at a glance. White is far from all of them.
TEST(ColorOfSet, ColorsOfOneFigureStayApart) {
  EXPECT_NEAR(Distance("#ffffff", "#000000"), 100.0, 0.1);
  for (std::size_t k = 0; k < 20; ++k) {
    EXPECT_GT(Distance(ColorHex(ColorOfSet(k)), "#ffffff"), 20.0) << k;
    for (std::size_t other = 0; other < k; ++other) {
      EXPECT_GT(Distance(ColorHex(ColorOfSet(k)), ColorHex(ColorOfSet(other))), 23.0) << k << " and " << other;
    }
  }
}

TEST(ColorOfSet, HasAnotherColorForEverySet) {
  std::set<std::string> seen;
  for (std::size_t k = 0; k < 60; ++k) {
    const std::string hex = ColorHex(ColorOfSet(k));
    EXPECT_THAT(hex, ::testing::MatchesRegex("#[0-9a-f]{6}"));
    EXPECT_TRUE(seen.insert(hex).second) << k << ": " << hex;
  }
}

// Measured and model as in Fig. 2 of the paper: red and blue.
TEST(ColorHex, MeaningsKeepTheirColors) {
  EXPECT_EQ(ColorHex(SeriesColor::kMeasured), "#cc3311");
  EXPECT_EQ(ColorHex(SeriesColor::kModel), "#0077bb");
  EXPECT_EQ(ColorOfSet(0), SeriesColor::kModel);
  EXPECT_EQ(ColorOfSet(1), SeriesColor::kMeasured);
}

TEST(ReportDeathTest, TwoSeriesInOneColorAreABug) {
  BarFigure figure;
  figure.title = "errors";
  figure.categories = {"joint 1"};
  figure.sets = {{"one", Eigen::VectorXd::Ones(1), ColorOfSet(3)}, {"two", Eigen::VectorXd::Ones(1), ColorOfSet(3)}};
  Report report;
  report.sections.push_back({"section", {FigureGrid{1, {figure}}}});
  EXPECT_DEATH(RenderReport(report), "errors: \"two\" has the colour of another");
}

}  // namespace
}  // namespace idim::color_test
