#include "core/dynamics/standard_model.h"
#include "core/effects/declared_friction.h"
#include "core/effects/registry.h"

namespace idim {
namespace {

using Eigen::VectorXd;

class Viscous : public DeclaredFriction {
 public:
  std::string id() const override { return "viscous"; }
  std::string physics() const override { return "Friction proportional to speed: oil and grease sheared in the gear."; }
  std::string how_to_confirm() const override {
    return "Drive the joint at several constant speeds both ways: half the difference of the two torques, against "
           "speed, is a straight line with this slope.";
  }

 private:
  VectorXd Column(const EffectMotion& motion, int joint) const override { return motion.dq().col(joint); }
  int Index() const override { return kFv; }
};

}  // namespace

std::unique_ptr<Effect> MakeViscous() { return std::make_unique<Viscous>(); }

}  // namespace idim
