// Data are never changed; a test that wants others makes them from these.

#ifndef IDIM_TESTS_SUPPORT_EDIT_DATA_H_
#define IDIM_TESTS_SUPPORT_EDIT_DATA_H_

#include <memory>
#include <utility>
#include <vector>

#include "core/model/active_effects.h"
#include "core/model/model.h"
#include "solvers/bundle/bundle_data.h"

namespace idim::testing {

// edit(Data*) of a copy, which takes the place of prepared->data.
template <typename Edit>
void EditData(PreparedStudy* prepared, Edit edit) {
  auto data = std::make_shared<Data>(*prepared->data);
  edit(data.get());
  prepared->data = std::move(data);
}

// edit(Recording*, JointStates*) of copies of each recording.
template <typename Edit>
void EditRecordings(PreparedStudy* prepared, Edit edit) {
  EditData(prepared, [&](Data* data) {
    for (MeasuredRecording& measured : data->recordings) {
      Recording recording = *measured.recording;
      JointStates states = *measured.states;
      edit(&recording, &states);
      measured.recording = std::make_shared<const Recording>(std::move(recording));
      measured.states = std::make_shared<const JointStates>(std::move(states));
    }
  });
}

// Some of the recordings in their roles.
inline void KeepRecordings(const std::vector<int>& indices, PreparedStudy* prepared) {
  *prepared = {SomeRecordings(*prepared->data, indices), ForRecordings(prepared->model, indices)};
}

// edit(std::vector<BundleSample>*) likewise.
template <typename Edit>
void EditSamples(BundleData* data, Edit edit) {
  std::vector<BundleSample> samples = data->samples();
  edit(&samples);
  data->SetSamples(std::move(samples));
}

}  // namespace idim::testing

#endif  // IDIM_TESTS_SUPPORT_EDIT_DATA_H_
