#include "core/report/figure_json.h"

#include <glog/logging.h>

#include <boost/archive/iterators/base64_from_binary.hpp>
#include <boost/archive/iterators/transform_width.hpp>
#include <boost/endian/conversion.hpp>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
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
    std::string rest(bytes.substr(whole));
    const std::size_t missing = 3 - rest.size();
    rest.append(missing, '\0');
    const std::string_view group(rest);
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

const char* ColorName(SeriesColor color) {
  switch (color) {
    case SeriesColor::kMeasured:
      return "measured";
    case SeriesColor::kModel:
      return "model";
    case SeriesColor::kResidual:
      return "residual";
    case SeriesColor::kOrange:
      return "orange";
    case SeriesColor::kTeal:
      return "teal";
    case SeriesColor::kPurple:
      return "purple";
  }
  LOG(FATAL) << "unknown series colour";
  return "";
}

// JSON has no NaN: null, which report.js takes for "not there".
json Numbers(const Eigen::VectorXd& values) {
  json array = json::array();
  for (const double value : values) array.push_back(std::isfinite(value) ? json(value) : json());
  return array;
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
          {{"name", trace.name}, {"color", ColorName(trace.color)}, {"samples", pool_.AddSingle(trace.value)}});
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
                        {"color", ColorName(set.color)},
                        {"x", pool_.AddSingle(set.x)},
                        {"y", pool_.AddSingle(set.y)}});
    }
    return {figure.title,
            kPlotHeight,
            {{"kind", "scatter"}, {"xTitle", figure.x_title}, {"yTitle", figure.y_title}, {"series", series}}};
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
                        {"color", ColorName(set.color)},
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
    return {figure.title, height, spec};
  }

  FigureJson operator()(const BarFigure& figure) {
    json series = json::array();
    for (const BarFigure::Bars& set : figure.sets) {
      CHECK_EQ(set.value.size(), static_cast<Eigen::Index>(figure.categories.size())) << figure.title;
      series.push_back({{"name", set.name}, {"color", ColorName(set.color)}, {"value", Numbers(set.value)}});
    }
    return {figure.title,
            kPlotHeight,
            {{"kind", "bar"},
             {"categories", figure.categories},
             {"xTitle", figure.x_title},
             {"yTitle", figure.y_title},
             {"series", series}}};
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

FigureJson ToJson(const Figure& figure, SamplePool* pool) { return std::visit(Converter(pool), figure); }

}  // namespace idim
