// The links' side of a simulated arm with effects: links, payloads and what effects add to them.

#ifndef IDIM_CORE_SIMULATION_EFFECTS_LINKS_H_
#define IDIM_CORE_SIMULATION_EFFECTS_LINKS_H_

#include <Eigen/Core>
#include <vector>

#include "core/dynamics/standard_model.h"
#include "core/simulation/effects_drive_train.h"
#include "core/simulation/scenario.h"

namespace idim::internal {

// Of a scenario, in its order; they point into it.
using ActingEffects = std::vector<const SimulatedEffect*>;

ActingEffects EffectsIn(const Scenario& scenario, const ScenarioRecording& recording);

// Parameters of the standard model apart: links; drive inertias; friction of the couplings and offsets. Fv and Fs of
// the joints are what effects change.
struct StandardParts {
  Eigen::VectorXd links, inertias, others, fv, fs;
};

StandardParts Split(const StandardModel& model, const Eigen::VectorXd& chi);

// Of one recording; the scenario outlives it.
class Links {
 public:
  Links(const Scenario& scenario, const ScenarioRecording& recording, const ActingEffects& effects);

  // n, at t [s] and the links' state.
  Eigen::VectorXd Torque(double t, const JointState& state);

 private:
  ActingEffects effects_;
  StandardModel model_;
  Eigen::VectorXd chi_;
  InertialVector payload_;
};

// Those of the first recording without payload and effects: contacts and dampers refer to their inertia.
Links BareLinks(const Scenario& scenario);

std::vector<FlexibleJoint> FlexibleJoints(const Scenario& scenario, const ActingEffects& effects);

}  // namespace idim::internal

#endif  // IDIM_CORE_SIMULATION_EFFECTS_LINKS_H_
