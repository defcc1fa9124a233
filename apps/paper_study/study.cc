#include "apps/paper_study/study.h"

#include <utility>

#include "core/model/active_effects.h"
#include "solvers/estimators/estimators.h"
#include "solvers/linear/gain_system.h"

namespace idim {
namespace {

struct Spec {
  const char* name;
  const char* estimator;
  PayloadKnowledge knowledge;
};

constexpr Spec kSpecs[kNumPaperCases] = {
    {"Manufacturer", "wls", PayloadKnowledge::kNothing}, {"Case 1", "wls", PayloadKnowledge::kTen},
    {"Case 2", "wls", PayloadKnowledge::kMass},          {"Case 3", "wtls", PayloadKnowledge::kTen},
    {"Case 4", "wtls", PayloadKnowledge::kMass},         {"Scaled TLS", "wgtls", PayloadKnowledge::kMass}};

Reference TruthOf(const Scenario& scenario, const BaseParameters& base) {
  Reference truth;
  truth.name = "truth";
  const int n = scenario.robot.dof();
  const std::vector<Parameter> gains = GainParameters(scenario.robot, scenario.truth.signal_side);
  for (int j = 0; j < n; ++j) truth.parameters.push_back({gains[j].name, scenario.gains[j], 0.0});
  const Eigen::VectorXd chi = base.projection() * scenario.chi;
  for (int k = 0; k < base.size(); ++k) truth.parameters.push_back({base.parameters()[k].name, chi[k], 0.0});
  for (int k = 0; k < kNumInertial; ++k) {
    truth.parameters.push_back({kStandardNames[k] + std::to_string(n + 1), scenario.payloads[0].inertial[k], 0.0});
  }
  return truth;
}

Result<PaperCase> RunCase(const PaperStudy& paper, const Spec& spec, double r_sigma) {
  PaperCase result;
  result.name = spec.name;
  result.estimator = spec.estimator;
  result.knowledge = spec.knowledge;
  PreparedStudy fit = WithPayloadKnowledge(paper.prepared, paper.scenario, spec.knowledge, true);
  // The manufacturer's gains are taken for true, as in the paper: a classical identification with a payload.
  if (spec.knowledge == PayloadKnowledge::kNothing) fit.model.gains_mode = GainsMode::kKnown;
  const Result<EstimatorRunner> runner = EstimatorRunner::Create(&fit);
  IDIM_RETURN_IF_ERROR(runner);
  Result<Identification> identification = runner->Run(spec.estimator, r_sigma);
  IDIM_RETURN_IF_ERROR(identification);
  result.estimate = std::move(identification->estimate);
  if (result.estimate.parameters.empty()) return result.estimate.status;
  PreparedStudy judge = WithPayloadKnowledge(paper.prepared, paper.scenario, spec.knowledge, false);
  if (spec.knowledge == PayloadKnowledge::kNothing) judge.model.gains_mode = GainsMode::kKnown;
  Reference reference = ReferenceOf(result.estimate);
  reference.name = spec.name;
  Result<Validation> validation = Validate(judge, reference);
  IDIM_RETURN_IF_ERROR(validation);
  result.validation = std::move(validation).value();
  return result;
}

}  // namespace

PreparedStudy WithPayloadKnowledge(const PreparedStudy& prepared, const Scenario& scenario, PayloadKnowledge knowledge,
                                   bool identification_only) {
  PreparedStudy result = prepared;
  if (identification_only) {
    const std::vector<int> used = prepared.model.RecordingsFor(Use::kIdentification);
    result = {SomeRecordings(*prepared.data, used), ForRecordings(prepared.model, used)};
  }
  for (int k = 0; k < kNumInertial; ++k) {
    const bool known = knowledge == PayloadKnowledge::kTen || (knowledge == PayloadKnowledge::kMass && k == kM);
    result.model.payloads[0].known[k].reset();
    if (known) result.model.payloads[0].known[k] = scenario.payloads[0].inertial[k];
  }
  return result;
}

Result<PaperStudy> RunPaperStudy(const Scenario& scenario, double r_sigma) {
  if (scenario.gains_mode != GainsMode::kIdentify || scenario.a_priori_gains.size() == 0 || scenario.payloads.empty()) {
    return Status::BadInput(scenario.path +
                            ": expected gains of mode identify with a_priori values, and a payload to identify with");
  }
  std::vector<Recording> recordings;
  for (const ScenarioRecording& recording : scenario.recordings) {
    recordings.push_back(SimulateLog(scenario, recording, SimulateTruth(scenario, recording)));
  }
  Result<PreparedStudy> prepared = PrepareStudy(StudyOf(scenario), std::move(recordings));
  IDIM_RETURN_IF_ERROR(prepared);
  Reference truth = TruthOf(scenario, prepared->base());
  PaperStudy paper{scenario, std::move(prepared).value(), std::move(truth), {}};
  for (const Spec& spec : kSpecs) {
    Result<PaperCase> result = RunCase(paper, spec, r_sigma);
    IDIM_RETURN_IF_ERROR(result);
    paper.cases.push_back(std::move(result).value());
  }
  return paper;
}

}  // namespace idim
