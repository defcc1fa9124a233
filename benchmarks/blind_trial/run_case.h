// One simulated arm: what the closed loop finds of the effects that it has.

#ifndef IDIM_BENCHMARKS_BLIND_TRIAL_RUN_CASE_H_
#define IDIM_BENCHMARKS_BLIND_TRIAL_RUN_CASE_H_

#include <string>
#include <vector>

#include "benchmarks/blind_trial/draw.h"

namespace idim::blind_trial {

struct CaseOptions {
  ArmOptions arm;
  EffectEquationList equations;  // to draw from, not empty
  int seed = 1;
  double none = 0.25, two = 0.15;         // share of cases with so many effects; others have one
  double smallest = 0.01, largest = 0.3;  // of an effect's share of its joint's signal
  int decimation = 5;                     // samples kept: one in so many
  bool verbose = false;                   // what the loop is about, to standard error
};

struct Planted {
  SimulatedEffect effect;
  double share = 0.0;  // asked for
  double worth = 0.0;  // [%]
  bool found = false, id = false, joint = false;
};

struct Case {
  std::string problem;
  bool identify = false;
  std::vector<Planted> planted;
  std::vector<std::string> found, false_alarms, dropped;
  double before = 0.0, after = 0.0, truth = 0.0, seconds = 0.0;
  std::vector<std::string> unexplained;
};

// The result depends on options.seed and number alone.
Case RunCase(int number, const CaseOptions& options);

// id and joints.
std::string Title(const SimulatedEffect& effect);

}  // namespace idim::blind_trial

#endif  // IDIM_BENCHMARKS_BLIND_TRIAL_RUN_CASE_H_
