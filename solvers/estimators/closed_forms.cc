#include "solvers/estimators/closed_forms.h"

#include <glog/logging.h>

#include <string>
#include <vector>

#include "core/model/sample_stream.h"
#include "solvers/estimators/assemble_estimate.h"
#include "solvers/estimators/estimator.h"
#include "solvers/linear/least_squares.h"

namespace idim {

void AddClosedForms(std::vector<const Estimator*>* estimators);  // registry.cc

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

void AddRecording(const PreparedStudy& prepared, const Unknowns& unknowns, int recording, LinearSystem* system) {
  const int n = unknowns.dof(), torque = unknowns.num_columns();
  Observation::RowMajorMatrix rows = Observation::RowMajorMatrix::Zero(n, torque + 1);
  StreamSamples(prepared, unknowns, recording, [&](const Sample& sample) {
    rows.leftCols(torque) = sample.columns;
    const MatrixXd signal = sample.signal.transpose();
    rows.col(torque) = prepared.data->drive.Torque(prepared.model.gains, signal).transpose();
    rows.col(torque) -= sample.known;
    for (int j = 0; j < n; ++j) system->joints[j].AddRow(rows.row(j));
  });
}

// Standard deviation of each joint's torque by the a priori noise of the signals, at the recorded rate; empty where
// there is none. Decimation divides that of all joints by the same number, and only ratios count as weights.
VectorXd APrioriSigma(const Data& data, const VectorXd& gains) {
  const VectorXd& noise = data.request.signal_noise;
  if (noise.size() == 0) return VectorXd();
  return (data.drive.Matrix(gains).cwiseAbs2() * noise.cwiseAbs2()).cwiseSqrt();
}

// n x columns: the same for each column of a GainSystem, of which the signals' alone are noisy; only ratios count.
MatrixXd APrioriColumnNoise(const Data& data, int columns) {
  const VectorXd& of_signal = data.request.signal_noise;
  if (of_signal.size() == 0) return MatrixXd();
  const int n = data.drive.dof();
  MatrixXd noise = MatrixXd::Zero(n, columns);
  noise.leftCols(n) = data.drive.Matrix().cwiseAbs() * of_signal.asDiagonal();
  return noise;
}

// The model with its gains taken for known, where they are values to be taken.
Model WithKnownGains(const Model& model) {
  Model known = model;
  known.gains_mode = GainsMode::kKnown;
  return known;
}

}  // namespace

LinearFit FitLinear(const PreparedStudy& prepared, const LinearOptions& options) {
  LinearFit fit;
  fit.unknowns = Unknowns(WithKnownGains(prepared.model), UncertainPayload::kExact);
  LinearSystem system(fit.unknowns.parameters(), fit.unknowns.dof());
  for (const int r : prepared.model.RecordingsFor(Use::kIdentification)) {
    AddRecording(prepared, fit.unknowns, r, &system);
  }
  LinearOptions used = options;
  if (used.a_priori_sigma.size() == 0) used.a_priori_sigma = APrioriSigma(*prepared.data, prepared.model.gains);
  fit.summary = SolveLinear(system, used);
  return fit;
}

Result<FitSummary> SummarizeLinear(const PreparedStudy& prepared, const LinearOptions& options) {
  if (prepared.model.IdentifiesGains()) {
    return Status::BadInput(prepared.path() +
                            ": key 'gains.mode': 'identify' asks for drive gains, which this estimator "
                            "takes as known; expected 'known' with values");
  }
  IDIM_RETURN_IF_ERROR(CheckValidationPayloads(prepared));
  const auto [unknowns, summary] = FitLinear(prepared, options);
  FitSummary fit;
  fit.unknowns = unknowns;
  fit.header = BeginEstimate(prepared, summary.status, options.weighted ? "wls" : "ls");
  if (!summary.IsSolutionUsable()) return fit;
  fit.header.eliminated = summary.eliminated;
  fit.header.condition_number = summary.condition_number;
  fit.header.condition_number_weighted = summary.condition_number_solved;
  fit.values = summary.values;
  fit.covariance = summary.covariance;
  fit.degrees_of_freedom = static_cast<double>(summary.degrees_of_freedom);
  return fit;
}

Result<Identification> IdentifyLinear(const PreparedStudy& prepared, const LinearOptions& options) {
  const Result<FitSummary> fit = SummarizeLinear(prepared, options);
  IDIM_RETURN_IF_ERROR(fit);
  return ToIdentification(prepared, *fit);
}

Result<FitSummary> SummarizeGains(const PreparedStudy& prepared, const GainSystem& system, const GainOptions& options) {
  IDIM_RETURN_IF_ERROR(CheckValidationPayloads(prepared));
  FitSummary fit;
  fit.unknowns = Unknowns(prepared.model, UncertainPayload::kExact);
  GainOptions used = options;
  if (used.column_noise.size() == 0) used.column_noise = APrioriColumnNoise(*prepared.data, fit.unknowns.size() + 1);
  const GainSummary summary = SolveGains(system, used);

  fit.header = BeginEstimate(prepared, summary.status, GainEstimatorName(options.estimator));
  for (const GainVerdict& verdict : summary.verdicts) fit.header.gain_diagnoses.push_back(DescribeGain(verdict));
  fit.header.singular_values = summary.singular_values;
  if (summary.values.size() == 0) return fit;
  fit.header.eliminated = summary.eliminated;
  fit.header.condition_number = summary.condition_number;
  fit.header.condition_number_weighted = summary.condition_number_solved;
  fit.values = summary.values;
  fit.covariance = summary.covariance;
  fit.degrees_of_freedom = static_cast<double>(summary.degrees_of_freedom);
  return fit;
}

Result<Identification> IdentifyGains(const PreparedStudy& prepared, const GainSystem& system,
                                     const GainOptions& options) {
  const Result<FitSummary> fit = SummarizeGains(prepared, system, options);
  IDIM_RETURN_IF_ERROR(fit);
  return ToIdentification(prepared, *fit);
}

namespace {

// Least squares where gains are known, and least or total least squares where they are identified.
class ClosedForm : public Estimator {
 public:
  explicit ClosedForm(GainEstimator estimator) : estimator_(estimator) {}

  std::string name() const override { return GainEstimatorName(estimator_); }
  bool Takes(GainsMode mode) const override {
    return mode == GainsMode::kIdentify || estimator_ == GainEstimator::kLs || estimator_ == GainEstimator::kWls;
  }
  bool IsValid(const EstimatorOptions& options, std::string* error) const override {
    return IsValidEssentialRatio(options.essential_ratio, error);
  }
  Result<FitSummary> Fit(const PreparedStudy& prepared, const GainSystem* system,
                         const EstimatorOptions& options) const override {
    if (prepared.model.IdentifiesGains()) {
      GainOptions gains;
      gains.estimator = estimator_;
      gains.essential_ratio = options.essential_ratio;
      return SummarizeGains(prepared, *CHECK_NOTNULL(system), gains);
    }
    LinearOptions linear;
    linear.weighted = estimator_ == GainEstimator::kWls;
    linear.essential_ratio = options.essential_ratio;
    return SummarizeLinear(prepared, linear);
  }

 private:
  const GainEstimator estimator_;
};

}  // namespace

void AddClosedForms(std::vector<const Estimator*>* estimators) {
  for (const GainEstimator estimator : {GainEstimator::kLs, GainEstimator::kWls, GainEstimator::kTls,
                                        GainEstimator::kWtls, GainEstimator::kGtls, GainEstimator::kWgtls}) {
    estimators->push_back(new ClosedForm(estimator));
  }
}

}  // namespace idim
