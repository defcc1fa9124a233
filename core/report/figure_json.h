// Figures to JSON, their samples to base64: the two ends that report.js picks up.

#ifndef IDIM_CORE_REPORT_FIGURE_JSON_H_
#define IDIM_CORE_REPORT_FIGURE_JSON_H_

#include <Eigen/Core>
#include <nlohmann/json.hpp>
#include <string>
#include <unordered_map>
#include <vector>

#include "core/report/figure.h"

namespace idim {

// The sample vectors of a report, each held once however many figures show it (the time of six joints).
class SamplePool {
 public:
  struct Samples {
    std::string type;  // "f4" or "f8", little-endian
    Eigen::Index count = 0;
    std::string base64;
  };

  // Both return the index to refer to in a figure's JSON. Single precision resolves 1/10 of a pixel of any screen;
  // time keeps double, whose steps would be lost beside an epoch of 1e9 s.
  int AddSingle(const Eigen::VectorXd& values);
  int AddDouble(const Eigen::VectorXd& values);

  const std::vector<Samples>& all() const { return samples_; }

 private:
  int Add(Samples samples);

  std::vector<Samples> samples_;
  std::unordered_map<std::string, int> index_;
};

struct FigureJson {
  std::string title;
  int height_px = 0;
  nlohmann::json spec;
};

FigureJson ToJson(const Figure& figure, SamplePool* pool);

}  // namespace idim

#endif  // IDIM_CORE_REPORT_FIGURE_JSON_H_
