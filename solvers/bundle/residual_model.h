// What a fitted bundle leaves unexplained, and what a torque that it lacks would explain of it.
//
// At the bundle's minimum the whitened residual r (a row a joint and sample, unit variance if the model were true) is
// orthogonal to the whitened columns J of all unknowns, gains included. A torque column c becomes the whitened column
// z = -V^-1/2 diag(1/g) M^-1 c; only its part z' orthogonal to J can explain anything that the model cannot imitate.
//
//   explained      |Z'+ r|^2, the decrease of the sum of squares (score test, one step from the minimum)
//   statistic      s' S^-1 s of the scores s = Z'^T r with the long-run covariance S of what the effect leaves (Wald:
//                  with the effect's own torque in S, one that acts in short segments would hide itself), which knows
//                  that residuals are correlated in time and between joints (core/statistics/long_run_covariance.h); as
//                  F with (p, m - p) degrees, m = (sum h)^2 / sum h^2 the number of pieces, of the length of the
//                  correlation, from which the effect is told: an effect of one segment, however large, is
//                  one observation
//   held out       folds of contiguous blocks of every recording: all unknowns, with and without Z, are fitted on the
//                  other folds (linearised at the minimum), and the squares compared on the fold left out

#ifndef IDIM_SOLVERS_BUNDLE_RESIDUAL_MODEL_H_
#define IDIM_SOLVERS_BUNDLE_RESIDUAL_MODEL_H_

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <vector>

#include "core/dynamics/base_parameters.h"
#include "core/statistics/long_run_covariance.h"
#include "solvers/bundle/bundle.h"
#include "solvers/bundle/bundle_data.h"

namespace idim {

class ResidualModel {
 public:
  // summary: usable, of `data` of `prepared` (CHECK).
  ResidualModel(const BaseParameters& base, const BundleData& data, const BundleSummary& summary, int folds = 8);

  int dof() const { return dof_; }
  Eigen::Index samples() const { return static_cast<Eigen::Index>(of_torque_.size()); }
  // samples n.
  const Eigen::VectorXd& residual() const { return residual_; }
  // samples x n [N m or N]: the residual and the measured torque at the estimated gains.
  Eigen::MatrixXd TorqueResidual() const;
  const Eigen::MatrixXd& torque() const { return torque_; }
  // samples x n: squares of a residual in units of the signal, by this model's weights: a sample at rest, whose
  // friction nothing tells, counts little. To compare other models by one measure.
  Eigen::MatrixXd WeightedSquares(const Eigen::MatrixXd& signal_residual) const;
  const SampleRanges& recordings() const { return recordings_; }
  // The fold of each sample, below num_folds().
  const std::vector<int>& folds() const { return fold_; }
  int num_folds() const { return folds_; }

  // Whitened columns of decimated torques: one matrix of samples x parameters a joint that has any, in the order of
  // `joints`. Returns samples n x parameters.
  Eigen::MatrixXd Whiten(const std::vector<int>& joints, const std::vector<Eigen::MatrixXd>& torques) const;

  // Orthonormal columns of what Z leaves beside J; columns that J and the ones before imitate but for 2 % are dropped.
  // passes: 2 for orthogonality to rounding, 1 where that is not needed. samples n x (<= parameters).
  Eigen::MatrixXd Remainder(const Eigen::MatrixXd& z, int passes = 2) const;

  double Explained(const Eigen::MatrixXd& remainder) const;

  // The same of whitened columns, without their remainder, and what their parameters would be.
  struct Explanation {
    double explained = 0.0;
    Eigen::VectorXd step;  // of each column's parameter [its unit]; 0: dropped, as in Remainder
  };
  // z: samples n x (width candidates), `width` columns a candidate. One a candidate.
  std::vector<Explanation> Explain(const Eigen::MatrixXd& z, Eigen::Index width) const;

  struct Score {
    double statistic = 0.0;
    double p_value = 1.0;
    int degrees = 0;
    int lag = 0;
    double pieces = 0.0;
  };
  Score Test(const Eigen::MatrixXd& remainder) const;

  struct HeldOut {
    Eigen::MatrixXd squares;   // folds x n, of whitened residuals on rows not fitted
    Eigen::MatrixXd residual;  // samples x n [N m or N], each from the fit that did not see it
    Eigen::MatrixXd signal;    // the same in units of the signal
  };
  // With extra columns (samples n x p, of Remainder(); p may be 0).
  HeldOut CrossValidate(const Eigen::MatrixXd& remainder) const;

 private:
  void SetFolds();

  int dof_;
  SampleRanges recordings_;
  std::vector<int> fold_;  // of each sample
  int folds_;
  Eigen::MatrixXd q_;  // samples n x c, orthonormal: the space of J
  Eigen::VectorXd residual_;
  Eigen::VectorXd in_space_;  // c: q_' residual_
  // Of each fold: the unknowns' normal matrix on the other folds, and its right side.
  std::vector<Eigen::LDLT<Eigen::MatrixXd>> fold_normal_;
  std::vector<Eigen::VectorXd> fold_right_;
  // Segments of samples [begin, end) of each fold.
  std::vector<SampleRanges> fold_segments_;
  Eigen::MatrixXd drive_;                   // n x n: signal of a torque
  std::vector<Eigen::MatrixXd> of_torque_;  // BundleProblem::Rows
  std::vector<Eigen::MatrixXd> to_torque_;  // inverse
  Eigen::MatrixXd torque_;
};

}  // namespace idim

#endif  // IDIM_SOLVERS_BUNDLE_RESIDUAL_MODEL_H_
