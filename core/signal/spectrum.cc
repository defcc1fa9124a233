#include "core/signal/spectrum.h"

#include <glog/logging.h>

#include <cmath>
#include <complex>
#include <unsupported/Eigen/FFT>
#include <vector>

namespace idim {

Spectrum WelchSpectrum(const Eigen::MatrixXd& x, double step, int length) {
  const Eigen::Index n = x.rows();
  CHECK(length >= 8 && length % 2 == 0 && length <= n);
  const Eigen::RowVectorXd mean = x.colwise().mean();
  std::vector<double> window(length);
  double power = 0;
  for (int i = 0; i < length; ++i) {
    window[i] = 0.5 - 0.5 * std::cos(2.0 * M_PI * i / length);
    power += window[i] * window[i];
  }
  const int bins = length / 2 + 1;
  Spectrum spectrum;
  spectrum.frequency = Eigen::VectorXd::LinSpaced(bins, 0.0, 0.5 / step);
  spectrum.density = Eigen::MatrixXd::Zero(bins, x.cols());
  Eigen::FFT<double> fft;
  fft.SetFlag(Eigen::FFT<double>::HalfSpectrum);
  std::vector<double> segment(length);
  std::vector<std::complex<double>> transformed;
  for (Eigen::Index begin = 0; begin + length <= n; begin += length / 2) {
    ++spectrum.segments;
    for (Eigen::Index c = 0; c < x.cols(); ++c) {
      for (int i = 0; i < length; ++i) segment[i] = window[i] * (x(begin + i, c) - mean[c]);
      fft.fwd(transformed, segment);
      for (int b = 0; b < bins; ++b) spectrum.density(b, c) += std::norm(transformed[b]);
    }
  }
  spectrum.density *= 2.0 * step / (power * spectrum.segments);
  spectrum.density.row(0) *= 0.5;
  spectrum.density.row(bins - 1) *= 0.5;
  return spectrum;
}

}  // namespace idim
