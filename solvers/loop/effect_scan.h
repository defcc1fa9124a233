// Which effect would explain what a fitted model leaves, and on which joint: all candidates side by side.
//
// A candidate is an effect at its place (a joint, two joints, the arm) with its best shape: the grid of the effect,
// then golden section between the neighbours of its best point, by the squares that the columns explain beyond all that
// is in the model already (solvers/bundle/residual_model.h). The level is shared
// equally between the effects, then between the places of an effect, then between the shapes tried at a place
// (Bonferroni): the many orders of a ripple do not hide a spring.
//
// Held out: relative decrease of the squared whitened residual on rows not fitted, of the joints where the effect acts
// (all for an effect of the arm or of two joints), and its standard error from the folds.

#ifndef IDIM_SOLVERS_LOOP_EFFECT_SCAN_H_
#define IDIM_SOLVERS_LOOP_EFFECT_SCAN_H_

#include <functional>
#include <string>
#include <vector>

#include "core/effects/effect.h"
#include "core/model/model.h"
#include "core/model/prediction.h"
#include "solvers/bundle/residual_model.h"
#include "solvers/loop/loop_rules.h"

namespace idim {

struct EffectCandidate : CandidateRow {
  ActiveEffect effect;  // at its best shape
  double explained = 0.0;
  ResidualModel::Score score;
  Eigen::MatrixXd remainder;  // of its columns, samples n x parameters
};

struct ScanOptions {
  double significance = 0.05;    // candidates above this corrected p-value are not cross-validated, in (0, 1)
  std::vector<int> only_joints;  // where not empty: candidates at this place alone
  int threads = 1;               // >= 1; the result does not depend on it
  std::function<void(const std::string&)> progress;  // may be empty; called from one thread at a time
};

struct EffectScan {
  // Those with a p-value below `significance`, by decreasing held_out_gain; ties by id and joints.
  std::vector<EffectCandidate> candidates;
  int tried = 0;  // shapes of all candidates
};

// Candidates at every place but those of the model's effects and declared friction. arm: as fitted, with the effects.
EffectScan ScanEffects(const PreparedStudy& prepared, const ResidualModel& residual, const ArmParameters& arm,
                       const ScanOptions& options);

// The effect at the shape that explains most of what the model leaves; its own shape is not looked at.
ActiveEffect FindShape(const PreparedStudy& prepared, const ResidualModel& residual, const ArmParameters& arm,
                       const ActiveEffect& effect);

}  // namespace idim

#endif  // IDIM_SOLVERS_LOOP_EFFECT_SCAN_H_
