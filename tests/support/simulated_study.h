// A simulated spatial arm of three joints, unloaded and with a payload, as a user would have logged it; its truth is
// known. Through the files that idim_simulate writes, so that readers and filters take part.

#ifndef IDIM_TESTS_SUPPORT_SIMULATED_STUDY_H_
#define IDIM_TESTS_SUPPORT_SIMULATED_STUDY_H_

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "core/base/file.h"
#include "core/effects/simulated_effects.h"
#include "core/model/model.h"
#include "core/recording/study.h"
#include "core/simulation/scenario.h"
#include "core/simulation/simulate_scenario.h"
#include "tests/support/temp_folder.h"

namespace idim::testing {

inline constexpr char kArmRobot[] =
    "name: three\n"
    "gravity: [0, 0, -9.81]\n"
    "joints:\n"
    "  - {type: revolute, alpha: 0.3, d: 0, theta: 0, r: 0.3}\n"  // tilted: gravity loads every joint
    "  - {type: revolute, alpha: -1.4, d: 0.1, theta: 0, r: 0.05}\n"
    "  - {type: revolute, alpha: 1.2, d: 0.4, theta: 0, r: 0.2}\n";

// Smooth motion far below the filter's cut-off, encoders so fine that W is exact for all that is tested here; white
// noise of the signals of 0.02, 0.05 and 0.1 units.
inline constexpr char kArmScenario[] =
    "robot: robot.yaml\n"
    "parameters:\n"
    "  - {XX: 0.3, YY: 0.35, ZZ: 0.9, MX: 1.2, MY: 0.1, MZ: 0.2, M: 6, Ia: 0.5, Fv: 2.0, Fs: 3.0, off: 0.3}\n"
    "  - {XX: 0.2, XY: 0.02, YY: 0.4, ZZ: 0.5, MX: 0.8, MY: -0.1, MZ: 0.1, M: 4, Ia: 0.2, Fv: 1.5, Fs: 2.0, off: "
    "-0.2}\n"
    "  - {XX: 0.08, YY: 0.09, ZZ: 0.1, MX: 0.3, MY: 0.05, MZ: 0.2, M: 2, Ia: 0.1, Fv: 0.8, Fs: 1.0, off: 0.1}\n"
    "payloads:\n"
    "  big: {XX: 0.06, XY: -0.004, XZ: 0.01, YY: 0.07, YZ: 0.005, ZZ: 0.05, MX: 0.4, MY: -0.2, MZ: 0.5, M: 3,\n"
    "        known: [M]}\n"
    "gains: {values: [20, -11, 5], mode: known}\n"
    "rate: 200\n"
    "noise: {position: 1.0e-6, signal: [0.02, 0.05, 0.1]}\n"
    "limits: {lower: -2.0, upper: 2.0, velocity: 5.0, acceleration: 25.0, jerk: 500.0}\n"
    "recordings:\n"
    "  - {name: free, use: identification, seed: 1, trajectory: {type: fourier, frequency: 0.2, duration: 10}}\n"
    "  - {name: load, use: identification, payload: big, seed: 2,\n"
    "     trajectory: {type: fourier, frequency: 0.2, duration: 10}}\n"
    "  - {name: check, use: validation, payload: big, seed: 3,\n"
    "     trajectory: {type: fourier, frequency: 0.2, duration: 10}}\n";

inline void ReplaceOnce(const std::string& from, const std::string& to, std::string* text) {
  const size_t at = text->find(from);
  ASSERT_NE(at, std::string::npos) << from;
  ASSERT_EQ(text->find(from, at + 1), std::string::npos) << from << " twice";
  text->replace(at, from.size(), to);
}

struct SimulatedStudy {
  TempFolder folder;
  std::string robot = kArmRobot;
  std::string scenario_text = kArmScenario;
  Scenario scenario;
  std::string study_text;  // as simulated, with a filter added; to be changed before Prepare()

  void Simulate() {
    folder.Write("in/robot.yaml", robot);
    Result<Scenario> read = ReadScenario(folder.Write("in/scenario.yaml", scenario_text), EffectEquations());
    ASSERT_TRUE(read.ok()) << read.status().message();
    scenario = std::move(read).value();
    const Result<std::vector<OutputFile>> files = RenderScenario(scenario);
    ASSERT_TRUE(files.ok()) << files.status().message();
    for (const OutputFile& file : *files) {
      folder.Write(file.name, file.content);
      if (file.name == "study.yaml") study_text = file.content + "preprocessing: {cutoff_hz: 20, decimation: 5}\n";
    }
    ASSERT_FALSE(study_text.empty());
  }

  // What the tests ask for must succeed; where it does not the test ends with its message.
  PreparedStudy Prepare() const {
    const Result<Study> study = ReadStudy(folder.Write("study.yaml", study_text));
    if (!study.ok()) throw std::runtime_error(study.status().message());
    Result<PreparedStudy> prepared = PrepareStudy(*study);
    if (!prepared.ok()) throw std::runtime_error(prepared.status().message());
    return std::move(prepared).value();
  }
};

}  // namespace idim::testing

#endif  // IDIM_TESTS_SUPPORT_SIMULATED_STUDY_H_
