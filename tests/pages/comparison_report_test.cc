#include "apps/pages/comparison_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <iterator>
#include <sstream>
#include <string>
#include <vector>

namespace idim::comparison_report_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

Estimate Of(const std::string& estimator, const std::vector<std::pair<std::string, double>>& values) {
  Estimate e;
  e.robot = "arm";
  e.estimator = estimator;
  for (const auto& [name, value] : values) {
    ParameterEstimate p;
    p.parameter = {name, name[0] == 'g' ? ParameterKind::kDriveGain : ParameterKind::kBase, 1, "u"};
    p.value = value;
    p.standard_deviation = 0.5;
    SetInterval95(100.0, &p);
    e.parameters.push_back(p);
  }
  return e;
}

std::vector<std::vector<std::string>> Words(const std::string& text) {
  std::vector<std::vector<std::string>> lines;
  std::istringstream stream(text.substr(text.find("\nparameter") + 1));
  for (std::string line; std::getline(stream, line);) {
    std::istringstream words(line);
    lines.emplace_back(std::istream_iterator<std::string>(words), std::istream_iterator<std::string>());
  }
  return lines;
}

TEST(ComparisonToText, ValueSpreadAndDifferenceToTheFirstUsable) {
  Estimate none;
  none.estimator = "ls";
  none.status = Status::Untrusted("no rank");
  Estimate doubtful = Of("an_estimator_of_a_very_long_name", {{"g1", -5.0}, {"B", 0.0}});
  doubtful.status = Status::Untrusted("sign");
  Reference truth;
  truth.name = "truth";
  truth.parameters = {{"g1", 9.0, 0.0}};
  const std::string text =
      ComparisonToText(Comparison{{none, Of("wls", {{"g1", 10.0}, {"A", 1e-9}, {"B", 2.0}}), doubtful}, {}, {truth}});
  EXPECT_THAT(text, HasSubstr("IDIM-LS: no estimate; not to be trusted: no rank\n"));
  EXPECT_THAT(text, HasSubstr("difference to IDIM-WLS in %"));
  const auto lines = Words(text);
  ASSERT_EQ(lines.size(), 4u);
  // Difference by hand: 100 (-5 - 10) / 10.
  EXPECT_THAT(lines[1], ElementsAre("g1", "+1.000e+01", "5.0", "-5.000e+00", "10.0", "-150.0", "+9.000e+00"));
  EXPECT_THAT(lines[2], ElementsAre("A", "+1.000e-09", ">9999"));
  EXPECT_THAT(lines[3], ElementsAre("B", "+2.000e+00", "25.0", "+0.000e+00", ">9999", "-100.0"));
  EXPECT_THAT(text, HasSubstr("IDIM-AN_ESTIMATOR_OF_A_VERY_LONG_NAME (!)"));
  EXPECT_EQ(ComparisonToText(Comparison{{none}, {}, {}}), "IDIM-LS: no estimate; not to be trusted: no rank\n");
}

// Parameters that one estimator cancelled keep their place in the model's order.
TEST(ComparisonToText, OrderIsTheModels) {
  const auto lines = Words(ComparisonToText(Comparison{
      {Of("ls", {{"A", 1.0}, {"C", 1.0}, {"D", 1.0}}), Of("wls", {{"A", 1.0}, {"B", 1.0}, {"D", 1.0}, {"E", 1.0}})},
      {},
      {}}));
  std::vector<std::string> names;
  for (const auto& line : lines) names.push_back(line[0]);
  EXPECT_THAT(names, ElementsAre("parameter", "A", "B", "C", "D", "E"));
}

// limits of the figure of g1: none as long as everything is within a factor of two, else about the estimate to believe.
TEST(RenderComparisonReport, AGainThatIsFarOffDoesNotFlattenTheOthers) {
  const auto limits = [](const std::string& html) {
    const size_t name = html.find("\"parameters\":[\"g1\"]");
    EXPECT_NE(name, std::string::npos);
    const size_t begin = html.rfind("{\"kind\"", name);
    const std::string figure = html.substr(begin, name - begin);
    const size_t at = figure.find("\"limits\":");
    return at == std::string::npos ? std::string() : figure.substr(at, figure.find(']', at) + 1 - at);
  };
  EXPECT_EQ(limits(RenderComparisonReport(Comparison{{Of("ls", {{"g1", 8.0}}), Of("wgtls", {{"g1", 10.0}})}, {}, {}})),
            "");
  const Estimate far = Of("tls", {{"g1", 1000.0}});
  EXPECT_EQ(limits(RenderComparisonReport(Comparison{{far, Of("wgtls", {{"g1", 10.0}})}, {}, {}})),
            "\"limits\":[-5.0,25.0]");
  EXPECT_EQ(limits(RenderComparisonReport(Comparison{{far, Of("wgtls", {{"g1", -10.0}})}, {}, {}})),
            "\"limits\":[-25.0,5.0]");
  // The last is not to be trusted: the one before is the centre.
  Estimate doubtful = far;
  doubtful.status = Status::Untrusted("weak");
  EXPECT_EQ(limits(RenderComparisonReport(Comparison{{Of("ls", {{"g1", 20.0}}), doubtful}, {}, {}})),
            "\"limits\":[-5.0,45.0]");
  // A reference is believed before all.
  Reference truth;
  truth.name = "truth";
  truth.parameters = {{"g1", 50.0, 0.0}};
  EXPECT_EQ(limits(RenderComparisonReport(Comparison{{Of("ls", {{"g1", 20.0}}), far}, {}, {truth}})),
            "\"limits\":[-10.0,110.0]");
}

TEST(RenderComparisonReport, ParametersAreRelativeToTheEstimateToBelieve) {
  Estimate doubtful = Of("wgtls", {{"A", 3.0}});
  doubtful.status = Status::Untrusted("weak");
  Estimate none;
  none.estimator = "tls";
  none.status = Status::Untrusted("no rank");
  const std::string html =
      RenderComparisonReport(Comparison{{Of("ls", {{"A", 1.0}}), none, Of("gtls", {{"A", 2.0}}), doubtful}, {}, {}});
  EXPECT_THAT(html, HasSubstr("95 % intervals, divided by IDIM-GTLS"));
  // Not -1.00 for what was not computed.
  EXPECT_THAT(html, HasSubstr("not to be trusted: no rank"));
  EXPECT_THAT(html, Not(HasSubstr("<td>IDIM-TLS</td><td class=\"number\">-1")));
  EXPECT_EQ(html, RenderComparisonReport(
                      Comparison{{Of("ls", {{"A", 1.0}}), none, Of("gtls", {{"A", 2.0}}), doubtful}, {}, {}}));
}

}  // namespace
}  // namespace idim::comparison_report_test
