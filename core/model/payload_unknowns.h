// The unknown payload parameters among the unknowns of a linear system, and the known ones (paper II.B, eq. (5)).

#ifndef IDIM_CORE_MODEL_PAYLOAD_UNKNOWNS_H_
#define IDIM_CORE_MODEL_PAYLOAD_UNKNOWNS_H_

#include <array>
#include <vector>

#include "core/dynamics/parameters.h"
#include "core/recording/study.h"
#include "core/robot/inertia.h"

namespace idim {

// For each payload of a study the columns of its ten parameters, -1 where known or not carried.
using PayloadColumns = std::vector<std::array<int, kNumInertial>>;

// Appends the unknown parameters of each payload that an identification recording carries to *unknowns, named like the
// paper's link n + 1 ("XX7", "M7"; "XX7_big" where several payloads are carried).
PayloadColumns AppendPayloadUnknowns(const Study& study, std::vector<Parameter>* unknowns);

// The study with what it knows of payloads to a standard deviation only set free.
Study ReleaseUncertain(const Study& study);

// The known part of a payload of the study, zero where unknown and for payload -1.
InertialVector KnownPayload(const Study& study, int payload);

}  // namespace idim

#endif  // IDIM_CORE_MODEL_PAYLOAD_UNKNOWNS_H_
