#include "core/dynamics/standard_model.h"
#include "core/effects/declared_friction.h"
#include "core/effects/registry.h"

namespace idim {
namespace {

using Eigen::VectorXd;

class Offset : public DeclaredFriction {
 public:
  std::string id() const override { return "offset"; }
  std::string physics() const override {
    return "A constant torque: the zero of the current sensor, friction that differs between the two directions.";
  }
  std::string how_to_confirm() const override {
    return "Turn the joint's axis upright, so that gravity has no part, and drive it both ways: the mean of the two "
           "torques is this value; with the drive enabled and the brake on, the logged current shows the sensor's "
           "part of it.";
  }

 private:
  VectorXd Column(const EffectMotion& motion, int) const override { return VectorXd::Ones(motion.t().size()); }
  int Index() const override { return kOff; }
};

}  // namespace

std::unique_ptr<Effect> MakeOffset() { return std::make_unique<Offset>(); }

}  // namespace idim
