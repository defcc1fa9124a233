// The decisions of the loop, each a function of plain tables: candidates in rows, squared held-out residuals in folds.
// In which order they are asked: solvers/loop/loop_search.h; what for: solvers/loop/close_loop.h.

#ifndef IDIM_SOLVERS_LOOP_LOOP_RULES_H_
#define IDIM_SOLVERS_LOOP_LOOP_RULES_H_

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace idim {

// Standard errors of the folds by which ...
inline constexpr double kCandidateErrors = 2.0;    // a candidate must lower the held-out error of its joints
inline constexpr double kRefitErrors = 1.0;        // an effect must, once everything is fitted with it
inline constexpr double kSameErrors = 1.0;         // a candidate may be behind the best one and still be chosen
inline constexpr double kRivalErrors = 2.0;        // a candidate may be behind the chosen one and still be its rival
inline constexpr double kReplacementErrors = 2.0;  // another effect must be ahead of one in the model to replace it
// An effect that acts in a few stretches of motion gains much in some folds and little in others: its standard error
// is large, its sign sure. In this part of the folds, a gain counts whatever its standard error.
inline constexpr double kMostFolds = 0.85;
// Two effects explain the same above this mean squared cosine between their columns' spaces.
inline constexpr double kOverlap = 0.5;
// How often the effects in the model are tried again beside each other.
inline constexpr int kReconsiderations = 2;

// What is known of a candidate when it is judged.
struct CandidateRow {
  int parameters = 0;              // linear ones that the model cannot imitate, and shape parameters
  double p_value = 1.0;            // of the score test, corrected (CorrectedPValue)
  Eigen::VectorXd held_out_gain;   // folds: decrease of the squared residual of all joints
  double held_out_decrease = 0.0;  // its sum over the squares of the effect's joints
  double held_out_error = 0.0;     // standard error of held_out_decrease, from the folds
};

// Of the sum of `folds`, by their spread.
double StandardErrorOfSum(const Eigen::VectorXd& folds);

// gain: folds; squares: of the effect's joints, before.
void SetHeldOut(const Eigen::VectorXd& gain, double squares, CandidateRow* row);

// A relative decrease of the error, as one of its square.
double DecreaseOfSquares(double margin);

// Among how many one candidate was found.
struct Tries {
  int effects = 1;  // in the catalogue, with a place to act at
  int places = 1;   // of the candidate's effect
  int shapes = 1;   // looked at, at the candidate's place
};

// Bonferroni with unequal shares: the level is shared equally between the effects, then between the places of an
// effect, then between the shapes tried at a place. At most 1.
double CorrectedPValue(double p_value, const Tries& tries);

// The gate on the score test.
bool PassesScoreTest(double corrected_p_value, double significance);

// The gate on the held-out error, of a candidate: down by more than the margin, and by more than kCandidateErrors
// or in kMostFolds.
bool PassesHeldOut(const CandidateRow& row, double margin);

// The same of an effect once everything is fitted with and without it, by kRefitErrors. Squares by fold, of its joints.
bool IsNeeded(const Eigen::VectorXd& without, const Eigen::VectorXd& with, double margin);

// Best first: by the sum of held_out_gain.
bool RanksBefore(const CandidateRow& a, const CandidateRow& b);

// rows: of candidates that passed, best first, at least one; overlaps: which of them explain the same as the first.
// The first, or of those that overlap and that the folds cannot tell from it the one with the fewest parameters.
size_t ChooseCandidate(const std::vector<CandidateRow>& rows, const std::vector<bool>& overlaps);

// Those which the data cannot tell from the chosen one: they overlap and are not behind it by more than kRivalErrors.
std::vector<size_t> RivalsOf(size_t chosen, const std::vector<CandidateRow>& rows, const std::vector<bool>& overlaps);

// a, b: orthonormal columns.
bool Overlap(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

// Squares by fold of the model with the present effect, and with another in its place.
bool IsReplacedBy(const Eigen::VectorXd& present, const Eigen::VectorXd& other);

// values: of an effect's linear parameters; non_negative: physics forbids others.
bool HasForbiddenSign(bool non_negative, const Eigen::VectorXd& values);

// sweep: how often effects have been reconsidered; added: whether any was found since.
bool IsReconsideredAgain(int sweep, bool added);

}  // namespace idim

#endif  // IDIM_SOLVERS_LOOP_LOOP_RULES_H_
