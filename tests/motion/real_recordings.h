// The public recordings that tests of signals look at where they are found, read in the plainest way.

#ifndef IDIM_TESTS_MOTION_REAL_RECORDINGS_H_
#define IDIM_TESTS_MOTION_REAL_RECORDINGS_H_

#include <Eigen/Core>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "core/recording/recording.h"

namespace idim {

inline std::optional<Eigen::MatrixXd> LoadTable(const std::string& relative) {
  std::vector<std::string> roots = {IDIM_SOURCE_DIR "/../shared/datasets/", IDIM_SOURCE_DIR "/recordings/"};
  if (const char* dir = std::getenv("IDIM_DATA_DIR")) roots.insert(roots.begin(), std::string(dir) + "/");
  for (const std::string& root : roots) {
    std::ifstream file(root + relative);
    std::string line;
    if (!std::getline(file, line)) continue;
    std::vector<double> values;
    Eigen::Index rows = 0;
    while (std::getline(file, line)) {
      const char* p = line.c_str();
      char* end = nullptr;
      for (double x = std::strtod(p, &end); end != p; x = std::strtod(p, &end)) {
        values.push_back(x);
        p = *end == ',' ? end + 1 : end;
      }
      ++rows;
    }
    const Eigen::Index columns = static_cast<Eigen::Index>(values.size()) / rows;
    return Eigen::Map<Eigen::Matrix<double, -1, -1, Eigen::RowMajor>>(values.data(), rows, columns);
  }
  return std::nullopt;
}

// The Staubli TX-40 at 5 kHz, joint side.
inline std::optional<Recording> LoadTx40() {
  const auto motor = LoadTable("tx40/motor_position.csv");
  if (!motor) return std::nullopt;
  Recording recording;
  recording.name = "tx40";
  recording.t = Eigen::VectorXd::LinSpaced(motor->rows(), 0.0, static_cast<double>(motor->rows() - 1) / 5000.0);
  recording.q.resize(motor->rows(), 6);
  const double ratio[6] = {32, 32, 45, -48, 45, 32};
  for (int j = 0; j < 6; ++j) recording.q.col(j) = motor->col(j) / ratio[j];
  recording.q.col(5) -= recording.q.col(4);
  recording.signal = Eigen::MatrixXd::Zero(motor->rows(), 6);
  return recording;
}

// A recording of the UR10e, about 100 Hz with a jittering clock: "free_12", "free_14" or "load_14".
inline std::optional<Recording> LoadUr10e(const std::string& name) {
  const auto table = LoadTable("ur10e/" + name + ".csv");
  if (!table) return std::nullopt;
  Recording recording;
  recording.name = name;
  recording.t = table->col(0);
  recording.q = table->middleCols(1, 6);
  recording.logged_dq = table->middleCols(7, 6);
  recording.signal = table->middleCols(13, 6);
  return recording;
}

}  // namespace idim

#endif  // IDIM_TESTS_MOTION_REAL_RECORDINGS_H_
