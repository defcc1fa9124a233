// Every estimator on data simulated from an estimate of the study: what each of them makes of a known truth.
//
// A run:
//   1. motion    the filtered positions of the study's own identification recordings, at their recorded instants;
//   2. torque    the model's along that motion with the estimate's parameters (Predict), and the signal that the drives
//                with the estimate's gains need for it;
//   3. noise     white, normal, independent between samples, joints, q and v: standard deviations as the study's
//                positions have them and as the logged signals have about the model, at the recorded rate;
//   4. chain     filter, decimation and observation matrix as on the real recordings (same cut-off and decimation),
//                position noise estimated anew unless the study states it, then every estimator.
//
// What this shows: the estimators' bias, spread and honesty on this motion, with this model and this noise, filter and
// decimation included. What it does not: an error of the model (the truth is in the model's class), noise that is
// correlated in time or between joints (real residuals are, so real spreads are larger and real intervals hold the
// truth less often), quantisation, an outlier. The true motion carries what the filter left of the real noise, so it is
// a little livelier than the arm's, also where the arm stands still; the runs see it filtered a second time and with
// noise of their own. Friction's sign at reversals and at rest feels that first: on the UR10e recordings, which dwell,
// WGTLS finds Fs up to three of its spreads too small and Fv as much too large. Validation recordings take no part.
//
// Deterministic: the seed of a recording's noise is made of (seed, run, recording), runs are kept by their number, so
// neither the number of threads nor their order matters.

#ifndef IDIM_SOLVERS_JUDGE_MONTE_CARLO_H_
#define IDIM_SOLVERS_JUDGE_MONTE_CARLO_H_

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/base/status.h"
#include "core/estimate/estimate.h"
#include "core/estimate/monte_carlo.h"
#include "core/model/model.h"

namespace idim {

struct MonteCarloOptions {
  int runs = 200;  // >= 2
  std::uint64_t seed = 1;
  int threads = 1;               // >= 1; no more than runs are used
  double essential_ratio = 0.0;  // r_sigma of every estimator: > 1, or 0 for all parameters

  bool IsValid(std::string* error) const;
};

// reference: a usable estimate of `prepared` with its noise (CHECK); what it lacks as not essential is zero in truth.
// estimators: names of EstimatorNames. progress: called with the number of runs that are done, after each, one call at
// a time, from any thread; may be empty. A study that an estimator refuses in a run is a failure of that run. BadInput:
// options, an estimate of another study, a drive map without inverse.
Result<MonteCarlo> RunMonteCarlo(const PreparedStudy& prepared, const Estimate& reference,
                                 const std::vector<std::string>& estimators, const MonteCarloOptions& options,
                                 const std::function<void(int done)>& progress);

}  // namespace idim

#endif  // IDIM_SOLVERS_JUDGE_MONTE_CARLO_H_
