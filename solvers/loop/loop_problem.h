// What the loop searches (solvers/loop/loop_search.h): candidates on bundles that are fitted to data.

#ifndef IDIM_SOLVERS_LOOP_LOOP_PROBLEM_H_
#define IDIM_SOLVERS_LOOP_LOOP_PROBLEM_H_

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "solvers/loop/effect_scan.h"
#include "solvers/loop/judged_fit.h"
#include "solvers/loop/loop_options.h"
#include "solvers/loop/loop_step.h"

namespace idim {

class LoopProblem {
 public:
  using Model = JudgedFit;
  using Effect = ActiveEffect;
  using Candidate = EffectCandidate;
  using Step = LoopStep;

  // options: must outlive the problem. held_out_by_blocks: as in LoopErrorsOf(), for the errors of the steps.
  LoopProblem(const LoopOptions& options, bool held_out_by_blocks)
      : options_(options), held_out_by_blocks_(held_out_by_blocks) {}

  static const std::vector<ActiveEffect>& Effects(const JudgedFit& model) { return model.fit.prepared.model.effects; }
  static std::optional<JudgedFit> Fit(const JudgedFit& from, const std::vector<ActiveEffect>& effects);
  std::vector<EffectCandidate> Scan(const JudgedFit& model, const std::vector<int>& joints,
                                    const std::function<void(const std::string&)>& say) const;
  static std::vector<ActiveEffect> ForbiddenSigns(const JudgedFit& model) { return OfWrongSign(model.fit); }
  static Eigen::VectorXd HeldOut(const JudgedFit& measure, const JudgedFit& model, const std::vector<int>& joints) {
    return HeldOutByFold(measure.residual, model, joints);
  }
  static bool Overlap(const EffectCandidate& a, const EffectCandidate& b) {
    return idim::Overlap(a.remainder, b.remainder);
  }
  LoopStep Record(const JudgedFit& before, const JudgedFit& after, const std::vector<EffectCandidate>& scan,
                  const EffectCandidate& chosen, const std::vector<EffectCandidate>& rivals) const;

 private:
  const LoopOptions& options_;
  const bool held_out_by_blocks_;
};

}  // namespace idim

#endif  // IDIM_SOLVERS_LOOP_LOOP_PROBLEM_H_
