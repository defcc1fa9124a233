// A study with its recordings read, filtered and ready for the observation matrix.

#ifndef IDIM_CORE_OBSERVATION_PREPARED_STUDY_H_
#define IDIM_CORE_OBSERVATION_PREPARED_STUDY_H_

#include <Eigen/Core>
#include <vector>

#include "core/base/status.h"
#include "core/dynamics/base_parameters.h"
#include "core/recording/study.h"
#include "core/signal/preprocessing.h"

namespace idim {

struct PreparedRecording {
  RecordingEntry entry;
  Recording recording;
  JointStates states;
  Decimator decimator;
};

struct PreparedStudy {
  Study study;
  BaseParameters base;
  Preprocessing preprocessing;     // the same for all recordings, so that all equations see one filter
  Eigen::VectorXd position_noise;  // n [rad or m] a sample, a priori or estimated
  Eigen::VectorXd velocity_sigma;  // n [rad/s or m/s], of the undecimated dq
  std::vector<PreparedRecording> recordings;
};

// Reads every recording of the study, chooses the filter where the study does not, estimates the joint states.
// BadInput: as the readers and filters say. Untrusted: a joint that moves in no identification recording.
Result<PreparedStudy> PrepareStudy(const Study& study);

// The same of recordings that are in memory already, one a recording of the study in its order (CHECK).
Result<PreparedStudy> PrepareStudy(const Study& study, std::vector<Recording> recordings);

}  // namespace idim

#endif  // IDIM_CORE_OBSERVATION_PREPARED_STUDY_H_
