// Eigen's decompositions of a MatrixXd, compiled once, in decompositions.cc, instead of in every file that uses one:
// a fifth to two thirds of those files' compile time. Included beside the Eigen header of the decomposition, and never
// by an installed header, so that no program that uses the installed libraries is bound to them. What is not listed
// here (other arguments of compute(), right-hand sides that are expressions) works too and is compiled
// where it is used.

#ifndef IDIM_CORE_BASE_DECOMPOSITIONS_H_
#define IDIM_CORE_BASE_DECOMPOSITIONS_H_

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>

// kind: `extern template`, or `template` in the one file that compiles them.
// It is never an expression: NOLINTBEGIN(bugprone-macro-parentheses)
#define IDIM_DECOMPOSITIONS(kind)                                                                                     \
  kind class Eigen::PartialPivLU<Eigen::MatrixXd>;                                                                    \
  kind class Eigen::HouseholderQR<Eigen::MatrixXd>;                                                                   \
  kind void Eigen::HouseholderQR<Eigen::MatrixXd>::_solve_impl(const Eigen::VectorXd&, Eigen::VectorXd&) const;       \
  kind class Eigen::ColPivHouseholderQR<Eigen::MatrixXd>;                                                             \
  kind void Eigen::ColPivHouseholderQR<Eigen::MatrixXd>::_solve_impl(const Eigen::VectorXd&, Eigen::VectorXd&) const; \
  kind class Eigen::JacobiSVD<Eigen::MatrixXd>;                                                                       \
  kind Eigen::LLT<Eigen::MatrixXd>& Eigen::LLT<Eigen::MatrixXd>::compute(const Eigen::EigenBase<Eigen::MatrixXd>&);   \
  kind class Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>;                                                          \
  kind Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>& Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>::compute(       \
      const Eigen::EigenBase<Eigen::MatrixXd>&, int);                                                                 \
  kind class Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd>
// NOLINTEND(bugprone-macro-parentheses)

IDIM_DECOMPOSITIONS(extern template);

#endif  // IDIM_CORE_BASE_DECOMPOSITIONS_H_
