// What every page owes its reader: the unit of each joint's kind on its axes, a colour of its own for every series.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "apps/pages/comparison_report.h"
#include "apps/pages/identification_report.h"
#include "apps/pages/validation_report.h"
#include "core/estimate/estimate.h"

namespace idim::units_and_colors_test {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using Json = nlohmann::json;

Json Specs(const std::string& html) {
  const std::string begin = "id=\"figure-specs\">";
  const size_t at = html.find(begin) + begin.size();
  return Json::parse(html.substr(at, html.find("</script>", at) - at));
}

Robot TurnAndSlide() {
  Robot robot;
  robot.name = "arm";
  robot.joints = {JointFromModifiedDh(JointType::kRevolute, 0, 0, 0, 0),
                  JointFromModifiedDh(JointType::kPrismatic, 0, 0, 0, 0)};
  return robot;
}

RecordingSeries Series(const std::string& name) {
  RecordingSeries s;
  s.name = name;
  s.use = "identification";
  s.t = s.decimated_t = Eigen::VectorXd::LinSpaced(5, 0.0, 1.0);
  s.torque = s.model = s.decimated_torque = s.decimated_model = Eigen::MatrixXd::Ones(5, 2);
  s.decimated_q = s.decimated_dq = Eigen::MatrixXd::Ones(5, 2);
  return s;
}

RecordingFit Fit(const std::string& name) {
  RecordingFit fit;
  fit.name = name;
  fit.use = "identification";
  fit.relative_error_percent = fit.rms_torque = fit.rms_torque_unfiltered = fit.residual_lag1 = Eigen::Vector2d(1, 2);
  return fit;
}

Estimate Of(const std::string& estimator) {
  Estimate e;
  e.robot = "arm";
  e.status = Status::Ok();
  e.estimator = estimator;
  ParameterEstimate g;
  g.parameter = {"g1", ParameterKind::kDriveGain, 1, "N.m per signal unit"};
  g.value = 2.0;
  g.standard_deviation = 0.1;
  SetInterval95(100.0, &g);
  ParameterEstimate p = g;
  p.parameter = {"Fs2", ParameterKind::kFriction, 2, "N"};
  e.parameters = {g, p};
  e.recordings = {Fit("a"), Fit("b")};
  return e;
}

// The titles of the axes of the figures of a joint, whose unit stands in brackets.
std::vector<std::string> AxisTitles(const Json& specs, const std::string& joint) {
  std::vector<std::string> titles;
  for (const Json& spec : specs) {
    if (spec.at("title") != joint) continue;
    for (const char* key : {"xTitle", "yTitle"}) {
      if (spec.contains(key)) titles.push_back(spec.at(key));
    }
  }
  return titles;
}

void ExpectUnitsByKind(const std::string& html) {
  const std::vector<std::string> turns = AxisTitles(Specs(html), "joint 1"),
                                 slides = AxisTitles(Specs(html), "joint 2");
  ASSERT_THAT(turns, Not(IsEmpty()));
  ASSERT_EQ(turns.size(), slides.size());
  for (size_t k = 0; k < turns.size(); ++k) {
    const bool velocity = turns[k].find("velocity") != std::string::npos;
    EXPECT_THAT(turns[k], HasSubstr(velocity ? "[rad/s]" : "[N.m]"));
    EXPECT_THAT(slides[k], HasSubstr(velocity ? "[m/s]" : "[N]"));
  }
}

TEST(Pages, UnitsOfAnIdentificationFollowTheJoint) {
  ExpectUnitsByKind(RenderIdentificationReport(TurnAndSlide(), Of("wls"), {Series("a"), Series("b")}, {}));
}

TEST(Pages, UnitsOfAValidationFollowTheJoint) {
  Validation v;
  v.name = "estimate";
  v.recordings = {{"a", "", Fit("a"), 10.0, {}}};
  v.series = {Series("a")};
  ExpectUnitsByKind(RenderValidationReport(TurnAndSlide(), {v}));
}

TEST(Pages, TheTextNamesTheUnitsOfItsRow) {
  EXPECT_THAT(EstimateToText(Of("wls"), "N.m, N"), HasSubstr("unfiltered torque, N.m, N\n"));
}

// Seven estimators and three published tables, one estimator without numbers: none shares a colour, and each keeps its
// own in every figure.
TEST(Pages, EstimatorsSideBySideKeepColorsOfTheirOwn) {
  Comparison comparison;
  for (const char* name : {"ls", "wls", "tls", "wtls", "gtls", "wgtls", "eiv"}) {
    comparison.estimates.push_back(Of(name));
    comparison.estimates.back().singular_values = Eigen::Vector2d(2, 1);
  }
  comparison.estimates[2].parameters.clear();
  for (const char* name : {"maker", "table", "twin"}) {
    Reference reference;
    reference.name = name;
    reference.parameters = {{"g1", 2.0, 0.0}, {"Fs2", 2.0, 0.0}};
    comparison.references.push_back(reference);
  }
  std::map<std::string, std::set<std::string>> colors_of;
  std::set<std::string> colors;
  size_t most = 0;
  for (const Json& spec : Specs(RenderComparisonReport(comparison))) {
    most = std::max(most, spec.at("series").size());
    for (const Json& series : spec.at("series")) {
      colors_of[series.at("name")].insert(series.at("color").get<std::string>());
      colors.insert(series.at("color").get<std::string>());
    }
  }
  EXPECT_EQ(most, 9u);
  EXPECT_EQ(colors_of.size(), 10u);
  EXPECT_EQ(colors.size(), 10u);
  for (const auto& [name, own] : colors_of) EXPECT_EQ(own.size(), 1u) << name;
}

}  // namespace
}  // namespace idim::units_and_colors_test
