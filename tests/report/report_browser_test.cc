// Reports opened in a browser: every kind of figure is drawn, and a broken one is noticed.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <limits>
#include <optional>
#include <string>

#include "core/report/report.h"
#include "tests/report/demo_report.h"
#include "tests/support/browser.h"

namespace idim::testing::report_browser_test {
namespace {

class ReportBrowserTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const std::optional<std::string> found = FindChromium();
    if (!found) GTEST_SKIP() << "no Chromium in $IDIM_CHROMIUM or $PATH";
    chromium_ = *found;
    // A folder with a space and a quote: the command line must survive both.
    folder_ = std::filesystem::path(::testing::TempDir()) /
              (std::string("report's page ") + ::testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder_);
  }

  void TearDown() override {
    if (!folder_.empty()) std::filesystem::remove_all(folder_);
  }

  DrawnReport Open(const std::string& html) {
    const std::filesystem::path path = folder_ / "report.html";
    std::ofstream(path, std::ios::binary) << html;
    const Result<DrawnReport> drawn = OpenReport(chromium_, path);
    EXPECT_TRUE(drawn.ok()) << drawn.status().message();
    return drawn.ok() ? *drawn : DrawnReport();
  }

  std::string chromium_;
  std::filesystem::path folder_;
};

std::string Replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  if (at != std::string::npos) text.replace(at, from.size(), to);
  return text;
}

Report OneFigure(const Figure& figure) {
  Report report;
  report.title = "one figure";
  report.sections.push_back({"section", {FigureGrid{1, {figure}}}});
  return report;
}

TimeFigure Ramp() {
  return {"ramp",
          "torque [N.m]",
          Eigen::VectorXd::LinSpaced(100, 0.0, 1.0),
          {{"measured", Eigen::VectorXd::LinSpaced(100, -1.0, 1.0), SeriesColor::kMeasured}},
          ""};
}

TEST_F(ReportBrowserTest, DrawsEveryFigureOfAWholeRecording) {
  const DrawnReport drawn = Open(RenderReport(DemoReport(6, 45000)));
  EXPECT_EQ(drawn.figures_expected, 6 + 6 + 3 + 3);  // torque and scatter by joint, errors, gains, parameters, runs
  EXPECT_EQ(drawn.figures_drawn, drawn.figures_expected);
  EXPECT_EQ(drawn.script_errors, 0);
  EXPECT_THAT(drawn.figure_drawn, ::testing::AllOf(::testing::SizeIs(18), ::testing::Each(true)));
  EXPECT_TRUE(drawn.AllDrawn());
}

TEST_F(ReportBrowserTest, DrawsWhereTitlesTryToBreakOut) {
  TimeFigure figure = Ramp();
  figure.title = "</script><script>throw 1</script> \"'&amp; {{body}} \xE2\x80\xA8";
  figure.y_title = "</script><img src=x onerror=throw(1)>";
  figure.traces[0].name = "<!--<script>";
  Report report = OneFigure(figure);
  report.title = "</title><script>throw 1</script>";
  report.subtitle = "<img src=x onerror=throw(1)>";
  EXPECT_TRUE(Open(RenderReport(report)).AllDrawn());
}

TEST_F(ReportBrowserTest, DrawsAcrossGapsAndWithoutIntervals) {
  TimeFigure gaps = Ramp();
  gaps.traces[0].value.segment(30, 40).setConstant(std::numeric_limits<double>::quiet_NaN());
  EXPECT_TRUE(Open(RenderReport(OneFigure(gaps))).AllDrawn());
  BarFigure bars{"bars", "joint", "error [%]", {"1", "2"}, {}};
  bars.sets = {{"identification", Eigen::Vector2d(std::numeric_limits<double>::quiet_NaN(), 7.5), SeriesColor::kModel}};
  EXPECT_TRUE(Open(RenderReport(OneFigure(bars))).AllDrawn());
  const Eigen::VectorXd none = Eigen::VectorXd::Constant(2, std::numeric_limits<double>::quiet_NaN());
  IntervalFigure points{"points", "value", {"a", "b"}, {{"published", Eigen::Vector2d(1.0, 2.0), none, none}}};
  EXPECT_TRUE(Open(RenderReport(OneFigure(points))).AllDrawn());
}

// What a study of simulated runs may come to: a set without spread, one wholly beyond the limits, no positive number.
TEST_F(ReportBrowserTest, DrawsHistogramsAndBands) {
  HistogramFigure constant{"constant", "x", {{"same", Eigen::VectorXd::Constant(5, 3.0), SeriesColor::kModel}}};
  EXPECT_TRUE(Open(RenderReport(OneFigure(constant))).AllDrawn());
  HistogramFigure beyond{"beyond",
                         "x",
                         {{"far", Eigen::VectorXd::Constant(5, 30.0), SeriesColor::kModel},
                          {"near", Eigen::Vector3d(0.1, 0.2, 0.9), SeriesColor::kOrange}}};
  beyond.limits = {0.0, 1.0};
  EXPECT_TRUE(Open(RenderReport(OneFigure(beyond))).AllDrawn());
  IntervalFigure band{"band",
                      "value",
                      {"a"},
                      {{"set", Eigen::VectorXd::Ones(1), Eigen::VectorXd::Zero(1), Eigen::VectorXd::Constant(1, 2.0)}}};
  band.band = ReferenceBand{"nominal", 1.0, 0.8, 1.2};
  EXPECT_TRUE(Open(RenderReport(OneFigure(band))).AllDrawn());
  ScatterFigure nothing{"nothing", "x", "y", {{"set", Eigen::Vector2d(-1, -2), Eigen::Vector2d(1, 2)}}};
  nothing.logarithmic = true;
  EXPECT_EQ(Open(RenderReport(OneFigure(nothing))).figures_drawn, 0);
}

TEST_F(ReportBrowserTest, SeesAFigureWithCorruptSamples) {
  const std::string html = RenderReport(DemoReport(2, 100));
  // The first vector that is not the time: the measured torque of joint 1, in one figure only.
  const std::size_t samples = html.find("id=\"samples-1\"");
  const std::size_t begin = html.find('>', samples) + 1;
  std::string corrupt = html;
  corrupt.erase(begin, 8);
  const DrawnReport drawn = Open(corrupt);
  EXPECT_EQ(drawn.figures_expected, 2 + 2 + 3 + 3);
  EXPECT_EQ(drawn.figures_drawn, drawn.figures_expected - 1);
  EXPECT_GE(drawn.script_errors, 1);
  EXPECT_THAT(drawn.figure_drawn, ::testing::ElementsAre(false, true, true, true, true, true, true, true, true, true));
  EXPECT_FALSE(drawn.AllDrawn());
}

TEST_F(ReportBrowserTest, SeesAFigureWithoutData) {
  TimeFigure no_traces = Ramp();
  no_traces.traces.clear();
  TimeFigure no_samples = Ramp();
  no_samples.t.resize(0);
  no_samples.traces[0].value.resize(0);
  TimeFigure no_numbers = Ramp();
  no_numbers.traces[0].value.setConstant(std::numeric_limits<double>::quiet_NaN());
  TimeFigure one_of_two = Ramp();
  one_of_two.traces.push_back({"modelled", no_numbers.traces[0].value, SeriesColor::kModel});
  Report report = OneFigure(no_traces);
  report.sections.push_back({"more", {FigureGrid{2, {no_samples, no_numbers, one_of_two, Ramp()}}}});
  const DrawnReport drawn = Open(RenderReport(report));
  EXPECT_THAT(drawn.figure_drawn, ::testing::ElementsAre(false, false, false, false, true));
  EXPECT_EQ(drawn.figures_drawn, 1);
}

TEST_F(ReportBrowserTest, SeesCurvesThatLeaveNoInk) {
  // ECharts is content, yet nothing is on the paper: only the look at the pixels can tell.
  const std::string html =
      Replaced(RenderReport(OneFigure(Ramp())), "lineStyle: {width: 1.2}", "lineStyle: {opacity: 0}");
  const DrawnReport drawn = Open(html);
  EXPECT_EQ(drawn.figures_expected, 1);
  EXPECT_EQ(drawn.figures_drawn, 0);
}

TEST_F(ReportBrowserTest, CountsAScriptErrorOutsideFigures) {
  const std::string html =
      Replaced(RenderReport(OneFigure(Ramp())), "drawAll();\n</script>", "drawAll();\nnoSuchFunction();\n</script>");
  const DrawnReport drawn = Open(html);
  EXPECT_EQ(drawn.figures_drawn, 1);
  EXPECT_EQ(drawn.script_errors, 1);
  EXPECT_FALSE(drawn.AllDrawn());
}

TEST_F(ReportBrowserTest, RefusesToLoadFromElsewhere) {
  // The image is in no document: that nothing answers at its address is no error of the page, that it asked is.
  const std::string html = Replaced(RenderReport(OneFigure(Ramp())), "drawAll();\n</script>",
                                    "drawAll();\nnew Image().src = 'http://localhost:9/x.png';\n</script>");
  EXPECT_EQ(Open(html).script_errors, 1);
}

}  // namespace
}  // namespace idim::testing::report_browser_test
