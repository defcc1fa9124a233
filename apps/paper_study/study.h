// The study of Gautier & Briot (2014), section IV, on simulated recordings: its four cases, the manufacturer's gains,
// and scaled TLS beside them, each judged on recordings that it has not seen.
//
// Differences from the paper that follow from simulating: the ten "known" payload parameters of cases 1 and 3 are the
// true ones (the paper's come from CAD), and the truth can stand beside every estimate.

#ifndef IDIM_APPS_PAPER_STUDY_STUDY_H_
#define IDIM_APPS_PAPER_STUDY_STUDY_H_

#include <string>
#include <vector>

#include "core/base/status.h"
#include "core/estimate/estimate.h"
#include "core/model/model.h"
#include "core/simulation/scenario.h"
#include "core/simulation/simulate_scenario.h"
#include "solvers/judge/validation.h"

namespace idim {

// What is told of the payload on the loaded identification recording.
enum class PayloadKnowledge { kNothing, kMass, kTen };

struct PaperCase {
  std::string name;       // as the paper's tables name it
  std::string estimator;  // solvers/estimators/estimators.h
  PayloadKnowledge knowledge = PayloadKnowledge::kMass;
  Estimate estimate;      // essential parameters
  Validation validation;  // of every validation recording, in the scenario's order
};

struct PaperStudy {
  Scenario scenario;
  PreparedStudy prepared;        // all recordings; gains to be identified, payload masses known
  Reference truth;               // gains, base parameters, and the parameters of the calibrated payload ("MX7")
  std::vector<PaperCase> cases;  // manufacturer, cases 1 to 4, scaled TLS
};

// Which of the six.
enum PaperCaseIndex { kManufacturer, kCase1, kCase2, kCase3, kCase4, kScaled, kNumPaperCases };

// The prepared study with its payloads known as told and only recordings of one use or all.
PreparedStudy WithPayloadKnowledge(const PreparedStudy& prepared, const Scenario& scenario, PayloadKnowledge knowledge,
                                   bool identification_only);

// scenario: gains to be identified with a priori values; the first payload is the one to identify with. r_sigma: of the
// essential parameters. BadInput: a scenario of another kind; as the estimators and the validation say.
Result<PaperStudy> RunPaperStudy(const Scenario& scenario, double r_sigma);

}  // namespace idim

#endif  // IDIM_APPS_PAPER_STUDY_STUDY_H_
