// Parameters known from elsewhere (a paper's table, CAD, the truth of a simulation, an earlier estimate) to print
// beside an estimate.

#ifndef IDIM_CORE_ESTIMATE_REFERENCE_H_
#define IDIM_CORE_ESTIMATE_REFERENCE_H_

#include <string>
#include <vector>

#include "core/base/status.h"
#include "core/estimate/estimate.h"

namespace idim {

struct Reference {
  struct Entry {
    std::string name;
    double value = 0.0;
    double standard_deviation = 0.0;  // 0: exact or not stated
  };
  std::string name;
  std::string robot;    // empty: not stated
  std::string warning;  // why it is not to be trusted, where it says so itself
  std::vector<Entry> parameters;
  std::vector<EstimatedEffect> effects = {};  // as stated: neither ids nor joints are those of a robot yet
  bool velocity_zero_at_rest = false;

  // nullptr where the reference does not have the parameter.
  const Entry* Find(const std::string& parameter) const;
};

// An estimate as a reference, named by its estimator.
Reference ReferenceOf(const Estimate& estimate);

// JSON in the format of estimate.json, of which "name" (else "estimator", else the file's), "robot", "status",
// "message", "effects", "velocity_zero_at_rest", and of "parameters" "name", "value" and "standard_deviation" are read;
// so an estimate.json is a reference itself. Refuses what is not, naming file and key.
Result<Reference> ReadReference(const std::string& path);

// Of a comma-separated list of paths, in its order; empty for an empty list. Those of the same name have their paths
// in it too.
Result<std::vector<Reference>> ReadReferences(const std::string& paths);

// A line a parameter: the estimate, the reference, and their difference in standard deviations of the difference.
std::string BesideReference(const Estimate& estimate, const Reference& reference);

// (estimate - reference) / sqrt(both variances); NaN without any.
double DifferenceInSigmas(const ParameterEstimate& estimate, const Reference::Entry& reference);

}  // namespace idim

#endif  // IDIM_CORE_ESTIMATE_REFERENCE_H_
