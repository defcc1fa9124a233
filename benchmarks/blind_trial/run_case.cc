#include "benchmarks/blind_trial/run_case.h"

#include <glog/logging.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <utility>

#include "core/base/text.h"
#include "core/effects/simulated_effects.h"
#include "core/model/active_effects.h"
#include "core/simulation/effects_truth.h"
#include "core/simulation/simulate_scenario.h"
#include "solvers/bundle/residual_model.h"
#include "solvers/loop/close_loop.h"
#include "solvers/loop/effect_fit.h"

namespace idim::blind_trial {
namespace {

// As identification has it, at the true shape.
ActiveEffect TrueEffect(const SimulatedEffect& effect, const Scenario& scenario,
                        const std::vector<EffectMotion>& motions) {
  ActiveEffect known{FindEffect(effect.equation->id()), effect.joints, {}};
  known.shape = known.effect->TrueShape(effect, scenario);
  const std::vector<ShapeParameter> shapes = known.effect->Shapes(motions, known.joints);
  CHECK_EQ(static_cast<size_t>(known.shape.size()), shapes.size());
  for (size_t k = 0; k < shapes.size(); ++k) {
    double& value = known.shape[static_cast<Eigen::Index>(k)];
    value = std::clamp(value, shapes[k].lower, shapes[k].upper);
  }
  return known;
}

struct HeldOut {
  Eigen::MatrixXd residual, torque;
  double Percent() const { return 100.0 * residual.norm() / torque.norm(); }
  // Of the joints named; all: none.
  double Percent(const std::vector<int>& joints) const {
    if (joints.empty()) return Percent();
    double sum = 0.0, of = 0.0;
    for (const int j : joints) {
      sum += residual.col(j).squaredNorm();
      of += torque.col(j).squaredNorm();
    }
    return 100.0 * std::sqrt(sum / of);
  }
};

HeldOut HeldOutOf(const EffectFit& fit) {
  const ResidualModel model(fit.prepared.base(), fit.data, fit.summary);
  return {model.CrossValidate(Eigen::MatrixXd(model.residual().size(), 0)).residual, model.torque()};
}

Result<PreparedStudy> Log(const Scenario& scenario, const CaseOptions& options) {
  Study study = StudyOf(scenario);
  study.preprocessing.cutoff_hz = 0.4 * options.arm.rate / options.decimation;
  study.preprocessing.decimation = options.decimation;
  std::vector<Recording> logs;
  for (const ScenarioRecording& recording : scenario.recordings) {
    logs.push_back(SimulateLog(scenario, recording, SimulateTruth(scenario, recording)));
  }
  Result<PreparedStudy> prepared = PrepareStudy(study, std::move(logs));
  // As the loop does it, so that the model that knows the truth is fitted to the same velocities.
  if (prepared.ok()) prepared->data = WithVelocityZeroAtRest(*prepared->data);
  return prepared;
}

}  // namespace

std::string Title(const SimulatedEffect& effect) {
  return EffectTitle({FindEffect(effect.equation->id()), effect.joints, {}});
}

Case RunCase(int number, const CaseOptions& options) {
  Case result;
  Random random = Random::FromWords({static_cast<std::uint32_t>(options.seed), static_cast<std::uint32_t>(number)});
  Scenario scenario = DrawArm(options.arm, &random);
  result.identify = scenario.gains_mode == GainsMode::kIdentify;
  const double draw = random.Uniform();
  const int effects = draw < options.none ? 0 : draw < options.none + options.two ? 2 : 1;
  const int all = static_cast<int>(EffectEquations().size());
  while (static_cast<int>(result.planted.size()) < effects) {
    // By turns, so that each id has its share of the cases.
    const size_t turn =
        static_cast<size_t>(number) + result.planted.size() * static_cast<size_t>(1 + random.Below(all - 1));
    const EffectEquation& equation = *options.equations[turn % options.equations.size()];
    const SimulatedEffect effect = DrawEffect(equation, scenario, &random);
    const double share = random.LogUniform(options.smallest, options.largest);
    scenario.effects.push_back(effect);
    const size_t last = scenario.effects.size() - 1;
    double size = share;
    Status scaled = Status::Ok();
    if (!equation.share_follows_size()) {
      size = EffectShare(scenario, last);
    } else {
      scaled = ScaleEffect(&scenario, last, size);
      // Some effects have a largest size.
      for (int k = 0; !scaled.ok() && k < 4; ++k) scaled = ScaleEffect(&scenario, last, size *= 0.6);
    }
    if (!scaled.ok()) {
      result.problem = scaled.message();
      scenario.effects.pop_back();
      return result;
    }
    result.planted.push_back({scenario.effects[last], size});
  }

  const auto start = std::chrono::steady_clock::now();
  const Result<PreparedStudy> prepared = Log(scenario, options);
  if (!prepared.ok()) {
    result.problem = prepared.status().message();
    return result;
  }
  LoopOptions loop_options;
  if (options.verbose)
    loop_options.progress = [](const std::string& text) { std::fprintf(stderr, "%s\n", text.c_str()); };
  const Result<LoopResult> loop = CloseLoop(*prepared, loop_options);
  if (!loop.ok() || !loop->status.ok()) {
    result.problem = loop.ok() ? loop->status.message() : loop.status().message();
    if (!loop.ok() || loop->prepared.model.effects.empty()) return result;
  }
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  result.before = loop->declared.validation;
  result.after = loop->final.validation;
  result.dropped = loop->dropped;
  for (const Unexplained& u : loop->unexplained) {
    result.unexplained.push_back(
        Format("joint %d by %s (%.1f %%)", u.joint + 1, Join(u.depends_on, " and ").c_str(), u.share_percent));
  }
  for (const ActiveEffect& active : loop->prepared.model.effects) {
    const std::string title = EffectTitle(active);
    bool planted = false;
    for (Planted& p : result.planted) {
      const bool id = p.effect.equation == active.effect->equation(), joint = p.effect.joints == active.joints;
      p.id |= id;
      p.joint |= joint;
      p.found |= id && joint;
      planted |= id && joint;
    }
    result.found.push_back(title);
    if (!planted) result.false_alarms.push_back(title);
  }

  const Result<EffectFit> declared = FitDeclared(*prepared);
  CHECK(declared.ok());
  const std::vector<EffectMotion> motions = MotionsOf(declared->prepared, declared->Arm());
  std::vector<ActiveEffect> known;
  for (const Planted& p : result.planted) known.push_back(TrueEffect(p.effect, scenario, motions));
  const Result<EffectFit> truth = known.empty() ? declared : Refit(*declared, known);
  if (!truth.ok()) {
    result.problem = "truth: " + truth.status().message();
    return result;
  }
  const HeldOut with = HeldOutOf(*truth);
  result.truth = with.Percent();
  for (size_t k = 0; k < known.size(); ++k) {
    std::vector<ActiveEffect> others = known;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(k));
    const Result<EffectFit> without = others.empty() ? declared : Refit(*declared, others);
    if (!without.ok()) continue;
    const std::vector<int>& joints = known[k].joints;
    result.planted[k].worth = 100.0 * (1.0 - with.Percent(joints) / HeldOutOf(*without).Percent(joints));
  }
  return result;
}

}  // namespace idim::blind_trial
