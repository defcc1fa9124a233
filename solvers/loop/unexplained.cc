#include "solvers/loop/unexplained.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/effects/columns.h"
#include "core/model/active_effects.h"

namespace idim {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kCells = 10, kPairCells = 6;
// Cells' means are shrunk as if this many more samples of residual zero lay in each.
constexpr double kShrink = 5.0;
// What a pair must take away beyond the better of its two signals.
constexpr double kPairFactor = 1.2;

struct Signal {
  std::string name;
  VectorXd value;  // samples
};

// Without the noise of the states: it is in the residual too (of a joint at rest ddq is nothing else), and would
// be found.
VectorXd Smooth(const PreparedStudy& prepared, const MeasuredRecording& recording, const MatrixXd& of, int joint) {
  EffectMotion motion;
  motion.states = recording.states;
  motion.derivative_cutoff_hz = kDerivativeBand * prepared.data->preprocessing.cutoff_hz;
  return recording.decimator->Apply(ForDerivatives(motion, of.col(joint)));
}

std::vector<Signal> SignalsOf(const PreparedStudy& prepared, const ResidualModel& residual, int joint) {
  std::vector<Signal> signals;
  const int n = residual.dof();
  const auto stack = [&](auto get) {
    VectorXd value(residual.samples());
    size_t range = 0;
    for (const int r : prepared.model.RecordingsFor(Use::kIdentification)) {
      const auto [begin, end] = residual.recordings()[range++];
      value.segment(begin, end - begin) = get(prepared.data->recordings[static_cast<size_t>(r)]);
    }
    return value;
  };
  for (int j = 0; j < n; ++j) {
    const std::string number = std::to_string(j + 1);
    signals.push_back({"q" + number, stack([&](const MeasuredRecording& r) {
                         return VectorXd(r.decimator->Apply(r.states->q.col(j)));
                       })});
    signals.push_back(
        {"dq" + number, stack([&](const MeasuredRecording& r) { return Smooth(prepared, r, r.states->dq, j); })});
    signals.push_back(
        {"ddq" + number, stack([&](const MeasuredRecording& r) { return Smooth(prepared, r, r.states->ddq, j); })});
  }
  // Of the model: the measured one has the residual in it.
  signals.push_back(
      {"tau" + std::to_string(joint + 1), residual.torque().col(joint) - residual.TorqueResidual().col(joint)});
  signals.push_back({"t", stack([](const MeasuredRecording& r) { return r.decimator->times(); })});
  return signals;
}

// The cell of equal count that each sample lies in.
std::vector<int> CellsOf(const VectorXd& value, int cells) {
  std::vector<Index> order(static_cast<size_t>(value.size()));
  std::iota(order.begin(), order.end(), Index{0});
  std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) { return value[a] < value[b]; });
  std::vector<int> cell(order.size());
  for (size_t k = 0; k < order.size(); ++k) {
    cell[static_cast<size_t>(order[k])] = static_cast<int>(k * static_cast<size_t>(cells) / order.size());
  }
  return cell;
}

// Share of the residual's squares that the cells' means from the other folds take away.
double ShareOf(const VectorXd& r, const std::vector<int>& cell, int cells, const std::vector<int>& fold, int folds,
               std::vector<double>* sums, std::vector<double>* counts) {
  sums->assign(static_cast<size_t>(cells * folds), 0.0);
  counts->assign(static_cast<size_t>(cells * folds), 0.0);
  for (size_t k = 0; k < cell.size(); ++k) {
    const size_t at = static_cast<size_t>(cell[k] * folds + fold[k]);
    (*sums)[at] += r[static_cast<Index>(k)];
    (*counts)[at] += 1.0;
  }
  double taken = 0.0;
  for (int c = 0; c < cells; ++c) {
    double sum = 0.0, count = 0.0;
    for (int f = 0; f < folds; ++f) {
      sum += (*sums)[static_cast<size_t>(c * folds + f)];
      count += (*counts)[static_cast<size_t>(c * folds + f)];
    }
    for (int f = 0; f < folds; ++f) {
      const double own = (*sums)[static_cast<size_t>(c * folds + f)],
                   own_count = (*counts)[static_cast<size_t>(c * folds + f)];
      const double mean = (sum - own) / (count - own_count + kShrink);
      // sum r^2 - sum (r - mean)^2 of the fold's samples in this cell.
      taken += 2.0 * mean * own - mean * mean * own_count;
    }
  }
  return taken / r.squaredNorm();
}

// A cell structure to try.
struct Partition {
  std::vector<int> signals;  // one or two
  std::vector<int> cell;
  int cells = 0;
};

VectorXd Shifted(const VectorXd& r, const SampleRanges& recordings, double share) {
  VectorXd result(r.size());
  for (const auto& [begin, end] : recordings) {
    const Index count = end - begin, by = static_cast<Index>(share * static_cast<double>(count));
    for (Index k = 0; k < count; ++k) result[begin + (k + by) % count] = r[begin + k];
  }
  return result;
}

}  // namespace

std::vector<Unexplained> FindUnexplained(const PreparedStudy& prepared, const ResidualModel& residual,
                                         const UnexplainedOptions& options) {
  std::vector<Unexplained> found;
  const int n = residual.dof();
  for (int joint = 0; joint < n; ++joint) {
    const std::vector<Signal> signals = SignalsOf(prepared, residual, joint);
    VectorXd r(residual.samples());
    for (Index k = 0; k < r.size(); ++k) r[k] = residual.residual()[k * n + joint];
    std::vector<Partition> partitions;
    std::vector<std::vector<int>> coarse;
    for (size_t a = 0; a < signals.size(); ++a) {
      partitions.push_back({{static_cast<int>(a)}, CellsOf(signals[a].value, kCells), kCells});
      coarse.push_back(CellsOf(signals[a].value, kPairCells));
    }
    for (size_t a = 0; a < signals.size(); ++a) {
      for (size_t b = a + 1; b < signals.size(); ++b) {
        Partition pair{{static_cast<int>(a), static_cast<int>(b)}, coarse[a], kPairCells * kPairCells};
        for (size_t k = 0; k < pair.cell.size(); ++k) pair.cell[k] = pair.cell[k] * kPairCells + coarse[b][k];
        partitions.push_back(std::move(pair));
      }
    }
    std::vector<double> sums, counts;
    const auto share_of = [&](const VectorXd& of, const Partition& p) {
      return ShareOf(of, p.cell, p.cells, residual.folds(), residual.num_folds(), &sums, &counts);
    };
    double best_single = 0.0, best_pair = 0.0;
    size_t single = 0, pair = 0;
    for (size_t k = 0; k < partitions.size(); ++k) {
      const double share = share_of(r, partitions[k]);
      double& best = partitions[k].signals.size() == 1 ? best_single : best_pair;
      if (share > best) {
        best = share;
        (partitions[k].signals.size() == 1 ? single : pair) = k;
      }
    }
    const bool take_pair = best_pair > kPairFactor * best_single;
    const double share = take_pair ? best_pair : best_single;
    if (!(share > 0.0)) continue;
    // Shifts of a tenth to nine tenths of each recording.
    int above = 0;
    for (int s = 0; s < options.shifts; ++s) {
      const VectorXd shifted = Shifted(r, residual.recordings(), 0.1 + 0.8 * (s + 0.5) / options.shifts);
      double largest = 0.0;
      for (const Partition& p : partitions) largest = std::max(largest, share_of(shifted, p));
      above += largest >= share;
      // Enough to know that it is not significant.
      if (above + 1.0 > options.significance * (options.shifts + 1.0)) break;
    }
    const double p_value = (above + 1.0) / (options.shifts + 1.0);
    if (p_value > options.significance) continue;
    Unexplained one;
    one.joint = joint;
    for (const int s : partitions[take_pair ? pair : single].signals)
      one.depends_on.push_back(signals[static_cast<size_t>(s)].name);
    one.share_percent = 100.0 * share;
    one.p_value = p_value;
    found.push_back(std::move(one));
  }
  return found;
}

}  // namespace idim
