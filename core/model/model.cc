#include "core/model/model.h"

#include <algorithm>
#include <string>
#include <utility>

#include "core/recording/check_study.h"

namespace idim {

std::vector<int> Model::RecordingsFor(Use use) const {
  std::vector<int> indices;
  for (size_t r = 0; r < roles.size(); ++r) {
    if (roles[r].use == use) indices.push_back(static_cast<int>(r));
  }
  return indices;
}

bool Model::IsCarried(int payload) const {
  return std::any_of(roles.begin(), roles.end(), [&](const RecordingRole& role) {
    return role.use == Use::kIdentification && role.payload == payload;
  });
}

Result<Model> MakeModel(const Study& study) {
  Result<std::vector<PlacedEffect>> placed = PlaceDeclaredEffects(study);
  IDIM_RETURN_IF_ERROR(placed);
  Model model;
  model.base_parameters = std::make_shared<const BaseParameters>(StandardModel(study.robot, study.friction));
  model.gains_mode = study.gains_mode;
  model.signal_side = study.signal_side;
  model.gains = study.gains;
  model.payloads = study.payloads;
  for (const RecordingEntry& entry : study.recordings) model.roles.push_back({entry.use, entry.payload});
  model.priors = study.priors;
  model.declared = *std::move(placed);
  EffectColumns none;
  none.of_recording.resize(study.recordings.size());
  model.columns = std::make_shared<const EffectColumns>(std::move(none));
  return model;
}

std::vector<Prior> ActivePriors(const Model& model) {
  std::vector<Prior> priors;
  for (const Prior& prior : model.priors) {
    bool waits = false;
    for (const PlacedEffect& declared : model.declared) {
      for (const Parameter& parameter : declared.effect->Parameters(model.base().model().robot(), declared.joints)) {
        const bool there = std::any_of(model.effects.begin(), model.effects.end(), [&](const ActiveEffect& active) {
          return active.effect == declared.effect && active.joints == declared.joints;
        });
        waits |= parameter.name == prior.parameter && !there;
      }
    }
    if (!waits) priors.push_back(prior);
  }
  return priors;
}

InertialVector KnownPayload(const Model& model, int payload) {
  InertialVector known = InertialVector::Zero();
  for (int k = 0; payload >= 0 && k < kNumInertial; ++k) known[k] = model.payloads[payload].known[k].value_or(0.0);
  return known;
}

namespace {

// Of a checked study, its model made already.
Result<PreparedStudy> Prepare(const Study& study, Result<Model> model, std::vector<Recording> recordings) {
  if (recordings.size() != study.recordings.size()) {
    return Status::BadInput(study.path + ": " + std::to_string(recordings.size()) + " recordings for the " +
                            std::to_string(study.recordings.size()) +
                            " entries of the study; expected one an entry, in its order");
  }
  for (size_t k = 0; k < recordings.size(); ++k) {
    if (recordings[k].name.empty()) recordings[k].name = study.recordings[k].name;
    IDIM_RETURN_IF_ERROR(CheckRecording(study, recordings[k]));
  }
  IDIM_RETURN_IF_ERROR(model);
  Result<std::shared_ptr<const Data>> data = MakeData(DataRequestOf(study), std::move(recordings));
  IDIM_RETURN_IF_ERROR(data);
  return PreparedStudy{*std::move(data), *std::move(model)};
}

}  // namespace

Result<PreparedStudy> PrepareStudy(const Study& given) {
  const Result<Study> study = CheckedStudy(given);
  IDIM_RETURN_IF_ERROR(study);
  // Before the recordings are read: what is wrong in the study is said first.
  Result<Model> model = MakeModel(*study);
  IDIM_RETURN_IF_ERROR(model);
  std::vector<Recording> recordings;
  for (const RecordingEntry& entry : study->recordings) {
    Result<Recording> recording = ReadRecording(*study, entry);
    IDIM_RETURN_IF_ERROR(recording);
    recordings.push_back(std::move(recording).value());
  }
  return Prepare(*study, std::move(model), std::move(recordings));
}

Result<PreparedStudy> PrepareStudy(const Study& given, std::vector<Recording> recordings) {
  const Result<Study> study = CheckedStudy(given);
  IDIM_RETURN_IF_ERROR(study);
  return Prepare(*study, MakeModel(*study), std::move(recordings));
}

}  // namespace idim
