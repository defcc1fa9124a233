// Covariance of the joint states that white encoder noise leaves after the whole linear chain: low-pass, differences,
// decimation (core/motion/preprocessing.h).
//
// Every state is a linear functional of the N recorded positions of its joint, x_k^a = sum_i s_k^a(i) q_i with a = q,
// dq, ddq. For encoder noise that is white with standard deviation sigma,
//
//   Cov(x_k^a, x_l^b) = sigma^2 sum_i s_k^a(i) s_l^b(i).                                                (1)
//
// All figures here are for sigma = 1 and one joint; multiply by the joint's sigma^2 (core/motion/encoder_noise.h).
// Position and acceleration come out strongly (negatively) correlated; velocity is uncorrelated with both on a uniform
// clock, where s is symmetric.
//
// Uniform clock: s is the chain's impulse response, the same for every output whose window lies inside the recording,
// and (1) is exact there. For the up to kHalfWidth outputs nearest to each end, whose windows the ends cut, it is an
// approximation (tests say how good).
// Jittering clock: s differs between outputs; (1) is exact for every output, edges included, by one banded solve each.
// Representative figures are means over outputs spread evenly over the recording.

#ifndef IDIM_CORE_MOTION_STATE_COVARIANCE_H_
#define IDIM_CORE_MOTION_STATE_COVARIANCE_H_

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/base/status.h"
#include "core/motion/preprocessing.h"
#include "core/signal/clock.h"
#include "core/signal/decimator.h"
#include "core/signal/smoothing_spline.h"

namespace idim {

class StateCovariance {
 public:
  // `decimator` as MakeDecimator() made it from the same instants t and preprocessing.
  // BadInput as EstimateJointStates().
  static Result<StateCovariance> Create(const Eigen::VectorXd& t, const Preprocessing& preprocessing,
                                        const Decimator& decimator);

  // 3 x 3, rows and columns (q, dq, ddq), in units of (rad, rad/s, rad/s^2) per rad of encoder noise.

  // Decimated states, representative.
  const Eigen::Matrix3d& decimated() const { return decimated_; }
  // States at the recorded instants, before decimation, representative. The root of (1, 1) times sigma is the noise of
  // the velocity, which a sign function at rest sees.
  const Eigen::Matrix3d& full_rate() const { return full_rate_; }

  // Cov(x_k, x_(k + lag)) of decimated states, rows of output k, columns of output k + lag. Representative.
  Eigen::Matrix3d DecimatedAtLag(int lag) const;
  // Of each of the given outputs with itself; exact on a jittering clock, decimated() on a uniform one.
  std::vector<Eigen::Matrix3d> DecimatedOf(const std::vector<int>& outputs) const;

 private:
  explicit StateCovariance(const Decimator& decimator) : decimator_(decimator) {}

  // The functionals s_k of output k on the samples, N x 3 for each output, side by side.
  Eigen::MatrixXd SampleWeights(const std::vector<int>& outputs) const;

  Decimator decimator_;
  Eigen::VectorXd t_;
  Eigen::Matrix3d decimated_ = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d full_rate_ = Eigen::Matrix3d::Zero();
  Eigen::MatrixX3d response_;              // uniform clock: s about its centre
  std::optional<SmoothingSpline> spline_;  // jittering clock
};

}  // namespace idim

#endif  // IDIM_CORE_MOTION_STATE_COVARIANCE_H_
