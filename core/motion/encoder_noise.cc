#include "core/motion/encoder_noise.h"

#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "core/signal/butterworth.h"
#include "core/signal/smoothing_spline.h"

namespace idim {
namespace {

constexpr double kStepsToMove = 8;
constexpr double kPeriodsInBlock = 4;
constexpr int kProbeSamples = 40000;

// Samples left out at each end, where the residual shows the filter's transient: two periods of the cut-off, but
// never more than leaves half of a short recording.
int EdgeSamples(int samples, const Preprocessing& preprocessing, const Clock& clock) {
  return static_cast<int>(std::min(std::ceil(2.0 / (preprocessing.cutoff_hz * clock.step)), samples / 4.0));
}

// c of equation (1).
Result<double> ResidualFraction(const Eigen::VectorXd& t, const Preprocessing& preprocessing, const Clock& clock) {
  const int order = preprocessing.options.filter_order;
  if (clock.uniform) {
    const ButterworthFilter filter(order, preprocessing.cutoff_hz, clock.step);
    Eigen::VectorXd impulse = Eigen::VectorXd::Zero(12 * filter.padding() + 1);
    impulse[6 * filter.padding()] = 1.0;
    return (impulse - filter.ZeroPhase(impulse)).squaredNorm();
  }
  const Result<SmoothingSpline> spline = SmoothingSpline::Create(t, order, preprocessing.cutoff_hz);
  IDIM_RETURN_IF_ERROR(spline);
  const Eigen::Index n = t.size();
  const Eigen::Index probes = std::clamp<Eigen::Index>(kProbeSamples / n, 4, 256);
  std::mt19937_64 bits(1);  // not Random: other probes move the estimates of the UR10e by 5e-3 standard deviations
  Eigen::MatrixXd signs(n, probes);
  for (double& sign : signs.reshaped()) sign = (bits() & 1) != 0 ? 1.0 : -1.0;
  const Eigen::MatrixXd filtered = spline->Evaluate(spline->Fit(signs), t, 0);
  const Eigen::Index edge = EdgeSamples(static_cast<int>(n), preprocessing, clock);
  const auto residual = (signs - filtered).middleRows(edge, n - 2 * edge);
  return residual.squaredNorm() / static_cast<double>(residual.size());
}

double Median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

bool Moves(const Eigen::Ref<const Eigen::VectorXd>& block) {
  double smallest = std::numeric_limits<double>::infinity();
  for (Eigen::Index i = 1; i < block.size(); ++i) {
    const double change = std::abs(block[i] - block[i - 1]);
    if (change > 0) smallest = std::min(smallest, change);
  }
  return block.maxCoeff() - block.minCoeff() >= (kStepsToMove - 1e-6) * smallest;
}

}  // namespace

double QuantizationStep(const Eigen::Ref<const Eigen::VectorXd>& x) {
  // Rounding of the decimal numbers themselves is no change.
  const double rounding = 1e-12 * (1.0 + x.cwiseAbs().maxCoeff());
  std::vector<double> changes;
  for (Eigen::Index i = 1; i < x.size(); ++i) {
    const double change = std::abs(x[i] - x[i - 1]);
    if (change > rounding) changes.push_back(change);
  }
  if (changes.size() < 20) return 0;
  // A coarse step from the smallest change, then the least-squares one from all changes it explains.
  double step = *std::min_element(changes.begin(), changes.end());
  for (const double reach : {3.0, 50.0}) {
    double products = 0, squares = 0;
    int explained = 0, small = 0;
    for (const double change : changes) {
      const double multiple = std::round(change / step);
      if (multiple > reach) continue;
      ++small;
      if (std::abs(change / step - multiple) > 0.1) continue;
      ++explained;
      products += multiple * change;
      squares += multiple * multiple;
    }
    if (small < 20 || explained < 0.98 * small) return 0;
    step = products / squares;
  }
  return step;
}

Result<EncoderNoise> EstimateEncoderNoise(const Recording& recording, const Preprocessing& preprocessing,
                                          const JointStates& states) {
  CHECK_EQ(states.q.rows(), recording.q.rows());
  CHECK_EQ(states.q.cols(), recording.q.cols());
  const Clock& clock = states.clock;
  const Result<double> fraction = ResidualFraction(recording.t, preprocessing, clock);
  IDIM_RETURN_IF_ERROR(fraction);

  const double period = 1.0 / (preprocessing.cutoff_hz * clock.step);  // in samples
  const int edge = EdgeSamples(recording.samples(), preprocessing, clock);
  const int length =
      std::min(recording.samples() - 2 * edge, std::max(16, static_cast<int>(std::round(kPeriodsInBlock * period))));
  // The median of chi^2_nu / nu (Wilson and Hilferty).
  const double freedom = std::max(1.0, *fraction * length);
  const double median_bias = std::pow(1.0 - 2.0 / (9.0 * freedom), 3);

  const int dof = recording.dof();
  EncoderNoise noise;
  noise.sigma = Eigen::VectorXd::Zero(dof);
  noise.quantization = Eigen::VectorXd::Zero(dof);
  noise.provenance.resize(dof);
  for (int j = 0; j < dof; ++j) {
    std::vector<double> powers;
    for (int begin = edge; begin + length + edge <= recording.samples(); begin += length) {
      const auto raw = recording.q.col(j).segment(begin, length);
      if (!Moves(raw)) continue;
      powers.push_back((raw - states.q.col(j).segment(begin, length)).squaredNorm() / (length * *fraction));
    }
    noise.quantization[j] = QuantizationStep(recording.q.col(j));
    const double floor = noise.quantization[j] / std::sqrt(12.0);
    if (!powers.empty()) {
      noise.sigma[j] = std::sqrt(Median(powers) / median_bias);
      noise.provenance[j] = "residual of the low-pass, median of " + std::to_string(powers.size()) + " moving blocks";
    }
    if (noise.sigma[j] < floor) {
      noise.sigma[j] = floor;
      noise.provenance[j] = "quantisation step / sqrt(12)";
    }
  }
  const double largest = noise.sigma.maxCoeff();
  if (!(largest > 0)) {
    return Status::BadInput(
        "recording '" + recording.name +
        "': no encoder noise can be estimated: no joint moves, or the positions have no noise at all");
  }
  for (int j = 0; j < dof; ++j) {
    if (noise.sigma[j] > 0) continue;
    noise.sigma[j] = largest;
    noise.provenance[j] = "never moves: the largest of the other joints";
  }
  return noise;
}

}  // namespace idim
