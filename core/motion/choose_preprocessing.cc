#include "core/motion/choose_preprocessing.h"

#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "core/signal/smoothing_spline.h"
#include "core/signal/spectrum.h"

namespace idim {
namespace {

constexpr double kHighestCutoff = 0.4;  // of the sampling rate
constexpr double kLowestFactor = 5;     // of the bandwidth
constexpr double kHighestFactor = 20;
constexpr double kMotionShare = 0.999;
constexpr double kWorstGap = 5;  // nominal steps
constexpr int kFewestSamples = 64;

struct Band {
  double bandwidth = 0;  // [Hz], 0: no joint moves
  double crossing = 0;   // [Hz]
};

// `density` of the position at the `frequency`s; `usable` of them stand for the position, the upper half for its noise.
Band AnalyzeJoint(const Eigen::VectorXd& frequency, const Eigen::VectorXd& density, Eigen::Index usable) {
  std::vector<double> upper(density.data() + usable / 2, density.data() + usable);
  const auto middle = upper.begin() + static_cast<std::ptrdiff_t>(upper.size() / 2);
  std::nth_element(upper.begin(), middle, upper.end());
  const double floor = *middle;

  Eigen::Index crossing = 1;
  for (; crossing < usable / 2; ++crossing) {
    // A third of an octave about it and at least five bins, against the scatter of the estimate.
    const Eigen::Index reach = std::max<Eigen::Index>(2, crossing / 8);
    const Eigen::Index begin = std::max<Eigen::Index>(1, crossing - reach);
    const Eigen::Index end = std::min(usable, crossing + reach + 1);
    if (density.segment(begin, end - begin).mean() <= 2.0 * floor) break;
  }
  Band band;
  if (crossing <= 1) return band;
  band.crossing = frequency[crossing];
  const auto power = [&](Eigen::Index b) { return frequency[b] * frequency[b] * std::max(0.0, density[b] - floor); };
  double total = 0;
  for (Eigen::Index b = 1; b < crossing; ++b) total += power(b);
  double sum = 0;
  Eigen::Index b = 0;
  while (b + 1 < crossing && sum < kMotionShare * total) sum += power(++b);
  band.bandwidth = frequency[b];
  return band;
}

Result<Band> AnalyzeRecording(const Recording& recording, const Clock& clock) {
  Eigen::MatrixXd q;
  double usable_share = 1.0;  // of the Nyquist frequency
  if (clock.uniform) {
    q = recording.q;
  } else {
    // At 0.6 of the Nyquist frequency a spline with its cut-off at 0.8 of it still passes 91 %.
    usable_share = 0.6;
    const Result<SmoothingSpline> spline = SmoothingSpline::Create(recording.t, 4, kHighestCutoff / clock.step);
    IDIM_RETURN_IF_ERROR(spline);
    const Eigen::Index n = 1 + static_cast<Eigen::Index>(std::floor((clock.end - clock.start) / clock.step));
    const Eigen::VectorXd grid =
        Eigen::VectorXd::LinSpaced(n, clock.start, clock.start + static_cast<double>(n - 1) * clock.step);
    q = spline->Evaluate(spline->Fit(recording.q), grid, 0);
  }
  const Eigen::Index n = q.rows() - 2;
  const Eigen::MatrixXd difference = q.topRows(n) - 2.0 * q.middleRows(1, n) + q.bottomRows(n);
  int length = 8192;
  while (length > n / 4 && length > 16) length /= 2;
  const Spectrum spectrum = WelchSpectrum(difference, clock.step, length);
  const Eigen::ArrayXd gain = (2.0 * (M_PI * clock.step * spectrum.frequency.array()).sin()).pow(4);
  const Eigen::Index usable = static_cast<Eigen::Index>(usable_share * static_cast<double>(spectrum.frequency.size()));

  Band band;
  std::vector<double> bandwidths;
  for (Eigen::Index j = 0; j < q.cols(); ++j) {
    Eigen::VectorXd density = Eigen::VectorXd::Zero(gain.size());
    density.tail(gain.size() - 1) = spectrum.density.col(j).array().tail(gain.size() - 1) / gain.tail(gain.size() - 1);
    if (!(density.maxCoeff() > 0)) continue;  // never moves
    const Band joint = AnalyzeJoint(spectrum.frequency, density, usable);
    if (!(joint.bandwidth > 0)) continue;
    bandwidths.push_back(joint.bandwidth);
    band.crossing = std::max(band.crossing, joint.crossing);
  }
  if (!bandwidths.empty()) {
    std::sort(bandwidths.begin(), bandwidths.end());
    band.bandwidth = bandwidths[bandwidths.size() / 2];
  }
  return band;
}

double TwoDigits(double x) {
  const double unit = std::pow(10.0, std::floor(std::log10(x)) - 1.0);
  // Divided by the reciprocal where that is a whole number, so that 9.8 is the double that prints as 9.8.
  return unit < 1.0 ? std::round(x / unit) / std::round(1.0 / unit) : std::round(x / unit) * unit;
}

}  // namespace

Result<Preprocessing> ChoosePreprocessing(const std::vector<const Recording*>& recordings,
                                          const PreprocessingRequest& request, const PreprocessingOptions& options) {
  CHECK(!recordings.empty());
  Preprocessing chosen;
  chosen.options = options;
  std::string error;
  if (!options.IsValid(&error)) return Status::BadInput(error);
  if (request.decimation && *request.decimation < 1) {
    return Status::BadInput("decimation is " + std::to_string(*request.decimation) + ", must be at least 1");
  }

  std::vector<Clock> clocks;
  double rate = 0, gap = 0;
  for (const Recording* recording : recordings) {
    clocks.push_back(AnalyzeClock(recording->t, options.clock_tolerance));
    const Clock& clock = clocks.back();
    if (rate == 0 || clock.rate() < rate) rate = clock.rate();
    gap = std::max(gap, clock.max_step);
  }

  std::ostringstream reason;
  if (request.cutoff_hz) {
    chosen.cutoff_hz = *request.cutoff_hz;
    if (!(chosen.cutoff_hz > 0 && chosen.cutoff_hz < 0.5 * rate)) {
      std::ostringstream message;
      message << "cutoff_hz is " << chosen.cutoff_hz << ", must be positive and below half the sampling rate of "
              << rate << " Hz";
      return Status::BadInput(message.str());
    }
    reason << "cut-off " << chosen.cutoff_hz << " Hz as requested";
  } else {
    Band band;
    for (size_t r = 0; r < recordings.size(); ++r) {
      const Recording& recording = *recordings[r];
      const Clock& clock = clocks[r];
      std::ostringstream message;
      message << "recording '" << recording.name << "': ";
      if (recording.samples() < kFewestSamples) {
        message << "has " << recording.samples() << " samples, a cut-off frequency can be chosen from "
                << kFewestSamples << " or more";
        return Status::BadInput(message.str());
      }
      if (clock.max_step > kWorstGap * clock.step) {
        message << "a gap of " << clock.max_step << " s without samples after t = " << recording.t[clock.longest]
                << " s, more than " << kWorstGap << " times the median step of " << clock.step << " s";
        return Status::BadInput(message.str());
      }
      const Result<Band> one = AnalyzeRecording(recording, clock);
      if (!one.ok()) {
        message << one.status().message();
        return Status::BadInput(message.str());
      }
      band.bandwidth = std::max(band.bandwidth, one->bandwidth);
      band.crossing = std::max(band.crossing, one->crossing);
    }
    if (!(band.bandwidth > 0)) return Status::BadInput("no cut-off frequency can be chosen: no joint moves");

    double cutoff = band.crossing;
    reason << "motion meets the encoder noise at " << TwoDigits(band.crossing)
           << " Hz, 99.9 % of the velocity's power is below " << TwoDigits(band.bandwidth) << " Hz: cut-off ";
    std::ostringstream why;
    if (cutoff > kHighestFactor * band.bandwidth) {
      cutoff = kHighestFactor * band.bandwidth;
      why << "limited to " << kHighestFactor << " times the latter";
    } else if (cutoff < kLowestFactor * band.bandwidth) {
      cutoff = kLowestFactor * band.bandwidth;
      why << "raised to " << kLowestFactor << " times the latter";
    } else {
      why << "there";
    }
    if (cutoff > kHighestCutoff * rate) {
      cutoff = kHighestCutoff * rate;
      why.str("");
      why << "limited to " << kHighestCutoff << " of the sampling rate";
    }
    if (cutoff > 0.5 / gap * (1 + 1e-9) && gap > (1 + options.clock_tolerance) / rate) {
      cutoff = 0.5 / gap;
      why.str("");
      why << "lowered for a gap of " << gap << " s in the clock";
    }
    chosen.cutoff_hz = TwoDigits(cutoff);
    // Rounding must not cross a limit that the filters enforce.
    if (chosen.cutoff_hz > cutoff && chosen.cutoff_hz > std::min(0.45 * rate, 0.5 / gap)) chosen.cutoff_hz = cutoff;
    reason << chosen.cutoff_hz << " Hz (" << why.str() << ")";
  }

  if (request.decimation) {
    chosen.decimation = *request.decimation;
    reason << "; decimation " << chosen.decimation << " as requested";
  } else {
    chosen.decimation = std::max(1, static_cast<int>(std::floor(rate / chosen.cutoff_hz * (1 + 1e-9))));
    reason << "; decimation " << chosen.decimation << " of " << TwoDigits(rate)
           << " Hz (decimated Nyquist frequency at half the cut-off)";
  }
  chosen.reason = reason.str();
  return chosen;
}

}  // namespace idim
