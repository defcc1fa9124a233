#include "solvers/loop/loop_rules.h"

#include <glog/logging.h>

#include <algorithm>
#include <cmath>

namespace idim {

using Eigen::VectorXd;

namespace {

// What the folds cannot explain by chance. `decrease` and `error` in one unit.
bool IsSure(const VectorXd& gain, double decrease, double error, double standard_errors) {
  const auto up = static_cast<double>((gain.array() > 0.0).count());
  return decrease > standard_errors * error || up >= kMostFolds * static_cast<double>(gain.size());
}

// `row` is behind `best` by more than standard_errors of the difference.
bool IsBehind(const CandidateRow& row, const CandidateRow& best, double standard_errors) {
  const VectorXd behind = best.held_out_gain - row.held_out_gain;
  return behind.sum() > standard_errors * StandardErrorOfSum(behind);
}

}  // namespace

double StandardErrorOfSum(const VectorXd& folds) {
  const double count = static_cast<double>(folds.size());
  return std::sqrt(count / (count - 1.0) * (folds.array() - folds.mean()).matrix().squaredNorm());
}

void SetHeldOut(const VectorXd& gain, double squares, CandidateRow* row) {
  row->held_out_gain = gain;
  row->held_out_decrease = gain.sum() / squares;
  row->held_out_error = StandardErrorOfSum(gain) / squares;
}

double DecreaseOfSquares(double margin) { return margin * (2.0 - margin); }

double CorrectedPValue(double p_value, const Tries& tries) {
  const double count = static_cast<double>(tries.effects) * tries.places * std::max(tries.shapes, 1);
  return std::min(1.0, p_value * count);
}

bool PassesScoreTest(double corrected_p_value, double significance) { return corrected_p_value <= significance; }

bool PassesHeldOut(const CandidateRow& row, double margin) {
  return row.held_out_decrease > DecreaseOfSquares(margin) &&
         IsSure(row.held_out_gain, row.held_out_decrease, row.held_out_error, kCandidateErrors);
}

bool IsNeeded(const VectorXd& without, const VectorXd& with, double margin) {
  const VectorXd gain = without - with;
  return gain.sum() > DecreaseOfSquares(margin) * without.sum() &&
         IsSure(gain, gain.sum(), StandardErrorOfSum(gain), kRefitErrors);
}

bool RanksBefore(const CandidateRow& a, const CandidateRow& b) { return a.held_out_gain.sum() > b.held_out_gain.sum(); }

size_t ChooseCandidate(const std::vector<CandidateRow>& rows, const std::vector<bool>& overlaps) {
  CHECK(!rows.empty());
  CHECK_EQ(rows.size(), overlaps.size());
  size_t chosen = 0;
  for (size_t k = 1; k < rows.size(); ++k) {
    if (!overlaps[k] || IsBehind(rows[k], rows[0], kSameErrors)) continue;
    if (rows[k].parameters < rows[chosen].parameters) chosen = k;
  }
  return chosen;
}

std::vector<size_t> RivalsOf(size_t chosen, const std::vector<CandidateRow>& rows, const std::vector<bool>& overlaps) {
  CHECK_EQ(rows.size(), overlaps.size());
  std::vector<size_t> rivals;
  for (size_t k = 0; k < rows.size(); ++k) {
    if (k != chosen && overlaps[k] && !IsBehind(rows[k], rows[chosen], kRivalErrors)) rivals.push_back(k);
  }
  return rivals;
}

bool Overlap(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return (a.transpose() * b).squaredNorm() > kOverlap * static_cast<double>(std::min(a.cols(), b.cols()));
}

bool IsReplacedBy(const VectorXd& present, const VectorXd& other) {
  const VectorXd gain = present - other;
  return gain.sum() > kReplacementErrors * StandardErrorOfSum(gain);
}

bool HasForbiddenSign(bool non_negative, const VectorXd& values) {
  return non_negative && values.size() > 0 && values.minCoeff() < 0.0;
}

bool IsReconsideredAgain(int sweep, bool added) { return sweep < kReconsiderations && (sweep == 0 || added); }

}  // namespace idim
