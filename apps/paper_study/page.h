// The paper's tables regenerated beside the paper's numbers: datasets/paper_study/README.md; Fig. 2 as a report.

#ifndef IDIM_APPS_PAPER_STUDY_PAGE_H_
#define IDIM_APPS_PAPER_STUDY_PAGE_H_

#include <string>
#include <vector>

#include "apps/paper_study/paper_tables.h"
#include "apps/paper_study/study.h"
#include "apps/paper_study/variants.h"

namespace idim {

// What the study on the committed page was made with.
inline constexpr double kPaperRatio = 20.0;  // r_sigma; the paper's Table III ends at 19.8 and 19.9
inline constexpr int kPaperDraws = 10;
std::vector<VariantOptions> PaperVariants();

// Markdown. discussion: what is written by hand about the numbers, put first. Deterministic.
std::string RenderPaperPage(const PaperStudy& paper, const std::vector<Variant>& variants, const PaperTables& tables,
                            const std::string& discussion);

// Fig. 2: torque by gains and signal against the model's along the first validation trajectory, and the gains of every
// case. One self-contained page.
std::string RenderPaperReport(const PaperStudy& paper);

}  // namespace idim

#endif  // IDIM_APPS_PAPER_STUDY_PAGE_H_
