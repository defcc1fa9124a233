// Effects tried again beside all others, on models that are tables (tests/support/scripted_model.h).

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "solvers/loop/loop_search.h"
#include "tests/support/scripted_model.h"

namespace idim::testing::loop_reconsider_test {
namespace {

using ::testing::Contains;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::StartsWith;

// `a` stands in for b and c, and is found first.
struct StandIn {
  ScriptedProblem problem;
  StandIn() {
    problem.Leaves("", 100);
    problem.Leaves("a", 80);
    problem.Leaves("a b", 65);
    problem.Leaves("a b c", 50);
    problem.Leaves("b c", 50);
    problem.Leaves("a c", 60);
    problem.Leaves("b", 75);
    problem.Leaves("c", 75);
    problem.scans[""] = {Candidate("a", 20)};
    problem.scans["a"] = {Candidate("b", 15)};
    problem.scans["a b"] = {Candidate("c", 15)};
  }
};

TEST(LoopReconsiders, DropsWhatIsNotNeededBesideTheOthers) {
  StandIn stand_in;
  const Outcome outcome = Searched(stand_in.problem);
  EXPECT_EQ(outcome.model, "b c");
  EXPECT_THAT(outcome.found, ElementsAre("b", "c"));
  EXPECT_THAT(outcome.dropped, ElementsAre("a not needed"));
  // b and c are tried without a, and what is left is looked at once more.
  EXPECT_THAT(
      stand_in.problem.asked,
      ElementsAre("scan ", "fit a from ", "scan a", "fit a b from a", "scan a b", "fit a b c from a b", "scan a b c",
                  "fit b c from a b c", "fit c from b c", "scan c at 0", "fit b from b c", "scan b at 0", "scan b c"));
}

TEST(LoopReconsiders, IsTheSameWhateverTheThreads) {
  LoopOptions options;
  options.threads = 2;
  StandIn stand_in;
  const Outcome outcome = Searched(stand_in.problem, options);
  EXPECT_EQ(outcome.model, "b c");
  EXPECT_THAT(outcome.found, ElementsAre("b", "c"));
  EXPECT_THAT(outcome.dropped, ElementsAre("a not needed"));
  // One ahead, for nothing where the model has changed.
  EXPECT_THAT(stand_in.problem.asked, Contains("fit a c from a b c"));
}

TEST(LoopReconsiders, KeepsWhatItCannotFitWithout) {
  StandIn stand_in;
  stand_in.problem.unfittable = {"b c"};
  EXPECT_EQ(Searched(stand_in.problem).model, "a b c");
}

TEST(LoopReconsiders, KeepsWhatAnotherEffectNeedsForItsSign) {
  StandIn stand_in;
  stand_in.problem.forbidden["b c"] = {"b"};
  const Outcome outcome = Searched(stand_in.problem);
  EXPECT_EQ(outcome.model, "a b c");
  EXPECT_THAT(outcome.dropped, IsEmpty());
}

TEST(LoopReconsiders, DropsWhatTurnedItsSign) {
  ScriptedProblem problem;
  problem.Leaves("", 100);
  problem.Leaves("a", 80);
  problem.Leaves("a b", 50);
  problem.Leaves("b", 60);
  problem.scans[""] = {Candidate("a", 20)};
  problem.scans["a"] = {Candidate("b", 30)};
  problem.scans["b"] = {Candidate("c", 10)};
  problem.Leaves("b c", 50);
  problem.Leaves("c", 80);
  problem.forbidden["a b"] = {"a"};
  const Outcome outcome = Searched(problem);
  EXPECT_EQ(outcome.model, "b c");
  EXPECT_THAT(outcome.found, ElementsAre("b", "c"));
  EXPECT_THAT(outcome.dropped, ElementsAre("a forbidden sign"));
}

// Signs are looked at anew after each.
TEST(LoopReconsiders, DropsSignsOneAfterTheOther) {
  StandIn stand_in;
  ScriptedProblem& problem = stand_in.problem;
  problem.forbidden["a b c"] = {"a", "b"};
  EXPECT_THAT(Searched(problem).dropped, ElementsAre("a forbidden sign"));
  problem.forbidden["b c"] = {"c"};
  EXPECT_THAT(Searched(problem).dropped, ElementsAre("a forbidden sign", "c forbidden sign"));
  EXPECT_EQ(Searched(problem).model, "b");
}

TEST(LoopReconsiders, DropsWhatTurnedItsSignInTheLastSweep) {
  ScriptedProblem problem;
  problem.Leaves("", 100);
  problem.Leaves("a", 80);
  problem.Leaves("r", 40);  // replaces a
  problem.Leaves("r b", 20);
  problem.Leaves("b r", 20);
  problem.Leaves("b", 60);
  problem.Leaves("b r z", 10);
  problem.scans[""] = {Candidate("a", 20), Candidate("r", 20)};
  problem.scans["r"] = {Candidate("b", 20)};
  problem.forbidden["b r"] = {"r"};
  LoopOptions options;
  const Outcome outcome = Searched(problem, options);
  EXPECT_EQ(outcome.model, "b");
  EXPECT_THAT(outcome.dropped, ElementsAre("a replaced by r", "r forbidden sign"));
}

TEST(LoopReconsiders, KeepsAForbiddenSignThatItCannotFitWithout) {
  ScriptedProblem problem;
  problem.Leaves("", 100);
  problem.Leaves("a", 80);
  problem.Leaves("a b", 50);
  problem.scans[""] = {Candidate("a", 20)};
  problem.scans["a"] = {Candidate("b", 30)};
  problem.forbidden["a b"] = {"a"};
  problem.unfittable = {"b"};
  EXPECT_EQ(Searched(problem).model, "a b");
}

TEST(LoopReconsiders, ReplacesByWhatIsSurelyBetterAtTheSamePlace) {
  const auto prepare = [](ScriptedProblem* problem) {
    problem->Leaves("", 100);
    problem->Leaves("a", 80);
    problem->Leaves("r", 60);
    problem->Leaves("s", 40);
    problem->scans[""] = {Candidate("a", 30, 1, {2}), Candidate("q", 30, 1, {1}), Candidate("r", 20, 1, {2}),
                          Candidate("s", 10, 1, {2})};
    problem->unfittable = {"q"};
  };
  ScriptedProblem problem;
  prepare(&problem);
  Outcome outcome = Searched(problem);
  // The first of its place; what is at another joint, or worse in the scan, is not compared.
  EXPECT_EQ(outcome.model, "r");
  EXPECT_THAT(outcome.dropped, ElementsAre("a replaced by r"));
  ASSERT_THAT(outcome.found, ElementsAre("r"));
  EXPECT_EQ(outcome.steps[0].before, "");
  EXPECT_EQ(outcome.steps[0].after, "r");
  EXPECT_THAT(outcome.steps[0].ranking, ElementsAre("a", "r", "s"));
  EXPECT_THAT(outcome.steps[0].rivals, IsEmpty());
  EXPECT_THAT(problem.asked, Contains("scan  at 2"));

  ScriptedProblem worse;
  prepare(&worse);
  worse.Leaves("r", 80);
  EXPECT_EQ(Searched(worse).model, "a");

  ScriptedProblem unsure;
  prepare(&unsure);
  unsure.squares["r"] = Eigen::Vector4d(18, 18, 18, 20.9);
  unsure.squares["a"] = Eigen::Vector4d(20, 20, 20, 20);
  EXPECT_EQ(Searched(unsure).model, "a");

  ScriptedProblem failing;
  prepare(&failing);
  failing.unfittable.insert("r");
  EXPECT_EQ(Searched(failing).model, "s");

  ScriptedProblem negative;
  prepare(&negative);
  negative.forbidden["r"] = {"r"};
  EXPECT_EQ(Searched(negative).model, "s");

  ScriptedProblem weak;
  prepare(&weak);
  weak.scans[""][2].p_value = 0.06;
  EXPECT_EQ(Searched(weak).model, "s");
}

TEST(LoopReconsiders, AnEffectOfTheArmHasNoPlaceToShare) {
  ScriptedProblem problem;
  problem.Leaves("", 100);
  problem.Leaves("a", 80);
  problem.Leaves("r", 40);
  problem.scans[""] = {Candidate("a", 30, 1, {}), Candidate("r", 20, 1, {})};
  EXPECT_EQ(Searched(problem).model, "a");
}

TEST(LoopReconsiders, LooksAgainAfterAReplacement) {
  ScriptedProblem problem;
  problem.Leaves("", 100);
  problem.Leaves("a", 80);
  problem.Leaves("r", 60);
  problem.Leaves("b r", 40);
  problem.Leaves("b", 70);
  problem.scans[""] = {Candidate("a", 30), Candidate("r", 20)};
  problem.scans["r"] = {Candidate("b", 20)};
  EXPECT_EQ(Searched(problem).model, "b r");
}

TEST(LoopReconsiders, AReplacementKeepsTheOthersFromNothing) {
  ScriptedProblem problem;
  problem.Leaves("", 100);
  problem.Leaves("a", 80);
  problem.Leaves("a b", 60);
  problem.Leaves("b", 75);
  problem.Leaves("b r", 40);
  problem.Leaves("r", 40);
  problem.scans[""] = {Candidate("a", 20)};
  problem.scans["a"] = {Candidate("b", 20, 1, {1})};
  problem.scans["b"] = {Candidate("r", 30)};
  for (const int threads : {1, 2}) {
    LoopOptions options;
    options.threads = threads;
    const Outcome outcome = Searched(problem, options);
    EXPECT_THAT(outcome.dropped, ElementsAre("a replaced by r", "b not needed"));
    EXPECT_EQ(outcome.model, "r");
  }
}

// The model without effects is asked for at the second reconsideration, and there is no third.
TEST(LoopReconsiders, ReconsidersTwice) {
  ScriptedProblem problem;
  const std::vector<std::string> chain = {"a", "b", "c", "d"};
  problem.Leaves("", 100);
  for (size_t k = 0; k < chain.size(); ++k) problem.Leaves(chain[k], 80.0 - 10.0 * static_cast<double>(k));
  // Each is replaced by the next; something new (n, m) is found in between.
  problem.scans[""] = {Candidate("a", 20), Candidate("b", 15)};
  problem.scans["b"] = {Candidate("n", 20, 1, {1})};
  problem.Leaves("b n", 50);
  problem.Leaves("n", 65);
  problem.scans["n"] = {Candidate("b", 20), Candidate("c", 15)};
  problem.Leaves("c n", 40);
  problem.Leaves("c", 55);
  problem.scans["c n"] = {Candidate("m", 20, 1, {2})};
  problem.Leaves("c m n", 20);
  problem.Leaves("m n", 40);
  problem.scans["m n"] = {Candidate("c", 20), Candidate("d", 15)};
  problem.Leaves("d m n", 10);
  const Outcome outcome = Searched(problem);
  EXPECT_EQ(outcome.model, "c m n");
  EXPECT_THAT(outcome.dropped, ElementsAre("a replaced by b", "b replaced by c"));
  EXPECT_THAT(outcome.found, ElementsAre("n", "c", "m"));
  EXPECT_THAT(problem.asked, Not(Contains("fit m n from c m n")));
}

TEST(LoopReconsiders, DoesNotReconsiderASecondTimeForNothingNew) {
  ScriptedProblem problem;
  problem.Leaves("", 100);
  problem.Leaves("a", 80);
  problem.Leaves("r", 60);
  problem.scans[""] = {Candidate("a", 30), Candidate("r", 20)};
  EXPECT_EQ(Searched(problem).model, "r");
  EXPECT_THAT(problem.asked,
              ElementsAre("scan ", "fit a from ", "scan a", "fit  from a", "scan  at 0", "fit r from ", "scan r"));
}

TEST(LoopReconsiders, DeclaredEffectsStay) {
  ScriptedProblem problem;
  problem.Leaves("d", 100);
  problem.Leaves("a d", 80);
  problem.Leaves("a", 0);
  problem.scans["d"] = {Candidate("a", 30)};
  problem.forbidden["a d"] = {"d"};
  const Outcome outcome = Searched(problem, LoopOptions(), {{"d"}});
  EXPECT_EQ(outcome.model, "a d");
  EXPECT_THAT(outcome.found, ElementsAre("a"));
  EXPECT_THAT(problem.asked, Not(Contains(StartsWith("fit a from a d"))));
}

TEST(LoopReconsiders, ReleasesShapesThatWereHeld) {
  ScriptedProblem problem;
  problem.Leaves("d", 100);
  problem.Leaves("a d", 80);
  problem.scans["d"] = {Candidate("a", 30)};
  EXPECT_EQ(Searched(problem, LoopOptions(), {{"d", {0}, true}}).model, "a d");
  EXPECT_THAT(problem.asked, ElementsAre("scan d", "fit a d from d*", "scan a d", "fit a d from a d", "fit d from a d",
                                         "scan d at 0"));
}

}  // namespace
}  // namespace idim::testing::loop_reconsider_test
