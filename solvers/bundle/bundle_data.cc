#include "solvers/bundle/bundle_data.h"

#include <glog/logging.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "core/base/decompositions.h"
#include "core/base/text.h"
#include "core/model/observation_stream.h"
#include "core/model/payload_unknowns.h"
#include "core/motion/state_covariance.h"
#include "solvers/linear/gain_system.h"

namespace idim {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Appends the samples of one recording.
void AddRecording(const PreparedRecording& recording, const PreparedStudy& prepared, int index, BundleData* data) {
  const int payload = recording.entry.payload;
  const JointStates& states = recording.states;
  MatrixXd all(states.q.rows(), 4 * data->dof);
  all.leftCols(3 * data->dof) << states.q, states.dq, states.ddq;
  for (Eigen::Index i = 0; i < states.dq.rows(); ++i) {
    for (int j = 0; j < data->dof; ++j) {
      all(i, 3 * data->dof + j) = 1.0 - std::pow(ExpectedSign(states.dq(i, j), prepared.velocity_sigma[j]), 2);
    }
  }
  const MatrixXd decimated = recording.decimator.Apply(all);
  InertialVector known = InertialVector::Zero();
  if (payload >= 0) known = data->known_payload[payload];
  Eigen::Index row = 0;
  StreamObservations(prepared, recording, [&](const Observation& observation) {
    BundleSample sample;
    sample.recording = index;
    sample.columns.setZero(data->dof, data->num_columns());
    sample.columns.leftCols(data->num_base) = observation.columns;
    for (int k = 0; payload >= 0 && k < kNumInertial; ++k) {
      const int column = data->payload_columns[payload][k];
      if (column >= 0) sample.columns.col(column) = observation.payload.col(k);
    }
    sample.known = observation.payload * known;
    sample.signal = observation.signal;
    sample.state = decimated.row(row).head(3 * data->dof);
    sample.sign_variance = decimated.row(row++).tail(data->dof).cwiseMax(0.0);
    data->samples.push_back(std::move(sample));
  });
}

// Of the unknowns of *data: of payload parameters that the study states with a standard deviation, and of its key
// `priors`.
Status SetPriors(const Study& study, BundleData* data) {
  for (size_t p = 0; p < data->payload_columns.size(); ++p) {
    for (int k = 0; k < kNumInertial; ++k) {
      const Payload& payload = study.payloads[p];
      if (data->payload_columns[p][k] < 0 || !payload.standard_deviation[k]) continue;
      data->priors.push_back(
          {data->num_gains() + data->payload_columns[p][k], *payload.known[k], *payload.standard_deviation[k]});
    }
  }
  for (const Prior& prior : study.priors) {
    const auto found = std::find_if(data->unknowns.begin(), data->unknowns.end(),
                                    [&](const Parameter& unknown) { return unknown.name == prior.parameter; });
    if (found == data->unknowns.end()) {
      std::vector<std::string> names;
      for (const Parameter& unknown : data->unknowns) names.push_back(unknown.name);
      return Status::BadInput(prior.where + ": '" + prior.parameter +
                              "' is not identified by this study; expected one of " + Join(names, " "));
    }
    data->priors.push_back({static_cast<int>(found - data->unknowns.begin()), prior.value, prior.standard_deviation});
  }
  return Status::Ok();
}

}  // namespace

bool AreValid(const std::vector<BundlePrior>& priors, std::string* error) {
  for (const BundlePrior& prior : priors) {
    if (prior.unknown >= 0 && prior.standard_deviation > 0.0) continue;
    *error = "priors: expected an unknown >= 0 and a positive standard deviation";
    return false;
  }
  return true;
}

Result<BundleData> BuildBundleData(const PreparedStudy& prepared) {
  const Study study = ReleaseUncertain(prepared.study);
  BundleData data;
  data.dof = study.robot.dof();
  data.num_base = prepared.num_columns();
  if (study.gains_mode == GainsMode::kIdentify) {
    if (Status status = CheckGainStudy(prepared.study); !status.ok()) return status;
    data.unknowns = GainParameters(study.robot, study.signal_side);
  } else {
    data.known_gains = study.gains;
  }
  const std::vector<Parameter> of_model = prepared.parameters();
  data.unknowns.insert(data.unknowns.end(), of_model.begin(), of_model.end());
  data.payload_columns = AppendPayloadUnknowns(study, &data.unknowns);
  for (auto& columns : data.payload_columns) {
    for (int& column : columns) column -= column >= 0 ? data.num_gains() : 0;
  }
  for (int p = 0; p < static_cast<int>(study.payloads.size()); ++p)
    data.known_payload.push_back(KnownPayload(study, p));
  data.inverse_drive =
      JointTorque(study, VectorXd::Ones(data.dof), MatrixXd::Identity(data.dof, data.dof)).transpose().inverse();
  for (const PreparedRecording& recording : prepared.recordings) {
    if (recording.entry.use != Use::kIdentification) continue;
    const Result<StateCovariance> covariance =
        StateCovariance::Create(recording.recording.t, prepared.preprocessing, recording.decimator);
    if (!covariance.ok()) return covariance.status();
    std::vector<Eigen::Matrix3d> of_joints;
    for (const double sigma : prepared.position_noise) of_joints.push_back(sigma * sigma * covariance->decimated());
    data.state_covariance.push_back(std::move(of_joints));
    data.payload_of_recording.push_back(recording.entry.payload);
    AddRecording(recording, prepared, static_cast<int>(data.payload_of_recording.size()) - 1, &data);
  }
  for (int j = 1; j <= data.dof; ++j) {
    const auto& of_base = prepared.base.parameters();
    const auto found = std::find_if(of_base.begin(), of_base.end(), [&](const Parameter& parameter) {
      return parameter.name == "Fs" + std::to_string(j);
    });
    data.coulomb_columns.push_back(found == of_base.end() ? -1 : static_cast<int>(found - of_base.begin()));
  }
  if (Status status = SetPriors(prepared.study, &data); !status.ok()) return status;
  return data;
}

BundleData WithEffectsOf(const PreparedStudy& prepared, const BundleData& before) {
  const int base = prepared.base.size(), effects = static_cast<int>(prepared.effect_parameters.size());
  const int had = before.num_base - base, more = effects - had;
  BundleData data = before;
  data.num_base = base + effects;
  const auto first = data.unknowns.begin() + data.num_gains() + base;
  data.unknowns.erase(first, first + had);
  data.unknowns.insert(data.unknowns.begin() + data.num_gains() + base, prepared.effect_parameters.begin(),
                       prepared.effect_parameters.end());
  for (auto& columns : data.payload_columns) {
    for (int& column : columns) column += column >= 0 ? more : 0;
  }
  data.priors.clear();
  const Status priors = SetPriors(prepared.study, &data);
  CHECK(priors.ok()) << priors.message();
  const Eigen::Index payload = before.num_columns() - before.num_base;
  auto sample = data.samples.begin();
  for (const PreparedRecording& recording : prepared.recordings) {
    if (recording.entry.use != Use::kIdentification) continue;
    std::vector<MatrixXd> decimated;
    for (const EffectEntry& entry : recording.effects) decimated.push_back(recording.decimator.Apply(entry.torque));
    const Eigen::Index count = recording.decimator.times().size();
    for (Eigen::Index k = 0; k < count; ++k, ++sample) {
      auto& columns = sample->columns;
      const MatrixXd was = columns;
      columns.setZero(data.dof, data.num_columns());
      columns.leftCols(base) = was.leftCols(base);
      columns.rightCols(payload) = was.rightCols(payload);
      for (size_t e = 0; e < recording.effects.size(); ++e) {
        const EffectEntry& entry = recording.effects[e];
        columns(entry.joint, base + entry.parameter) += decimated[e](k, 0);
      }
    }
  }
  CHECK(sample == data.samples.end());
  return data;
}

SampleRanges RecordingsOf(const BundleData& data) {
  SampleRanges ranges;
  const Eigen::Index count = static_cast<Eigen::Index>(data.samples.size());
  for (Eigen::Index begin = 0; begin < count;) {
    Eigen::Index end = begin;
    while (end < count && data.samples[end].recording == data.samples[begin].recording) ++end;
    ranges.emplace_back(begin, end);
    begin = end;
  }
  return ranges;
}

MatrixXd StateCovarianceOf(const BundleData& data, int recording) {
  const int n = data.dof;
  MatrixXd covariance = MatrixXd::Zero(3 * n, 3 * n);
  for (int j = 0; j < n; ++j) {
    const Eigen::Matrix3d& own = data.state_covariance[recording][j];
    for (int a = 0; a < 3; ++a) {
      for (int b = 0; b < 3; ++b) covariance(a * n + j, b * n + j) = own(a, b);
    }
  }
  return covariance;
}

StateDerivatives::StateDerivatives(const BaseParameters& base, const BundleData& data)
    : data_(data),
      dynamics_(base.model().robot()),
      inertials_(data.dof),
      regressor_(kNumInertial * data.dof * data.dof) {
  const int n = data.dof;
  StandardModel model = base.model();
  std::vector<int> base_column(model.columns(), -1);
  for (int k = 0; k < base.size(); ++k) base_column[base.kept()[k]] = k;
  for (int j = 0; j < n; ++j) {
    for (int k = 0; k < kNumInertial; ++k) {
      const int column = base_column[model.Find(kStandardNames[k] + std::to_string(j + 1))];
      if (column >= 0) base_entries_.push_back({j, k, column});
    }
  }
  for (const std::array<int, kNumInertial>& columns : data.payload_columns) {
    payload_entries_.emplace_back();
    for (int k = 0; k < kNumInertial; ++k) {
      if (columns[k] >= 0) payload_entries_.back().push_back({n - 1, k, columns[k]});
    }
  }
  // The drives' columns but for the Coulomb ones are linear in dq and ddq: unit states give their derivatives.
  RowMajorMatrix w(n, model.columns()), w0(n, model.columns());
  const VectorXd zero = VectorXd::Zero(n);
  model.Regressor(zero.data(), zero.data(), zero.data(), nullptr, w0.data());
  for (int variable = n; variable < 3 * n; ++variable) {
    VectorXd state = VectorXd::Zero(3 * n);
    state[variable] = 1.0;
    model.Regressor(zero.data(), state.data() + n, state.data() + 2 * n, nullptr, w.data());
    for (int c = 0; c < model.columns(); ++c) {
      const Parameter& parameter = model.parameters()[c];
      const bool linear = parameter.kind == ParameterKind::kDriveInertia || parameter.name.rfind("Fv", 0) == 0;
      if (!linear || base_column[c] < 0) continue;
      for (int i = 0; i < n; ++i) {
        const double value = w(i, c) - w0(i, c);
        if (value != 0.0) drive_entries_.push_back({i, base_column[c], variable, value});
      }
    }
  }
}

void StateDerivatives::Torque(const BundleSample& sample, const VectorXd& chi, MatrixXd* d) {
  const int n = data_.dof;
  for (InertialVector& inertial : inertials_) inertial.setZero();
  for (const InertialEntry& entry : base_entries_) inertials_[entry.link][entry.parameter] = chi[entry.column];
  if (const int payload = data_.payload_of_recording[sample.recording]; payload >= 0) {
    inertials_.back() += data_.known_payload[payload];
    for (const InertialEntry& entry : payload_entries_[payload])
      inertials_.back()[entry.parameter] += chi[entry.column];
  }
  d->resize(n, 3 * n);
  dynamics_.InverseDynamics(sample.state.data(), inertials_.data(), d->data());
  for (const DriveEntry& entry : drive_entries_) (*d)(entry.row, entry.variable) += entry.value * chi[entry.column];
}

void StateDerivatives::Columns(const BundleSample& sample, const VectorXd& deviation, RowMajorMatrix* change) {
  const int n = data_.dof;
  CHECK_EQ(deviation.size(), 3 * n);
  dynamics_.Regressor(sample.state.data(), deviation.data(), regressor_.data());
  change->setZero(n, data_.num_columns());
  const auto copy = [&](const InertialEntry& entry) {
    for (int i = 0; i <= entry.link; ++i) {
      (*change)(i, entry.column) = regressor_[(i * n + entry.link) * kNumInertial + entry.parameter];
    }
  };
  for (const InertialEntry& entry : base_entries_) copy(entry);
  if (const int payload = data_.payload_of_recording[sample.recording]; payload >= 0) {
    for (const InertialEntry& entry : payload_entries_[payload]) copy(entry);
  }
  for (const DriveEntry& entry : drive_entries_) {
    (*change)(entry.row, entry.column) += entry.value * deviation[entry.variable];
  }
}

}  // namespace idim
