#include "core/model/observation_stream.h"

#include <glog/logging.h>

#include <algorithm>

namespace idim {
namespace {

// The entries of the n x columns() standard regressor (and of the n x 10 payload columns) that are not zero by
// structure, so that the filter runs over half the entries: joint i is not moved by links before it.
struct Entry {
  int row, from, to;  // standard column `from` becomes base column `to`
};

std::vector<Entry> StructuralEntries(const BaseParameters& base) {
  StandardModel model = base.model();
  const int n = model.dof();
  Observation::RowMajorMatrix w(n, model.columns());
  Eigen::ArrayXXi used = Eigen::ArrayXXi::Zero(n, model.columns());
  for (int trial = 0; trial < 3; ++trial) {
    // Any irregular states would do; three guard against a zero by accident.
    const auto irregular = [&](double start) {
      return Eigen::VectorXd::NullaryExpr(n,
                                          [=](Eigen::Index j) { return start + 0.377 * double(j) + 0.7311 * trial; });
    };
    const Eigen::VectorXd q = irregular(0.31), dq = irregular(1.17), ddq = irregular(2.03);
    model.Regressor(q.data(), dq.data(), ddq.data(), nullptr, w.data());
    used = used.max((w.array() != 0.0).cast<int>());
  }
  std::vector<Entry> entries;
  for (int i = 0; i < n; ++i) {
    for (int k = 0; k < base.size(); ++k) {
      if (used(i, base.kept()[k]) != 0) entries.push_back({i, base.kept()[k], k});
    }
  }
  return entries;
}

}  // namespace

void StreamObservations(const BaseParameters& base, const JointStates& states, const Eigen::MatrixXd& signal,
                        const Eigen::VectorXd& velocity_sigma, const Decimator& decimator,
                        const std::function<void(const Observation&)>& visit, const std::vector<EffectEntry>& effects,
                        int effect_parameters) {
  StandardModel model = base.model();
  const int n = model.dof();
  CHECK_EQ(states.q.cols(), n);
  CHECK_EQ(signal.rows(), decimator.samples());
  CHECK_EQ(velocity_sigma.size(), n);
  for (const EffectEntry& effect : effects) {
    CHECK_EQ(effect.torque.size(), decimator.samples());
    CHECK_LT(effect.parameter, effect_parameters);
  }
  const std::vector<Entry> entries = StructuralEntries(base);
  const int num_entries = static_cast<int>(entries.size());
  const int num_effects = static_cast<int>(effects.size());
  const int payload = num_entries + num_effects;
  const int packed = payload + 10 * n + n;  // base entries, effects, payload columns, signal
  const int ring = decimator.max_open() + 1;
  Eigen::MatrixXd open = Eigen::MatrixXd::Zero(packed, ring);  // a column an open output

  Observation observation;
  observation.columns.setZero(n, base.size() + effect_parameters);
  observation.payload.setZero(n, 10);
  observation.signal.setZero(n);
  const auto emit = [&](int output) {
    auto sums = open.col(output % ring);
    for (int e = 0; e < num_entries; ++e) observation.columns(entries[e].row, entries[e].to) = sums[e];
    observation.columns.rightCols(effect_parameters).setZero();
    for (int e = 0; e < num_effects; ++e) {
      observation.columns(effects[e].joint, base.size() + effects[e].parameter) += sums[num_entries + e];
    }
    std::copy_n(sums.data() + payload, 10 * n, observation.payload.data());
    observation.signal = sums.tail(n);
    observation.t = decimator.times()[output];
    visit(observation);
    sums.setZero();
  };

  Eigen::VectorXd q(n), dq(n), ddq(n), now(packed);
  Observation::RowMajorMatrix w(n, model.columns());
  int next = 0;
  for (int i = 0; i < decimator.samples(); ++i) {
    const Decimator::Contribution contribution = decimator.At(i);
    if (contribution.count > 0) {
      q = states.q.row(i);
      dq = states.dq.row(i);
      ddq = states.ddq.row(i);
      model.Regressor(q.data(), dq.data(), ddq.data(), velocity_sigma.data(), w.data());
      for (int e = 0; e < num_entries; ++e) now[e] = w(entries[e].row, entries[e].from);
      for (int e = 0; e < num_effects; ++e) now[num_entries + e] = effects[e].torque[i];
      model.PayloadColumns(now.data() + payload);
      now.tail(n) = signal.row(i);
      for (int j = 0; j < contribution.count; ++j) {
        open.col((contribution.first + j) % ring) += contribution.weights[j] * now;
      }
    }
    while (next < decimator.outputs() && decimator.LastSample(next) <= i) emit(next++);
  }
}

}  // namespace idim
