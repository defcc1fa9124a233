#include "core/estimate/estimate.h"

#include <boost/math/distributions/students_t.hpp>
#include <cctype>
#include <cmath>
#include <limits>

#include "core/base/text.h"

namespace idim {
double ParameterEstimate::RelativeSigmaPercent() const {
  return value == 0.0 ? std::numeric_limits<double>::infinity() : 100.0 * standard_deviation / std::abs(value);
}

const ParameterEstimate* Estimate::Find(const std::string& name) const {
  for (const ParameterEstimate& p : parameters) {
    if (p.parameter.name == name) return &p;
  }
  return nullptr;
}

void SetInterval95(double degrees_of_freedom, ParameterEstimate* estimate, double factor) {
  const double t = factor * boost::math::quantile(boost::math::students_t(degrees_of_freedom), 0.975);
  estimate->interval95[0] = estimate->value - t * estimate->standard_deviation;
  estimate->interval95[1] = estimate->value + t * estimate->standard_deviation;
}

std::string EstimatorTitle(const std::string& estimator) {
  std::string title = "IDIM-";
  for (const char c : estimator) title += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return title;
}

std::string EstimateToText(const Estimate& e, const std::string& torque_units) {
  std::string text = e.robot + ", " + EstimatorTitle(e.estimator) + "\n" + e.preprocessing + "\n";
  if (!e.start.empty()) text += e.start + "\n";
  if (!e.uncertainty.empty()) text += e.uncertainty + "\n";
  text += "\n";
  if (!e.status.ok()) text += "NOT TO BE TRUSTED: " + e.status.message() + "\n\n";
  text += "parameter      value       %std    95 % interval             unit\n";
  for (const ParameterEstimate& p : e.parameters) {
    text += Format("%-10s %+11.4e %9.2f    [%+.3e, %+.3e]  %s\n", p.parameter.name.c_str(), p.value,
                   p.RelativeSigmaPercent(), p.interval95[0], p.interval95[1], p.parameter.unit.c_str());
    if (!p.regrouping.empty()) text += "             = " + p.regrouping + "\n";
  }
  if (!e.eliminated.empty()) {
    text += "\nnot essential, set to zero:";
    for (const std::string& name : e.eliminated) text += " " + name;
    text += "\n";
  }
  text += Format("\n%d parameters, cond(W) = %.0f (weighted %.0f), relative error |rho|/|Y| = %.2f %%\n",
                 static_cast<int>(e.parameters.size()), e.condition_number, e.condition_number_weighted,
                 e.relative_error_percent);
  for (const GainDiagnosis& g : e.gain_diagnoses) text += "\n" + g.sentence;
  if (!e.gain_diagnoses.empty()) text += "\n";
  text += "\nrecording                    samples  relative error per joint, %\n";
  for (const RecordingFit& r : e.recordings) {
    text += Format("%-14s %-14s %6d ", r.name.c_str(), r.use.c_str(), r.samples);
    for (const double error : r.relative_error_percent) text += Format(" %6.2f", error);
    text += Format("   all %.2f\n", r.relative_error_percent_all);
  }
  text +=
      "\n                                      RMS torque error against the unfiltered torque, " + torque_units + "\n";
  for (const RecordingFit& r : e.recordings) {
    text += Format("%-14s %-14s        ", r.name.c_str(), r.use.c_str());
    for (const double error : r.rms_torque_unfiltered) text += Format(" %6.3f", error);
    text += "\n";
  }
  return text;
}

}  // namespace idim
