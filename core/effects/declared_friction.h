// The friction that a study declares by itself (key `friction`), as effects: the columns of StandardModel, which has
// their equations too.

#ifndef IDIM_CORE_EFFECTS_DECLARED_FRICTION_H_
#define IDIM_CORE_EFFECTS_DECLARED_FRICTION_H_

#include <Eigen/Core>
#include <vector>

#include "core/effects/effect.h"

namespace idim {

class DeclaredFriction : public Effect {
 public:
  EffectSite site() const override { return EffectSite::kJoint; }
  EffectDomain domain() const override { return EffectDomain::kVelocity; }
  bool in_standard_model() const override { return true; }

  std::vector<EffectEntry> Columns(const EffectMotion& motion, const std::vector<int>& joints,
                                   const Eigen::VectorXd& shape) const override;
  std::vector<Parameter> Parameters(const Robot& robot, const std::vector<int>& joints) const override;

 private:
  virtual Eigen::VectorXd Column(const EffectMotion& motion, int joint) const = 0;
  virtual int Index() const = 0;  // among the standard parameters
};

}  // namespace idim

#endif  // IDIM_CORE_EFFECTS_DECLARED_FRICTION_H_
