#include "core/model/sample_stream.h"

namespace idim {

void StreamObservations(const PreparedStudy& prepared, int recording,
                        const std::function<void(const Observation&)>& visit) {
  const auto r = static_cast<size_t>(recording);
  const MeasuredRecording& measured = prepared.data->recordings[r];
  const EffectColumns& effects = *prepared.model.columns;
  StreamObservations(prepared.base(), *measured.states, measured.recording->signal, prepared.data->velocity_sigma,
                     *measured.decimator, visit, effects.of_recording[r], static_cast<int>(effects.parameters.size()));
}

void StreamSamples(const PreparedStudy& prepared, const Unknowns& unknowns, int recording,
                   const std::function<void(const Sample&)>& visit) {
  const int payload = prepared.model.roles[static_cast<size_t>(recording)].payload;
  const InertialVector known = unknowns.known_payload(payload);
  Sample sample;
  sample.columns.setZero(unknowns.dof(), unknowns.num_columns());
  StreamObservations(prepared, recording, [&](const Observation& observation) {
    sample.columns.leftCols(observation.columns.cols()) = observation.columns;
    for (int k = 0; k < kNumInertial; ++k) {
      const int unknown = unknowns.payload(payload, k);
      if (unknown >= 0) sample.columns.col(unknown - unknowns.num_gains()) = observation.payload.col(k);
    }
    sample.t = observation.t;
    sample.known = observation.payload * known;
    sample.signal = observation.signal;
    visit(sample);
  });
}

}  // namespace idim
