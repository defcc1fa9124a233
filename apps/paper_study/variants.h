// Why gains come out wrong: the same two recordings under other disturbances and motions, several draws of the noise
// each, with the errors of the gains against the truth. All base parameters kept,
// so that no elimination blurs the comparison.

#ifndef IDIM_APPS_PAPER_STUDY_VARIANTS_H_
#define IDIM_APPS_PAPER_STUDY_VARIANTS_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "apps/paper_study/study.h"

namespace idim {

// What stands between the model's torque and gain times signal. All are scaled, joint by joint, to the size that the
// scenario's white noise has after decimation.
enum class Disturbance {
  kWhite,
  kSlow,      // first-order autoregressive noise with a corner at 2 Hz
  kFriction,  // no noise but a friction torque that grows like the square root of speed, what viscous and Coulomb
              // friction and an offset can imitate of it taken out: an error of the model, alike in both recordings
};

struct VariantOptions {
  std::string title;
  Disturbance disturbance = Disturbance::kWhite;
  double size = 1.0;         // of the disturbance
  double speed = 1.0;        // of the motion, > 0: paths are the same and take 1 / speed of the time
  bool same_motion = false;  // the loaded arm moves as the unloaded one
  // What cases with ten known parameters are told, empty: the truth.
  std::vector<double> believed_ten = {};
};

struct GainErrors {
  std::string name;
  Eigen::VectorXd mean_percent;    // n, of (estimate - truth) / truth over the draws
  Eigen::VectorXd spread_percent;  // n, standard deviation of one draw
  double residual_percent = 0.0;   // |rho| / |V g|, mean over the draws
};

struct Variant {
  std::string title;
  // |Y_L| / |V g| at the true gains: how large the known torque of the payload is; and of the part of it that no other
  // torque of the model can imitate. Ten known parameters, then the mass alone; first draw.
  double share_ten = 0.0, independent_ten = 0.0;
  double share_mass = 0.0, independent_mass = 0.0;
  std::vector<GainErrors> cases;
};

// Errors as the estimators say. draws >= 2, with seeds from the scenario's and the draw's number.
Result<Variant> RunVariant(const PaperStudy& paper, const VariantOptions& options, int draws);

}  // namespace idim

#endif  // IDIM_APPS_PAPER_STUDY_VARIANTS_H_
