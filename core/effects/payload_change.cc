// A body on the last link from an instant on, to the end of that recording: M, MX, MY and MZ in the frame of the last
// link; its inertia about that frame is left out (of a small body close to the flange it is small).
//
// The instant is counted in recordings: r + f is the fraction f of the duration of recording r. f = 0: the whole of it.

#include <glog/logging.h>

#include <algorithm>
#include <cmath>

#include "core/base/text.h"
#include "core/effects/columns.h"
#include "core/effects/registry.h"
#include "core/simulation/effect_equation.h"
#include "core/simulation/scenario.h"

namespace idim {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr char kPayloadChangeId[] = "payload_change";

// M [kg], x, y, z [m], from [s]: a point mass M at (x, y, z) on the last link from then on.
class PayloadChangeEquation : public EffectEquation {
 public:
  PayloadChangeEquation()
      : EffectEquation(kPayloadChangeId, EffectJoints::kNone,
                       {EffectKey::Any("M", 1), EffectKey::Any("x").Optional(), EffectKey::Any("y").Optional(),
                        EffectKey::Any("z").Optional(), EffectKey::From(0.0, kLargestInput, "from").Optional()}) {}

  std::map<std::string, double> DrawValues(double duration, Random* random) const override {
    return {{"M", 0.5},
            {"x", random->Uniform(-0.1, 0.1)},
            {"y", random->Uniform(-0.1, 0.1)},
            {"z", random->Uniform(0.0, 0.2)},
            {"from", duration * (random->Uniform() < 0.5 ? 0.0 : random->Uniform(0.2, 0.8))}};
  }

  void AddPayload(const SimulatedEffect& effect, double t, InertialVector* payload) const override {
    if (t < effect.Value("from")) return;
    *payload += InertialFromCentreOfMass(effect.Value("M"), {effect.Value("x"), effect.Value("y"), effect.Value("z")},
                                         Eigen::Matrix3d::Zero());
  }
};

constexpr int kInstants = 8;  // a recording, on the grid
constexpr int kFirst = kMX;   // MX MY MZ M are neighbours among the ten
constexpr int kCount = 4;

class PayloadChange : public Effect {
 public:
  std::string id() const override { return kPayloadChangeId; }
  EffectSite site() const override { return EffectSite::kArm; }
  bool shapes_count_recordings() const override { return true; }
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
    const Index count = motion.t().size();
    if (count == 0 || recording != motion.recording) return {};
    const double begin = motion.t()[0] + (shape[0] - recording) * (motion.t()[count - 1] - motion.t()[0]);
    const int n = motion.robot->dof();
    std::vector<EffectEntry> entries;
    for (int k = 0; k < kCount; ++k) {
      for (int j = 0; j < n; ++j) entries.push_back({k, j, VectorXd::Zero(count)});
    }
    for (Index i = 0; i < count; ++i) {
      if (motion.t()[i] < begin) continue;
      const MatrixXd body = motion.body_columns(motion.q().row(i), motion.dq().row(i), motion.ddq().row(i));
      for (int k = 0; k < kCount; ++k) {
        for (int j = 0; j < n; ++j) entries[k * n + j].torque[i] = body(j, kFirst + k);
      }
    }
    return entries;
  }

  VectorXd TrueShape(const SimulatedEffect& effect, const Scenario& scenario) const override {
    int r = 0;
    while (scenario.recordings.at(static_cast<size_t>(r)).name != effect.recording) ++r;
    return VectorXd::Constant(1, r + effect.Value("from") / DurationOf(scenario.recordings[static_cast<size_t>(r)]));
  }

  const EffectEquation* equation() const override { return &equation_; }

 private:
  const PayloadChangeEquation equation_;
};

}  // namespace

std::unique_ptr<Effect> MakePayloadChange() { return std::make_unique<PayloadChange>(); }

}  // namespace idim
