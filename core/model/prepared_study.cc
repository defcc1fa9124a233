#include "core/model/prepared_study.h"

#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "core/motion/choose_preprocessing.h"
#include "core/motion/encoder_noise.h"
#include "core/motion/state_covariance.h"

namespace idim {
namespace {

Status At(const std::string& path, const Status& status) { return Status::BadInput(path + ": " + status.message()); }

// Root mean square over the identification recordings, weighted by their samples.
Result<Eigen::VectorXd> PositionNoise(const PreparedStudy& prepared) {
  if (prepared.study.position_noise.size() > 0) return prepared.study.position_noise;
  Eigen::VectorXd squares = Eigen::VectorXd::Zero(prepared.study.robot.dof());
  double samples = 0.0;
  for (const PreparedRecording& r : prepared.recordings) {
    if (r.entry.use != Use::kIdentification) continue;
    const Result<EncoderNoise> noise = EstimateEncoderNoise(r.recording, prepared.preprocessing, r.states);
    if (!noise.ok()) return At(r.entry.q_file, noise.status());
    squares += noise->sigma.cwiseAbs2() * r.recording.samples();
    samples += r.recording.samples();
  }
  return Eigen::VectorXd((squares / samples).cwiseSqrt());
}

// A joint that stands still in every identification recording, as far as its encoder can tell.
Status CheckMotion(const PreparedStudy& prepared) {
  for (int j = 0; j < prepared.study.robot.dof(); ++j) {
    double range = 0.0;
    std::string files;
    for (const PreparedRecording& r : prepared.recordings) {
      if (r.entry.use != Use::kIdentification) continue;
      const auto q = r.states.q.col(j);
      range = std::max(range, q.maxCoeff() - q.minCoeff());
      files += (files.empty() ? "" : ", ") + r.entry.q_file;
    }
    // The filtered noise of a joint at rest spans about ten of its standard deviations.
    if (range > 20.0 * prepared.position_noise[j]) continue;
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

void SetVelocityZeroAtRest(PreparedStudy* prepared) {
  CHECK_EQ(prepared->position_sigma.size(), prepared->study.robot.dof());
  prepared->velocity_zero_at_rest = true;
  for (PreparedRecording& recording : prepared->recordings) {
    SetRest(prepared->preprocessing, prepared->position_sigma, prepared->velocity_sigma, &recording.states);
  }
}

std::vector<Parameter> PreparedStudy::parameters() const {
  std::vector<Parameter> all = base.parameters();
  all.insert(all.end(), effect_parameters.begin(), effect_parameters.end());
  return all;
}

void StreamObservations(const PreparedStudy& prepared, const PreparedRecording& recording,
                        const std::function<void(const Observation&)>& visit) {
  StreamObservations(prepared.base, recording.states, recording.recording.signal, prepared.velocity_sigma,
                     recording.decimator, visit, recording.effects,
                     static_cast<int>(prepared.effect_parameters.size()));
}

Result<PreparedStudy> PrepareStudy(const Study& study) {
  // Before the recordings are read: what is wrong in the study is said first.
  if (const auto placed = PlaceDeclaredEffects(study); !placed.ok()) return placed.status();
  std::vector<Recording> recordings;
  for (const RecordingEntry& entry : study.recordings) {
    Result<Recording> recording = ReadRecording(study, entry);
    if (!recording.ok()) return recording.status();
    recordings.push_back(std::move(recording).value());
  }
  return PrepareStudy(study, std::move(recordings));
}

Result<PreparedStudy> PrepareStudy(const Study& study, std::vector<Recording> recordings) {
  CHECK_EQ(recordings.size(), study.recordings.size());
  PreparedStudy prepared{study, BaseParameters(StandardModel(study.robot, study.friction)), {}, {}, {}, {}};
  Result<std::vector<PlacedEffect>> placed = PlaceDeclaredEffects(study);
  if (!placed.ok()) return placed.status();
  prepared.declared = *std::move(placed);
  // Validation recordings are filtered alike, but have no say in how.
  std::vector<const Recording*> identification;
  for (size_t k = 0; k < recordings.size(); ++k) {
    if (study.recordings[k].use == Use::kIdentification) identification.push_back(&recordings[k]);
  }
  Result<Preprocessing> preprocessing = ChoosePreprocessing(identification, study.preprocessing);
  if (!preprocessing.ok()) return At(study.path, preprocessing.status());
  prepared.preprocessing = *preprocessing;

  for (size_t k = 0; k < recordings.size(); ++k) {
    Result<JointStates> states = EstimateJointStates(recordings[k], prepared.preprocessing);
    if (!states.ok()) return At(study.recordings[k].q_file, states.status());
    Result<Decimator> decimator = MakeDecimator(recordings[k], prepared.preprocessing);
    if (!decimator.ok()) return At(study.recordings[k].q_file, decimator.status());
    prepared.recordings.push_back(
        {study.recordings[k], std::move(recordings[k]), std::move(states).value(), std::move(decimator).value()});
  }

  Result<Eigen::VectorXd> noise = PositionNoise(prepared);
  if (!noise.ok()) return noise.status();
  prepared.position_noise = *noise;
  if (Status status = CheckMotion(prepared); !status.ok()) return status;

  const PreparedRecording& first = prepared.recordings[0];
  const Result<StateCovariance> covariance =
      StateCovariance::Create(first.recording.t, prepared.preprocessing, first.decimator);
  if (!covariance.ok()) return At(first.entry.q_file, covariance.status());
  prepared.velocity_sigma = prepared.position_noise * std::sqrt(covariance->full_rate()(1, 1));
  prepared.position_sigma = prepared.position_noise * std::sqrt(covariance->full_rate()(0, 0));
  return prepared;
}

}  // namespace idim
