// A study with its recordings read, filtered and ready for the observation matrix.

#ifndef IDIM_CORE_MODEL_PREPARED_STUDY_H_
#define IDIM_CORE_MODEL_PREPARED_STUDY_H_

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "core/base/status.h"
#include "core/dynamics/base_parameters.h"
#include "core/effects/effect.h"
#include "core/effects/placed_effects.h"
#include "core/model/observation_stream.h"
#include "core/motion/preprocessing.h"
#include "core/recording/study.h"

namespace idim {

struct PreparedRecording {
  RecordingEntry entry;
  Recording recording;
  JointStates states;
  Decimator decimator;
  std::vector<EffectEntry> effects =
      {};  // of all effects of the study; parameter: index into PreparedStudy::effect_parameters
};

// An effect in the model, where and of which shape.
struct ActiveEffect {
  const Effect* effect = nullptr;
  std::vector<int> joints;  // zero-based, see Effect::Parameters()
  Eigen::VectorXd shape;
  Eigen::VectorXd values = {};  // of its linear parameters as last estimated; empty: not yet
  bool held = false;            // its shape stays as it is
};

struct PreparedStudy {
  Study study;
  BaseParameters base;
  Preprocessing preprocessing;     // the same for all recordings, so that all equations see one filter
  Eigen::VectorXd position_noise;  // n [rad or m] a sample, a priori or estimated
  Eigen::VectorXd velocity_sigma;  // n [rad/s or m/s], of the undecimated dq
  std::vector<PreparedRecording> recordings;
  Eigen::VectorXd position_sigma = {};      // n [rad or m], of the undecimated q; empty: not known
  std::vector<PlacedEffect> declared = {};  // those of the study, at their places
  std::vector<ActiveEffect> effects = {};   // beside declared friction; set by SetEffects (core/model/active_effects.h)
  std::vector<Parameter> effect_parameters = {};
  bool velocity_zero_at_rest = false;  // SetVelocityZeroAtRest() was called

  // What the columns of an observation belong to: base parameters, then those of the effects.
  std::vector<Parameter> parameters() const;
  int num_columns() const { return base.size() + static_cast<int>(effect_parameters.size()); }
};

// StreamObservations() of one of the study's recordings, its effects included.
void StreamObservations(const PreparedStudy& prepared, const PreparedRecording& recording,
                        const std::function<void(const Observation&)>& visit);

// Reads every recording of the study, chooses the filter where the study does not, estimates the joint states.
// BadInput: as the readers, PlaceDeclaredEffects() and the filters say. Untrusted: a joint that moves in no
// identification recording.
Result<PreparedStudy> PrepareStudy(const Study& study);

// The same of recordings that are in memory already, one a recording of the study in its order (CHECK).
Result<PreparedStudy> PrepareStudy(const Study& study, std::vector<Recording> recordings);

// Zero-velocity update: where for a while (0.1 s and two periods of the cut-off) velocity is within 4 standard
// deviations of zero and position within 8 of one place, the velocity is set to zero. The sign of the noise there is no
// friction, but as a function of the measured velocity it would pass for one. For tracing; estimators take velocities
// as measured, which on the real TX-40 makes less than 3 % of any joint's error.
void SetVelocityZeroAtRest(PreparedStudy* prepared);

}  // namespace idim

#endif  // IDIM_CORE_MODEL_PREPARED_STUDY_H_
