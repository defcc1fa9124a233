#include "core/motion/state_covariance.h"

#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "core/signal/butterworth.h"

namespace idim {
namespace {

constexpr int kRepresentatives = 32;
constexpr int kBatch = 16;  // outputs solved together

// The response of the chain of a uniform clock: the symmetric low-pass and the differences act on the decimator's taps
// (one tap of 1: no decimation) as they act on positions, but for the sign of the odd first difference.
Eigen::MatrixX3d ChainResponse(const std::vector<double>& taps, int order, double cutoff, double step) {
  const ButterworthFilter filter(order, cutoff, step);
  // In 12 periods even the slowest poles of order 6 decay to exp(-24 pi sin(pi / 12)) = 3e-9.
  const int tail = 6 * filter.padding();
  const Eigen::Index n = static_cast<Eigen::Index>(taps.size()) + 2 * tail;
  Eigen::VectorXd x = Eigen::VectorXd::Zero(n);
  x.segment(tail, taps.size()) = Eigen::Map<const Eigen::VectorXd>(taps.data(), taps.size());
  const Eigen::VectorXd s = filter.ZeroPhase(x, 1);
  Eigen::MatrixX3d response(n, 3);
  response.col(0) = s.segment(1, n);
  response.col(1) = -(s.tail(n) - s.head(n)) / (2.0 * step);
  response.col(2) = (s.tail(n) - 2.0 * s.segment(1, n) + s.head(n)) / (step * step);
  return response;
}

// `count` numbers spread evenly over [0, n).
std::vector<int> Spread(int n, int count) {
  count = std::min(n, count);
  std::vector<int> numbers(count);
  for (int i = 0; i < count; ++i) numbers[i] = static_cast<int>((static_cast<int64_t>(2 * i + 1) * n) / (2 * count));
  return numbers;
}

}  // namespace

Result<StateCovariance> StateCovariance::Create(const Eigen::VectorXd& t, const Preprocessing& preprocessing,
                                                const Decimator& decimator) {
  CHECK_EQ(t.size(), decimator.samples());
  const Clock clock = AnalyzeClock(t, preprocessing.options.clock_tolerance);
  const int order = preprocessing.options.filter_order;
  const double cutoff = preprocessing.cutoff_hz;
  StateCovariance out(decimator);
  out.t_ = t;
  if (clock.uniform) {
    if (!(cutoff > 0 && cutoff * clock.step < 0.5)) {
      return Status::BadInput("cutoff_hz must be positive and below half the sampling rate");
    }
    const Eigen::MatrixX3d undecimated = ChainResponse({1.0}, order, cutoff, clock.step);
    out.full_rate_ = undecimated.transpose() * undecimated;
    out.response_ = ChainResponse(decimator.Taps(), order, cutoff, clock.step);
    out.decimated_ = out.response_.transpose() * out.response_;
    return out;
  }

  Result<SmoothingSpline> spline = SmoothingSpline::Create(t, order, cutoff);
  IDIM_RETURN_IF_ERROR(spline);
  out.spline_ = std::move(spline).value();
  const std::vector<int> outputs = Spread(decimator.outputs(), kRepresentatives);
  for (const Eigen::Matrix3d& covariance : out.DecimatedOf(outputs)) out.decimated_ += covariance;
  out.decimated_ /= static_cast<double>(outputs.size());

  // Full rate: the functionals are the basis functions at a sample; the ends are left out like the decimator does.
  const double* const instants = t.data();
  const int begin = static_cast<int>(std::lower_bound(instants, instants + t.size(), decimator.times()[0]) - instants);
  const int end = static_cast<int>(
      std::upper_bound(instants, instants + t.size(), decimator.times()[decimator.outputs() - 1]) - instants);
  const std::vector<int> samples = Spread(std::max(1, end - begin), kRepresentatives);
  Eigen::MatrixXd functionals =
      Eigen::MatrixXd::Zero(out.spline_->num_coefficients(), 3 * static_cast<Eigen::Index>(samples.size()));
  double basis[SmoothingSpline::kMaxSupport];
  for (size_t s = 0; s < samples.size(); ++s) {
    for (int derivative = 0; derivative < 3; ++derivative) {
      int first = 0;
      out.spline_->Basis(t[begin + samples[s]], derivative, &first, basis);
      for (int j = 0; j < out.spline_->support(); ++j) {
        functionals(first + j, 3 * static_cast<Eigen::Index>(s) + derivative) = basis[j];
      }
    }
  }
  const Eigen::MatrixXd weights = out.spline_->SampleWeights(functionals);
  for (size_t s = 0; s < samples.size(); ++s) {
    const auto block = weights.middleCols<3>(3 * static_cast<Eigen::Index>(s));
    out.full_rate_ += block.transpose() * block;
  }
  out.full_rate_ /= static_cast<double>(samples.size());
  return out;
}

Eigen::MatrixXd StateCovariance::SampleWeights(const std::vector<int>& outputs) const {
  Eigen::MatrixXd functionals =
      Eigen::MatrixXd::Zero(spline_->num_coefficients(), 3 * static_cast<Eigen::Index>(outputs.size()));
  double basis[SmoothingSpline::kMaxSupport];
  for (size_t o = 0; o < outputs.size(); ++o) {
    const int k = outputs[o];
    for (int i = decimator_.FirstSample(k); i <= decimator_.LastSample(k); ++i) {
      const Decimator::Contribution part = decimator_.At(i);
      const double weight = part.weights[k - part.first];
      for (int derivative = 0; derivative < 3; ++derivative) {
        int first = 0;
        spline_->Basis(t_[i], derivative, &first, basis);
        for (int j = 0; j < spline_->support(); ++j) {
          functionals(first + j, 3 * static_cast<Eigen::Index>(o) + derivative) += weight * basis[j];
        }
      }
    }
  }
  return spline_->SampleWeights(functionals);
}

Eigen::Matrix3d StateCovariance::DecimatedAtLag(int lag) const {
  const int distance = std::abs(lag);
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  if (!spline_) {
    // sum_m s(m) s(m - lag D)'
    const int64_t shift = static_cast<int64_t>(distance) * decimator_.options().decimation;
    if (shift >= response_.rows()) return covariance;
    const Eigen::Index overlap = response_.rows() - static_cast<Eigen::Index>(shift);
    covariance = response_.bottomRows(overlap).transpose() * response_.topRows(overlap);
  } else {
    const int pairs = decimator_.outputs() - distance;
    if (pairs <= 0) return covariance;
    const std::vector<int> first = Spread(pairs, kRepresentatives);
    for (size_t begin = 0; begin < first.size(); begin += kBatch) {
      const size_t count = std::min<size_t>(kBatch, first.size() - begin);
      std::vector<int> outputs(first.begin() + static_cast<std::ptrdiff_t>(begin),
                               first.begin() + static_cast<std::ptrdiff_t>(begin + count));
      for (size_t i = 0; i < count; ++i) outputs.push_back(outputs[i] + distance);
      const Eigen::MatrixXd weights = SampleWeights(outputs);
      for (size_t i = 0; i < count; ++i) {
        covariance += weights.middleCols<3>(3 * static_cast<Eigen::Index>(i)).transpose() *
                      weights.middleCols<3>(3 * static_cast<Eigen::Index>(count + i));
      }
    }
    covariance /= static_cast<double>(first.size());
  }
  if (lag < 0) covariance.transposeInPlace();
  return covariance;
}

std::vector<Eigen::Matrix3d> StateCovariance::DecimatedOf(const std::vector<int>& outputs) const {
  for (int k : outputs) CHECK(k >= 0 && k < decimator_.outputs());
  if (!spline_) return std::vector<Eigen::Matrix3d>(outputs.size(), decimated_);
  std::vector<Eigen::Matrix3d> covariances;
  for (size_t begin = 0; begin < outputs.size(); begin += kBatch) {
    const size_t count = std::min<size_t>(kBatch, outputs.size() - begin);
    const std::vector<int> batch(outputs.begin() + static_cast<std::ptrdiff_t>(begin),
                                 outputs.begin() + static_cast<std::ptrdiff_t>(begin + count));
    const Eigen::MatrixXd weights = SampleWeights(batch);
    for (size_t i = 0; i < count; ++i) {
      const auto block = weights.middleCols<3>(3 * static_cast<Eigen::Index>(i));
      covariances.push_back(block.transpose() * block);
    }
  }
  return covariances;
}

}  // namespace idim
