#include "solvers/estimators/eiv_identification.h"

#include <glog/logging.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "core/base/decompositions.h"
#include "core/base/text.h"
#include "core/model/unknowns.h"
#include "solvers/estimators/assemble_estimate.h"
#include "solvers/estimators/closed_forms.h"
#include "solvers/estimators/estimator.h"
#include "solvers/linear/gain_identification.h"
#include "solvers/linear/least_squares.h"

namespace idim {

void AddEiv(std::vector<const Estimator*>* estimators);  // registry.cc

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// A parameter that is not essential is held at zero by a prior this much narrower than what the data say of it.
constexpr double kHeld = 1e-6;

struct Start {
  std::string name;
  VectorXd values;  // of BundleData::unknowns
};

// Values of the unknowns of a bundle by name, those of its priors where a closed form has no such unknown.
VectorXd ByName(const std::vector<Parameter>& names, const VectorXd& values, const BundleData& data) {
  std::map<std::string, double> known;
  for (const BundlePrior& prior : data.priors) known[data.unknowns[prior.unknown].name] = prior.value;
  for (size_t k = 0; k < names.size(); ++k) known[names[k].name] = values[static_cast<Index>(k)];
  VectorXd result(data.num_unknowns());
  for (int k = 0; k < result.size(); ++k) result[k] = known.at(data.unknowns[k].name);
  return result;
}

// The other unknowns of a gain system by weighted least squares at given gains: (gains, chi, chi_uL).
VectorXd AtGains(const GainSystem& system, const VectorXd& gains, const VectorXd& joint_sigma) {
  const int n = system.dof();
  TriangularFactor factor(static_cast<int>(system.unknowns.size()) + 1);
  for (int j = 0; j < n; ++j) factor.Merge(system.joints[j], 1.0 / joint_sigma[j]);
  const MatrixXd r = factor.R();
  const Index others = r.cols() - 1 - n;
  MatrixXd rows(r.rows(), others + 1);
  rows << r.middleCols(n, others), -(r.leftCols(n) * gains + r.col(r.cols() - 1));
  VectorXd values(n + others);
  values << gains, SolveLeastSquares(rows, factor.rows() - others).values;
  return values;
}

bool CanStart(const VectorXd& values, int gains) {
  return values.allFinite() && (gains == 0 || values.head(gains).cwiseAbs().minCoeff() > 0.0);
}

// One that is sound, or several of which none is.
std::vector<Start> GainStarts(const GainSystem& system, const BundleData& data, const GainSummary& wgtls) {
  std::vector<Start> starts;
  const auto add = [&](const std::string& name, const VectorXd& values) {
    if (values.size() == 0 || !CanStart(values, data.dof)) return;
    starts.push_back({name, ByName(system.unknowns, values, data)});
  };
  if (wgtls.status.ok()) {
    add("WGTLS", wgtls.values);
    if (!starts.empty()) return starts;
  }
  GainOptions closed;
  closed.estimator = GainEstimator::kWls;
  const GainSummary wls = SolveGains(system, closed);
  if (system.a_priori_gains.size() > 0) {
    add("a priori gains", AtGains(system, system.a_priori_gains, wls.joint_sigma));
  }
  add("WGTLS, which is not sound", wgtls.values);
  add("WLS", wls.values);
  return starts;
}

// The best of several starts. *report: which was taken, and whether others end elsewhere.
BundleSummary SolveFrom(const std::vector<Start>& starts, const PreparedStudy& prepared, const BundleData& data,
                        const BundleOptions& options, std::string* report) {
  std::vector<BundleSummary> summaries;
  size_t best = 0;
  for (const Start& start : starts) {
    summaries.push_back(SolveBundle(prepared.base(), data, start.values, options));
    const BundleSummary& last = summaries.back();
    const BundleSummary& so_far = summaries[best];
    const bool better = last.IsSolutionUsable() == so_far.IsSolutionUsable() ? last.deviance < so_far.deviance
                                                                             : last.IsSolutionUsable();
    if (better) best = summaries.size() - 1;
  }
  *report = "start: " + starts[best].name;
  for (size_t k = 0; k < starts.size(); ++k) {
    if (k == best) continue;
    const double above = summaries[k].deviance - summaries[best].deviance;
    if (!summaries[k].IsSolutionUsable()) {
      *report += "; from " + starts[k].name + " it does not converge";
    } else if (above > 0.01) {
      *report +=
          "; from " + starts[k].name + Format(" it ends at another minimum, of a deviance higher by %.3g", above);
    } else {
      *report += "; from " + starts[k].name + " it ends at the same minimum";
    }
  }
  *report +=
      Format("; %d iterations, %d rounds of weights", summaries[best].iterations, summaries[best].weight_iterations);
  return summaries[best];
}

// Parameters that the data cannot tell from zero beside the others, by r_sigma: from the minimum's covariance alone.
std::vector<std::string> Inessential(const BundleData& data, const BundleSummary& summary, double ratio) {
  const auto solve = [&](const std::vector<int>& kept) {
    std::vector<int> dropped;
    for (int k = 0; k < data.num_unknowns(); ++k) {
      if (!std::binary_search(kept.begin(), kept.end(), k)) dropped.push_back(k);
    }
    const MatrixXd& p = summary.covariance;
    ParameterSolution solution;
    solution.values = summary.values(kept);
    solution.covariance = p(kept, kept);
    if (dropped.empty()) return solution;
    const MatrixXd gain = p(kept, dropped) * MatrixXd(p(dropped, dropped)).inverse();
    solution.values -= gain * summary.values(dropped);
    solution.covariance -= gain * p(dropped, kept);
    return solution;
  };
  return EliminateInessential(
             data.unknowns.parameters(), ratio,
             [](const Parameter& parameter) {
               return parameter.kind == ParameterKind::kDriveGain || IsOfEffect(parameter.kind);
             },
             solve)
      .eliminated;
}

std::string Uncertainty(const BundleSummary& summary) {
  return Format(
      "standard deviations allow for residuals correlated over up to %d samples and between joints; intervals are %.1f "
      "%% wider than normal ones for that",
      summary.hac_lag, 100.0 * (summary.interval_factor - 1.0));
}

}  // namespace

bool EivOptions::IsValid(std::string* error) const {
  if (!(huber_threshold >= 0.0)) {
    *error = "huber_threshold is " + std::to_string(huber_threshold) + "; expected 0 (no loss) or more";
    return false;
  }
  if (!(max_spread_percent > 0.0)) {
    *error = "max_spread_percent is " + std::to_string(max_spread_percent) + "; expected a number above 0";
    return false;
  }
  return IsValidEssentialRatio(essential_ratio, error);
}

Result<EivFit> FitEiv(const PreparedStudy& prepared, const GainSystem* system, const EivOptions& options) {
  std::string error;
  CHECK(options.IsValid(&error)) << error;
  const bool identify = prepared.model.IdentifiesGains();
  CHECK_EQ(identify, system != nullptr);
  IDIM_RETURN_IF_ERROR(CheckValidationPayloads(prepared));
  Result<BundleData> data = BuildBundleData(prepared);
  IDIM_RETURN_IF_ERROR(data);

  EivFit fit;
  fit.data = std::move(data).value();
  Estimate& estimate = fit.header;
  std::vector<Start> starts;
  Status start_status;
  estimate = BeginEstimate(prepared, Status::Ok(), "eiv");
  if (identify) {
    GainOptions closed;
    closed.estimator = GainEstimator::kWgtls;
    const GainSummary wgtls = SolveGains(*system, closed);
    starts = GainStarts(*system, fit.data, wgtls);
    start_status = wgtls.status;
    for (const GainVerdict& verdict : wgtls.verdicts) estimate.gain_diagnoses.push_back(DescribeGain(verdict));
    estimate.condition_number = wgtls.condition_number;
  } else {
    const LinearFit wls = FitLinear(prepared, LinearOptions());
    start_status = wls.summary.status;
    if (start_status.ok()) {
      starts.push_back({"WLS", ByName(wls.unknowns.parameters(), wls.summary.values, fit.data)});
      estimate.condition_number = wls.summary.condition_number;
    }
  }
  if (starts.empty()) {
    estimate.status = fit.summary.status = start_status;
    return fit;
  }
  BundleOptions bundle;
  bundle.priors = fit.data.priors;
  bundle.huber_threshold = options.huber_threshold;
  fit.summary = SolveFrom(starts, prepared, fit.data, bundle, &estimate.start);
  if (fit.summary.IsSolutionUsable() && options.essential_ratio > 0.0) {
    const std::vector<std::string> dropped = Inessential(fit.data, fit.summary, options.essential_ratio);
    VectorXd from = fit.summary.values;
    for (int k = 0; k < fit.data.num_unknowns(); ++k) {
      if (std::find(dropped.begin(), dropped.end(), fit.data.unknowns[k].name) == dropped.end()) continue;
      bundle.priors.push_back({k, 0.0, kHeld * std::sqrt(fit.summary.covariance(k, k))});
      from[k] = 0.0;
    }
    fit.summary = SolveBundle(prepared.base(), fit.data, from, bundle);
    estimate.eliminated = dropped;
  }
  estimate.status = fit.summary.status;
  if (identify && estimate.status.ok()) {
    const std::string why =
        ReasonsAgainstGains(fit.summary.values.head(fit.data.num_gains()), fit.summary.robust_covariance,
                            system->a_priori_gains, options.max_spread_percent);
    if (!why.empty()) estimate.status = Status::Untrusted("gains that cannot be trusted: " + why);
  }
  return fit;
}

FitSummary SummaryOf(const BundleData& data, const BundleSummary& summary, const Estimate& header) {
  FitSummary fit;
  fit.header = header;
  fit.unknowns = data.unknowns;
  if (summary.robust_covariance.size() == 0) return fit;
  fit.values = summary.values;
  fit.covariance = summary.robust_covariance;
  fit.model_covariance = summary.model_covariance;
  fit.degrees_of_freedom = summary.degrees_of_freedom;
  fit.interval_factor = summary.interval_factor;
  fit.header.uncertainty = Uncertainty(summary);
  fit.header.condition_number_weighted = summary.condition_number;
  fit.header.signal_noise_decimated = summary.signal_sigma;
  return fit;
}

Result<FitSummary> SummarizeEiv(const PreparedStudy& prepared, const GainSystem* system, const EivOptions& options) {
  const Result<EivFit> fit = FitEiv(prepared, system, options);
  IDIM_RETURN_IF_ERROR(fit);
  return SummaryOf(fit->data, fit->summary, fit->header);
}

Result<Identification> IdentifyEiv(const PreparedStudy& prepared, const GainSystem* system, const EivOptions& options) {
  const Result<FitSummary> fit = SummarizeEiv(prepared, system, options);
  IDIM_RETURN_IF_ERROR(fit);
  return ToIdentification(prepared, *fit);
}

namespace {

class Eiv : public Estimator {
 public:
  std::string name() const override { return "eiv"; }
  bool Takes(GainsMode) const override { return true; }
  bool has_robust_loss() const override { return true; }
  bool IsValid(const EstimatorOptions& options, std::string* error) const override {
    return OptionsOf(options).IsValid(error);
  }
  Result<FitSummary> Fit(const PreparedStudy& prepared, const GainSystem* system,
                         const EstimatorOptions& options) const override {
    return SummarizeEiv(prepared, system, OptionsOf(options));
  }

 private:
  static EivOptions OptionsOf(const EstimatorOptions& options) {
    EivOptions eiv;
    eiv.essential_ratio = options.essential_ratio;
    eiv.huber_threshold = options.huber_threshold;
    return eiv;
  }
};

}  // namespace

void AddEiv(std::vector<const Estimator*>* estimators) { estimators->push_back(new Eiv()); }

}  // namespace idim
