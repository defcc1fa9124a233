#include "core/model/payload_unknowns.h"

#include <set>

namespace idim {

PayloadColumns AppendPayloadUnknowns(const Study& study, std::vector<Parameter>* unknowns) {
  std::set<int> carried;
  for (const RecordingEntry& entry : study.recordings) {
    if (entry.use == Use::kIdentification && entry.payload >= 0) carried.insert(entry.payload);
  }
  const int n = study.robot.dof();
  PayloadColumns payload_columns;
  for (int p = 0; p < static_cast<int>(study.payloads.size()); ++p) {
    std::array<int, kNumInertial> columns;
    for (int k = 0; k < kNumInertial; ++k) {
      columns[k] = -1;
      if (study.payloads[p].known[k] || carried.count(p) == 0) continue;
      columns[k] = static_cast<int>(unknowns->size());
      // The paper numbers the payload as link n + 1.
      std::string name = kStandardNames[k] + std::to_string(n + 1);
      if (carried.size() > 1) name += "_" + study.payloads[p].name;
      unknowns->push_back({name, ParameterKind::kPayload, n, StandardUnit(k, false)});
    }
    payload_columns.push_back(columns);
  }
  return payload_columns;
}

Study ReleaseUncertain(const Study& study) {
  Study released = study;
  for (Payload& payload : released.payloads) {
    for (int k = 0; k < kNumInertial; ++k) {
      if (payload.standard_deviation[k]) payload.known[k].reset();
    }
  }
  return released;
}

InertialVector KnownPayload(const Study& study, int payload) {
  InertialVector known = InertialVector::Zero();
  for (int k = 0; payload >= 0 && k < kNumInertial; ++k) known[k] = study.payloads[payload].known[k].value_or(0.0);
  return known;
}

}  // namespace idim
