// The synthetic TX-40 as a study that identifies its gains, for the programs that compare and judge estimates.

#ifndef IDIM_TESTS_APPS_COMPARISON_STUDY_H_
#define IDIM_TESTS_APPS_COMPARISON_STUDY_H_

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/support/program.h"
#include "tests/support/temp_folder.h"

namespace idim::testing {

inline std::string Dataset(const std::string& path) { return std::string(IDIM_SOURCE_DIR) + "/datasets/" + path; }

inline nlohmann::json ReadJson(const std::string& path) { return nlohmann::json::parse(ReadText(path)); }

inline std::vector<std::string> FilesIn(const std::string& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) names.push_back(entry.path().filename());
  std::sort(names.begin(), names.end());
  return names;
}

// {"name": "g1", ...} of an estimate; null where it has none.
inline nlohmann::json FindParameter(const nlohmann::json& estimate, const std::string& name) {
  for (const auto& p : estimate.at("parameters")) {
    if (p.at("name") == name) return p;
  }
  return nullptr;
}

// study.yaml of the synthetic TX-40 with these lines for `gains`, and paths that lead to its recordings.
inline std::string SyntheticStudy(const std::string& gains) {
  std::string text = ReadText(Dataset("tx40_synthetic/study.yaml"));
  const size_t at = text.find("gains:");
  EXPECT_NE(at, std::string::npos);
  text.replace(at, text.find('\n', at) - at, gains);
  for (const std::string key : {"robot: ", "{file: "}) {
    for (size_t k = text.find(key); k != std::string::npos; k = text.find(key, k + 1)) {
      text.insert(k + key.size(), Dataset("tx40_synthetic/"));
    }
  }
  return text;
}

inline constexpr char kIdentifyGains[] =
    "gains: {mode: identify, values: [32.96, 32.96, 25.65, -11.52, 18.48, 7.68]}";  // the maker's, as in the paper

}  // namespace idim::testing

#endif  // IDIM_TESTS_APPS_COMPARISON_STUDY_H_
