#include "solvers/bundle/bundle_data.h"

#include <glog/logging.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "core/base/decompositions.h"
#include "core/base/text.h"
#include "core/model/sample_stream.h"
#include "core/motion/state_covariance.h"
#include "solvers/linear/gain_system.h"

namespace idim {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// n x (base and payload unknowns): what a model's effects have no part in.
BundleSample::RowMajorMatrix WithoutEffectColumns(const Unknowns& unknowns, const BundleSample::RowMajorMatrix& all) {
  const int base = unknowns.num_base(), effects = unknowns.num_effect_parameters();
  BundleSample::RowMajorMatrix columns(all.rows(), all.cols() - effects);
  columns << all.leftCols(base), all.rightCols(all.cols() - base - effects);
  return columns;
}

// Appends the samples of recording r of the data, and the columns of their effects.
void AddRecording(const PreparedStudy& prepared, int r, int index, const BundleData& data,
                  std::vector<BundleSample>* samples, std::vector<BundleSample::RowMajorMatrix>* effects) {
  const int n = data.dof;
  const MeasuredRecording& recording = prepared.data->recordings[static_cast<size_t>(r)];
  const JointStates& states = *recording.states;
  MatrixXd all(states.q.rows(), 4 * n);
  all.leftCols(3 * n) << states.q, states.dq, states.ddq;
  for (Eigen::Index i = 0; i < states.dq.rows(); ++i) {
    for (int j = 0; j < n; ++j) {
      all(i, 3 * n + j) = 1.0 - std::pow(ExpectedSign(states.dq(i, j), prepared.data->velocity_sigma[j]), 2);
    }
  }
  const MatrixXd decimated = recording.decimator->Apply(all);
  Eigen::Index row = 0;
  StreamSamples(prepared, data.unknowns, r, [&](const Sample& streamed) {
    BundleSample sample;
    sample.recording = index;
    sample.columns = WithoutEffectColumns(data.unknowns, streamed.columns);
    sample.known = streamed.known;
    sample.signal = streamed.signal;
    sample.state = decimated.row(row).head(3 * n);
    sample.sign_variance = decimated.row(row++).tail(n).cwiseMax(0.0);
    samples->push_back(std::move(sample));
    effects->push_back(streamed.columns.middleCols(data.unknowns.num_base(), data.unknowns.num_effect_parameters()));
  });
}

// Of the unknowns of *data: of payload parameters that the model states with a standard deviation, and its priors.
Status SetPriors(const Model& model, BundleData* data) {
  data->priors.clear();
  for (int p = 0; p < data->unknowns.num_payloads(); ++p) {
    const Payload& payload = model.payloads[static_cast<size_t>(p)];
    for (int k = 0; k < kNumInertial; ++k) {
      if (data->unknowns.payload(p, k) < 0 || !payload.standard_deviation[k]) continue;
      data->priors.push_back({data->unknowns.payload(p, k), *payload.known[k], *payload.standard_deviation[k]});
    }
  }
  for (const Prior& prior : ActivePriors(model)) {
    const std::optional<int> unknown = data->unknowns.Find(prior.parameter);
    if (!unknown) {
      std::vector<std::string> names;
      for (const Parameter& parameter : data->unknowns.parameters()) names.push_back(parameter.name);
      return Status::BadInput(prior.where + ": '" + prior.parameter +
                              "' is not identified by this study; expected one of " + Join(names, " "));
    }
    data->priors.push_back({*unknown, prior.value, prior.standard_deviation});
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

const BundleData::RowMajorMatrix& BundleData::Columns(size_t k, RowMajorMatrix* scratch) const {
  const RowMajorMatrix& own = samples()[k].columns;
  if (effects_.cols() == 0) return own;
  const Eigen::Index base = unknowns.num_base(), payload = own.cols() - base;
  scratch->resize(dof, own.cols() + effects_.cols());
  scratch->leftCols(base) = own.leftCols(base);
  scratch->middleCols(base, effects_.cols()) = effects_.middleRows(static_cast<Eigen::Index>(k) * dof, dof);
  scratch->rightCols(payload) = own.rightCols(payload);
  return *scratch;
}

Result<BundleData> BuildBundleData(const PreparedStudy& prepared) {
  const Model& model = prepared.model;
  BundleData data;
  data.dof = prepared.robot().dof();
  if (model.IdentifiesGains()) {
    IDIM_RETURN_IF_ERROR(CheckGainStudy(prepared));
  }
  data.unknowns = Unknowns(model, UncertainPayload::kUnknown);
  data.inverse_drive = prepared.data->drive.Matrix().inverse();
  std::vector<BundleSample> samples;
  std::vector<BundleData::RowMajorMatrix> effects;
  for (const int r : model.RecordingsFor(Use::kIdentification)) {
    const MeasuredRecording& recording = prepared.data->recordings[static_cast<size_t>(r)];
    const Result<StateCovariance> covariance =
        StateCovariance::Create(recording.recording->t, prepared.data->preprocessing, *recording.decimator);
    IDIM_RETURN_IF_ERROR(covariance);
    std::vector<Eigen::Matrix3d> of_joints;
    for (const double sigma : prepared.data->position_noise) {
      of_joints.push_back(sigma * sigma * covariance->decimated());
    }
    data.state_covariance.push_back(std::move(of_joints));
    data.payload_of_recording.push_back(model.roles[static_cast<size_t>(r)].payload);
    AddRecording(prepared, r, static_cast<int>(data.payload_of_recording.size()) - 1, data, &samples, &effects);
  }
  BundleData::RowMajorMatrix stacked(data.dof * static_cast<Eigen::Index>(effects.size()),
                                     data.unknowns.num_effect_parameters());
  for (size_t k = 0; k < effects.size(); ++k) {
    stacked.middleRows(static_cast<Eigen::Index>(k) * data.dof, data.dof) = effects[k];
  }
  data.SetSamples(std::move(samples));
  data.SetEffectColumns(std::move(stacked));
  for (int j = 1; j <= data.dof; ++j) {
    const std::optional<int> coulomb = data.unknowns.Find("Fs" + std::to_string(j));
    data.coulomb_columns.push_back(coulomb ? *coulomb - data.num_gains() : -1);
  }
  IDIM_RETURN_IF_ERROR(SetPriors(model, &data));
  return data;
}

BundleData WithEffectColumnsOf(const PreparedStudy& prepared, const BundleData& before) {
  BundleData data = before;
  data.unknowns = Unknowns(prepared.model, UncertainPayload::kUnknown);
  const Status priors = SetPriors(prepared.model, &data);
  CHECK(priors.ok()) << priors.message();
  BundleData::RowMajorMatrix effects = BundleData::RowMajorMatrix::Zero(
      data.dof * static_cast<Eigen::Index>(data.samples().size()), data.unknowns.num_effect_parameters());
  Eigen::Index first = 0;
  for (const int r : prepared.model.RecordingsFor(Use::kIdentification)) {
    const Decimator& decimator = *prepared.data->recordings[static_cast<size_t>(r)].decimator;
    for (const EffectEntry& entry : prepared.model.columns->of_recording[static_cast<size_t>(r)]) {
      const MatrixXd decimated = decimator.Apply(entry.torque);
      for (Eigen::Index k = 0; k < decimated.rows(); ++k) {
        effects((first + k) * data.dof + entry.joint, entry.parameter) += decimated(k, 0);
      }
    }
    first += decimator.times().size();
  }
  CHECK_EQ(static_cast<size_t>(first), data.samples().size());
  data.SetEffectColumns(std::move(effects));
  return data;
}

SampleRanges RecordingsOf(const BundleData& data) {
  SampleRanges ranges;
  const Eigen::Index count = static_cast<Eigen::Index>(data.samples().size());
  for (Eigen::Index begin = 0; begin < count;) {
    Eigen::Index end = begin;
    while (end < count &&
           data.samples()[static_cast<size_t>(end)].recording == data.samples()[static_cast<size_t>(begin)].recording)
      ++end;
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
  for (int p = 0; p < data.unknowns.num_payloads(); ++p) {
    payload_entries_.emplace_back();
    for (int k = 0; k < kNumInertial; ++k) {
      if (data.payload_column(p, k) >= 0) payload_entries_.back().push_back({n - 1, k, data.payload_column(p, k)});
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
    inertials_.back() += data_.unknowns.known_payload(payload);
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
