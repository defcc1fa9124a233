#include "core/estimate/series.h"

#include <cstdio>

namespace idim {
namespace {

void AppendNumber(const char* format, double value, std::string* text) {
  char number[40];
  std::snprintf(number, sizeof(number), format, value);
  *text += number;
}

}  // namespace

std::string ResidualsToCsv(const std::vector<RecordingSeries>& series) {
  std::string text = "recording,use,t";
  const Eigen::Index n = series.empty() ? 0 : series[0].torque.cols();
  for (const char* quantity : {"q", "dq", "tau", "model", "residual"}) {
    for (Eigen::Index j = 1; j <= n; ++j) text += "," + std::string(quantity) + std::to_string(j);
  }
  text += "\n";
  for (const RecordingSeries& s : series) {
    const Eigen::MatrixXd residual = s.decimated_torque - s.decimated_model;
    for (Eigen::Index k = 0; k < s.decimated_t.size(); ++k) {
      text += s.name + "," + s.use;
      AppendNumber(",%.9g", s.decimated_t[k], &text);
      for (const Eigen::MatrixXd* m :
           {&s.decimated_q, &s.decimated_dq, &s.decimated_torque, &s.decimated_model, &residual}) {
        for (Eigen::Index j = 0; j < n; ++j) AppendNumber(",%.7g", (*m)(k, j), &text);
      }
      text += "\n";
    }
  }
  return text;
}

}  // namespace idim
