#include "core/model/data.h"

#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/motion/choose_preprocessing.h"
#include "core/motion/encoder_noise.h"
#include "core/motion/state_covariance.h"

namespace idim {
namespace {

Status At(const std::string& path, const Status& status) { return Status::BadInput(path + ": " + status.message()); }

// Root mean square over the identification recordings, weighted by their samples.
Result<Eigen::VectorXd> PositionNoise(const Data& data) {
  if (data.request.position_noise.size() > 0) return data.request.position_noise;
  Eigen::VectorXd squares = Eigen::VectorXd::Zero(data.robot().dof());
  double samples = 0.0;
  for (const MeasuredRecording& r : data.recordings) {
    if (r.entry.use != Use::kIdentification) continue;
    const Result<EncoderNoise> noise = EstimateEncoderNoise(*r.recording, data.preprocessing, *r.states);
    if (!noise.ok()) return At(r.entry.q_file, noise.status());
    squares += noise->sigma.cwiseAbs2() * r.recording->samples();
    samples += r.recording->samples();
  }
  return Eigen::VectorXd((squares / samples).cwiseSqrt());
}

// A joint that stands still in every identification recording, as far as its encoder can tell.
Status CheckMotion(const Data& data) {
  for (int j = 0; j < data.robot().dof(); ++j) {
    double range = 0.0;
    std::string files;
    for (const MeasuredRecording& r : data.recordings) {
      if (r.entry.use != Use::kIdentification) continue;
      const auto q = r.states->q.col(j);
      range = std::max(range, q.maxCoeff() - q.minCoeff());
      files += (files.empty() ? "" : ", ") + r.entry.q_file;
    }
    // The filtered noise of a joint at rest spans about ten of its standard deviations.
    if (range > 20.0 * data.position_noise[j]) continue;
    const std::string name = std::to_string(j + 1);
    return Status::Untrusted(files + ": joint " + name + " never moves (column 'q" + name + "'), so Ia" + name +
                             ", Fv" + name + ", Fs" + name +
                             " and what its motion excites cannot be identified; expected at least one identification "
                             "recording in which it moves");
  }
  return Status::Ok();
}

void SetRest(const Preprocessing& preprocessing, const Eigen::VectorXd& position_sigma,
             const Eigen::VectorXd& velocity_sigma, JointStates* states) {
  const double shortest = std::max(0.1, 2.0 / preprocessing.cutoff_hz);  // [s]
  const Eigen::Index count = states->t.size();
  for (Eigen::Index j = 0; j < states->dq.cols(); ++j) {
    const double slow = 4.0 * velocity_sigma[j], near = 8.0 * position_sigma[j];
    for (Eigen::Index begin = 0; begin < count;) {
      double lowest = states->q(begin, j), highest = lowest;
      Eigen::Index end = begin;
      while (end < count && std::abs(states->dq(end, j)) < slow) {
        lowest = std::min(lowest, states->q(end, j));
        highest = std::max(highest, states->q(end, j));
        if (highest - lowest > near) break;
        ++end;
      }
      if (end > begin && states->t[end - 1] - states->t[begin] >= shortest) {
        states->dq.col(j).segment(begin, end - begin).setZero();
        begin = end;
      } else {
        ++begin;
      }
    }
  }
}

}  // namespace

DataRequest DataRequestOf(const Study& study) {
  return {study.path,           study.robot,        study.signal_side,  study.recordings,
          study.position_noise, study.signal_noise, study.preprocessing};
}

Result<std::shared_ptr<const Data>> MakeData(const DataRequest& request, std::vector<Recording> recordings) {
  CHECK_EQ(recordings.size(), request.recordings.size());
  Data data{request, DriveMap(request.robot, request.signal_side), {}, {}, {}, {}, {}};
  // Validation recordings are filtered alike, but have no say in how.
  std::vector<const Recording*> identification;
  for (size_t k = 0; k < recordings.size(); ++k) {
    if (request.recordings[k].use == Use::kIdentification) identification.push_back(&recordings[k]);
  }
  Result<Preprocessing> preprocessing = ChoosePreprocessing(identification, request.preprocessing);
  if (!preprocessing.ok()) return At(request.path, preprocessing.status());
  data.preprocessing = *preprocessing;

  for (size_t k = 0; k < recordings.size(); ++k) {
    const RecordingEntry& entry = request.recordings[k];
    Result<JointStates> states = EstimateJointStates(recordings[k], data.preprocessing);
    if (!states.ok()) return At(entry.q_file, states.status());
    Result<Decimator> decimator = MakeDecimator(recordings[k], data.preprocessing);
    if (!decimator.ok()) return At(entry.q_file, decimator.status());
    data.recordings.push_back({entry, std::make_shared<const Recording>(std::move(recordings[k])),
                               std::make_shared<const JointStates>(std::move(states).value()),
                               std::make_shared<const Decimator>(std::move(decimator).value())});
  }

  Result<Eigen::VectorXd> noise = PositionNoise(data);
  IDIM_RETURN_IF_ERROR(noise);
  data.position_noise = *noise;
  IDIM_RETURN_IF_ERROR(CheckMotion(data));

  const MeasuredRecording& first = data.recordings[0];
  const Result<StateCovariance> covariance =
      StateCovariance::Create(first.recording->t, data.preprocessing, *first.decimator);
  if (!covariance.ok()) return At(first.entry.q_file, covariance.status());
  data.velocity_sigma = data.position_noise * std::sqrt(covariance->full_rate()(1, 1));
  data.position_sigma = data.position_noise * std::sqrt(covariance->full_rate()(0, 0));
  return std::make_shared<const Data>(std::move(data));
}

std::shared_ptr<const Data> WithVelocityZeroAtRest(const Data& data) {
  Data result = data;
  result.velocity_zero_at_rest = true;
  for (MeasuredRecording& recording : result.recordings) {
    JointStates states = *recording.states;
    SetRest(data.preprocessing, data.position_sigma, data.velocity_sigma, &states);
    recording.states = std::make_shared<const JointStates>(std::move(states));
  }
  return std::make_shared<const Data>(std::move(result));
}

std::shared_ptr<const Data> SomeRecordings(const Data& data, const std::vector<int>& indices) {
  Data result = data;
  result.recordings.clear();
  result.request.recordings.clear();
  for (const int k : indices) {
    result.recordings.push_back(data.recordings.at(static_cast<size_t>(k)));
    result.request.recordings.push_back(result.recordings.back().entry);
  }
  return std::make_shared<const Data>(std::move(result));
}

}  // namespace idim
