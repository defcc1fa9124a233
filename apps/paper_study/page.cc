#include "apps/paper_study/page.h"

#include <glog/logging.h>

#include <cmath>
#include <cstdio>
#include <functional>
#include <utility>

namespace idim {
namespace {

using Cells = std::vector<std::string>;

std::string Format(const char* format, double value) {
  char buffer[64];
  std::snprintf(buffer, sizeof(buffer), format, value);
  const std::string text(buffer);
  // A zero has no sign.
  const bool zero = text.find_first_of("123456789") == std::string::npos;
  return zero && (text[0] == '-' || text[0] == '+') ? text.substr(1) : text;
}
std::string Fixed2(double value) { return Format("%.2f", value); }
std::string Value(double value) { return Format("%.2e", value); }

class MarkdownTable {
 public:
  explicit MarkdownTable(const Cells& header) : columns_(header.size()) {
    Row(header);
    text_ += "|";
    for (size_t c = 0; c < columns_; ++c) text_ += c == 0 ? "---|" : "---:|";
    text_ += "\n";
  }
  void Row(const Cells& cells) {
    CHECK_EQ(cells.size(), columns_);
    text_ += "|";
    for (const std::string& cell : cells) text_ += (cell.empty() ? " " : " " + cell + " ") + "|";
    text_ += "\n";
  }
  std::string text() const { return text_ + "\n"; }

 private:
  size_t columns_;
  std::string text_;
};

void Append(Cells* cells, const Cells& more) { cells->insert(cells->end(), more.begin(), more.end()); }

std::string Heading(const std::string& title) { return "## " + title + "\n\n"; }

double Truth(const PaperStudy& paper, const std::string& name) {
  const Reference::Entry* entry = paper.truth.Find(name);
  CHECK(entry != nullptr) << name;
  return entry->value;
}

int RowOf(const PaperTable& table, const std::string& parameter) {
  for (size_t r = 0; r < table.rows.size(); ++r) {
    if (table.Cell(static_cast<int>(r), "parameter") == parameter) return static_cast<int>(r);
  }
  return -1;
}

std::string OrDash(const std::string& cell) { return cell.empty() ? "–" : cell; }

// Tables I and III. Rows: what the paper or one of the two cases keeps, and the payload.
std::string ParameterTable(const PaperStudy& paper, const PaperTable& table, int ten, int mass,
                           const PaperTable& errors) {
  MarkdownTable out({"parameter", "truth", "paper, ten known", "%σ", "idim", "%σ", "paper, mass known", "%σ", "%e",
                     "idim", "%σ", "%e"});
  double sum = 0.0, paper_sum = 0.0;
  int count = 0, paper_count = 0;
  for (const Reference::Entry& entry : paper.truth.parameters) {
    if (entry.name[0] == 'g') continue;
    const int row = RowOf(table, entry.name);
    const ParameterEstimate* one = paper.cases[ten].estimate.Find(entry.name);
    const ParameterEstimate* two = paper.cases[mass].estimate.Find(entry.name);
    const bool payload = entry.name.back() == '7';
    if (row < 0 && one == nullptr && two == nullptr) continue;
    const auto cell = [&](const char* column) { return row < 0 ? "–" : OrDash(table.Cell(row, column)); };
    // What the first case knows or finds, and the difference of the second to it.
    const double first = payload ? entry.value : one != nullptr ? one->value : 0.0;
    std::string difference = "–";
    if (two != nullptr && first != 0.0) {
      const double percent = 100.0 * std::abs((first - two->value) / first);
      difference = Fixed2(percent);
      sum += percent;
      ++count;
    }
    if (row >= 0 && !table.Cell(row, "difference_percent").empty()) {
      paper_sum += table.Number(row, "difference_percent");
      ++paper_count;
    }
    const bool known = payload && two == nullptr && entry.name == "M7";
    Cells cells = {entry.name, Value(entry.value), cell("ten_known_value"), cell("ten_known_relative_std_percent")};
    if (payload) {
      Append(&cells, {"known", "–"});
    } else {
      Append(&cells, {one ? Value(one->value) : "–", one ? Fixed2(one->RelativeSigmaPercent()) : "–"});
    }
    Append(&cells, {cell("mass_known_value"), cell("mass_known_relative_std_percent"), cell("difference_percent"),
                    known ? "known" : (two ? Value(two->value) : "–"), two ? Fixed2(two->RelativeSigmaPercent()) : "–",
                    difference});
    out.Row(cells);
  }
  const auto error = [&](int c) { return Fixed2(paper.cases[c].estimate.relative_error_percent) + " %"; };
  const auto printed = [&](int c) { return errors.Cell(c - kCase1, "relative_error_percent") + " %"; };
  return out.text() + "Relative error norm ‖ρ‖/‖Y‖: ten known, paper " + printed(ten) + ", idim " + error(ten) +
         "; mass known, paper " + printed(mass) + ", idim " + error(mass) + ". Mean %e: paper " +
         Fixed2(paper_sum / paper_count) + ", idim " + Fixed2(sum / count) + ".\n\n";
}

// Tables II and IV, with the error against the truth that only a simulation can give.
std::string GainTable(const PaperStudy& paper, const PaperTable& table, const std::string& method, int ten, int mass) {
  MarkdownTable out({"i", "a priori", "paper, ten known", "%σ", "%e", "idim", "%σ", "%e", "paper, mass known", "%σ",
                     "%e", "idim", "%σ", "%e", "truth", "idim, ten − truth, %", "idim, mass − truth, %"});
  double sums[4] = {};
  for (int j = 0; j < 6; ++j) {
    const double prior = table.Number(j, "a_priori");
    const auto difference = [&](double value, double* sum) {
      const double percent = 100.0 * std::abs((value - prior) / prior);
      *sum += percent / 6.0;
      return Fixed2(percent);
    };
    const std::string name = "g" + std::to_string(j + 1);
    const double truth = Truth(paper, name);
    Cells cells = {std::to_string(j + 1), table.Cell(j, "a_priori")};
    Cells wrong = {Fixed2(truth)};
    for (int k = 0; k < 2; ++k) {
      const std::string column = method + (k == 0 ? "_ten_known" : "_mass_known");
      const ParameterEstimate* gain = paper.cases[k == 0 ? ten : mass].estimate.Find(name);
      CHECK(gain != nullptr) << name;
      Append(&cells,
             {table.Cell(j, column), table.Cell(j, column + "_rsd"), difference(table.Number(j, column), &sums[2 * k]),
              Fixed2(gain->value), Fixed2(gain->RelativeSigmaPercent()), difference(gain->value, &sums[2 * k + 1])});
      wrong.push_back(Format("%+.1f", 100.0 * (gain->value / truth - 1.0)));
    }
    Append(&cells, wrong);
    out.Row(cells);
  }
  return out.text() + "%e: difference to the a priori value. Mean %e: ten known, paper " + Fixed2(sums[0]) + ", idim " +
         Fixed2(sums[1]) + "; mass known, paper " + Fixed2(sums[2]) + ", idim " + Fixed2(sums[3]) + ".\n\n";
}

std::string ScaledTable(const PaperStudy& paper) {
  MarkdownTable out({"parameter", "truth", "value", "%σ", "difference, standard deviations"});
  for (const ParameterEstimate& p : paper.cases[kScaled].estimate.parameters) {
    const double truth = Truth(paper, p.parameter.name);
    out.Row({p.parameter.name, Value(truth), Value(p.value), Fixed2(p.RelativeSigmaPercent()),
             Format("%+.1f", (p.value - truth) / p.standard_deviation)});
  }
  return out.text() + "Relative error norm " + Fixed2(paper.cases[kScaled].estimate.relative_error_percent) + " %.\n\n";
}

std::string ConditionTable(const PaperStudy& paper, const PaperTable& table) {
  MarkdownTable out({"", "Traj. 1", "Traj. 2", "Traj. 3"});
  Cells printed = {"paper"}, ours = {"idim"};
  for (int t = 0; t < 3; ++t) {
    printed.push_back(table.Cell(t, "condition_number"));
    ours.push_back(Format("%.0f", paper.cases[kManufacturer].validation.recordings[t].condition_number));
  }
  out.Row(printed);
  out.Row(ours);
  return out.text();
}

const std::vector<std::string>& PaperColumns() {
  static const auto* const columns = new std::vector<std::string>{"manufacturer", "case1", "case2", "case3", "case4"};
  return *columns;
}

Cells CaseHeader(const PaperStudy& paper, const std::string& first) {
  Cells header = {first};
  for (int c = 0; c < kScaled; ++c) header.push_back("paper: " + paper.cases[c].name);
  for (const PaperCase& c : paper.cases) header.push_back("idim: " + c.name);
  return header;
}

std::string ErrorTable(const PaperStudy& paper, const PaperTable& table) {
  MarkdownTable out(CaseHeader(paper, "trajectory, joint"));
  std::vector<double> means(2 * kNumPaperCases, 0.0);
  for (int row = 0; row < 18; ++row) {
    const int trajectory = row / 6, joint = row % 6;
    Cells cells = {table.Cell(row, "trajectory") + ", " + table.Cell(row, "joint")};
    for (int c = 0; c < kScaled; ++c) {
      means[c] += table.Number(row, PaperColumns()[c]) / 18.0;
      cells.push_back(table.Cell(row, PaperColumns()[c]));
    }
    for (int c = 0; c < kNumPaperCases; ++c) {
      const auto& fit = paper.cases[c].validation.recordings[trajectory].fit;
      const double error = fit->relative_error_percent[joint];
      means[kNumPaperCases + c] += error / 18.0;
      cells.push_back(Fixed2(error));
    }
    out.Row(cells);
  }
  Cells cells = {"mean"};
  for (int c = 0; c < kScaled; ++c) cells.push_back(Fixed2(means[c]));
  for (int c = 0; c < kNumPaperCases; ++c) cells.push_back(Fixed2(means[kNumPaperCases + c]));
  out.Row(cells);
  return out.text();
}

// Tables VII and VIII: rows first, first + 1, first + 2 of the CSV and of the validation recordings.
std::string MassTable(const PaperStudy& paper, const PaperTable& table, int first) {
  MarkdownTable out(CaseHeader(paper, ""));
  std::vector<double> means(2 * kNumPaperCases, 0.0);
  for (int t = 0; t < 3; ++t) {
    const double mass = table.Number(first + t, "true_mass");
    const std::string name = "traj. " + std::to_string(t + 1) + ", ";
    Cells masses = {name + "mass [kg]"}, sigmas = {name + "%σ"}, errors = {name + "%e"};
    for (int c = 0; c < kScaled; ++c) {
      const double error = 100.0 * std::abs(mass - table.Number(first + t, PaperColumns()[c])) / mass;
      means[c] += error / 3.0;
      masses.push_back(table.Cell(first + t, PaperColumns()[c]));
      sigmas.push_back(table.Cell(first + t, PaperColumns()[c] + "_rsd"));
      errors.push_back(Fixed2(error));
    }
    for (int c = 0; c < kNumPaperCases; ++c) {
      const auto& estimate = paper.cases[c].validation.recordings[first + t].mass;
      const double error = 100.0 * std::abs(mass - estimate->value) / mass;
      means[kNumPaperCases + c] += error / 3.0;
      masses.push_back(Fixed2(estimate->value));
      sigmas.push_back(Fixed2(100.0 * estimate->standard_deviation / estimate->value));
      errors.push_back(Fixed2(error));
    }
    out.Row(masses);
    out.Row(sigmas);
    out.Row(errors);
  }
  Cells cells = {"mean %e"};
  for (int c = 0; c < kScaled; ++c) cells.push_back(Fixed2(means[c]));
  for (int c = 0; c < kNumPaperCases; ++c) cells.push_back(Fixed2(means[kNumPaperCases + c]));
  out.Row(cells);
  return out.text();
}

// Torque is gain times signal, so that friction coefficients of a joint and its gain change alike from one case to the
// next, and the payload's mass with the gains of the arm.
std::string ConsistencyTable(const PaperTables& tables) {
  MarkdownTable out({"paper, mass known over ten known", "1", "2", "3", "4", "5", "6", "mean"});
  const auto row = [&](const std::string& title, const std::function<double(int)>& ratio) {
    Cells cells = {title};
    double mean = 0.0;
    for (int j = 0; j < 6; ++j) {
      mean += ratio(j) / 6.0;
      cells.push_back(Format("%.3f", ratio(j)));
    }
    cells.push_back(Format("%.3f", mean));
    out.Row(cells);
  };
  const auto viscous = [](const PaperTable& table, int j) {
    const int r = RowOf(table, "Fv" + std::to_string(j + 1));
    CHECK_GE(r, 0) << table.path;
    return table.Number(r, "mass_known_value") / table.Number(r, "ten_known_value");
  };
  const auto gain = [&](const std::string& method, int j) {
    return tables.table_2_4.Number(j, method + "_mass_known") / tables.table_2_4.Number(j, method + "_ten_known");
  };
  const auto mass = [&](const char* over, const char* under, int k) {
    return tables.table_7_8.Number(k, over) / tables.table_7_8.Number(k, under);
  };
  row("WLS: Fv of the joint (Table I)", [&](int j) { return viscous(tables.table_1, j); });
  row("WLS: gain of the joint (Table II)", [&](int j) { return gain("wls", j); });
  row("WLS: mass, case 2 over case 1 (Tables VII, VIII; by row)", [&](int k) { return mass("case2", "case1", k); });
  row("TLS: Fv of the joint (Table III)", [&](int j) { return viscous(tables.table_3, j); });
  row("TLS: gain of the joint (Table IV)", [&](int j) { return gain("tls", j); });
  row("TLS: mass, case 4 over case 3 (Tables VII, VIII; by row)", [&](int k) { return mass("case4", "case3", k); });
  return out.text();
}

std::string Percent(double value) { return std::abs(value) < 1000.0 ? Format("%+.1f", value) : "beyond 1000"; }

std::string VariantTables(const std::vector<Variant>& variants) {
  std::string text;
  for (const Variant& variant : variants) {
    text += "### " + variant.title + "\n\nThe known torque is " + Format("%.1f", 100.0 * variant.share_ten) +
            " % of all torque with ten known parameters, and " + Format("%.1f", 100.0 * variant.independent_ten) +
            " % is what nothing else can imitate; of the mass alone " + Format("%.1f", 100.0 * variant.share_mass) +
            " and " + Format("%.1f", 100.0 * variant.independent_mass) + " %.\n\n";
    MarkdownTable out(
        {"error of the gains, %", "g1", "g2", "g3", "g4", "g5", "g6", "largest spread of a draw", "‖ρ‖/‖Y‖, %"});
    for (const GainErrors& errors : variant.cases) {
      Cells cells = {errors.name};
      for (double mean : errors.mean_percent) cells.push_back(Percent(mean));
      const double spread = errors.spread_percent.maxCoeff();
      cells.push_back(spread < 1000.0 ? Format("%.1f", spread) : "beyond 1000");
      cells.push_back(Fixed2(errors.residual_percent));
      out.Row(cells);
    }
    text += out.text();
  }
  return text;
}

}  // namespace

std::vector<VariantOptions> PaperVariants() {
  std::vector<VariantOptions> variants(8);
  variants[0].title = "As in the tables: white noise on the signals";
  variants[1].title = "No noise on the signals (encoders and 0.001 steps of the signal remain)";
  variants[1].size = 0.0;
  variants[2].title = "Half the noise on the signals";
  variants[2].size = 0.5;
  variants[3].title = "Slow noise: corner at 2 Hz, as large as the white noise after decimation";
  variants[3].disturbance = Disturbance::kSlow;
  variants[4].title = "No noise but an error of the friction model, as large as the white noise after decimation";
  variants[4].disturbance = Disturbance::kFriction;
  variants[5].title = "Motion at 0.3 of the speed";
  variants[5].speed = 0.3;
  variants[6].title = "The loaded arm moves as the unloaded one";
  variants[6].same_motion = true;
  variants[7].title = "Cases with ten known parameters are told the paper's CAD values, which are not the true ones";
  variants[7].believed_ten = {0.064, -0.018, 0.026, 0.064, 0.026, 0.044, -0.29, -0.29, 0.41, 4.59};  // Table I, bold
  return variants;
}

std::string RenderPaperPage(const PaperStudy& paper, const std::vector<Variant>& variants, const PaperTables& tables,
                            const std::string& discussion) {
  const auto& recordings = paper.cases[kManufacturer].validation.recordings;
  CHECK_EQ(recordings.size(), 6u) << "three trajectories with each payload";
  std::string text = discussion;
  if (!text.empty() && text.back() != '\n') text += "\n";
  text +=
      "\n# The tables\n\nWritten by `scripts/run_paper_study.sh` from `scenario.yaml` (seeds there) and `paper/`; a "
      "test writes them again and compares. Filter: " +
      paper.prepared.data->preprocessing.reason + ". r_σ = " + Format("%.0f", kPaperRatio) +
      ". \"–\": eliminated as not essential, or not printed in the paper.\n\n";
  text += Heading("Table I: essential parameters, IDIM-WLS (cases 1 and 2)") +
          ParameterTable(paper, tables.table_1, kCase1, kCase2, tables.relative_error);
  text += Heading("Table II: drive gains, IDIM-WLS (cases 1 and 2)") +
          GainTable(paper, tables.table_2_4, "wls", kCase1, kCase2);
  text += Heading("Table III: essential parameters, IDIM-TLS, rows weighted (cases 3 and 4)") +
          ParameterTable(paper, tables.table_3, kCase3, kCase4, tables.relative_error);
  text += Heading("Table IV: drive gains, IDIM-TLS, rows weighted (cases 3 and 4)") +
          GainTable(paper, tables.table_2_4, "tls", kCase3, kCase4);
  text += Heading("Beside the paper: scaled TLS, mass known") + ScaledTable(paper);
  text += Heading("Table V: condition number of the observation matrix") + ConditionTable(paper, tables.table_5);
  text +=
      Heading("Table VI: relative error of the torque on recordings not fitted, %") + ErrorTable(paper, tables.table_6);
  text += Heading("Table VII: payload of 4.59 kg") + MassTable(paper, tables.table_7_8, 0);
  text += Heading("Table VIII: payload of 1.686 kg") + MassTable(paper, tables.table_7_8, 3);
  text += Heading("The paper's tables against each other") + ConsistencyTable(tables);
  text +=
      Heading("Other disturbances and motions") + "Mean error of the gains against the truth over " +
      std::to_string(kPaperDraws) +
      " draws of the noise; all base parameters kept. \"Weights by known gains\": rows divided by what each joint's "
      "equations leave once its gain is taken as known, in place of what the unweighted solution leaves.\n\n" +
      VariantTables(variants);
  while (text.size() > 1 && text[text.size() - 2] == '\n') text.pop_back();
  return text;
}

}  // namespace idim
