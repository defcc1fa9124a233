// The rows of the errors-in-variables bundle with its latents eliminated: one pass over the samples gives its cost, the
// triangular factor of its Gauss-Newton step and what the weights need. Symbols: solvers/bundle/bundle.h.

#ifndef IDIM_SOLVERS_BUNDLE_BUNDLE_PROBLEM_H_
#define IDIM_SOLVERS_BUNDLE_BUNDLE_PROBLEM_H_

#include <Eigen/Core>
#include <limits>
#include <vector>

#include "core/dynamics/base_parameters.h"
#include "solvers/bundle/bundle_data.h"

namespace idim {

// Huber's loss of s = r' V^-1 r, the squared norm of a sample's whitened residual: s up to threshold^2, beyond it
// 2 threshold sqrt(s) - threshold^2. 0: no loss.
struct HuberNorm {
  double threshold = 0.0;

  double Cost(double s) const;
  double Weight(double s) const;  // derivative of Cost
  // E[Weight(s) s] / n for s chi-square with n degrees: what down-weighting takes of normal residuals' squares.
  double Consistency(int n) const;
  // E[Weight(s)^2 s] / E[Weight(s) s]: by what the inverse curvature is to be multiplied for a covariance (the
  // curvature is Consistency(n) times that of squares, by Stein's identity).
  double VarianceFactor(int n) const;
};

class BundleProblem {
 public:
  using RowMajorMatrix = StateDerivatives::RowMajorMatrix;

  // All must outlive the problem.
  BundleProblem(const BaseParameters& base, const BundleData& data, const std::vector<BundlePrior>& priors,
                HuberNorm loss);

  struct Evaluation {
    double cost = std::numeric_limits<double>::infinity();
    // (c + 1) x (c + 1), upper triangular: R'R = sum w [J r]' V^-1 [J r] + priors.
    Eigen::MatrixXd r;
    // n each, sums over samples with the weight u = (S_jj / (S_jj + F_jj))^2 of a sample for joint j's sigma, F the
    // variance that the sign at rest adds: of u w r_j^2, u (B C B' + F)_jj and u.
    Eigen::VectorXd squares, spread, weight;
    double log_determinants = 0.0;  // sum log |V|
  };
  // sigma: n standard deviations of the signals. Cost infinite, and the rest without meaning, where it overflows.
  Evaluation Evaluate(const Eigen::VectorXd& theta, const Eigen::VectorXd& sigma);

  // Dry friction at rest, whose variance is part of V: that of theta from now on. A weight, held while theta moves
  // (with it free the cost would fall by friction growing). Until the first call: none.
  void HoldFriction(const Eigen::VectorXd& theta);

  // What the residual's mean square leaves after the joint data's share: the next standard deviations.
  Eigen::VectorXd NextSigma(const Evaluation& at) const;

  // Scores w J' V^-1 r of the samples, samples x c, and R of their derivative: as Evaluation::r without its last
  // column, but that Huber's loss no longer pulls along a residual beyond its threshold.
  struct Sensitivity {
    Eigen::MatrixXd scores;
    Eigen::MatrixXd curvature;
    // samples x n: what each sample adds to the variances sigma^2 that NextSigma() gives, their sums zero.
    Eigen::MatrixXd variances;
  };
  Sensitivity Scores(const Eigen::VectorXd& theta, const Eigen::VectorXd& sigma);

  // All whitened rows, samples n x (c + 1): V^-1/2 [J | r]; and n x n of each sample, V^-1/2 diag(1/g) M^-1, by which a
  // torque that the model lacks becomes a row: column = -of_torque * torque.
  struct Rows {
    RowMajorMatrix rows;
    std::vector<Eigen::MatrixXd> of_torque;
  };
  Rows Linearize(const Eigen::VectorXd& theta, const Eigen::VectorXd& sigma);

  // d(sum of scores) / d(sigma_j^2), c x n: by central differences, from at most `max_samples` of the samples.
  Eigen::MatrixXd ScoreByVariance(const Eigen::VectorXd& theta, const Eigen::VectorXd& sigma, int max_samples);

  // E sum dJ' V^-1 dJ: what the error of the estimated states, of covariance Q = C - C B' V^-1 B C, adds to
  // sum J' V^-1 J. From at most `max_samples` of the samples, evenly spread. c x c.
  Eigen::MatrixXd NoiseInformation(const Eigen::VectorXd& theta, const Eigen::VectorXd& sigma, int max_samples = 400);

  int num_gains() const { return data_.num_gains(); }

 private:
  // What all samples have in common at these unknowns and weights.
  void Set(const Eigen::VectorXd& theta, const Eigen::VectorXd& sigma);
  // The whitened rows V^-1/2 [J | r] of sample k into rows_; returns r' V^-1 r. Allocates nothing.
  double Whiten(size_t k);
  Eigen::VectorXd ScoreSum(const Eigen::VectorXd& theta, const Eigen::VectorXd& sigma, size_t step);
  void AddSignVariance(const BundleSample& sample);
  void InvertFactor();
  void AddPriors(const Eigen::VectorXd& theta, class TriangularFactor* factor) const;

  const BundleData& data_;
  const std::vector<BundlePrior>& priors_;
  HuberNorm loss_;
  StateDerivatives derivatives_;
  // Of Set().
  Eigen::VectorXd chi_, inverse_gains_, variance_;
  Eigen::MatrixXd drive_;     // diag(1/g) M^-1
  Eigen::MatrixXd friction_;  // its columns times Fs, of HoldFriction()
  // Of the last sample.
  Eigen::VectorXd torque_, signal_, residual_, spread_, rest_, half_, weighted_, deviation_, lower_;
  Eigen::MatrixXd d_, b_, cb_, v_, factor_, whitened_drive_;  // factor_: L^-1 of V = L L'
  RowMajorMatrix columns_, change_, rows_;
  double log_determinant_ = 0.0;  // of V
};

}  // namespace idim

#endif  // IDIM_SOLVERS_BUNDLE_BUNDLE_PROBLEM_H_
