// A study with all of its estimators.

#ifndef IDIM_SOLVERS_ESTIMATORS_ESTIMATORS_H_
#define IDIM_SOLVERS_ESTIMATORS_ESTIMATORS_H_

#include <optional>
#include <string>
#include <vector>

#include "core/base/status.h"
#include "core/estimate/bias_test.h"
#include "core/model/model.h"
#include "solvers/estimators/identification.h"
#include "solvers/estimators/registry.h"
#include "solvers/linear/gain_system.h"

namespace idim {

// A prepared study with what its estimators share: where gains are identified, one pass over the data, however many of
// them follow.
class EstimatorRunner {
 public:
  // BadInput: as BuildGainSystem. The prepared study must outlive the runner.
  static Result<EstimatorRunner> Create(const PreparedStudy* prepared);

  // essential_ratio: r_sigma, 0 keeps all parameters; huber: threshold of eiv's robust loss, 0 for none. BadInput: no
  // such estimator for this study, bad r_sigma, a loss that is negative or for a closed form, as the estimators say.
  Result<Identification> Run(const std::string& estimator, double essential_ratio, double huber = 0.0) const;

  // Where gains are identified, else nothing: the baseline that finds them one joint at a time (gains only).
  std::optional<Estimate> RunSequential() const;

  // Where gains are identified, else empty: whether LS is biased, in the equations of each joint and in all of them
  // with rows weighted like WGTLS does.
  Result<std::vector<BiasTest>> TestBias() const;

 private:
  explicit EstimatorRunner(const PreparedStudy* prepared) : prepared_(prepared) {}

  const PreparedStudy* prepared_;
  std::optional<GainSystem> gain_system_;  // where gains are identified
};

}  // namespace idim

#endif  // IDIM_SOLVERS_ESTIMATORS_ESTIMATORS_H_
