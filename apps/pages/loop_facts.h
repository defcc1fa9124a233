// What the text, the JSON and the page of a closed loop have in common.

#ifndef IDIM_APPS_PAGES_LOOP_FACTS_H_
#define IDIM_APPS_PAGES_LOOP_FACTS_H_

#include <string>
#include <vector>

#include "solvers/loop/close_loop.h"

namespace idim {

struct NamedShape {
  ShapeParameter parameter;
  double value = 0.0;
};
std::vector<NamedShape> ShapesOf(const LoopResult& result, const ActiveEffect& active);

// Of an effect of the final model: its linear parameters and shapes as the final estimate has them.
std::vector<ParameterEstimate> EffectEstimates(const LoopResult& result, const ActiveEffect& active);

// Of both models, with a final value beyond the 95 % interval of the declared one: gains first.
struct Movement {
  ParameterEstimate before, after;
};
std::vector<Movement> Movements(const LoopResult& result);

// "held-out blocks" where there are no validation recordings.
std::string HeldOutName(const LoopResult& result);

// "0.93 +- 0.04 N.m".
std::string ValueText(const ParameterEstimate& p);

// "below 1e-300" where it is too small for a double.
std::string PValueText(double p_value);

// "The residual of joint 3 still depends on q2 and dq3: ...".
std::string UnexplainedSentence(const Unexplained& unexplained);

// "joint 1: 3.00 -> 2.00 %", of two joints with a comma between; "" for an effect of the whole arm and
// where there are no errors a joint.
std::string OfItsJoints(const LoopStep& step, const Eigen::VectorXd& before, const Eigen::VectorXd& after);

// How sure: statistic, corrected p-value, the decrease of the held-out squares.
std::string EvidenceSentence(const LoopResult& result, const LoopStep& step);

// What cannot be as the final model has it, a sentence each.
std::vector<std::string> Warnings(const LoopResult& result);

// Rivals, or that there is none.
std::string RivalSentence(const LoopStep& step);

}  // namespace idim

#endif  // IDIM_APPS_PAGES_LOOP_FACTS_H_
