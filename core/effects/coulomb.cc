#include "core/dynamics/standard_model.h"
#include "core/effects/columns.h"
#include "core/effects/declared_friction.h"
#include "core/effects/registry.h"

namespace idim {
namespace {

using Eigen::VectorXd;

class Coulomb : public DeclaredFriction {
 public:
  std::string id() const override { return "coulomb"; }
  std::string physics() const override { return "Dry friction of constant size against the motion: seals, preload."; }
  std::string how_to_confirm() const override {
    return "Drive the joint slowly both ways through the same positions: half the difference of the torques is this "
           "value wherever the joint stands.";
  }

 private:
  VectorXd Column(const EffectMotion& motion, int joint) const override { return ExpectedSigns(motion, joint); }
  int Index() const override { return kFs; }
};

}  // namespace

std::unique_ptr<Effect> MakeCoulomb() { return std::make_unique<Coulomb>(); }

}  // namespace idim
