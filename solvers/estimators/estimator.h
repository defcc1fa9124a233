// An estimator as programs, Monte-Carlo and comparison see it. Adding one: a file with its class and its maker, and a
// line in registry.cc.

#ifndef IDIM_SOLVERS_ESTIMATORS_ESTIMATOR_H_
#define IDIM_SOLVERS_ESTIMATORS_ESTIMATOR_H_

#include <string>

#include "core/base/status.h"
#include "core/model/model.h"
#include "solvers/estimators/fit_summary.h"
#include "solvers/linear/gain_system.h"

namespace idim {

struct EstimatorOptions {
  double essential_ratio = 0.0;  // r_sigma of the essential parameters, 0 keeps all, else > 1
  double huber_threshold = 0.0;  // of a robust loss, >= 0; 0: none
};

class Estimator {
 public:
  virtual ~Estimator() = default;

  // As a command line gives it: "wls".
  virtual std::string name() const = 0;
  // Whether it can be run where gains are known, or where they are identified.
  virtual bool Takes(GainsMode mode) const = 0;
  virtual bool has_robust_loss() const { return false; }
  // False with a sentence in *error.
  virtual bool IsValid(const EstimatorOptions& options, std::string* error) const = 0;
  // system: of the same study where gains are identified, else nullptr. Options and mode are such as it takes (CHECK).
  // BadInput: the study cannot be asked this. What the data cannot tell is in header.status of the result.
  virtual Result<FitSummary> Fit(const PreparedStudy& prepared, const GainSystem* system,
                                 const EstimatorOptions& options) const = 0;
};

}  // namespace idim

#endif  // IDIM_SOLVERS_ESTIMATORS_ESTIMATOR_H_
