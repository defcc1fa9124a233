// Forward steps of the loop on models that are tables (tests/support/scripted_model.h): what is added, what is refused.

#include "solvers/loop/loop_search.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/support/scripted_model.h"

namespace idim::testing::loop_search_test {
namespace {

using ::testing::Contains;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Not;

TEST(LoopSearch, StopsWhereNothingIsFound) {
  const ScriptedProblem problem;
  const Outcome outcome = Searched(problem);
  EXPECT_EQ(outcome.model, "");
  EXPECT_THAT(outcome.found, IsEmpty());
  EXPECT_THAT(problem.asked, ElementsAre("scan "));
}

TEST(LoopSearch, AddsWhatPassesAndLooksAgain) {
  ScriptedProblem problem;
  problem.Leaves("", 100);
  problem.Leaves("b", 90);
  problem.Leaves("a b", 70);
  problem.Leaves("a", 80);
  problem.scans[""] = {Candidate("b", 30), Candidate("a", 20)};
  problem.scans["b"] = {Candidate("a", 20)};
  const Outcome outcome = Searched(problem);
  EXPECT_EQ(outcome.model, "a b");
  EXPECT_THAT(outcome.found, ElementsAre("b", "a"));
  EXPECT_THAT(outcome.dropped, IsEmpty());
  EXPECT_EQ(outcome.steps[0].before, "");
  EXPECT_EQ(outcome.steps[0].after, "b");
  EXPECT_THAT(outcome.steps[0].ranking, ElementsAre("b", "a"));
  EXPECT_THAT(outcome.steps[0].rivals, IsEmpty());
  EXPECT_EQ(outcome.steps[1].before, "b");
  EXPECT_EQ(outcome.steps[1].after, "a b");
  // Each is tried beside the other, in the order of the model, and another in its place looked for; nothing changed.
  EXPECT_THAT(problem.asked, ElementsAre("scan ", "fit b from ", "scan b", "fit a b from b", "scan a b",
                                         "fit a from a b", "scan a at 0", "fit b from a b", "scan b at 0"));
}

TEST(LoopSearch, RefusesByTheScoreTest) {
  ScriptedProblem problem;
  problem.scans[""] = {Candidate("a", 30)};
  problem.scans[""][0].p_value = 0.0501;
  EXPECT_EQ(Searched(problem).model, "");
  EXPECT_THAT(problem.asked, ElementsAre("scan "));
  LoopOptions options;
  options.significance = 0.06;
  problem.Leaves("", 100);
  problem.Leaves("a", 70);
  EXPECT_EQ(Searched(problem, options).model, "a");
}

TEST(LoopSearch, RefusesByTheHeldOutError) {
  ScriptedProblem problem;
  problem.scans[""] = {Candidate("a", 3.9)};  // 2 % of the error are 3.96 % of its square
  EXPECT_EQ(Searched(problem).model, "");
  EXPECT_THAT(problem.asked, ElementsAre("scan "));
  LoopOptions options;
  options.margin = 0.019;
  problem.Leaves("", 100);
  problem.Leaves("a", 70);
  EXPECT_EQ(Searched(problem, options).model, "a");
}

TEST(LoopSearch, RefusesWhatIsNoBetterOnceFittedAndTakesTheNext) {
  ScriptedProblem problem;
  problem.Leaves("", 100);
  problem.Leaves("a", 96.1);
  problem.Leaves("b", 95);
  problem.scans[""] = {Candidate("a", 30), Candidate("b", 20)};
  problem.scans["b"] = {Candidate("a", 30)};
  const Outcome outcome = Searched(problem);
  EXPECT_THAT(outcome.found, ElementsAre("b"));
  EXPECT_THAT(outcome.steps[0].ranking, ElementsAre("a", "b"));
  // What was put aside stays there.
  EXPECT_THAT(problem.asked,
              ElementsAre("scan ", "fit a from ", "fit b from ", "scan b", "fit  from b", "scan  at 0", "fit a from "));
}

TEST(LoopSearch, TheMarginHoldsOnceFitted) {
  ScriptedProblem problem;
  problem.Leaves("", 100);
  problem.Leaves("a", 95);
  problem.scans[""] = {Candidate("a", 30)};
  LoopOptions options;
  options.margin = 0.03;
  EXPECT_EQ(Searched(problem, options).model, "");
  EXPECT_EQ(Searched(problem).model, "a");
}

TEST(LoopSearch, RefusesWhatCannotBeFitted) {
  ScriptedProblem problem;
  problem.scans[""] = {Candidate("a", 30)};
  problem.unfittable = {"a"};
  EXPECT_EQ(Searched(problem).model, "");
  EXPECT_THAT(problem.asked, ElementsAre("scan ", "fit a from "));
}

TEST(LoopSearch, RefusesAForbiddenSignOfTheNewEffect) {
  ScriptedProblem problem;
  problem.Leaves("", 100);
  problem.Leaves("a", 50);
  problem.scans[""] = {Candidate("a", 30)};
  problem.forbidden["a"] = {"a"};
  const Outcome outcome = Searched(problem);
  EXPECT_EQ(outcome.model, "");
  EXPECT_THAT(outcome.dropped, IsEmpty());
}

TEST(LoopSearch, MeasuresTheJointsOfTheEffect) {
  ScriptedProblem problem;
  problem.Leaves("", 100);
  problem.Leaves("a", 99);
  problem.Leaves(" at 1", 10);
  problem.Leaves("a at 1", 9);
  problem.scans[""] = {Candidate("a", 30, 1, {1})};
  EXPECT_EQ(Searched(problem).model, "a");
  problem.scans[""] = {Candidate("a", 30, 1, {0})};
  EXPECT_EQ(Searched(problem).model, "");
}

TEST(LoopSearch, PrefersFewerParametersAmongThoseThatExplainTheSame) {
  ScriptedProblem problem;
  problem.Leaves("", 100);
  for (const char* name : {"a", "b"}) problem.Leaves(name, 70);
  problem.scans[""] = {Candidate("a", 30, 3), Candidate("b", 30, 2)};
  EXPECT_THAT(Searched(problem).found, ElementsAre("a"));
  problem.overlapping = {{"a", "b"}};
  EXPECT_THAT(Searched(problem).found, ElementsAre("b"));
  problem.scans[""][1].parameters = 3;
  EXPECT_THAT(Searched(problem).found, ElementsAre("a"));
}

TEST(LoopSearch, OverlapIsWithTheBestThatStillPasses) {
  ScriptedProblem problem;
  problem.Leaves("", 100);
  for (const char* name : {"b", "c"}) problem.Leaves(name, 70);
  problem.scans[""] = {Candidate("a", 30, 3), Candidate("b", 30, 3), Candidate("c", 30, 1)};
  problem.scans[""][0].p_value = 1.0;
  problem.overlapping = {{"b", "c"}};
  EXPECT_THAT(Searched(problem).found, ElementsAre("c"));
}

TEST(LoopSearch, ListsRivals) {
  ScriptedProblem problem;
  problem.Leaves("", 100);
  problem.Leaves("a", 70);
  problem.Leaves("b", 70);
  problem.scans[""] = {Candidate("a", 30, 3), Candidate("b", 30, 2), Candidate("c", 30, 2), Candidate("d", 29, 2),
                       Candidate("e", 30, 2)};
  problem.scans[""][4].p_value = 0.06;
  // d is behind by the same in every fold, e did not pass, c explains something else.
  problem.overlapping = {{"a", "b"}, {"b", "d"}, {"b", "e"}, {"a", "c"}};
  const Outcome outcome = Searched(problem);
  ASSERT_THAT(outcome.found, ElementsAre("b"));
  EXPECT_THAT(outcome.steps[0].rivals, ElementsAre("a"));
}

TEST(LoopSearch, RivalsAreOfThoseThatStillPass) {
  ScriptedProblem problem;
  problem.Leaves("", 100);
  problem.Leaves("a", 100);
  problem.Leaves("b", 70);
  problem.scans[""] = {Candidate("a", 30), Candidate("b", 30), Candidate("c", 30)};
  problem.overlapping = {{"a", "b"}, {"b", "c"}};
  const Outcome outcome = Searched(problem);
  ASSERT_THAT(outcome.found, ElementsAre("b"));
  EXPECT_THAT(outcome.steps[0].rivals, ElementsAre("c"));
}

TEST(LoopSearch, AddsAtMostSoManyEffects) {
  ScriptedProblem problem;
  problem.Leaves("", 100);
  problem.Leaves("a", 70);
  problem.Leaves("a b", 50);
  problem.Leaves("b", 70);
  problem.scans[""] = {Candidate("a", 30)};
  problem.scans["a"] = {Candidate("b", 30)};
  LoopOptions options;
  options.max_effects = 0;
  EXPECT_THAT(Searched(problem, options).found, IsEmpty());
  EXPECT_THAT(problem.asked, IsEmpty());
  options.max_effects = 1;
  EXPECT_THAT(Searched(problem, options).found, ElementsAre("a"));
  EXPECT_THAT(problem.asked, Not(Contains("scan a")));
  options.max_effects = 2;
  EXPECT_THAT(Searched(problem, options).found, ElementsAre("a", "b"));
  // Declared ones do not count.
  ScriptedProblem declared;
  declared.Leaves("d", 100);
  declared.Leaves("a d", 70);
  declared.scans["d"] = {Candidate("a", 30)};
  options.max_effects = 1;
  EXPECT_THAT(Searched(declared, options, {{"d"}}).found, ElementsAre("a"));
}

TEST(LoopSearch, SaysWhatItDoes) {
  ScriptedProblem problem;
  problem.Leaves("", 100);
  problem.Leaves("a", 96.1);
  problem.Leaves("b", 90);
  problem.scans[""] = {Candidate("a", 30), Candidate("b", 20), Candidate("c", 10)};
  problem.unfittable = {"c", "b c"};
  problem.scans["b"] = {Candidate("c", 10)};
  LoopOptions options;
  std::vector<std::string> said;
  options.progress = [&said](const std::string& text) { said.push_back(text); };
  Searched(problem, options);
  EXPECT_THAT(said, ElementsAre("0 effects, scanning", "0 effects, fitting with a", "0 effects, no better with a",
                                "0 effects, fitting with b", "1 effects, scanning", "1 effects, fitting with c",
                                "1 effects, no fit with c", "1 effects, is b needed beside the others?",
                                "1 effects, scanning"));
}

}  // namespace
}  // namespace idim::testing::loop_search_test
