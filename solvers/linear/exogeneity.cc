#include "solvers/linear/exogeneity.h"

#include <glog/logging.h>

#include <Eigen/QR>
#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/complement.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <cmath>
#include <deque>
#include <limits>
#include <optional>

#include "solvers/linear/gain_system.h"
#include "solvers/linear/least_squares.h"

namespace idim {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd Beside(const MatrixXd& a, const MatrixXd& b) {
  MatrixXd both(a.rows(), a.cols() + b.cols());
  both << a, b;
  return both;
}

// Regression on the columns of a, independent or not.
class Regression {
 public:
  Regression(const MatrixXd& a, double rank_tolerance) : scales_(ColumnScales(a)) {
    if (a.cols() == 0) return;
    qr_.emplace(a.rows(), a.cols());
    qr_->setThreshold(rank_tolerance);
    qr_->compute(a * scales_.cwiseInverse().asDiagonal());
  }
  int rank() const { return qr_ ? static_cast<int>(qr_->rank()) : 0; }
  VectorXd Coefficients(const VectorXd& y) const { return VectorXd(qr_->solve(y)).cwiseQuotient(scales_); }
  MatrixXd Residual(const MatrixXd& y) const {
    if (!qr_) return y;
    MatrixXd rotated = qr_->householderQ().transpose() * y;
    rotated.topRows(rank()).setZero();
    return qr_->householderQ() * rotated;
  }

 private:
  VectorXd scales_;
  std::optional<Eigen::CompleteOrthogonalDecomposition<MatrixXd>> qr_;
};

double FProbability(double f, int numerator, std::int64_t denominator) {
  if (!std::isfinite(f)) return 0.0;
  const boost::math::fisher_f distribution(numerator, static_cast<double>(denominator));
  return boost::math::cdf(boost::math::complement(distribution, std::max(0.0, f)));
}

}  // namespace

bool ExogeneityOptions::IsValid(std::string* error) const {
  if (!(level > 0.0 && level < 1.0)) {
    *error = "level is " + std::to_string(level) + "; expected a number in (0, 1)";
    return false;
  }
  if (!(min_first_stage_f >= 0.0)) {
    *error = "min_first_stage_f is " + std::to_string(min_first_stage_f) + "; expected a number of at least 0";
    return false;
  }
  return IsValidRankTolerance(rank_tolerance, error);
}

ExogeneityTest TestExogeneity(const MatrixXd& r, std::int64_t rows, int instruments, const std::vector<int>& suspects,
                              const ExogeneityOptions& options) {
  std::string error;
  CHECK(options.IsValid(&error)) << error;
  const Index columns = r.cols() - instruments - 1;
  CHECK_GT(instruments, 0);
  CHECK_GT(columns, 0);
  const double tolerance = options.rank_tolerance;
  ExogeneityTest test;
  test.given = options;
  if (suspects.empty()) {
    test.status = Status::Untrusted("exogeneity test: no column is suspected, so there is nothing to test");
    return test;
  }
  const MatrixXd z = r.leftCols(instruments);
  const MatrixXd x = r.middleCols(instruments, columns);
  const VectorXd y = r.rightCols<1>();
  MatrixXd suspect(r.rows(), suspects.size()), exogenous(r.rows(), columns - Index(suspects.size()));
  Index s = 0, e = 0;
  for (Index k = 0; k < columns; ++k) {
    if (std::find(suspects.begin(), suspects.end(), static_cast<int>(k)) != suspects.end()) {
      suspect.col(s++) = x.col(k);
    } else {
      exogenous.col(e++) = x.col(k);
    }
  }
  CHECK_EQ(s, static_cast<Index>(suspects.size())) << "a suspect that is no column of X, or one given twice";

  // First stage.
  const Regression own(exogenous, tolerance), stage(Beside(exogenous, z), tolerance);
  const int added = stage.rank() - own.rank();
  const std::int64_t stage_freedom = rows - stage.rank();
  if (added < static_cast<int>(suspects.size()) || stage_freedom <= 0) {
    test.status = Status::Untrusted("exogeneity test: " + std::to_string(added) + " independent instruments for " +
                                    std::to_string(suspects.size()) + " suspected columns in " + std::to_string(rows) +
                                    " rows. Give more instruments, or record longer");
    return test;
  }
  const MatrixXd v = stage.Residual(suspect);
  const MatrixXd without = own.Residual(suspect);
  test.first_stage_f.resize(suspect.cols());
  for (Index k = 0; k < suspect.cols(); ++k) {
    const double squares_left = v.col(k).squaredNorm();
    test.first_stage_f[k] =
        (without.col(k).squaredNorm() - squares_left) / added / (squares_left / static_cast<double>(stage_freedom));
  }
  if (const double weakest = test.first_stage_f.minCoeff(); weakest < options.min_first_stage_f) {
    test.status =
        Status::Untrusted("exogeneity test: weak instruments, the first-stage F is " + std::to_string(weakest) +
                          "; expected at least " + std::to_string(options.min_first_stage_f));
    return test;
  }

  // Augmented regression.
  const Regression plain(x, tolerance), augmented(Beside(x, v), tolerance);
  test.least_squares = plain.Coefficients(y);
  test.instrumental = augmented.Coefficients(y).head(columns);
  test.numerator = augmented.rank() - plain.rank();
  test.denominator = rows - augmented.rank();
  if (test.numerator <= 0 || test.denominator <= 0) {
    test.status = Status::Untrusted("exogeneity test: the instruments explain the suspected columns with nothing left");
    return test;
  }
  const double restricted = plain.Residual(y).squaredNorm(), free = augmented.Residual(y).squaredNorm();
  test.f = (restricted - free) / test.numerator / (free / static_cast<double>(test.denominator));
  test.p_value = FProbability(test.f, test.numerator, test.denominator);
  test.biased = test.p_value < options.level;
  test.status = Status::Ok();

  test.overidentification = added - static_cast<int>(suspects.size());
  if (test.overidentification > 0) {
    const VectorXd residual = y - x * test.instrumental;
    const double explained = residual.squaredNorm() - stage.Residual(residual).squaredNorm();
    const double sargan = static_cast<double>(rows) * explained / residual.squaredNorm();
    const boost::math::chi_squared distribution(test.overidentification);
    test.sargan_p = boost::math::cdf(boost::math::complement(distribution, std::max(0.0, sargan)));
  }
  return test;
}

Result<LaggedSystem> BuildLaggedSystem(const PreparedStudy& prepared, const LaggedOptions& options) {
  if (options.lag < 1 || options.stride < 1) {
    return Status::BadInput("lag is " + std::to_string(options.lag) + " and stride " + std::to_string(options.stride) +
                            "; expected both at least 1");
  }
  const Result<GainRows> rows = GainRows::Create(prepared);
  IDIM_RETURN_IF_ERROR(rows);
  const int unknowns = rows->unknowns().size();
  LaggedSystem system;
  system.dof = prepared.robot().dof();
  const int suspected = options.suspects == Suspects::kSignals ? system.dof : unknowns;
  for (int k = 0; k < suspected; ++k) system.suspects.push_back(k);
  system.instruments = 2 * suspected;
  system.joints.assign(system.dof, TriangularFactor(system.instruments + unknowns + 1));

  const int lag = options.lag;
  std::deque<GainRows::RowMajorMatrix> window;  // 2 lag + 1 samples
  std::int64_t sample = 0;
  Eigen::RowVectorXd row(system.instruments + unknowns + 1);
  for (const int recording : prepared.model.RecordingsFor(Use::kIdentification)) {
    window.clear();
    rows->Stream(recording, [&](const GainRows::RowMajorMatrix& w) {
      window.push_back(w);
      if (static_cast<int>(window.size()) > 2 * lag + 1) window.pop_front();
      if (static_cast<int>(window.size()) < 2 * lag + 1 || sample++ % options.stride != 0) return;
      for (int j = 0; j < system.dof; ++j) {
        row << window.front().row(j).head(suspected), window.back().row(j).head(suspected),
            window[lag].row(j).head(unknowns), -window[lag](j, unknowns);
        system.joints[j].AddRow(row);
      }
    });
  }
  return system;
}

ExogeneityTest TestJointExogeneity(const LaggedSystem& system, int joint, const ExogeneityOptions& options) {
  const MatrixXd r = system.joints[joint].R();
  const int columns = static_cast<int>(r.cols()) - system.instruments - 1;
  const Remainder known = RemainderOf(r.middleCols(system.instruments + system.dof, columns - system.dof),
                                      r.rightCols<1>(), options.rank_tolerance);
  if (!(known.norm > 1e-8 * r.rightCols<1>().norm())) {
    ExogeneityTest test;
    test.given = options;
    test.status = Status::Untrusted("exogeneity test: the equations of joint " + std::to_string(joint + 1) +
                                    " alone hold nothing known, so that least squares has nothing to be biased about");
    return test;
  }
  std::vector<int> suspects;
  for (const int k : system.suspects) {
    if (r.col(system.instruments + k).norm() > 0.0) suspects.push_back(k);
  }
  return TestExogeneity(r, system.joints[joint].rows(), system.instruments, suspects, options);
}

ExogeneityTest TestAllExogeneity(const LaggedSystem& system, const VectorXd& row_sigma,
                                 const ExogeneityOptions& options) {
  CHECK_EQ(row_sigma.size(), system.dof);
  TriangularFactor factor(system.joints[0].columns());
  for (int j = 0; j < system.dof; ++j) factor.Merge(system.joints[j], 1.0 / row_sigma[j]);
  return TestExogeneity(factor.R(), factor.rows(), system.instruments, system.suspects, options);
}

}  // namespace idim
