#include <algorithm>
#include <limits>
#include <utility>

#include "apps/pages/loop_facts.h"
#include "apps/pages/loop_figures.h"
#include "apps/pages/loop_report.h"
#include "apps/pages/words.h"
#include "core/base/text.h"
#include "core/model/active_effects.h"
#include "core/report/report.h"

namespace idim {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

std::string Capital(std::string text) {
  if (!text.empty() && text[0] >= 'a' && text[0] <= 'z') text[0] = static_cast<char>(text[0] - 'a' + 'A');
  return text;
}

std::string OnPage(std::string text) {
  for (const auto& [plain, sign] : {std::make_pair("+-", "±"), std::make_pair("->", "→")}) {
    for (size_t at = text.find(plain); at != std::string::npos; at = text.find(plain, at)) text.replace(at, 2, sign);
  }
  return text;
}

std::string Change(double before, double after) {
  return ErrorText(before, "") + " → " + ErrorText(after, "") + (after < 0.0 ? "" : " %");
}

Table ErrorTable(const LoopResult& result) {
  Table table;
  table.caption = "Relative error of the torque on the decimated samples, %";
  table.columns = {{"data"}, {"model"}};
  for (Index j = 0; j < result.declared.identification_per_joint.size(); ++j) {
    table.columns.push_back({JointTitle(j), Table::Align::kNumber});
  }
  table.columns.push_back({"all", Table::Align::kNumber});
  const auto add = [&](const std::string& data, const std::string& model, const VectorXd& joints, double all) {
    std::vector<std::string> row = {data, model};
    for (const double error : joints) row.push_back(ErrorText(error, ""));
    row.resize(table.columns.size() - 1);
    row.push_back(ErrorText(all, ""));
    table.rows.push_back(std::move(row));
  };
  const LoopErrors& before = result.declared;
  const LoopErrors& after = result.final;
  add("identification", "declared", before.identification_per_joint, before.identification);
  add("identification", "final", after.identification_per_joint, after.identification);
  add(HeldOutName(result), "declared", before.validation_per_joint, before.validation);
  add(HeldOutName(result), "final", after.validation_per_joint, after.validation);
  add("- while the joint moves", "declared", before.validation_moving, -1.0);
  add("- while the joint moves", "final", after.validation_moving, -1.0);
  return table;
}

BarFigure ErrorBars(const std::string& title, const VectorXd& before, const VectorXd& after) {
  BarFigure figure;
  figure.title = title;
  figure.y_title = "relative error [%]";
  for (Index j = 0; j < before.size(); ++j) figure.categories.push_back(JointTitle(j));
  figure.sets = {{"declared model", before, kBefore}, {"final model", after, kAfter}};
  return figure;
}

std::string Verdict(const LoopResult& result) {
  if (result.steps.empty()) {
    return "Nothing is missing that these data can show: no effect of the catalogue lowers the error of data that were "
           "not fitted.";
  }
  std::vector<std::string> titles;
  for (const LoopStep& step : result.steps) titles.push_back(Words(EffectTitle(step.effect)));
  return Format("The declared model lacks %d effect%s: ", static_cast<int>(titles.size()),
                titles.size() == 1 ? "" : "s") +
         Join(titles, "; ") + ". The error on the " + HeldOutName(result) + " goes from " +
         ErrorText(result.declared.validation, "") + " % to " + ErrorText(result.final.validation, "") + " %.";
}

Section Summary(const LoopResult& result) {
  Section section;
  section.title = "What was found";
  if (const Status status = StatusOf(result); !status.ok()) {
    section.blocks.emplace_back(Paragraph{"Not to be trusted: " + status.message(), Paragraph::Kind::kWarning});
  }
  if (result.before.estimate.parameters.empty()) return section;
  section.blocks.emplace_back(Paragraph{Verdict(result)});
  for (const std::string& warning : Warnings(result)) {
    section.blocks.emplace_back(Paragraph{warning, Paragraph::Kind::kWarning});
  }
  section.blocks.emplace_back(ErrorTable(result));
  section.blocks.emplace_back(Paragraph{
      result.held_out_by_blocks
          ? "There are no validation recordings. Held-out blocks: contiguous blocks of the identification recordings, "
            "each predicted by a fit on the others."
          : "Validation recordings were not looked at while effects were chosen.",
      Paragraph::Kind::kNote});
  FigureGrid grid;
  if (result.declared.validation_per_joint.size() > 0) {
    grid.figures.emplace_back(ErrorBars(Capital(HeldOutName(result)), result.declared.validation_per_joint,
                                        result.final.validation_per_joint));
  }
  if (result.declared.identification_per_joint.size() > 0) {
    grid.figures.emplace_back(
        ErrorBars("Identification", result.declared.identification_per_joint, result.final.identification_per_joint));
  }
  if (!grid.figures.empty()) section.blocks.emplace_back(std::move(grid));
  if (!result.steps.empty()) {
    Table table;
    table.caption = "Effects in the order in which they were found, and what each did to the relative error";
    table.columns = {{"", Table::Align::kRight},          {"effect"},
                     {"p", Table::Align::kRight},         {"identification", Table::Align::kRight},
                     {"its joint", Table::Align::kRight}, {HeldOutName(result), Table::Align::kRight},
                     {"its joint", Table::Align::kRight}, {"rivals"}};
    for (const LoopStep& step : result.steps) {
      std::vector<std::string> rivals;
      for (const LoopRival& rival : step.confusable_with) rivals.push_back(Words(EffectTitle(rival.effect)));
      const LoopErrors &before = step.before, &after = step.after;
      table.rows.push_back({std::to_string(table.rows.size() + 1), Words(EffectTitle(step.effect)),
                            PValueText(step.candidate.p_value), Change(before.identification, after.identification),
                            OnPage(OfItsJoints(step, before.identification_per_joint, after.identification_per_joint)),
                            Change(before.validation, after.validation),
                            OnPage(OfItsJoints(step, before.validation_per_joint, after.validation_per_joint)),
                            Join(rivals, "; ")});
    }
    section.blocks.emplace_back(std::move(table));
  }
  for (const std::string& sentence : result.dropped) section.blocks.emplace_back(Paragraph{sentence});
  return section;
}

// Candidates of one scan with their held-out decrease; the one that was added in the colour of the final model.
IntervalFigure Ranking(const LoopStep& step) {
  constexpr size_t kShown = 12;
  std::vector<const EffectCandidate*> shown;
  for (const EffectCandidate& c : step.ranking) {
    const bool chosen = SameEffect(c.effect, step.effect);
    if (shown.size() < kShown || chosen) shown.push_back(&c);
  }
  const auto count = static_cast<Index>(shown.size());
  const VectorXd none = VectorXd::Constant(count, std::numeric_limits<double>::quiet_NaN());
  IntervalFigure figure;
  figure.title = step.ranking.size() > shown.size()
                     ? Format("The best %d of %d candidates that passed the score test", static_cast<int>(shown.size()),
                              static_cast<int>(step.ranking.size()))
                     : "Candidates that passed the score test";
  figure.value_title = "decrease of the squared residual of its joints on blocks not fitted [%], ± 2 standard errors";
  IntervalFigure::Estimates added{"added", none, none, none, kAfter};
  IntervalFigure::Estimates others{"other candidates", none, none, none, SeriesColor::kResidual};
  for (Index k = 0; k < count; ++k) {
    const EffectCandidate& c = *shown[static_cast<size_t>(k)];
    figure.parameters.push_back(Words(EffectTitle(c.effect)));
    IntervalFigure::Estimates& set = SameEffect(c.effect, step.effect) ? added : others;
    set.value[k] = 100.0 * c.held_out_decrease;
    set.lower[k] = 100.0 * (c.held_out_decrease - 2.0 * c.held_out_error);
    set.upper[k] = 100.0 * (c.held_out_decrease + 2.0 * c.held_out_error);
  }
  for (IntervalFigure::Estimates* set : {&added, &others}) {
    if (!set->value.array().isNaN().all()) figure.sets.push_back(std::move(*set));
  }
  return figure;
}

Section Step(const LoopResult& result, const LoopStep& step, size_t number) {
  Section section;
  section.title = "Effect " + std::to_string(number) + ": " + Words(EffectTitle(step.effect));
  section.blocks.emplace_back(Paragraph{step.effect.effect->physics()});
  KeyValues errors;
  errors.entries = {{"identification error", Change(step.before.identification, step.after.identification)},
                    {"error on the " + HeldOutName(result), Change(step.before.validation, step.after.validation)}};
  section.blocks.emplace_back(std::move(errors));
  section.blocks.emplace_back(Paragraph{"How sure: " + OnPage(EvidenceSentence(result, step)) + "."});
  section.blocks.emplace_back(Paragraph{"Rivals: " + RivalSentence(step) + "."});
  section.blocks.emplace_back(
      Paragraph{"To confirm at the robot: " + step.effect.effect->how_to_confirm(), Paragraph::Kind::kNote});
  Table table;
  table.caption = "Its parameters in the final model";
  table.columns = {{"parameter"},
                   {"value", Table::Align::kNumber},
                   {"σ", Table::Align::kNumber},
                   {"95 % from", Table::Align::kNumber},
                   {"to", Table::Align::kNumber},
                   {"unit"}};
  for (const ParameterEstimate& p : EffectEstimates(result, step.effect)) {
    table.rows.push_back({p.parameter.name, Format("%.4g", p.value), Format("%.2g", p.standard_deviation),
                          Format("%.4g", p.interval95[0]), Format("%.4g", p.interval95[1]), p.parameter.unit});
  }
  if (!table.rows.empty()) section.blocks.emplace_back(std::move(table));
  if (!step.ranking.empty()) section.blocks.emplace_back(FigureGrid{1, {Ranking(step)}});
  return section;
}

Section AddedParameters(const LoopResult& result) {
  Section section;
  section.title = "Added parameters";
  std::vector<ParameterEstimate> all;
  for (const LoopStep& step : result.steps) {
    for (ParameterEstimate& p : EffectEstimates(result, step.effect)) {
      if (p.value != 0.0) all.push_back(std::move(p));
    }
  }
  if (all.empty()) return section;
  const auto count = static_cast<Index>(all.size());
  IntervalFigure figure;
  figure.title = "Estimates and 95 % intervals, divided by the estimate";
  figure.value_title = "relative to the estimate; an interval that reaches 0 leaves the sign open";
  figure.scale = IntervalFigure::Scale::kRelativeToFirst;
  figure.limits = std::make_pair(-1.0, 3.0);
  IntervalFigure::Estimates set{"final model", VectorXd(count), VectorXd(count), VectorXd(count), kAfter};
  for (Index k = 0; k < count; ++k) {
    const ParameterEstimate& p = all[static_cast<size_t>(k)];
    figure.parameters.push_back(p.parameter.name);
    set.value[k] = p.value;
    set.lower[k] = p.interval95[0];
    set.upper[k] = p.interval95[1];
  }
  figure.sets.push_back(std::move(set));
  section.blocks.emplace_back(FigureGrid{1, {std::move(figure)}});
  return section;
}

// Gains and what moved, declared and final side by side, divided by the declared.
Section Moved(const LoopResult& result) {
  Section section;
  section.title = "What moved when the effects were added";
  const std::vector<Movement> movements = Movements(result);
  std::vector<Movement> shown;
  for (const ParameterEstimate& before : result.before.estimate.parameters) {
    const ParameterEstimate* after = result.after.estimate.Find(before.parameter.name);
    if (before.parameter.kind == ParameterKind::kDriveGain && after != nullptr) shown.push_back({before, *after});
  }
  for (const Movement& m : movements) {
    if (m.before.parameter.kind != ParameterKind::kDriveGain) shown.push_back(m);
  }
  section.blocks.emplace_back(Paragraph{
      movements.empty() ? "No parameter left the 95 % interval that the declared model gave it."
                        : Format("%d parameter%s left the 95 %% interval that the declared model gave %s: what a model "
                                 "lacks is taken up by what it has.",
                                 static_cast<int>(movements.size()), movements.size() == 1 ? "" : "s",
                                 movements.size() == 1 ? "it" : "them")});
  if (shown.empty()) return section;
  Table table;
  table.caption = "The drive gains where they are identified, and what left its interval";
  table.columns = {{"parameter"},
                   {"declared model", Table::Align::kNumber},
                   {"σ", Table::Align::kNumber},
                   {"final model", Table::Align::kNumber},
                   {"σ", Table::Align::kNumber},
                   {"unit"}};
  IntervalFigure figure;
  figure.title = "Estimates and 95 % intervals, divided by the declared model's";
  figure.value_title = "relative to the declared model's";
  figure.scale = IntervalFigure::Scale::kRelativeToFirst;
  figure.limits = std::make_pair(-1.0, 3.0);
  const auto count = static_cast<Index>(shown.size());
  IntervalFigure::Estimates before{"declared model", VectorXd(count), VectorXd(count), VectorXd(count), kBefore};
  IntervalFigure::Estimates after{"final model", VectorXd(count), VectorXd(count), VectorXd(count), kAfter};
  for (Index k = 0; k < count; ++k) {
    const Movement& m = shown[static_cast<size_t>(k)];
    figure.parameters.push_back(m.before.parameter.name);
    before.value[k] = m.before.value, after.value[k] = m.after.value;
    before.lower[k] = m.before.interval95[0], after.lower[k] = m.after.interval95[0];
    before.upper[k] = m.before.interval95[1], after.upper[k] = m.after.interval95[1];
    table.rows.push_back({m.before.parameter.name, Format("%.4g", m.before.value),
                          Format("%.2g", m.before.standard_deviation), Format("%.4g", m.after.value),
                          Format("%.2g", m.after.standard_deviation), m.before.parameter.unit});
  }
  figure.sets = {std::move(before), std::move(after)};
  section.blocks.emplace_back(std::move(table));
  section.blocks.emplace_back(FigureGrid{1, {std::move(figure)}});
  return section;
}

Section Left(const LoopResult& result) {
  Section section;
  section.title = "What is left";
  if (result.unexplained.empty()) {
    section.blocks.emplace_back(
        Paragraph{"The final residual depends on no position, velocity, acceleration, torque or time that was tried, "
                  "alone or in pairs."});
  }
  for (const Unexplained& u : result.unexplained) {
    section.blocks.emplace_back(Paragraph{UnexplainedSentence(u), Paragraph::Kind::kWarning});
  }
  return section;
}

}  // namespace

std::string RenderLoopReport(const LoopResult& result) {
  Report report;
  report.title = result.prepared.robot().name;
  report.subtitle = "What the declared model lacks";
  report.sections.push_back(Summary(result));
  if (result.before.series.empty()) return RenderReport(report);
  const auto add = [&](Section section) {
    if (!section.blocks.empty()) report.sections.push_back(std::move(section));
  };
  for (size_t k = 0; k < result.steps.size(); ++k) add(Step(result, result.steps[k], k + 1));
  add(FrictionSection(result));
  add(OtherEffectsSection(result));
  add(AddedParameters(result));
  if (!result.steps.empty()) add(Moved(result));
  add(Left(result));
  for (Section& section : ResidualSections(result)) add(std::move(section));
  return RenderReport(report);
}

}  // namespace idim
