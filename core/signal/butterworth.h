// Zero-phase Butterworth low-pass of uniformly sampled signals.
//
// A digital Butterworth filter of order n (bilinear transformation with the cut-off prewarped) as a cascade of
// second-order sections, run forwards and then backwards over the signal. The two passes cancel each other's phase
// and square the magnitude: with x = tan(pi f h) / tan(pi f_c h),
//
//   |H(f)|^2 = 1 / (1 + x^(2 n)),                                                                     (1)
//
// so that the gain at the cut-off is 1/2 (-6 dB), as with `filtfilt` of other packages. Away from the ends polynomials
// of degree below 2 n pass unchanged. At the ends the signal is continued by its odd reflection about the end point and
// every section starts in its steady state (F. Gustafsson discusses the alternatives), so a constant passes unchanged
// everywhere; what else the ends distort dies out within about two periods of the cut-off.
//
// Why written here: Debian 12 has no maintained double-precision C++ library of digital filters with zero-phase
// operation; the ones there (SoX, liquid-dsp, JUCE ports) work in single precision or are causal.
//
// S. Butterworth, "On the theory of filter amplifiers", 1930; A. V. Oppenheim, R. W. Schafer, "Discrete-Time Signal
// Processing", ch. 7; F. Gustafsson, "Determining the initial states in forward-backward filtering", IEEE TSP 44, 1996.

#ifndef IDIM_CORE_SIGNAL_BUTTERWORTH_H_
#define IDIM_CORE_SIGNAL_BUTTERWORTH_H_

#include <Eigen/Core>
#include <vector>

namespace idim {

class ButterworthFilter {
 public:
  // order >= 1, 0 < cutoff_hz < 1 / (2 step) (CHECK).
  ButterworthFilter(int order, double cutoff_hz, double step);

  int order() const { return order_; }
  double cutoff_hz() const { return cutoff_hz_; }

  // |H(f)|^2 of equation (1), what one call of ZeroPhase() applies.
  double ZeroPhaseGain(double frequency_hz) const;

  // Samples by which a signal is continued at each end: two periods of the cut-off, in which the slowest pole pair of
  // the fourth-order filter decays to exp(-4 pi sin(pi / 8)) = 0.8 %. A signal must be longer than this.
  int padding() const { return padding_; }

  // x: N samples, N > padding() (CHECK). Returns N + 2 margin filtered samples: `margin` more at each end, which are
  // filtered continuation and serve central differences at the ends. 0 <= margin <= padding() (CHECK).
  Eigen::VectorXd ZeroPhase(const Eigen::Ref<const Eigen::VectorXd>& x, int margin = 0) const;

 private:
  // y = (b0 + b1 z^-1 + b2 z^-2) / (1 + a1 z^-1 + a2 z^-2) x; first-order sections have b2 = a2 = 0.
  struct Section {
    double b0, b1, b2, a1, a2;
    double z1, z2;  // state in response to a constant 1, transposed direct form II
  };

  void RunInPlace(double* x, Eigen::Index n, Eigen::Index stride) const;

  int order_;
  double cutoff_hz_;
  double step_;
  int padding_;
  std::vector<Section> sections_;
};

}  // namespace idim

#endif  // IDIM_CORE_SIGNAL_BUTTERWORTH_H_
