// The paper's study, whole: makes datasets/paper_study/README.md and the report
// with Fig. 2 (scripts/run_paper_study.sh).

#include <gflags/gflags.h>
#include <glog/logging.h>

#include <iostream>

#include "apps/paper_study/page.h"
#include "apps/program.h"
#include "core/base/file.h"
#include "core/effects/simulated_effects.h"

DEFINE_string(study, "datasets/paper_study",
              "Directory with scenario.yaml, discussion.md and paper/; README.md goes there");
DEFINE_string(output, "out/paper_study", "Directory for report.html");

namespace {

using idim::Status;

Status Run() {
  const idim::Result<idim::PaperTables> tables = idim::ReadPaperTables(FLAGS_study + "/paper");
  IDIM_RETURN_IF_ERROR(tables);
  const idim::Result<std::string> discussion = idim::ReadFile(FLAGS_study + "/discussion.md");
  IDIM_RETURN_IF_ERROR(discussion);
  const idim::Result<idim::Scenario> scenario =
      idim::ReadScenario(FLAGS_study + "/scenario.yaml", idim::EffectEquations());
  IDIM_RETURN_IF_ERROR(scenario);
  const idim::Result<idim::PaperStudy> paper = idim::RunPaperStudy(*scenario, idim::kPaperRatio);
  IDIM_RETURN_IF_ERROR(paper);
  std::vector<idim::Variant> variants;
  for (const idim::VariantOptions& options : idim::PaperVariants()) {
    idim::Result<idim::Variant> variant = idim::RunVariant(*paper, options, idim::kPaperDraws);
    IDIM_RETURN_IF_ERROR(variant);
    variants.push_back(std::move(variant).value());
  }
  IDIM_RETURN_IF_ERROR(idim::WriteFiles(FLAGS_output, {{"report.html", idim::RenderPaperReport(*paper)}}));
  IDIM_RETURN_IF_ERROR(
      idim::WriteFiles(FLAGS_study, {{"README.md", idim::RenderPaperPage(*paper, variants, *tables, *discussion)}}));
  std::cout << "Tables I to VIII: " << FLAGS_study << "/README.md\nFig. 2: " << FLAGS_output << "/report.html\n";
  return Status::Ok();
}

}  // namespace

int main(int argc, char** argv) {
  const idim::ProgramUsage usage = {
      "paper_study", {}, {}, "the study of Gautier & Briot (2014) on simulated recordings"};
  return idim::RunProgram(argc, argv, usage, [](const std::vector<std::string>&) { return Run(); });
}
