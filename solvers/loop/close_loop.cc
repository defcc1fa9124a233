#include "solvers/loop/close_loop.h"

#include <glog/logging.h>

#include <string>
#include <utility>

#include "core/model/active_effects.h"
#include "solvers/loop/declared_effects.h"
#include "solvers/loop/loop_problem.h"
#include "solvers/loop/loop_search.h"

namespace idim {
namespace {

using Search = LoopSearch<LoopProblem>;

std::string Sentence(const Search::Dropped& dropped) {
  const std::string title = EffectTitle(dropped.effect);
  switch (dropped.why) {
    case WhyDropped::kForbiddenSign:
      return title + " came out negative beside what was found later, which it cannot be";
    case WhyDropped::kNotNeeded:
      return title + " is not needed beside what was found later";
    case WhyDropped::kReplaced:
      return title + " is replaced by " + EffectTitle(*dropped.replaced_by) +
             ", which explains more beside what was found later";
  }
  LOG(FATAL) << "a reason without a sentence";
}

}  // namespace

Result<LoopResult> CloseLoop(const PreparedStudy& as_recorded, const LoopOptions& options) {
  std::string error;
  CHECK(options.IsValid(&error)) << error;
  const PreparedStudy prepared{WithVelocityZeroAtRest(*as_recorded.data), as_recorded.model};
  LoopResult result(prepared);
  result.given = options;
  result.held_out_by_blocks = prepared.model.RecordingsFor(Use::kValidation).empty();
  if (options.progress) options.progress("fitting the declared model");
  Result<EffectFit> declared = FitWithDeclaredEffects(prepared);
  if (!declared.ok()) {
    if (declared.status().code() == StatusCode::kBadInput) return declared.status();
    result.status = declared.status();
    return result;
  }
  result.before = IdentificationOf(*declared);
  const LoopProblem problem(options, result.held_out_by_blocks);
  Search search(problem, options, JudgedFit(std::move(declared).value()));
  result.declared = LoopErrorsOf(search.model(), result.held_out_by_blocks);
  search.Run();
  const JudgedFit& final = search.model();
  result.final = LoopErrorsOf(final, result.held_out_by_blocks);
  result.steps = search.TakeSteps();
  for (const Search::Dropped& dropped : search.dropped()) result.dropped.push_back(Sentence(dropped));
  // Values and shapes of the last fit, in which effects found later take part.
  for (LoopStep& step : result.steps) {
    for (const ActiveEffect& effect : final.fit.prepared.model.effects) {
      if (SameEffect(step.effect, effect)) step.effect = effect;
    }
  }
  if (options.progress) options.progress("what is left");
  result.unexplained = FindUnexplained(final.fit.prepared, final.residual, UnexplainedOptions());
  result.after = IdentificationOf(final.fit);
  result.prepared = final.fit.prepared;
  result.status = result.after.estimate.status;
  return result;
}

}  // namespace idim
