// The loop reconsiders: on simulated studies a first look that does not see what is there (a scan whose list lacks it)
// leads it to another effect. All else is the loop's own: data, fits, held-out errors, decisions.

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "core/model/active_effects.h"
#include "solvers/loop/declared_effects.h"
#include "solvers/loop/loop_problem.h"
#include "solvers/loop/loop_search.h"
#include "tests/support/simulated_study.h"

namespace idim::testing::misled_loop_test {
namespace {

using Ids = std::set<std::string>;

// The first `scans` looks at the whole arm do not see effects of these ids.
class Misled : public LoopProblem {
 public:
  Misled(const LoopOptions& options, Ids unseen, int scans)
      : LoopProblem(options, false), unseen_(std::move(unseen)), scans_(scans) {}

  std::vector<EffectCandidate> Scan(const JudgedFit& model, const std::vector<int>& joints,
                                    const std::function<void(const std::string&)>& say) const {
    std::vector<EffectCandidate> all = LoopProblem::Scan(model, joints, say);
    if (!joints.empty() || seen_++ >= scans_) return all;
    all.erase(std::remove_if(all.begin(), all.end(),
                             [&](const EffectCandidate& c) { return unseen_.count(c.effect.effect->id()) > 0; }),
              all.end());
    return all;
  }

 private:
  const Ids unseen_;
  const int scans_;
  mutable int seen_ = 0;
};

using Search = LoopSearch<Misled>;

struct Outcome {
  std::vector<std::string> effects;  // in the model at the end
  std::vector<Search::Dropped> dropped;
};

Outcome Close(const std::string& effects, const Ids& unseen, int scans) {
  SimulatedStudy study;
  ReplaceOnce("recordings:\n", "effects:\n" + effects + "recordings:\n", &study.scenario_text);
  study.Simulate();
  Result<EffectFit> declared = FitWithDeclaredEffects(study.Prepare());
  if (!declared.ok()) throw std::runtime_error(declared.status().message());
  const LoopOptions options;
  const Misled problem(options, unseen, scans);
  Search search(problem, options, JudgedFit(*std::move(declared)));
  search.Run();
  Outcome outcome;
  for (const ActiveEffect& effect : Misled::Effects(search.model())) outcome.effects.push_back(EffectTitle(effect));
  outcome.dropped = search.dropped();
  return outcome;
}

struct Case {
  const char* effects;   // of the scenario
  const char* unseen;    // id of the effect that is there
  const char* truth;     // its title
  const char* stand_in;  // what is found in its stead
};
const Case kPowerViscous = {"  - {id: power_viscous, joints: [2], coefficient: 4.0, exponent: 0.4}\n", "power_viscous",
                            "power_viscous on joint 2", "presliding on joint 2"};
const Case kStribeck = {"  - {id: stribeck, joints: [2], Fst: 2.0, vs: 0.2}\n", "stribeck", "stribeck on joint 2",
                        "power_viscous on joint 2"};
const Case kSpring = {"  - {id: joint_spring, joints: [1], stiffness: 2.0, rest: 0.3}\n", "joint_spring",
                      "joint_spring on joint 1", "torque_ripple on joint 1"};

// The truth is left alone in the model, the stand-in gone for this reason.
void ExpectCorrected(const Case& one, int scans, WhyDropped why) {
  const Outcome outcome = Close(one.effects, {one.unseen}, scans);
  EXPECT_EQ(outcome.effects, std::vector<std::string>({one.truth}));
  ASSERT_EQ(outcome.dropped.size(), 1u) << one.truth;
  EXPECT_EQ(EffectTitle(outcome.dropped[0].effect), one.stand_in);
  EXPECT_EQ(outcome.dropped[0].why, why) << one.truth;
  ASSERT_EQ(outcome.dropped[0].replaced_by.has_value(), why == WhyDropped::kReplaced) << one.truth;
  if (why == WhyDropped::kReplaced) {
    EXPECT_EQ(EffectTitle(*outcome.dropped[0].replaced_by), one.truth);
  }
}

TEST(MisledLoop, DropsWhatIsNotNeededBesideTheTruth) {
  for (const Case& one : {kPowerViscous, kSpring}) ExpectCorrected(one, 1, WhyDropped::kNotNeeded);
}

TEST(MisledLoop, DropsWhatTurnedItsSignBesideTheTruth) { ExpectCorrected(kStribeck, 1, WhyDropped::kForbiddenSign); }

// Seen only where the place of the other is looked at again.
TEST(MisledLoop, ReplacesByTheTruth) {
  for (const Case& one : {kPowerViscous, kStribeck, kSpring}) ExpectCorrected(one, 1000, WhyDropped::kReplaced);
}

}  // namespace
}  // namespace idim::testing::misled_loop_test
