// A two-joint arm with a recording that identifies it, as files, to be used whole or broken one line at a time.

#ifndef IDIM_TESTS_APPS_SMALL_STUDY_H_
#define IDIM_TESTS_APPS_SMALL_STUDY_H_

#include <Eigen/Core>
#include <cmath>
#include <cstdio>
#include <string>

#include "core/dynamics/standard_model.h"
#include "tests/support/temp_folder.h"

namespace idim::testing {

inline constexpr char kSmallRobot[] =
    "name: two\n"
    "gravity: [0, -9.81, 0]\n"
    "joints:\n"
    "  - {type: revolute, alpha: 0, d: 0, theta: 0, r: 0}\n"
    "  - {type: revolute, alpha: 0, d: 0.5, theta: 0, r: 0}\n";

inline constexpr char kSmallStudy[] =
    "robot: robot.yaml\n"
    "recordings:\n"
    "  - {file: a.csv, name: a, use: identification}\n"
    "preprocessing: {cutoff_hz: 20, decimation: 5}\n";

// The standard parameters behind the recording, in the order of StandardModel.
inline Eigen::VectorXd SmallTruth(const StandardModel& model) {
  Eigen::VectorXd chi = Eigen::VectorXd::Zero(model.columns());
  const auto set = [&](const char* name, double value) { chi[model.Find(name)] = value; };
  set("ZZ1", 0.9), set("MX1", 1.2), set("MY1", 0.1), set("M1", 4.0), set("Ia1", 0.2), set("Fv1", 2.0), set("Fs1", 3.0);
  set("off1", 0.3), set("ZZ2", 0.3), set("MX2", 0.6), set("MY2", -0.05), set("M2", 2.0), set("Ia2", 0.1);
  set("Fv2", 1.0), set("Fs2", 1.5), set("off2", -0.2);
  return chi;
}

inline Robot SmallArm() {
  Robot robot;
  robot.gravity = Eigen::Vector3d(0.0, -9.81, 0.0);
  robot.joints.push_back(JointFromModifiedDh(JointType::kRevolute, 0, 0, 0, 0));
  robot.joints.push_back(JointFromModifiedDh(JointType::kRevolute, 0, 0.5, 0, 0));
  return robot;
}

// 4 s at 200 Hz; `second_moves` false: joint 2 stands still. Noise-free but for the digits.
inline std::string SmallCsv(bool second_moves = true) {
  StandardModel model(SmallArm(), FrictionModel{});
  const Eigen::VectorXd chi = SmallTruth(model);
  std::string text = "t,q1,q2,v1,v2\n";
  for (int i = 0; i < 800; ++i) {
    const double t = 0.005 * i;
    const double amplitude[2] = {0.9, second_moves ? 0.7 : 0.0};
    double q[2], dq[2], ddq[2], tau[2];
    for (int j = 0; j < 2; ++j) {
      const double w1 = 3.1 + 1.3 * j, w2 = 6.7 - 1.1 * j, a = amplitude[j];
      q[j] = a * (std::sin(w1 * t) + 0.5 * std::cos(w2 * t)) + 0.2;
      dq[j] = a * (w1 * std::cos(w1 * t) - 0.5 * w2 * std::sin(w2 * t));
      ddq[j] = a * (-w1 * w1 * std::sin(w1 * t) - 0.5 * w2 * w2 * std::cos(w2 * t));
    }
    model.Torque(q, dq, ddq, nullptr, chi, InertialVector::Zero(), tau);
    char line[160];
    std::snprintf(line, sizeof(line), "%.3f,%.7f,%.7f,%.6f,%.6f\n", t, q[0], q[1], tau[0], tau[1]);
    text += line;
  }
  return text;
}

// robot.yaml, study.yaml and a.csv in a folder of their own, with an output folder that does not exist yet.
struct SmallStudy {
  TempFolder folder;
  std::string robot = kSmallRobot;
  std::string study = kSmallStudy;
  std::string csv = SmallCsv();

  // Writes the files and returns the command line for idim_identify.
  std::string Arguments() {
    folder.Write("robot.yaml", robot);
    folder.Write("study.yaml", study);
    if (!csv.empty() || write_empty_csv) folder.Write("a.csv", csv);
    return folder / "study.yaml" + " --output=" + folder / "out" + " " + flags;
  }
  bool OutputExists() const { return std::filesystem::exists(folder / "out"); }

  std::string flags;
  bool write_empty_csv = false;
};

inline void Replace(const std::string& from, const std::string& to, std::string* text) {
  const size_t at = text->find(from);
  ASSERT_NE(at, std::string::npos) << from;
  text->replace(at, from.size(), to);
}

}  // namespace idim::testing

#endif  // IDIM_TESTS_APPS_SMALL_STUDY_H_
