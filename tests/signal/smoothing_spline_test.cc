#include "core/signal/smoothing_spline.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/signal/clock.h"
#include "tests/signal/signals.h"

namespace idim::smoothing_spline_test {
namespace {

SmoothingSpline Make(const Eigen::VectorXd& t, int order, double cutoff, double knots = 10.0) {
  Result<SmoothingSpline> spline = SmoothingSpline::Create(t, order, cutoff, knots);
  EXPECT_TRUE(spline.ok()) << spline.status().message();
  return std::move(spline).value();
}

double Gain(int order, double f_over_cutoff) { return 1.0 / (1.0 + std::pow(f_over_cutoff, 2 * order)); }

TEST(SmoothingSpline, PassesPolynomialsBelowTheOrderWithTheirDerivatives) {
  const Eigen::VectorXd t = JitteringClock(400, 0.01, 0.8, 1);
  const Eigen::ArrayXd u = t.array() - 102.0;
  for (int order = SmoothingSpline::kMinOrder; order <= SmoothingSpline::kMaxOrder; ++order) {
    const SmoothingSpline spline = Make(t, order, 8.0);
    for (int degree = 0; degree < order; ++degree) {
      const Eigen::MatrixXd c = spline.Fit(u.pow(degree).matrix());
      // The ends included; rounding of the coefficients grows with the condition of A and with each derivative.
      const double tolerance = 1e-8;
      EXPECT_LT((spline.Evaluate(c, t, 0).array() - u.pow(degree)).abs().maxCoeff(), tolerance) << order << degree;
      const Eigen::ArrayXd first = degree < 1 ? Eigen::ArrayXd::Zero(400) : (degree * u.pow(degree - 1)).eval();
      const Eigen::ArrayXd second =
          degree < 2 ? Eigen::ArrayXd::Zero(400) : (degree * (degree - 1.0) * u.pow(degree - 2)).eval();
      EXPECT_LT((spline.Evaluate(c, t, 1).array() - first).abs().maxCoeff(), 1e2 * tolerance) << order << degree;
      EXPECT_LT((spline.Evaluate(c, t, 2).array() - second).abs().maxCoeff(), 1e4 * tolerance) << order << degree;
    }
  }
}

// Equation (2) of the header on a clock dense enough that sampling plays no role, for the value and both derivatives.
TEST(SmoothingSpline, HasTheButterworthResponse) {
  const double cutoff = 5.0;
  const Eigen::VectorXd t = UniformClock(6000, 1e-3, 50.0);
  for (int order = SmoothingSpline::kMinOrder; order <= SmoothingSpline::kMaxOrder; ++order) {
    const SmoothingSpline spline = Make(t, order, cutoff);
    for (const double ratio : {0.1, 0.5, 0.8, 1.0, 1.3, 2.0, 4.0}) {
      const Eigen::MatrixXd c = spline.Fit(Wave(t, ratio * cutoff, 0.4, 0));
      for (int derivative = 0; derivative <= 2; ++derivative) {
        const Eigen::VectorXd expected = Gain(order, ratio) * Wave(t, ratio * cutoff, 0.4, derivative);
        const double scale = std::pow(2 * M_PI * ratio * cutoff, derivative);
        const Eigen::VectorXd error = (spline.Evaluate(c, t, derivative) - expected) / scale;
        EXPECT_LT(error.segment(2400, 1200).lpNorm<Eigen::Infinity>(), 1e-3)
            << "order " << order << ", f / f_c " << ratio << ", derivative " << derivative;
      }
    }
  }
}

TEST(SmoothingSpline, HalvingTheKnotsChangesLittle) {
  const double cutoff = 5.0;
  const Eigen::VectorXd t = JitteringClock(800, 0.01, 0.6, 2);
  const Eigen::MatrixXd noise = Gaussian(800, 3, 3);
  const SmoothingSpline coarse = Make(t, 4, cutoff);
  const SmoothingSpline fine = Make(t, 4, cutoff, 20.0);
  for (int derivative = 0; derivative <= 2; ++derivative) {
    const Eigen::MatrixXd a = coarse.Evaluate(coarse.Fit(noise), t, derivative);
    const Eigen::MatrixXd b = fine.Evaluate(fine.Fit(noise), t, derivative);
    EXPECT_LT((a - b).norm(), 1e-3 * b.norm()) << derivative;
    EXPECT_GT((a - b).norm(), 0.0);
  }
}

// On a clock with steps of 0.2 to 1.8 of the nominal one, the trapezoidal rule behind (1) errs; a wave at a quarter of
// the cut-off, 1/40 of the rate, is passed to better than the distance of its gain from one allows (order 4: 1.5e-5).
TEST(SmoothingSpline, PassesBandLimitedMotionOnAJitteringClock) {
  const double cutoff = 10.0;
  const Eigen::VectorXd t = JitteringClock(2000, 0.01, 0.8, 4);
  const SmoothingSpline spline = Make(t, 4, cutoff);
  const Eigen::MatrixXd c = spline.Fit(Wave(t, 2.5, 0.1, 0));
  for (int derivative = 0; derivative <= 2; ++derivative) {
    const Eigen::VectorXd truth = Wave(t, 2.5, 0.1, derivative);
    const Eigen::VectorXd error = spline.Evaluate(c, t, derivative) - truth;
    EXPECT_LT(error.segment(200, 1600).norm(), 1e-3 * truth.segment(200, 1600).norm()) << derivative;
  }
}

TEST(SmoothingSpline, DerivativesAreThoseOfTheFunction) {
  const Eigen::VectorXd t = JitteringClock(300, 0.01, 0.5, 5);
  const SmoothingSpline spline = Make(t, 4, 6.0);
  const Eigen::MatrixXd c = spline.Fit(Gaussian(300, 2, 6));
  const double e = 1e-5;
  const Eigen::VectorXd at = t.segment(5, 290);
  for (int derivative = 0; derivative < 3; ++derivative) {
    const Eigen::MatrixXd numeric =
        (spline.Evaluate(c, at.array() + e, derivative) - spline.Evaluate(c, at.array() - e, derivative)) / (2 * e);
    const Eigen::MatrixXd exact = spline.Evaluate(c, at, derivative + 1);
    EXPECT_LT((numeric - exact).norm(), 1e-5 * exact.norm()) << derivative;
  }
}

// The minimiser of (1): any other spline of the same knots has a larger objective. Checked by the gradient, with the
// penalty integrated by brute force instead of the element matrix.
TEST(SmoothingSpline, MinimisesTheObjective) {
  const int order = 3;
  const double cutoff = 6.0;
  const Eigen::VectorXd t = JitteringClock(60, 0.01, 0.5, 7);
  const SmoothingSpline spline = Make(t, order, cutoff);
  const Eigen::MatrixXd y = Gaussian(60, 1, 8);
  const Eigen::MatrixXd c = spline.Fit(y);
  const Eigen::VectorXd spacing = SampleSpacing(t);
  const double lambda = std::pow(2 * M_PI * cutoff, -2 * order);
  const int fine = 40001;
  const double h = (t[59] - t[0]) / (fine - 1);
  const Eigen::VectorXd grid = Eigen::VectorXd::LinSpaced(fine, t[0], t[59]);
  const Eigen::VectorXd curve = spline.Evaluate(c, grid, order);
  const Eigen::VectorXd residual = y - spline.Evaluate(c, t, 0);
  for (const int k : {0, 3, 10, spline.num_coefficients() - 1}) {
    Eigen::MatrixXd direction = Eigen::MatrixXd::Zero(spline.num_coefficients(), 1);
    direction(k, 0) = 1.0;
    const double data = (spacing.array() * residual.array() * spline.Evaluate(direction, t, 0).col(0).array()).sum();
    const Eigen::VectorXd products = curve.cwiseProduct(spline.Evaluate(direction, grid, order).col(0));
    const double penalty = lambda * h * (products.sum() - 0.5 * (products[0] + products[fine - 1]));
    // The second derivative's third is piecewise quadratic: the trapezoidal rule on 40 000 steps errs by
    // about 1e-6 of it.
    const double size = lambda * h * products.cwiseAbs().sum() + 1e-12;
    EXPECT_NEAR(data, penalty, 1e-4 * size) << k;
    EXPECT_GT(size, 1e-9) << k;
  }
}

TEST(SmoothingSpline, SampleWeightsAreTheTransposedFit) {
  const Eigen::VectorXd t = JitteringClock(150, 0.01, 0.5, 9);
  const SmoothingSpline spline = Make(t, 4, 7.0);
  const Eigen::MatrixXd y = Gaussian(150, 2, 10);
  const Eigen::MatrixXd g = Gaussian(spline.num_coefficients(), 3, 11);
  const Eigen::MatrixXd direct = g.transpose() * spline.Fit(y);
  EXPECT_LT((spline.SampleWeights(g).transpose() * y - direct).norm(), 1e-9 * direct.norm());
}

}  // namespace
}  // namespace idim::smoothing_spline_test
