// The figures of a report as data: what is drawn, in which unit, in which colour. How it is drawn is report.js.
//
// Vectors of one figure that must agree in length, and its colours, which must differ, are CHECKed. A value that is not
// finite is a gap, never a point.

#ifndef IDIM_CORE_REPORT_FIGURE_H_
#define IDIM_CORE_REPORT_FIGURE_H_

#include <Eigen/Core>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "core/report/color.h"

namespace idim {

// Traces over time, fast with 1e5 samples: the screen shows minimum and maximum of what falls on a pixel, every sample
// once zoomed in.
struct TimeFigure {
  struct Trace {
    std::string name;
    Eigen::VectorXd value;  // N
    SeriesColor color = SeriesColor::kMeasured;
  };
  std::string title;
  std::string y_title;  // quantity and unit: "torque [N.m]"
  Eigen::VectorXd t;    // N [s], increasing
  std::vector<Trace> traces;
  // Figures of one report with the same link share their time range and zoom together; empty: alone.
  std::string link = "";
};

// Where values are expected: a dashed line in a pale band, such as a nominal coverage and what chance makes of it.
struct ReferenceBand {
  std::string name;  // at the line
  double value = 0.0;
  double lower = 0.0, upper = 0.0;  // lower <= value <= upper
};

// A cloud of points, such as residual over velocity.
struct ScatterFigure {
  struct Points {
    std::string name;
    Eigen::VectorXd x, y;  // N each
    SeriesColor color = SeriesColor::kModel;
    std::vector<std::string> labels = {};  // N or none: what a point is
    double size_px = 0.0;                  // of a point; 0: by their number
  };
  // y = slope * x, dashed; slope > 0.
  struct Ray {
    std::string name;
    double slope = 1.0;
  };
  std::string title;
  std::string x_title, y_title;
  std::vector<Points> sets;
  bool logarithmic = false;                  // both axes; points that are not positive are gaps
  bool show_labels = false;                  // beside the points, not only under the pointer
  std::vector<std::string> categories = {};  // names of x = 0, 1, ... where x is no quantity; not logarithmic then
  std::vector<Ray> rays = {};
  std::optional<ReferenceBand> band = std::nullopt;  // of y
};

// Point estimates with intervals, a row a parameter; several sets (estimators, a published table) side by side.
struct IntervalFigure {
  enum class Scale {
    kValue,            // as given: all rows share a unit
    kRelativeToFirst,  // every row divided by the first set's estimate: rows of different units in one figure; an
                       // interval that reaches 0 tells nothing of its parameter's sign
  };
  struct Estimates {
    std::string name;
    Eigen::VectorXd value;         // P; NaN: this set does not have the parameter
    Eigen::VectorXd lower, upper;  // P; NaN: no interval known
    SeriesColor color = SeriesColor::kModel;
  };
  std::string title;
  std::string value_title;
  std::vector<std::string> parameters;  // P names
  std::vector<Estimates> sets;
  Scale scale = Scale::kValue;
  // Ends of the value axis, in units of the scale; what lies beyond is marked by an arrow. Absent: all that there is.
  std::optional<std::pair<double, double>> limits = std::nullopt;
  std::optional<ReferenceBand> band = std::nullopt;  // of the values, in units of the scale
  bool vertical = false;  // false: intervals lie, names stand in a column; true: intervals stand, for few short names
};

// Bars by category, such as the relative error by joint.
struct BarFigure {
  struct Bars {
    std::string name;
    Eigen::VectorXd value;  // C
    SeriesColor color = SeriesColor::kModel;
  };
  std::string title;
  std::string x_title, y_title;
  std::vector<std::string> categories;  // C
  std::vector<Bars> sets;
};

// How often values fall into bins of equal width, a curve of steps a set; every set in percent of its own finite
// values, so that sets of different size can be compared.
struct HistogramFigure {
  struct Values {
    std::string name;
    Eigen::VectorXd value;  // N, in any order; those that are not finite do not count
    SeriesColor color = SeriesColor::kModel;
  };
  // A vertical line, such as the true value.
  struct Mark {
    std::string name;
    double value = 0.0;
  };
  std::string title;
  std::string x_title;
  std::vector<Values> sets;
  std::optional<Mark> mark = std::nullopt;
  // Ends of the bins; the legend tells how much of a set lies beyond. Absent: from the least value to the greatest.
  std::optional<std::pair<double, double>> limits = std::nullopt;
  int bins = 60;                 // >= 1
  bool standard_normal = false;  // dashed: what a standard normal variable gives in the same bins
};

using Figure = std::variant<TimeFigure, ScatterFigure, IntervalFigure, BarFigure, HistogramFigure>;

}  // namespace idim

#endif  // IDIM_CORE_REPORT_FIGURE_H_
