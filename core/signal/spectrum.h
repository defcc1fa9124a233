// Welch's estimate of a power spectral density (P. D. Welch, IEEE Trans. Audio Electroacoust. 15, 1967).

#ifndef IDIM_CORE_SIGNAL_SPECTRUM_H_
#define IDIM_CORE_SIGNAL_SPECTRUM_H_

#include <Eigen/Core>

namespace idim {

struct Spectrum {
  Eigen::VectorXd frequency;  // [Hz], M frequencies, 0 to the Nyquist frequency
  Eigen::MatrixXd density;    // M x c one-sided [unit^2 / Hz]: its integral over frequency is the variance
  int segments = 0;
};

// x: N x c equidistant samples, `step` seconds apart. Hann windows of `length` samples (even, 8 <= length <= N, CHECK)
// with half an overlap; the mean of each column is removed first.
Spectrum WelchSpectrum(const Eigen::MatrixXd& x, double step, int length);

}  // namespace idim

#endif  // IDIM_CORE_SIGNAL_SPECTRUM_H_
