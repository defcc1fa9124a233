// The list of effects. A new one: its file <id>.cc, which defines Make<Name>(), and its line here.

#ifndef IDIM_CORE_EFFECTS_REGISTRY_H_
#define IDIM_CORE_EFFECTS_REGISTRY_H_

#include <memory>

#include "core/effects/effect.h"

// The declared friction, then the contract's order.
#define IDIM_EFFECTS(EFFECT) \
  EFFECT(Viscous)            \
  EFFECT(Coulomb)            \
  EFFECT(Offset)             \
  EFFECT(Stribeck)           \
  EFFECT(PowerViscous)       \
  EFFECT(AsymmetricFriction) \
  EFFECT(LoadFriction)       \
  EFFECT(Presliding)         \
  EFFECT(ThermalDrift)       \
  EFFECT(TorqueRipple)       \
  EFFECT(JointSpring)        \
  EFFECT(MotorCoupling)      \
  EFFECT(BaseTilt)           \
  EFFECT(PayloadChange)      \
  EFFECT(TimeDelay)          \
  EFFECT(GainSaturation)     \
  EFFECT(JointElasticity)    \
  EFFECT(Backlash)

namespace idim {

#define IDIM_DECLARE_EFFECT(name) std::unique_ptr<Effect> Make##name();
IDIM_EFFECTS(IDIM_DECLARE_EFFECT)
#undef IDIM_DECLARE_EFFECT

}  // namespace idim

#endif  // IDIM_CORE_EFFECTS_REGISTRY_H_
