#include "core/report/report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "tests/report/demo_report.h"

namespace idim::testing::report_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

std::string Between(const std::string& text, const std::string& begin, const std::string& end, std::size_t from = 0) {
  const std::size_t at = text.find(begin, from);
  EXPECT_NE(at, std::string::npos) << begin;
  if (at == std::string::npos) return "";
  return text.substr(at + begin.size(), text.find(end, at + begin.size()) - at - begin.size());
}

// RFC 4648 by its table, independent of the encoder; EXPECTs the length and the padding to be right.
std::string DecodeBase64(const std::string& text) {
  const std::string alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  EXPECT_EQ(text.size() % 4, 0u);
  std::string bytes;
  for (std::size_t i = 0; i + 4 <= text.size(); i += 4) {
    std::uint32_t group = 0;
    int padding = 0;
    for (std::size_t k = i; k < i + 4; ++k) {
      const std::size_t digit = text[k] == '=' ? 0 : alphabet.find(text[k]);
      EXPECT_NE(digit, std::string::npos) << text[k];
      padding += text[k] == '=';
      group = group << 6 | static_cast<std::uint32_t>(digit);
    }
    for (int k = 0; k < 3 - padding; ++k) bytes += static_cast<char>(group >> (16 - 8 * k) & 0xff);
  }
  return bytes;
}

// Little-endian by hand, on a machine of either order.
template <typename Float, typename Bits>
std::vector<Float> Samples(const std::string& html, int index) {
  const std::string tag = "id=\"samples-" + std::to_string(index) + "\"";
  const std::string bytes = DecodeBase64(Between(html, ">", "<", html.find(tag)));
  EXPECT_EQ(bytes.size() % sizeof(Float), 0u);
  std::vector<Float> values(bytes.size() / sizeof(Float));
  for (std::size_t i = 0; i < values.size(); ++i) {
    Bits bits = 0;
    for (std::size_t k = 0; k < sizeof(Bits); ++k) {
      bits |= static_cast<Bits>(static_cast<unsigned char>(bytes[i * sizeof(Bits) + k])) << (8 * k);
    }
    std::memcpy(&values[i], &bits, sizeof(bits));
  }
  return values;
}

nlohmann::json Specs(const std::string& html) {
  return nlohmann::json::parse(Between(html, "id=\"figure-specs\">", "</script>"));
}

Report OneBlock(Block block) {
  Report report;
  report.title = "title";
  report.sections.push_back({"section", {std::move(block)}});
  return report;
}

std::string RenderFigure(Figure figure) { return RenderReport(OneBlock(FigureGrid{1, {std::move(figure)}})); }

TEST(ReportTest, SamplesSurviveTheRoundTrip) {
  // Every remainder of the length by three bytes: 4, 8 and 12 bytes of samples.
  for (const int n : {1, 2, 3, 1000}) {
    TimeFigure figure;
    figure.t = Eigen::VectorXd::LinSpaced(n, 1.7e9, 1.7e9 + 9.0);
    figure.traces = {{"tau", Eigen::VectorXd::LinSpaced(n, -1e-3, 77.7), SeriesColor::kMeasured}};
    const std::string html = RenderFigure(figure);
    const nlohmann::json spec = Specs(html).at(0);
    const std::vector<double> t = Samples<double, std::uint64_t>(html, spec.at("t"));
    const std::vector<float> tau = Samples<float, std::uint32_t>(html, spec.at("series").at(0).at("samples"));
    ASSERT_EQ(static_cast<int>(t.size()), n);
    ASSERT_EQ(static_cast<int>(tau.size()), n);
    for (int i = 0; i < n; ++i) {
      EXPECT_EQ(t[i], figure.t[i]);
      EXPECT_EQ(tau[i], static_cast<float>(figure.traces[0].value[i]));
    }
  }
}

TEST(ReportTest, WhatIsNotFiniteIsNaN) {
  TimeFigure figure;
  figure.t = Eigen::Vector4d(0, 1, 2, 3);
  const double inf = std::numeric_limits<double>::infinity();
  figure.traces = {{"tau", Eigen::Vector4d(1.0, std::nan(""), -inf, inf), SeriesColor::kMeasured}};
  const std::vector<float> tau = Samples<float, std::uint32_t>(RenderFigure(figure), 1);
  EXPECT_EQ(tau[0], 1.0f);
  for (int i = 1; i < 4; ++i) EXPECT_TRUE(std::isnan(tau[i]));
  // The same page whatever the sign of the NaN.
  TimeFigure other = figure;
  other.traces[0].value[1] = -std::nan("");
  EXPECT_EQ(RenderFigure(figure), RenderFigure(other));
}

TEST(ReportTest, EqualVectorsAreHeldOnce) {
  const std::string html = RenderReport(DemoReport(6, 100));
  int vectors = 0;
  for (std::size_t at = html.find("id=\"samples-"); at != std::string::npos; at = html.find("id=\"samples-", at + 1)) {
    ++vectors;
  }
  // One time; measured, modelled, residual and velocity by joint (the residual in two figures).
  // And x and y of two scatters.
  EXPECT_EQ(vectors, 1 + 4 * 6 + 4);
}

TEST(ReportTest, AWholeRecordingStaysBelowTwelveMegabytes) {
  EXPECT_LT(RenderReport(DemoReport(6, 45000)).size(), 12u << 20);
}

TEST(ReportTest, SameReportSameBytes) { EXPECT_EQ(RenderReport(DemoReport(3, 200)), RenderReport(DemoReport(3, 200))); }

TEST(ReportTest, MarkupInStringsIsShownNotObeyed) {
  const std::string evil = "</script><b onclick=\"x\">'&{{samples}}<!--";
  const std::string shown = "&lt;/script&gt;&lt;b onclick=&quot;x&quot;&gt;&#39;&amp;{{samples}}&lt;!--";
  TimeFigure figure;
  figure.title = evil;
  figure.y_title = evil;
  figure.link = evil;
  figure.t = Eigen::Vector2d(0, 1);
  figure.traces = {{evil, Eigen::Vector2d(1, 2), SeriesColor::kMeasured}};
  IntervalFigure intervals{
      evil,
      evil,
      {evil},
      {{evil, Eigen::VectorXd::Ones(1), Eigen::VectorXd::Zero(1), Eigen::VectorXd::Constant(1, 2.0)}}};
  Report report;
  report.title = evil;
  report.subtitle = evil;
  report.sections.push_back(
      {evil,
       {Paragraph{evil, Paragraph::Kind::kWarning}, KeyValues{{{evil, evil}}},
        Table{evil, {{evil, Table::Align::kLeft}, {evil, Table::Align::kNumber}}, {{evil, evil}}, {}},
        FigureGrid{1, {figure, intervals}}}});
  const std::string html = RenderReport(report);
  EXPECT_THAT(html, Not(HasSubstr(evil)));
  EXPECT_THAT(html, Not(HasSubstr("<b onclick")));
  // <title>, h1, subtitle, h2, paragraph, key, value, caption, two headings, two cells, two figures' caption and label.
  int count = 0;
  for (std::size_t at = html.find(shown); at != std::string::npos; at = html.find(shown, at + 1)) ++count;
  EXPECT_EQ(count, 12 + 2 * 2);
  const nlohmann::json specs = Specs(html);
  EXPECT_EQ(specs.at(0).at("title"), evil);
  EXPECT_EQ(specs.at(0).at("series").at(0).at("name"), evil);
  EXPECT_EQ(specs.at(1).at("parameters").at(0), evil);
}

TEST(ReportTest, ScriptsEndWhereTheyShould) {
  const std::string html = RenderReport(DemoReport(2, 100));
  std::size_t open = 0;
  for (std::size_t at = 0; (at = html.find("<script", at)) != std::string::npos; ++at) ++open;
  std::size_t close = 0;
  for (std::size_t at = 0; (at = html.find("</script", at)) != std::string::npos; ++at) ++close;
  EXPECT_EQ(open, close);
  EXPECT_EQ(close, 1u + 4u * 2u + 4u + 3u);  // samples, specifications, ECharts, ours
}

TEST(ReportTest, BytesThatAreNotUtf8DoNotThrow) {
  TimeFigure figure;
  figure.title = "St\xE4ubli";
  figure.t = Eigen::Vector2d(0, 1);
  figure.traces = {{"a", Eigen::Vector2d(1, 2), SeriesColor::kMeasured}};
  EXPECT_EQ(Specs(RenderFigure(figure)).at(0).at("title"), "St\xEF\xBF\xBDubli");
}

TEST(ReportTest, LoadsNothingFromElsewhere) {
  const std::string html = RenderReport(DemoReport(2, 100));
  // ECharts itself writes an <img> for a picture that it has made; an address in one is what must not be.
  const std::vector<std::pair<std::string, std::string>> loads = {
      {"<script[^>]*[ \n]src", "<script defer src=\"plot.js\">"},
      {"<link", "<link rel=\"stylesheet\""},
      {"<iframe", "<iframe>"},
      {"<img[^>]*src=[^a-z>]*(https?:)?//", "<img src=\"https://example.org/a.png\">"},
      {"@import", "@import 'a.css'"},
      {"url[(] *[\"']?(https?:)?//", "url(\"//example.org/font.woff\")"}};
  for (const auto& [pattern, example] : loads) {
    EXPECT_THAT(example, ::testing::ContainsRegex(pattern));
    EXPECT_FALSE(::testing::Matches(::testing::ContainsRegex(pattern))(html)) << pattern;
  }
  EXPECT_THAT(html, HasSubstr("Content-Security-Policy\" content=\"default-src 'none'"));
}

TEST(ReportTest, CarriesTheLicencesOfWhatItEmbeds) {
  const std::string html = RenderReport(Report());
  EXPECT_THAT(html, HasSubstr("Apache ECharts\nCopyright"));
  EXPECT_THAT(html, HasSubstr("TERMS AND CONDITIONS FOR USE, REPRODUCTION, AND DISTRIBUTION"));
  EXPECT_THAT(html, HasSubstr("Mike Bostock"));
}

TEST(ReportTest, TablesAlignDecimalPoints) {
  Table table;
  table.columns = {{"name", Table::Align::kLeft}, {"value", Table::Align::kNumber}, {"n", Table::Align::kRight}};
  table.rows = {{"a", "-1.25", "3"}, {"b", "10", "4"}, {"c", "0.5", "5"}};
  table.muted_rows = {1};
  const std::string html = RenderReport(OneBlock(table));
  EXPECT_THAT(html,
              HasSubstr("<tr><td>a</td><td class=\"right\">-1<span class=\"fraction\" style=\"width:3ch\">.25</span>"
                        "</td><td class=\"right\">3</td></tr>"));
  EXPECT_THAT(html, HasSubstr("<tr class=\"muted\"><td>b</td><td class=\"right\">10<span class=\"fraction\" "
                              "style=\"width:3ch\"></span></td>"));
}

TEST(ReportTest, IntervalsSayWhatTheyAreDividedBy) {
  IntervalFigure figure{"f", "v", {"a", "b"}, {}};
  figure.sets = {{"one", Eigen::Vector2d(-2, std::nan("")), Eigen::Vector2d(-3, 0), Eigen::Vector2d(-1, 1)},
                 {"two", Eigen::Vector2d(-4, 1), Eigen::Vector2d(-5, 0), Eigen::Vector2d(-3, 2), ColorOfSet(1)}};
  EXPECT_EQ(Specs(RenderFigure(figure)).at(0).at("unit"), nlohmann::json::parse("[1.0, 1.0]"));
  figure.scale = IntervalFigure::Scale::kRelativeToFirst;
  const nlohmann::json spec = Specs(RenderFigure(figure)).at(0);
  EXPECT_EQ(spec.at("unit"), nlohmann::json::parse("[-2.0, null]"));
  EXPECT_EQ(spec.at("series").at(1).at("value"), nlohmann::json::parse("[-4.0, 1.0]"));
}

// Bins [0, 1), [1, 2), [2, 3), [3, 4]; the last holds its upper end, what is not finite does not count.
TEST(ReportTest, HistogramCountsByHand) {
  Eigen::VectorXd values(11);
  values << 0.0, 0.5, 1.0, 2.9, 3.0, 4.0, 4.0, -0.1, 4.1, 77.0, std::nan("");
  HistogramFigure figure{"h", "x", {{"set", values, SeriesColor::kModel}}};
  figure.limits = {0.0, 4.0};
  figure.bins = 4;
  const nlohmann::json spec = Specs(RenderFigure(figure)).at(0);
  EXPECT_EQ(spec.at("kind"), "histogram");
  EXPECT_EQ(spec.at("lower"), 0.0);
  EXPECT_EQ(spec.at("width"), 1.0);
  const nlohmann::json& set = spec.at("series").at(0);
  EXPECT_EQ(set.at("count"), 10);
  EXPECT_EQ(set.at("beyond"), 3);
  EXPECT_EQ(set.at("percent"), nlohmann::json::parse("[20.0, 10.0, 10.0, 30.0]"));
  EXPECT_FALSE(spec.contains("mark"));
  EXPECT_FALSE(spec.contains("expected"));

  // Without limits nothing is beyond; values that are all the same have a width all the same.
  figure.limits.reset();
  EXPECT_EQ(Specs(RenderFigure(figure)).at(0).at("series").at(0).at("beyond"), 0);
  figure.sets[0].value = Eigen::Vector2d(-5.0, -5.0);
  const nlohmann::json same = Specs(RenderFigure(figure)).at(0);
  EXPECT_GT(same.at("width").get<double>(), 0.0);
  EXPECT_EQ(same.at("series").at(0).at("beyond"), 0);

  // Of a standard normal variable, 68.27 % lie within one deviation, 95.45 % within two.
  figure.limits = {-2.0, 2.0};
  figure.standard_normal = true;
  const nlohmann::json expected = Specs(RenderFigure(figure)).at(0).at("expected");
  EXPECT_NEAR(expected.at(1).get<double>() + expected.at(2).get<double>(), 68.2689, 1e-3);
  EXPECT_NEAR(expected.at(0).get<double>() + expected.at(3).get<double>(), 95.4500 - 68.2689, 1e-3);
}

TEST(ReportTest, BandsAndLabelsReachThePage) {
  ScatterFigure figure{"s", "x", "y", {{"set", Eigen::Vector2d(0, 1), Eigen::Vector2d(90, 96)}}};
  figure.sets[0].labels = {"g1", "g2"};
  figure.categories = {"LS", "EIV"};
  figure.band = ReferenceBand{"95 %", 95.0, 92.0, 98.0};
  const nlohmann::json spec = Specs(RenderFigure(figure)).at(0);
  EXPECT_EQ(spec.at("band"), nlohmann::json::parse(R"({"name": "95 %", "value": 95.0, "lower": 92.0, "upper": 98.0})"));
  EXPECT_EQ(spec.at("series").at(0).at("labels"), nlohmann::json::parse(R"(["g1", "g2"])"));
  EXPECT_EQ(spec.at("categories"), nlohmann::json::parse(R"(["LS", "EIV"])"));
}

TEST(ReportDeathTest, LengthsThatDisagreeAreABug) {
  TimeFigure figure;
  figure.title = "torque";
  figure.t = Eigen::Vector2d(0, 1);
  figure.traces = {{"measured", Eigen::Vector3d(1, 2, 3), SeriesColor::kMeasured}};
  EXPECT_DEATH(RenderFigure(figure), "torque: measured");
  Table table{"gains", {{"joint"}, {"gain"}}, {{"1"}}, {}};
  EXPECT_DEATH(RenderReport(OneBlock(table)), "gains");
  ScatterFigure scatter{"cloud", "x", "y", {{"set", Eigen::Vector2d(0, 1), Eigen::Vector2d(0, 1)}}};
  scatter.sets[0].labels = {"alone"};
  EXPECT_DEATH(RenderFigure(scatter), "cloud: set");
}

}  // namespace
}  // namespace idim::testing::report_test
