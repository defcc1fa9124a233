// Every decision of the loop on tables that lie on both sides of its threshold, and on it.
//
// Folds whose sums and standard errors are whole numbers: (3, 0, 0) has the sum 3 and the standard error 3, (4, 1, 1)
// the sum 6 and the standard error 3.

#include "solvers/loop/loop_rules.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace idim::loop_rules_test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd Folds(const std::vector<double>& values) {
  return Eigen::Map<const VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

// `up` folds that gain, the others lose as much: told apart by their number alone.
VectorXd SomeUp(int up, int folds) {
  VectorXd gain = VectorXd::Constant(folds, -1.0);
  gain.head(up).setOnes();
  return gain;
}

CandidateRow Row(const std::vector<double>& gain, int parameters = 1) {
  CandidateRow row;
  row.parameters = parameters;
  row.held_out_gain = Folds(gain);
  return row;
}

TEST(LoopRules, StandardErrorOfASumIsThatOfIndependentFolds) {
  EXPECT_EQ(StandardErrorOfSum(Folds({3, 0, 0})), 3.0);
  EXPECT_EQ(StandardErrorOfSum(Folds({4, 1, 1})), 3.0);
  EXPECT_EQ(StandardErrorOfSum(Folds({5, 5, 5})), 0.0);
  // sqrt(n) times the standard deviation of a fold (n - 1 in its denominator).
  EXPECT_NEAR(StandardErrorOfSum(Folds({1, 2, 3, 4, 5})), std::sqrt(5.0 * 2.5), 1e-14);
}

TEST(LoopRules, HeldOutGainIsRelativeToTheSquaresBefore) {
  CandidateRow row;
  SetHeldOut(Folds({4, 1, 1}), 24.0, &row);
  EXPECT_EQ(row.held_out_gain, Folds({4, 1, 1}));
  EXPECT_EQ(row.held_out_decrease, 0.25);
  EXPECT_EQ(row.held_out_error, 0.125);
}

TEST(LoopRules, MarginOfTheErrorAsOneOfItsSquare) {
  for (const double margin : {0.02, 0.1, 0.5}) {
    EXPECT_NEAR(DecreaseOfSquares(margin), 1.0 - (1.0 - margin) * (1.0 - margin), 1e-15);
  }
}

TEST(LoopRules, PValueIsCorrectedForEffectsPlacesAndShapes) {
  EXPECT_DOUBLE_EQ(CorrectedPValue(1e-3, Tries()), 1e-3);
  EXPECT_DOUBLE_EQ(CorrectedPValue(1e-3, {5, 1, 1}), 5e-3);
  EXPECT_DOUBLE_EQ(CorrectedPValue(1e-3, {1, 6, 1}), 6e-3);
  EXPECT_DOUBLE_EQ(CorrectedPValue(1e-3, {1, 1, 7}), 7e-3);
  EXPECT_DOUBLE_EQ(CorrectedPValue(1e-3, {5, 6, 7}), 210e-3);
  // Where no shape was looked at, the place itself was.
  EXPECT_DOUBLE_EQ(CorrectedPValue(1e-3, {5, 6, 0}), 30e-3);
  EXPECT_EQ(CorrectedPValue(0.4, {1, 3, 1}), 1.0);
  EXPECT_EQ(CorrectedPValue(0.0, {5, 6, 7}), 0.0);
}

TEST(LoopRules, ScoreTestHasALevel) {
  EXPECT_TRUE(PassesScoreTest(0.0, 0.05));
  EXPECT_TRUE(PassesScoreTest(0.05, 0.05));
  EXPECT_FALSE(PassesScoreTest(0.0501, 0.05));
  EXPECT_FALSE(PassesScoreTest(1.0, 0.05));
}

TEST(LoopRules, CandidateLowersTheErrorByTheMargin) {
  CandidateRow row = Row({1, 1, 1});
  const double least = DecreaseOfSquares(0.5);
  ASSERT_EQ(least, 0.75);
  row.held_out_decrease = least;
  EXPECT_FALSE(PassesHeldOut(row, 0.5));
  row.held_out_decrease = 1.001 * least;
  EXPECT_TRUE(PassesHeldOut(row, 0.5));
  row.held_out_decrease = -1.0;
  EXPECT_FALSE(PassesHeldOut(row, 0.5));
}

TEST(LoopRules, CandidateLowersTheErrorByTwoStandardErrors) {
  CandidateRow row;
  row.held_out_gain = SomeUp(1, 8);
  row.held_out_decrease = 0.25;
  row.held_out_error = 0.125;
  EXPECT_FALSE(PassesHeldOut(row, 0.02));
  row.held_out_error = 0.1249;
  EXPECT_TRUE(PassesHeldOut(row, 0.02));
}

TEST(LoopRules, CandidateMayLowerTheErrorInMostFoldsInstead) {
  CandidateRow row;
  row.held_out_decrease = 0.25;
  row.held_out_error = 1.0;
  row.held_out_gain = SomeUp(17, 20);
  EXPECT_TRUE(PassesHeldOut(row, 0.02));
  row.held_out_gain = SomeUp(16, 20);
  EXPECT_FALSE(PassesHeldOut(row, 0.02));
  // A fold that does not change is none that gains.
  row.held_out_gain = VectorXd::Zero(20);
  EXPECT_FALSE(PassesHeldOut(row, 0.02));
  // The margin holds all the same.
  row.held_out_gain = SomeUp(20, 20);
  row.held_out_decrease = 0.03;
  EXPECT_FALSE(PassesHeldOut(row, 0.02));
}

TEST(LoopRules, EffectIsNeededByTheMargin) {
  const VectorXd without = Folds({100, 100, 100, 100});
  EXPECT_FALSE(IsNeeded(without, Folds({25, 25, 25, 25}), 0.5));
  EXPECT_TRUE(IsNeeded(without, Folds({24.9, 24.9, 24.9, 24.9}), 0.5));
  EXPECT_FALSE(IsNeeded(without, without, 0.5));
  EXPECT_FALSE(IsNeeded(Folds({25, 25, 25, 25}), without, 0.5));
  // Relative to the squares without it: from 175 down to 100 is less than by half the error, though 75 is not less than
  // 0.75 times 100.
  EXPECT_FALSE(IsNeeded(Folds({175, 175, 175, 175}), Folds({99, 99, 99, 99}), 0.5));
}

TEST(LoopRules, EffectIsNeededByOneStandardErrorOrInMostFolds) {
  const VectorXd without = Folds({10, 10, 10});
  EXPECT_FALSE(IsNeeded(without, Folds({7, 10, 10}), 0.02));
  EXPECT_TRUE(IsNeeded(without, Folds({7, 9.99, 10}), 0.02));
  EXPECT_FALSE(IsNeeded(without, Folds({7, 10.01, 10}), 0.02));
  // One fold gains much, all others little: one standard error is nearly the gain, but the sign is sure.
  VectorXd with = VectorXd::Constant(20, 99.99);
  with[0] = 1.0;
  with.tail(3).setConstant(100.1);
  EXPECT_TRUE(IsNeeded(VectorXd::Constant(20, 100.0), with, 0.02));
  with.tail(4).setConstant(100.1);
  EXPECT_FALSE(IsNeeded(VectorXd::Constant(20, 100.0), with, 0.02));
}

TEST(LoopRules, RankIsByWhatAllJointsGain) {
  EXPECT_TRUE(RanksBefore(Row({1, 5, 1}), Row({2, 2, 2})));
  EXPECT_FALSE(RanksBefore(Row({2, 2, 2}), Row({1, 5, 1})));
  EXPECT_FALSE(RanksBefore(Row({2, 2, 2}), Row({1, 3, 2})));
}

TEST(LoopRules, ChoosesTheBestUnlessOneWithFewerParametersIsAsGood) {
  const CandidateRow best = Row({10, 10, 10}, 3);
  const auto choose = [&](const CandidateRow& other, bool overlaps) {
    return ChooseCandidate({best, other}, {true, overlaps});
  };
  EXPECT_EQ(choose(Row({7, 10, 10}, 2), true), 1u);  // behind by one standard error
  EXPECT_EQ(choose(Row({7, 9.99, 10}, 2), true), 0u);
  EXPECT_EQ(choose(Row({7, 10.01, 10}, 2), true), 1u);
  EXPECT_EQ(choose(Row({7, 10, 10}, 2), false), 0u);  // explains something else
  EXPECT_EQ(choose(Row({10, 10, 10}, 3), true), 0u);  // no fewer
  EXPECT_EQ(choose(Row({10, 10, 10}, 4), true), 0u);
  EXPECT_EQ(ChooseCandidate({best}, {true}), 0u);
}

TEST(LoopRules, ChoosesTheFewestParametersOfAllThatAreAsGood) {
  const std::vector<CandidateRow> rows = {Row({10, 10, 10}, 5), Row({9, 10, 10}, 4), Row({8, 10, 10}, 2),
                                          Row({8, 10, 10}, 3), Row({8, 10, 10}, 2)};
  EXPECT_EQ(ChooseCandidate(rows, {true, true, true, true, true}), 2u);  // the first of two that tie
  EXPECT_EQ(ChooseCandidate(rows, {true, true, false, true, false}), 3u);
}

TEST(LoopRules, RivalsOverlapAndAreNotBehindByTwoStandardErrors) {
  const CandidateRow chosen = Row({10, 10, 10});
  const auto rivals = [&](const CandidateRow& other, bool overlaps) {
    return RivalsOf(1, {other, chosen}, {overlaps, true});
  };
  EXPECT_THAT(rivals(Row({6, 9, 9}), true), ElementsAre(0));  // behind by two
  EXPECT_THAT(rivals(Row({6, 8.99, 8.99}), true), IsEmpty());
  EXPECT_THAT(rivals(Row({6, 9.01, 9.01}), true), ElementsAre(0));
  EXPECT_THAT(rivals(Row({12, 12, 12}), true), ElementsAre(0));  // ahead, but for its parameters
  EXPECT_THAT(rivals(Row({10, 10, 10}), false), IsEmpty());
  EXPECT_THAT(RivalsOf(0, {chosen}, {true}), IsEmpty());
  EXPECT_THAT(RivalsOf(0, {chosen, chosen, chosen}, {true, false, true}), ElementsAre(2));
}

TEST(LoopRules, OverlapIsHalfOfTheSmallerSpace) {
  const MatrixXd axes = MatrixXd::Identity(4, 4);
  const auto at = [](double cosine) -> MatrixXd {
    return Eigen::Vector4d(cosine, std::sqrt(1.0 - cosine * cosine), 0.0, 0.0);
  };
  EXPECT_FALSE(Overlap(axes.col(0), at(0.70)));
  EXPECT_TRUE(Overlap(axes.col(0), at(0.71)));
  EXPECT_TRUE(Overlap(axes.col(0), at(-0.71)));
  // One of two directions is half of the space, not more.
  EXPECT_FALSE(Overlap(axes.leftCols(2), axes.middleCols(1, 2)));
  EXPECT_TRUE(Overlap(axes.leftCols(1), axes.leftCols(3)));
  EXPECT_TRUE(Overlap(axes.leftCols(3), axes.leftCols(1)));
  EXPECT_FALSE(Overlap(axes.leftCols(3), axes.rightCols(2)));
}

TEST(LoopRules, ReplacesOnlyWhatIsSurelyBetter) {
  const VectorXd present = Folds({10, 10, 10});
  EXPECT_FALSE(IsReplacedBy(present, Folds({6, 9, 9})));  // ahead by two standard errors
  EXPECT_TRUE(IsReplacedBy(present, Folds({6, 8.99, 8.99})));
  EXPECT_FALSE(IsReplacedBy(present, Folds({6, 9.01, 9.01})));
  EXPECT_FALSE(IsReplacedBy(present, present));
  EXPECT_FALSE(IsReplacedBy(present, Folds({14, 11.01, 11.01})));
}

TEST(LoopRules, SignIsForbiddenWherePhysicsForbidsIt) {
  EXPECT_TRUE(HasForbiddenSign(true, Folds({1, -1e-9})));
  EXPECT_TRUE(HasForbiddenSign(true, Folds({-2, 1})));
  EXPECT_FALSE(HasForbiddenSign(true, Folds({1, 0})));
  EXPECT_FALSE(HasForbiddenSign(false, Folds({1, -1})));
  EXPECT_FALSE(HasForbiddenSign(true, VectorXd()));
}

TEST(LoopRules, ReconsidersTwiceAndTheSecondTimeForSomethingNew) {
  EXPECT_TRUE(IsReconsideredAgain(0, true));
  EXPECT_TRUE(IsReconsideredAgain(0, false));
  EXPECT_TRUE(IsReconsideredAgain(1, true));
  EXPECT_FALSE(IsReconsideredAgain(1, false));
  EXPECT_FALSE(IsReconsideredAgain(2, true));
  EXPECT_FALSE(IsReconsideredAgain(2, false));
}

TEST(LoopRulesDeathTest, TablesOfOneSize) {
  EXPECT_DEATH(ChooseCandidate({}, {}), "rows.empty");
  EXPECT_DEATH(ChooseCandidate({Row({1, 1})}, {}), "overlaps.size");
  EXPECT_DEATH(RivalsOf(0, {Row({1, 1})}, {}), "overlaps.size");
}

}  // namespace
}  // namespace idim::loop_rules_test
