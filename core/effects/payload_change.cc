// A body on the last link from an instant on, to the end of that recording: M, MX, MY and MZ in the frame of the last
// link; its inertia about that frame is left out (of a small body close to the flange it is small).
//
// The instant is counted in recordings: r + f is the fraction f of the duration of recording r. f = 0: the whole of it.

#include <glog/logging.h>

#include <algorithm>
#include <cmath>

#include "core/effects/columns.h"
#include "core/effects/registry.h"

namespace idim {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kInstants = 8;  // a recording, on the grid
constexpr int kFirst = kMX;   // MX MY MZ M are neighbours among the ten
constexpr int kCount = 4;

class PayloadChange : public Effect {
 public:
  std::string id() const override { return "payload_change"; }
  EffectSite site() const override { return EffectSite::kArm; }
  std::string physics() const override {
    return "A body that the study does not declare is on the last link from some instant of a recording on: something "
           "picked up, dropped, mounted.";
  }
  std::string how_to_confirm() const override {
    return "Look at the tool: weigh what hangs there beyond the declared payload, compare with dM, and read in the log "
           "what happened at the instant named.";
  }

  std::vector<Parameter> Parameters(const Robot& robot, const std::vector<int>& joints) const override {
    CHECK(joints.empty());
    (void)robot;
    std::vector<Parameter> parameters;
    for (int k = kFirst; k < kFirst + kCount; ++k) {
      parameters.push_back({std::string("d") + kStandardNames[k], ParameterKind::kEffect, 0, StandardUnit(k, false)});
    }
    return parameters;
  }

  std::vector<ShapeParameter> Shapes(const std::vector<EffectMotion>& motions,
                                     const std::vector<int>& joints) const override {
    CHECK(joints.empty());
    CHECK(!motions.empty());
    std::vector<double> grid;
    for (const EffectMotion& motion : motions) {
      for (int k = 0; k < kInstants; ++k) grid.push_back(motion.recording + static_cast<double>(k) / kInstants);
    }
    std::sort(grid.begin(), grid.end());
    grid.erase(std::unique(grid.begin(), grid.end()), grid.end());
    // Not up to the next whole number: that is another recording.
    return {{"instant", "recordings", grid.front(), grid.back() + 0.9 / kInstants, grid}};
  }

  std::vector<EffectEntry> Columns(const EffectMotion& motion, const std::vector<int>& joints,
                                   const VectorXd& shape) const override {
    CHECK(joints.empty());
    CHECK_EQ(shape.size(), 1);
    const double recording = std::floor(shape[0]);
    const Index count = motion.t.size();
    if (count == 0 || recording != motion.recording) return {};
    const double begin = motion.t[0] + (shape[0] - recording) * (motion.t[count - 1] - motion.t[0]);
    const int n = motion.robot->dof();
    std::vector<EffectEntry> entries;
    for (int k = 0; k < kCount; ++k) {
      for (int j = 0; j < n; ++j) entries.push_back({k, j, VectorXd::Zero(count)});
    }
    for (Index i = 0; i < count; ++i) {
      if (motion.t[i] < begin) continue;
      const MatrixXd body = motion.body_columns(motion.q.row(i), motion.dq.row(i), motion.ddq.row(i));
      for (int k = 0; k < kCount; ++k) {
        for (int j = 0; j < n; ++j) entries[k * n + j].torque[i] = body(j, kFirst + k);
      }
    }
    return entries;
  }
};

}  // namespace

std::unique_ptr<Effect> MakePayloadChange() { return std::make_unique<PayloadChange>(); }

}  // namespace idim
