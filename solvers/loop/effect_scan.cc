#include "solvers/loop/effect_scan.h"

#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <cstdint>
#include <map>
#include <mutex>

#include "core/base/parallel_for.h"
#include "core/effects/effect_motion.h"
#include "core/model/active_effects.h"

namespace idim {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

struct Place {
  const Effect* effect;
  std::vector<int> joints;
};

std::vector<Place> Places(const PreparedStudy& prepared, const ScanOptions& options) {
  std::vector<Place> places;
  const int n = prepared.robot().dof();
  const auto add = [&](const Effect* effect, const std::vector<int>& joints) {
    for (const ActiveEffect& active : prepared.model.effects) {
      if (active.effect == effect && active.joints == joints) return;
    }
    if (!options.only_joints.empty() && joints != options.only_joints) return;
    places.push_back({effect, joints});
  };
  for (const Effect* effect : AllEffects()) {
    if (effect->in_standard_model()) continue;
    if (effect->site() == EffectSite::kArm) add(effect, {});
    for (int a = 0; a < n; ++a) {
      if (effect->site() == EffectSite::kJoint) add(effect, {a});
      for (int b = a + 1; b < n && effect->site() == EffectSite::kJointPair; ++b) add(effect, {a, b});
    }
  }
  return places;
}

// The remainder of an effect's columns at a shape: of the recorded instants, decimated like all columns, or (to look
// over a grid, fifty times cheaper) straight from the decimated states.
class Columns {
 public:
  Columns(const PreparedStudy& prepared, const ResidualModel& residual, const std::vector<EffectMotion>& motions,
          const ArmParameters& arm)
      : prepared_(prepared), residual_(residual) {
    for (size_t r = 0; r < motions.size(); ++r) {
      const RecordingRole& role = prepared.model.roles[r];
      if (role.use != Use::kIdentification) continue;
      const Data& data = *prepared.data;
      const Decimator& decimator = *data.recordings[r].decimator;
      recorded_.push_back(motions[r]);
      decimators_.push_back(&decimator);
      const JointStates& recorded = *data.recordings[r].states;
      const auto states = std::make_shared<const JointStates>(
          JointStates{recorded.clock, decimator.times(), decimator.Apply(recorded.q), decimator.Apply(recorded.dq),
                      decimator.Apply(recorded.ddq)});
      decimated_.push_back(MakeEffectMotion(prepared.base(), states, static_cast<int>(r), data.velocity_sigma,
                                            arm.chi.head(prepared.base().size()), arm.Carried(role),
                                            data.position_sigma));
      decimated_.back().derivative_cutoff_hz = motions[r].derivative_cutoff_hz;
      decimated_.back().torque = decimator.Apply(motions[r].torque);
    }
  }

  // Of the recordings for identification.
  const std::vector<EffectMotion>& motions() const { return recorded_; }

  // Whitened, samples n x parameters.
  MatrixXd Whitened(const Place& place, const VectorXd& shape, bool recorded) const {
    const Index parameters = static_cast<Index>(place.effect->Parameters(prepared_.robot(), place.joints).size());
    const int n = residual_.dof();
    std::vector<MatrixXd> torques(static_cast<size_t>(n));
    for (size_t r = 0; r < recorded_.size(); ++r) {
      const auto [begin, end] = residual_.recordings()[r];
      const EffectMotion& motion = recorded ? recorded_[r] : decimated_[r];
      for (const EffectEntry& entry : place.effect->Columns(motion, place.joints, shape)) {
        MatrixXd& torque = torques[static_cast<size_t>(entry.joint)];
        if (torque.size() == 0) torque.setZero(residual_.samples(), parameters);
        auto to = torque.col(entry.parameter).segment(begin, end - begin);
        if (recorded) {
          to += decimators_[r]->Apply(entry.torque).col(0);
        } else {
          to += entry.torque;
        }
      }
    }
    std::vector<int> joints;
    std::vector<MatrixXd> used;
    for (int j = 0; j < n; ++j) {
      if (torques[static_cast<size_t>(j)].size() == 0) continue;
      joints.push_back(j);
      used.push_back(std::move(torques[static_cast<size_t>(j)]));
    }
    return residual_.Whiten(joints, used);
  }

 private:
  const PreparedStudy& prepared_;
  const ResidualModel& residual_;
  std::vector<EffectMotion> recorded_, decimated_;
  std::vector<const Decimator*> decimators_;
};

// Of white noise one column explains 1 on the average. Less than this is not worth a closer look.
constexpr double kWorthALook = 8.0;

// The shape of one candidate that explains most.
class ShapeSearch {
 public:
  ShapeSearch(const Place& place, const Columns& columns, const ResidualModel& residual)
      : place_(place),
        columns_(columns),
        residual_(residual),
        shapes_(place.effect->Shapes(columns.motions(), place.joints)) {}

  // *tried: shapes looked at.
  EffectCandidate Run(int* tried) {
    EffectCandidate best;
    best.effect = {place_.effect, place_.joints, VectorXd(static_cast<Index>(shapes_.size()))};
    VectorXd& shape = best.effect.shape;
    for (size_t s = 0; s < shapes_.size(); ++s) {
      shape[static_cast<Index>(s)] = shapes_[s].grid[shapes_[s].grid.size() / 2];
    }
    // One coordinate after the other, from the middle of its grid.
    double explained = 0.0;
    for (size_t s = 0; s < shapes_.size(); ++s) {
      const std::vector<double> over_grid = OverGrid(static_cast<Index>(s), shape);
      const auto largest = std::max_element(over_grid.begin(), over_grid.end());
      explained = *largest;
      shape[static_cast<Index>(s)] = shapes_[s].grid[static_cast<size_t>(largest - over_grid.begin())];
      *tried += static_cast<int>(over_grid.size());
    }
    if (shapes_.empty()) ++*tried;
    if (shapes_.empty() || explained > kWorthALook) {
      for (size_t s = 0; s < shapes_.size(); ++s) Refine(static_cast<Index>(s), &shape);
      const MatrixXd whitened = columns_.Whitened(place_, shape, true);
      if (Allowed(residual_.Explain(whitened, whitened.cols())[0]) > 0.0) {
        best.remainder = residual_.Remainder(whitened);
        best.explained = residual_.Explained(best.remainder);
      }
    }
    best.parameters = static_cast<int>(best.remainder.cols() + static_cast<Index>(shapes_.size()));
    return best;
  }

 private:
  // What it explains, as long as its parameters have the sign that physics allows.
  double Allowed(const ResidualModel::Explanation& explanation) const {
    return HasForbiddenSign(place_.effect->non_negative(), explanation.step) ? 0.0 : explanation.explained;
  }

  // At each value on the grid of shape s, the others as they are; by decimated states.
  std::vector<double> OverGrid(Index s, VectorXd shape) const {
    constexpr size_t kAtOnce = 16;
    const std::vector<double>& grid = shapes_[static_cast<size_t>(s)].grid;
    std::vector<double> explained;
    for (size_t first = 0; first < grid.size(); first += kAtOnce) {
      const size_t count = std::min(kAtOnce, grid.size() - first);
      MatrixXd all;
      Index width = 0;
      for (size_t k = 0; k < count; ++k) {
        shape[s] = grid[first + k];
        const MatrixXd whitened = columns_.Whitened(place_, shape, false);
        if (k == 0) {
          width = whitened.cols();
          all.resize(whitened.rows(), width * static_cast<Index>(count));
        }
        all.middleCols(static_cast<Index>(k) * width, width) = whitened;
      }
      for (const ResidualModel::Explanation& explanation : residual_.Explain(all, width)) {
        explained.push_back(Allowed(explanation));
      }
    }
    return explained;
  }

  double Explained(const VectorXd& shape) const {
    const MatrixXd whitened = columns_.Whitened(place_, shape, true);
    return Allowed(residual_.Explain(whitened, whitened.cols())[0]);
  }

  // Brent's method between the neighbours on the grid.
  void Refine(Index s, VectorXd* shape) const {
    constexpr int kBits = 20;  // of the shape: finer than what its explanation can tell
    constexpr std::uintmax_t kRefinements = 8;
    const std::vector<double>& grid = shapes_[static_cast<size_t>(s)].grid;
    const size_t point = static_cast<size_t>(std::lower_bound(grid.begin(), grid.end(), (*shape)[s]) - grid.begin());
    const ShapeParameter& parameter = shapes_[static_cast<size_t>(s)];
    const double low = parameter.Within((*shape)[s], grid[point > 0 ? point - 1 : point]);
    const double high = parameter.Within((*shape)[s], grid[point + 1 < grid.size() ? point + 1 : point]);
    if (!(high > low)) return;
    VectorXd trial = *shape;
    const double best = Explained(trial);
    std::uintmax_t evaluations = kRefinements;
    const auto [value, unexplained] = boost::math::tools::brent_find_minima(
        [&](double at) {
          trial[s] = at;
          return -Explained(trial);
        },
        low, high, kBits, evaluations);
    if (-unexplained > best) (*shape)[s] = value;
  }

  const Place& place_;
  const Columns& columns_;
  const ResidualModel& residual_;
  std::vector<ShapeParameter> shapes_;
};

void CrossValidate(const ResidualModel& residual, const MatrixXd& before, EffectCandidate* candidate) {
  const MatrixXd after = residual.CrossValidate(candidate->remainder).squares;
  double squares = before.sum();
  if (candidate->effect.joints.size() == 1) squares = before.col(candidate->effect.joints[0]).sum();
  SetHeldOut((before - after).rowwise().sum(), squares, candidate);
}

}  // namespace

EffectScan ScanEffects(const PreparedStudy& prepared, const ResidualModel& residual, const ArmParameters& arm,
                       const ScanOptions& options) {
  const std::vector<EffectMotion> motions = MotionsOf(prepared, arm);
  const std::vector<Place> places = Places(prepared, options);
  const Columns columns(prepared, residual, motions, arm);
  std::vector<EffectCandidate> all(places.size());
  std::vector<int> tried(places.size(), 0);
  size_t done = 0;
  std::mutex mutex;
  ParallelFor(options.threads, static_cast<int>(places.size()), [&](int place) {
    const auto k = static_cast<size_t>(place);
    all[k] = ShapeSearch(places[k], columns, residual).Run(&tried[k]);
    if (all[k].remainder.cols() > 0) all[k].score = residual.Test(all[k].remainder);
    const std::lock_guard<std::mutex> lock(mutex);
    if (options.progress) {
      options.progress(std::to_string(++done) + " of " + std::to_string(places.size()) + " candidates");
    }
  });

  EffectScan scan;
  for (const int count : tried) scan.tried += count;
  const MatrixXd before = residual.CrossValidate(MatrixXd(residual.residual().size(), 0)).squares;
  std::map<const Effect*, int> places_of;
  for (const Place& place : places) ++places_of[place.effect];
  for (size_t k = 0; k < all.size(); ++k) {
    EffectCandidate& candidate = all[k];
    const Tries tries = {static_cast<int>(places_of.size()), places_of[places[k].effect], tried[k]};
    candidate.p_value = CorrectedPValue(candidate.score.p_value, tries);
    if (candidate.remainder.cols() == 0 || !PassesScoreTest(candidate.p_value, options.significance)) continue;
    CrossValidate(residual, before, &candidate);
    scan.candidates.push_back(std::move(candidate));
  }
  std::stable_sort(scan.candidates.begin(), scan.candidates.end(), RanksBefore);
  return scan;
}

ActiveEffect FindShape(const PreparedStudy& prepared, const ResidualModel& residual, const ArmParameters& arm,
                       const ActiveEffect& effect) {
  const std::vector<EffectMotion> motions = MotionsOf(prepared, arm);
  const Columns columns(prepared, residual, motions, arm);
  const Place place = {effect.effect, effect.joints};
  int tried = 0;
  return ShapeSearch(place, columns, residual).Run(&tried).effect;
}

}  // namespace idim
