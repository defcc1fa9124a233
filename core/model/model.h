// What is supposed of an arm: a small value, apart from the data it is fitted to.

#ifndef IDIM_CORE_MODEL_MODEL_H_
#define IDIM_CORE_MODEL_MODEL_H_

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "core/base/status.h"
#include "core/dynamics/base_parameters.h"
#include "core/effects/effect.h"
#include "core/effects/placed_effects.h"
#include "core/model/data.h"
#include "core/recording/study.h"

namespace idim {

// An effect in the model, where and of which shape.
struct ActiveEffect {
  const Effect* effect = nullptr;
  std::vector<int> joints;  // zero-based, see Effect::Parameters()
  Eigen::VectorXd shape;
  Eigen::VectorXd values = {};  // of its linear parameters as last estimated; empty: not yet
  bool held = false;            // its shape stays as it is
};

// Torque columns of all effects of a model along the recordings of its data.
struct EffectColumns {
  std::vector<Parameter> parameters;                   // linear ones and steps of shapes, effect by effect
  std::vector<std::vector<EffectEntry>> of_recording;  // EffectEntry::parameter: index into `parameters`
};

// What a recording of the data is for, and what it carries.
struct RecordingRole {
  Use use = Use::kIdentification;
  int payload = -1;  // index into Model::payloads, -1: none
};

struct Model {
  std::shared_ptr<const BaseParameters> base_parameters;
  GainsMode gains_mode = GainsMode::kKnown;
  Side signal_side = Side::kJoint;
  Eigen::VectorXd gains;             // n [N m or N per signal unit]: exact where known, else a priori or empty
  std::vector<Payload> payloads;     // their known and unknown parameters
  std::vector<RecordingRole> roles;  // one a recording of the data
  std::vector<Prior> priors;         // those on effects wait until the effect is in the model (ActivePriors())
  std::vector<PlacedEffect> declared;
  std::vector<ActiveEffect> effects;             // beside declared friction (core/model/active_effects.h adds them)
  std::shared_ptr<const EffectColumns> columns;  // of `effects`

  const BaseParameters& base() const { return *base_parameters; }
  bool IdentifiesGains() const { return gains_mode == GainsMode::kIdentify; }
  // Indices of the recordings of a use, increasing.
  std::vector<int> RecordingsFor(Use use) const;
  // Of payloads that an identification recording carries.
  bool IsCarried(int payload) const;
};

// The model of a study, without its effects. BadInput: as PlaceDeclaredEffects().
Result<Model> MakeModel(const Study& study);

// The study's priors but those on parameters of declared effects that are not in the model yet.
std::vector<Prior> ActivePriors(const Model& model);

// The known part of a payload of the model, zero where unknown and for payload -1.
InertialVector KnownPayload(const Model& model, int payload);

// A model with the data that it speaks of: what an estimator is given.
struct PreparedStudy {
  std::shared_ptr<const Data> data;
  Model model;

  const Robot& robot() const { return data->robot(); }
  const std::string& path() const { return data->path(); }
  const BaseParameters& base() const { return model.base(); }
};

// CheckedStudy() (core/recording/check_study.h), every recording read, then MakeData() and MakeModel(). BadInput: as
// these and the readers say. May be called for one study from several threads at once.
Result<PreparedStudy> PrepareStudy(const Study& study);

// The same of recordings that are in memory already, one a recording of the study in its order. BadInput: another
// number of them; as CheckRecording().
Result<PreparedStudy> PrepareStudy(const Study& study, std::vector<Recording> recordings);

}  // namespace idim

#endif  // IDIM_CORE_MODEL_MODEL_H_
