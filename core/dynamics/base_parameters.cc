#include "core/dynamics/base_parameters.h"

#include <glog/logging.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "core/base/decompositions.h"
#include "core/base/random.h"

namespace idim {
namespace {

using RowMajorMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// The columns at enough random states that a dependence found there holds everywhere.
Eigen::MatrixXd SampleColumns(StandardModel* model, std::uint64_t seed) {
  const int n = model->dof();
  const int columns = model->columns();
  const int states = 6 * columns / n + 10;
  Random random(seed);
  const auto uniform = [&random](double limit) { return random.Uniform(-limit, limit); };
  Eigen::MatrixXd w(states * n, columns);
  RowMajorMatrix block(n, columns);
  Eigen::VectorXd q(n), dq(n), ddq(n);
  for (int k = 0; k < states; ++k) {
    for (int j = 0; j < n; ++j) {
      q[j] = uniform(model->robot().joints[j].type == JointType::kRevolute ? M_PI : 1.0);
      dq[j] = uniform(3.0);
      ddq[j] = uniform(10.0);
    }
    model->Regressor(q.data(), dq.data(), ddq.data(), nullptr, block.data());
    w.middleRows(k * n, n) = block;
  }
  return w;
}

// "+ 0.225 MX3", "- YY2".
std::string Term(double coefficient, const std::string& name) {
  std::string text = coefficient < 0.0 ? " - " : " + ";
  const double size = std::abs(coefficient);
  if (std::abs(size - 1.0) > 1e-9) {
    char number[32];
    std::snprintf(number, sizeof(number), "%.6g ", size);
    text += number;
  }
  return text + name;
}

}  // namespace

BaseParameters::BaseParameters(StandardModel model, const BaseParameterOptions& options) : model_(std::move(model)) {
  CHECK_GT(options.tolerance, 0.0);
  CHECK_LT(options.tolerance, 1.0);
  Eigen::MatrixXd w = SampleColumns(&model_, options.seed);
  const int columns = model_.columns();
  const double scale = w.colwise().norm().maxCoeff();
  std::vector<int> dropped;
  Eigen::MatrixXd basis(w.rows(), columns);  // orthonormal, of the kept columns
  for (int c = 0; c < columns; ++c) {
    const double norm = w.col(c).norm();
    if (norm <= 1e-12 * scale) {
      without_effect_.push_back(model_.parameters()[c].name);
      continue;
    }
    const auto q = basis.leftCols(size());
    Eigen::VectorXd remainder = w.col(c) / norm;
    for (int pass = 0; pass < 2; ++pass) remainder -= q * (q.transpose() * remainder);  // twice is enough (Kahan)
    const double norm_left = remainder.norm();
    if (norm_left > options.tolerance) {
      basis.col(size()) = remainder / norm_left;
      kept_.push_back(c);
      smallest_kept_ = std::min(smallest_kept_, norm_left);
    } else {
      dropped.push_back(c);
      largest_dropped_ = std::max(largest_dropped_, norm_left);
    }
  }

  Eigen::MatrixXd w_kept(w.rows(), size());
  Eigen::MatrixXd w_dropped(w.rows(), dropped.size());
  for (int k = 0; k < size(); ++k) w_kept.col(k) = w.col(kept_[k]);
  for (size_t d = 0; d < dropped.size(); ++d) w_dropped.col(d) = w.col(dropped[d]);
  const Eigen::MatrixXd b = w_kept.householderQr().solve(w_dropped);

  projection_ = Eigen::MatrixXd::Zero(size(), columns);
  for (int k = 0; k < size(); ++k) {
    Parameter parameter = model_.parameters()[kept_[k]];
    projection_(k, kept_[k]) = 1.0;
    std::string relation = parameter.name;
    bool regrouped = false;
    for (size_t d = 0; d < dropped.size(); ++d) {
      // Geometry in metres and radians: a true coefficient is far above rounding.
      if (std::abs(b(k, d)) < 1e-9) continue;
      projection_(k, dropped[d]) = b(k, d);
      relation += Term(b(k, d), model_.parameters()[dropped[d]].name);
      regrouped = true;
    }
    if (regrouped) parameter.name += "R";
    parameters_.push_back(parameter);
    regroupings_.push_back(regrouped ? relation : "");
  }
}

}  // namespace idim
