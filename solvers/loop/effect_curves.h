// The torque of a joint's effects by the final model, and what the data say of it.
//
// Friction curve of a joint: data are the measured torque less all of the final model that is not friction, the model's
// are its friction alone (Fv, Fs, off and the effects of friction on that joint). The two differ by the final residual.

#ifndef IDIM_SOLVERS_LOOP_EFFECT_CURVES_H_
#define IDIM_SOLVERS_LOOP_EFFECT_CURVES_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "solvers/loop/close_loop.h"

namespace idim {

// Decimated samples of all recordings, one after the other; samples at which the joint rests count too.
struct EffectCurve {
  enum class Over {
    kVelocity,  // of friction: its whole torque over dq [rad/s or m/s]
    kPosition,  // of the effects alone, functions of position, over q [rad or m]
    kModel      // of the effects alone over their torque by the model [N m or N]
  };
  int joint = 0;  // zero-based
  Over over = Over::kVelocity;
  std::string effects;       // ids, comma-separated
  Eigen::VectorXd abscissa;  // N
  Eigen::VectorXd data;      // N [N m or N]
  Eigen::VectorXd model;     // N
  Eigen::VectorXd declared;  // N: the friction of the declared model; empty where it is not friction
  // Of friction: of the samples faster than a tenth of the top speed, the share at which the model's friction without
  // its offset drives the joint. No friction does.
  double driving_share = 0.0;
};

// Friction of each joint on which an effect of friction acts, then the torque of other effects on each joint where such
// act; effects of the whole arm have none.
std::vector<EffectCurve> EffectCurves(const LoopResult& result);

}  // namespace idim

#endif  // IDIM_SOLVERS_LOOP_EFFECT_CURVES_H_
