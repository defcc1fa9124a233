#include "solvers/judge/monte_carlo.h"

#include <glog/logging.h>

#include <Eigen/LU>
#include <algorithm>
#include <mutex>
#include <random>
#include <utility>

#include "core/base/parallel_for.h"
#include "core/model/active_effects.h"
#include "core/model/prediction.h"
#include "core/model/unknowns.h"
#include "core/simulation/simulate.h"
#include "solvers/estimators/estimators.h"
#include "solvers/judge/validation.h"
#include "solvers/loop/declared_effects.h"

namespace idim {
namespace {

using Eigen::MatrixXd;

// All that the runs share; read by every thread, written by none.
struct Simulator {
  DataRequest request;        // identification recordings only, with the filter of the original
  Model model;                // of these, its effects declared
  std::vector<Truth> truths;  // one a recording of `request`
  std::vector<bool> signal_is_torque;
  std::vector<TrueParameter> parameters;
  NoiseOptions noise;
};

// Of the model, in the order of the estimates: gains where they are identified, base parameters, those of effects,
// unknown payloads'.
std::vector<TrueParameter> TrueParameters(const PreparedStudy& prepared, const ArmParameters& arm) {
  const Unknowns unknowns(prepared.model, UncertainPayload::kExact);
  const Eigen::VectorXd values = unknowns.Values(arm);
  std::vector<TrueParameter> parameters;
  for (int k = 0; k < unknowns.size(); ++k) parameters.push_back({unknowns[k], values[k] + unknowns.Offset(k)});
  return parameters;
}

// To be declared in every run, where shapes begin from the truth.
std::vector<PlacedEffect> EffectsAt(const StatedModel& stated) {
  std::vector<PlacedEffect> effects;
  for (const ActiveEffect& active : stated.prepared.model.effects) {
    PlacedEffect declared{active.effect, active.joints, {}, stated.prepared.path() + ": " + EffectTitle(active)};
    const std::vector<ShapeParameter> shapes = ShapesAlong(stated.prepared, *active.effect, active.joints);
    // Limits differ a little from run to run; recordings, by which some count, from those of the study.
    for (size_t s = 0; s < shapes.size() && !active.effect->shapes_count_recordings(); ++s) {
      const double margin = 0.01 * (shapes[s].upper - shapes[s].lower);
      const double start =
          std::clamp(active.shape[static_cast<Eigen::Index>(s)], shapes[s].lower + margin, shapes[s].upper - margin);
      declared.shape.push_back({shapes[s].name, start, declared.where});
    }
    effects.push_back(std::move(declared));
  }
  return effects;
}

Result<Simulator> MakeSimulator(const PreparedStudy& prepared, const Estimate& reference) {
  const Result<ArmParameters> arm = ArmParametersOf(prepared, ReferenceOf(reference));
  IDIM_RETURN_IF_ERROR(arm);
  const Eigen::FullPivLU<MatrixXd> inverse(prepared.data->drive.Matrix(arm->gains));
  if (!inverse.isInvertible()) {
    return Status::BadInput(prepared.path() +
                            ": a drive gain of the estimate is zero, so no signal gives its joint a torque");
  }
  const std::vector<int> used = prepared.model.RecordingsFor(Use::kIdentification);
  const Preprocessing& preprocessing = prepared.data->preprocessing;
  const StatedModel stated = AsStated(prepared, *arm);
  Simulator simulator;
  simulator.request = SomeRecordings(*prepared.data, used)->request;
  simulator.request.preprocessing = {preprocessing.cutoff_hz, preprocessing.decimation};
  simulator.model = ForRecordings(WithoutEffects(prepared.model), used);
  simulator.model.declared = EffectsAt(stated);
  simulator.parameters = TrueParameters(prepared, *arm);
  simulator.noise.position = prepared.data->position_noise;
  simulator.noise.signal = reference.signal_noise;
  for (const int r : used) {
    const MeasuredRecording& recording = prepared.data->recordings[static_cast<size_t>(r)];
    Truth truth;
    truth.t = recording.recording->t;
    truth.q = recording.states->q;
    truth.torque = Predict(stated.prepared, r, stated.arm).model;
    truth.signal = inverse.solve(truth.torque.transpose()).transpose();
    simulator.truths.push_back(std::move(truth));
    simulator.signal_is_torque.push_back(recording.recording->signal_is_torque);
  }
  return simulator;
}

// Fixed by the C++ standard, unlike std::hash.
std::uint64_t SeedOf(std::uint64_t seed, int run, size_t recording) {
  std::seed_seq sequence{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32),
                         static_cast<std::uint32_t>(run), static_cast<std::uint32_t>(recording)};
  std::uint32_t words[2];
  sequence.generate(words, words + 2);
  return static_cast<std::uint64_t>(words[1]) << 32 | words[0];
}

Estimate Failed(const std::string& estimator, const Status& status) {
  Estimate estimate;
  estimate.estimator = estimator;
  estimate.status = status;
  return estimate;
}

// One entry an estimator.
std::vector<RunErrors> OneRun(const Simulator& simulator, const std::vector<std::string>& estimators,
                              const MonteCarloOptions& options, int run) {
  std::vector<Recording> recordings;
  for (size_t k = 0; k < simulator.truths.size(); ++k) {
    recordings.push_back(
        AddNoise(simulator.truths[k], simulator.request.robot, simulator.noise, SeedOf(options.seed, run, k)));
    recordings.back().name = simulator.request.recordings[k].name;
    recordings.back().signal_is_torque = simulator.signal_is_torque[k];
  }
  std::vector<RunErrors> errors;
  const auto fail = [&](const Status& status) {
    for (const std::string& name : estimators)
      errors.push_back(RunErrorsOf(simulator.parameters, Failed(name, status)));
    return errors;
  };
  Result<std::shared_ptr<const Data>> data = MakeData(simulator.request, std::move(recordings));
  if (!data.ok()) return fail(data.status());
  const Result<PreparedStudy> prepared = DeclareEffects({*std::move(data), simulator.model});
  if (!prepared.ok()) return fail(prepared.status());
  const Result<EstimatorRunner> runner = EstimatorRunner::Create(&*prepared);
  if (!runner.ok()) return fail(runner.status());
  for (const std::string& name : estimators) {
    const Result<Identification> result = runner->Run(name, options.essential_ratio);
    errors.push_back(RunErrorsOf(simulator.parameters, result.ok() ? result->estimate : Failed(name, result.status())));
  }
  return errors;
}

}  // namespace

bool MonteCarloOptions::IsValid(std::string* error) const {
  error->clear();
  if (runs < 2) {
    *error = "runs = " + std::to_string(runs) + ", must be at least 2";
  } else if (threads < 1) {
    *error = "threads = " + std::to_string(threads) + ", must be at least 1";
  } else if (!(essential_ratio == 0.0 || essential_ratio > 1.0)) {
    *error = "essential_ratio = " + std::to_string(essential_ratio) + ", must be above 1, or 0";
  }
  return error->empty();
}

Result<MonteCarlo> RunMonteCarlo(const PreparedStudy& prepared, const Estimate& reference,
                                 const std::vector<std::string>& estimators, const MonteCarloOptions& options,
                                 const std::function<void(int done)>& progress) {
  std::string error;
  if (!options.IsValid(&error)) return Status::BadInput(error);
  CHECK(!reference.parameters.empty()) << reference.estimator << " has no numbers to simulate from";
  CHECK_EQ(reference.signal_noise.size(), prepared.robot().dof());
  const Result<Simulator> simulator = MakeSimulator(prepared, reference);
  IDIM_RETURN_IF_ERROR(simulator);

  std::vector<std::vector<RunErrors>> by_estimator(estimators.size(), std::vector<RunErrors>(options.runs));
  std::mutex mutex;
  int done = 0;
  ParallelFor(options.threads, options.runs, [&](int run) {
    std::vector<RunErrors> errors = OneRun(*simulator, estimators, options, run);
    for (size_t k = 0; k < estimators.size(); ++k) by_estimator[k][run] = std::move(errors[k]);
    const std::lock_guard<std::mutex> lock(mutex);
    ++done;
    if (progress) progress(done);
  });

  MonteCarlo result;
  result.runs = options.runs;
  result.seed = options.seed;
  result.reference = reference.estimator;
  result.position_noise = simulator->noise.position;
  result.signal_noise = simulator->noise.signal;
  for (size_t k = 0; k < estimators.size(); ++k) {
    result.estimators.push_back(Accumulate(estimators[k], simulator->parameters, by_estimator[k]));
  }
  return result;
}

}  // namespace idim
