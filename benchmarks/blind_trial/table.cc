#include "benchmarks/blind_trial/table.h"

#include <algorithm>
#include <cstdio>
#include <map>
#include <string>

#include "core/base/text.h"

namespace idim::blind_trial {
namespace {

std::string List(const std::vector<std::string>& names) { return names.empty() ? "-" : Join(names, ", "); }

constexpr double kWorthFinding = 3.0;  // [%]

struct Tally {
  int planted = 0, worth = 0, worth_found = 0, worth_joint = 0, worth_id = 0, found = 0;
};

}  // namespace

void PrintCase(int number, const Case& c) {
  std::string planted;
  for (const Planted& p : c.planted) {
    planted += (planted.empty() ? "" : ", ") + Title(p.effect) +
               Format(" (share %.3f, worth %.1f %%%s)", p.share, p.worth, p.found ? "" : ", MISSED");
  }
  std::printf("%4d %s %s\n       found %s; held out %.3f -> %.3f, truth %.3f %%; unexplained: %s; %.1f s\n", number,
              c.identify ? "g" : " ", planted.empty() ? "none" : planted.c_str(), List(c.found).c_str(), c.before,
              c.after, c.truth, List(c.unexplained).c_str(), c.seconds);
  for (const std::string& name : c.false_alarms) std::printf("       FALSE ALARM %s\n", name.c_str());
  for (const std::string& text : c.dropped) std::printf("       dropped: %s\n", text.c_str());
  if (!c.problem.empty()) std::printf("       PROBLEM %s\n", c.problem.c_str());
}

void PrintSummary(const std::vector<Case>& cases) {
  std::map<std::string, Tally> by_id;
  Tally all;
  int none = 0, alarmed_none = 0, alarmed = 0, run = 0, close = 0, problems = 0;
  double before = 0.0, after = 0.0, truth = 0.0, seconds = 0.0;
  std::vector<double> ratio;
  for (const Case& c : cases) {
    problems += !c.problem.empty();
    if (!(c.truth > 0.0)) continue;
    ++run;
    seconds += c.seconds;
    before += c.before, after += c.after, truth += c.truth;
    none += c.planted.empty();
    alarmed_none += c.planted.empty() && !c.false_alarms.empty();
    alarmed += !c.planted.empty() && !c.false_alarms.empty();
    ratio.push_back(c.after / c.truth);
    close += ratio.back() <= 1.03;
    for (const Planted& p : c.planted) {
      for (Tally* t : {&by_id[p.effect.equation->id()], &all}) {
        ++t->planted;
        t->found += p.found;
        if (p.worth <= kWorthFinding) continue;
        ++t->worth;
        t->worth_found += p.found;
        t->worth_joint += p.joint;
        t->worth_id += p.id;
      }
    }
  }
  std::printf("\n%-22s %8s %8s | worth more than %.0f %%: %6s %6s %6s %6s\n", "id", "planted", "found", kWorthFinding,
              "cases", "both", "joint", "id");
  const auto row = [](const std::string& id, const Tally& t) {
    std::printf("%-22s %8d %8d | %22s %6d %6d %6d %6d\n", id.c_str(), t.planted, t.found, "", t.worth, t.worth_found,
                t.worth_joint, t.worth_id);
  };
  for (const auto& [id, tally] : by_id) row(id, tally);
  row("all", all);
  if (run == 0) return;
  std::sort(ratio.begin(), ratio.end());
  std::printf("\n%d cases run, %d with a problem; %.1f s each\n", run, problems, seconds / run);
  std::printf("without effect: %d, of which with a false alarm %d\n", none, alarmed_none);
  std::printf("with effects: %d, of which with one more that was not simulated %d\n", run - none, alarmed);
  std::printf("held-out error, mean: before %.3f, after %.3f, truth known %.3f %%\n", before / run, after / run,
              truth / run);
  std::printf("after / truth: median %.4f, 90th percentile %.4f, largest %.4f; within 3 %%: %d of %d\n",
              ratio[ratio.size() / 2], ratio[ratio.size() * 9 / 10], ratio.back(), close, run);
}

}  // namespace idim::blind_trial
