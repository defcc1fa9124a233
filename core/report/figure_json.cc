#include "core/report/figure_json.h"

#include <glog/logging.h>

#include <algorithm>
#include <boost/archive/iterators/base64_from_binary.hpp>
#include <boost/archive/iterators/transform_width.hpp>
#include <boost/endian/conversion.hpp>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <set>
#include <string>
#include <string_view>
#include <utility>

namespace idim {
namespace {

using nlohmann::json;

constexpr int kPlotHeight = 330;
constexpr int kAxesHeight = 120;  // what legend, axis titles and ticks take of an interval figure
constexpr int kRowHeight = 10;    // plus kSetHeight for every set in the row
constexpr int kSetHeight = 6;

std::string Base64(std::string_view bytes) {
  namespace it = boost::archive::iterators;
  using Encoder = it::base64_from_binary<it::transform_width<std::string_view::const_iterator, 6, 8>>;
  // The iterators read past the end unless the length is a multiple of three: whole groups, then the padded rest.
  const std::size_t whole = bytes.size() / 3 * 3;
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  text.append(Encoder(bytes.begin()), Encoder(bytes.begin() + whole));
  if (whole < bytes.size()) {
    std::string tail(bytes.substr(whole));
    const std::size_t missing = 3 - tail.size();
    tail.append(missing, '\0');
    const std::string_view group(tail);
    std::string last(Encoder(group.begin()), Encoder(group.end()));
    last.replace(4 - missing, missing, missing, '=');
    text += last;
  }
  return text;
}

template <typename Float, typename Bits>
std::string LittleEndianBytes(const Eigen::VectorXd& values) {
  static_assert(sizeof(Float) == sizeof(Bits));
  std::string bytes(values.size() * sizeof(Float), '\0');
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    // One bit pattern for all that is not finite, since the sign of a NaN differs between machines.
    const Float value =
        std::isfinite(values[i]) ? static_cast<Float>(values[i]) : std::numeric_limits<Float>::quiet_NaN();
    Bits bits;
    std::memcpy(&bits, &value, sizeof(bits));
    boost::endian::native_to_little_inplace(bits);
    std::memcpy(&bytes[i * sizeof(bits)], &bits, sizeof(bits));
  }
  return bytes;
}

// JSON has no NaN: null, which report.js takes for "not there".
json Numbers(const Eigen::VectorXd& values) {
  json array = json::array();
  for (const double value : values) array.push_back(std::isfinite(value) ? json(value) : json());
  return array;
}

json BandJson(const ReferenceBand& band) {
  CHECK_LE(band.lower, band.value) << band.name;
  CHECK_LE(band.value, band.upper) << band.name;
  return {{"name", band.name}, {"value", band.value}, {"lower", band.lower}, {"upper", band.upper}};
}

// Of the bins: the limits, else the least and the greatest value, made wider where there is no width.
std::pair<double, double> BinRange(const HistogramFigure& figure) {
  if (figure.limits) {
    CHECK_LT(figure.limits->first, figure.limits->second) << figure.title;
    return *figure.limits;
  }
  double lower = std::numeric_limits<double>::infinity(), upper = -lower;
  for (const HistogramFigure::Values& set : figure.sets) {
    for (const double value : set.value) {
      if (!std::isfinite(value)) continue;
      lower = std::min(lower, value);
      upper = std::max(upper, value);
    }
  }
  if (!(lower <= upper)) return {0.0, 1.0};
  if (lower < upper) return {lower, upper};
  const double half = lower == 0.0 ? 0.5 : 0.05 * std::abs(lower);
  return {lower - half, upper + half};
}

class Converter {
 public:
  explicit Converter(SamplePool* pool) : pool_(*pool) {}

  FigureJson operator()(const TimeFigure& figure) {
    json series = json::array();
    const int t = pool_.AddDouble(figure.t);
    for (const TimeFigure::Trace& trace : figure.traces) {
      CHECK_EQ(trace.value.size(), figure.t.size()) << figure.title << ": " << trace.name;
      series.push_back(
          {{"name", trace.name}, {"color", ColorHex(trace.color)}, {"samples", pool_.AddSingle(trace.value)}});
    }
    return {figure.title,
            kPlotHeight,
            {{"kind", "time"}, {"yTitle", figure.y_title}, {"t", t}, {"series", series}, {"link", figure.link}}};
  }

  FigureJson operator()(const ScatterFigure& figure) {
    json series = json::array();
    for (const ScatterFigure::Points& set : figure.sets) {
      CHECK_EQ(set.x.size(), set.y.size()) << figure.title << ": " << set.name;
      series.push_back({{"name", set.name},
                        {"color", ColorHex(set.color)},
                        {"x", pool_.AddSingle(set.x)},
                        {"y", pool_.AddSingle(set.y)}});
      if (set.size_px > 0.0) series.back()["size"] = set.size_px;
      if (set.labels.empty()) continue;
      CHECK_EQ(static_cast<Eigen::Index>(set.labels.size()), set.x.size()) << figure.title << ": " << set.name;
      series.back()["labels"] = set.labels;
    }
    json spec = {{"kind", "scatter"}, {"xTitle", figure.x_title}, {"yTitle", figure.y_title}, {"series", series}};
    if (figure.logarithmic) {
      CHECK(figure.categories.empty()) << figure.title;
      spec["logarithmic"] = true;
    }
    if (figure.show_labels) spec["showLabels"] = true;
    if (!figure.categories.empty()) spec["categories"] = figure.categories;
    for (const ScatterFigure::Ray& ray : figure.rays) {
      CHECK_GT(ray.slope, 0.0) << figure.title;
      spec["rays"].push_back({{"name", ray.name}, {"slope", ray.slope}});
    }
    if (figure.band) spec["band"] = BandJson(*figure.band);
    return {figure.title, kPlotHeight, spec};
  }

  FigureJson operator()(const IntervalFigure& figure) {
    const auto rows = static_cast<Eigen::Index>(figure.parameters.size());
    Eigen::VectorXd unit = Eigen::VectorXd::Ones(rows);
    json series = json::array();
    for (const IntervalFigure::Estimates& set : figure.sets) {
      CHECK_EQ(set.value.size(), rows) << figure.title << ": " << set.name;
      CHECK_EQ(set.lower.size(), rows) << figure.title << ": " << set.name;
      CHECK_EQ(set.upper.size(), rows) << figure.title << ": " << set.name;
      if (series.empty() && figure.scale == IntervalFigure::Scale::kRelativeToFirst) unit = set.value;
      series.push_back({{"name", set.name},
                        {"color", ColorHex(set.color)},
                        {"value", Numbers(set.value)},
                        {"lower", Numbers(set.lower)},
                        {"upper", Numbers(set.upper)}});
    }
    const int sets = static_cast<int>(figure.sets.size());
    const int height =
        figure.vertical ? kPlotHeight : kAxesHeight + static_cast<int>(rows) * (kRowHeight + kSetHeight * sets);
    json spec = {{"kind", "interval"},          {"parameters", figure.parameters}, {"valueTitle", figure.value_title},
                 {"vertical", figure.vertical}, {"unit", Numbers(unit)},           {"series", series}};
    if (figure.limits) {
      CHECK_LT(figure.limits->first, figure.limits->second) << figure.title;
      spec["limits"] = {figure.limits->first, figure.limits->second};
    }
    if (figure.band) spec["band"] = BandJson(*figure.band);
    return {figure.title, height, spec};
  }

  FigureJson operator()(const BarFigure& figure) {
    json series = json::array();
    for (const BarFigure::Bars& set : figure.sets) {
      CHECK_EQ(set.value.size(), static_cast<Eigen::Index>(figure.categories.size())) << figure.title;
      series.push_back({{"name", set.name}, {"color", ColorHex(set.color)}, {"value", Numbers(set.value)}});
    }
    return {figure.title,
            kPlotHeight,
            {{"kind", "bar"},
             {"categories", figure.categories},
             {"xTitle", figure.x_title},
             {"yTitle", figure.y_title},
             {"series", series}}};
  }

  FigureJson operator()(const HistogramFigure& figure) {
    CHECK_GE(figure.bins, 1) << figure.title;
    const auto [lower, upper] = BinRange(figure);
    const double width = (upper - lower) / figure.bins;
    json series = json::array();
    for (const HistogramFigure::Values& set : figure.sets) {
      Eigen::VectorXd percent = Eigen::VectorXd::Zero(figure.bins);
      int count = 0, inside = 0;
      for (const double value : set.value) {
        if (!std::isfinite(value)) continue;
        ++count;
        if (value < lower || value > upper) continue;
        ++inside;
        // The last bin holds its upper end.
        percent[std::min(static_cast<int>((value - lower) / width), figure.bins - 1)] += 1.0;
      }
      if (count > 0) percent *= 100.0 / count;
      series.push_back({{"name", set.name},
                        {"color", ColorHex(set.color)},
                        {"count", count},
                        {"beyond", count - inside},
                        {"percent", Numbers(percent)}});
    }
    json spec = {
        {"kind", "histogram"}, {"xTitle", figure.x_title}, {"lower", lower}, {"width", width}, {"series", series}};
    if (figure.mark) spec["mark"] = {{"name", figure.mark->name}, {"value", figure.mark->value}};
    if (figure.standard_normal) {
      Eigen::VectorXd expected(figure.bins);
      // C++17 lets no lambda capture a structured binding by its name.
      const auto below = [from = lower, width](int edge) {
        return 0.5 * std::erfc(-(from + edge * width) / std::sqrt(2.0));
      };
      for (int k = 0; k < figure.bins; ++k) expected[k] = 100.0 * (below(k + 1) - below(k));
      spec["expected"] = Numbers(expected);
    }
    return {figure.title, kPlotHeight, spec};
  }

 private:
  SamplePool& pool_;
};

}  // namespace

int SamplePool::AddSingle(const Eigen::VectorXd& values) {
  return Add({"f4", values.size(), Base64(LittleEndianBytes<float, std::uint32_t>(values))});
}

int SamplePool::AddDouble(const Eigen::VectorXd& values) {
  return Add({"f8", values.size(), Base64(LittleEndianBytes<double, std::uint64_t>(values))});
}

int SamplePool::Add(Samples samples) {
  const auto [known, is_new] = index_.emplace(samples.type + samples.base64, static_cast<int>(samples_.size()));
  if (is_new) samples_.push_back(std::move(samples));
  return known->second;
}

FigureJson ToJson(const Figure& figure, SamplePool* pool) {
  FigureJson json = std::visit(Converter(pool), figure);
  std::set<std::string> colors;
  for (const auto& series : json.spec.at("series")) {
    CHECK(colors.insert(series.at("color")).second)
        << json.title << ": " << series.at("name") << " has the colour of another";
  }
  return json;
}

}  // namespace idim
