// Parallel decimation: one linear operator, applied alike to every column of the observation matrix and to the signal
// (paper II.C: "parallel decimation of Y and each column of W"). What is linear in the equations stays exact, whatever
// the operator removes or distorts, so long as both sides see the same one.
//
// The operator is a zero-phase FIR low-pass with its cut-off at the decimated Nyquist frequency 1 / (2 D h), a
// Hamming-windowed sinc over +-10 D nominal steps h:
//
//   g(s) = sinc(s / (D h)) (0.54 + 0.46 cos(pi s / (10 D h))),      |s| <= 10 D h,
//   out_k = sum_i w_i g(T_k - t_i) y_i / sum_i w_i g(T_k - t_i),     T_k = t_0 + k D h,                  (1)
//
// evaluated by quadrature on the recorded time, w_i the spacing of sample i. On a uniform clock this is the filter with
// 20 D + 1 taps of scipy.signal.decimate(ftype='fir', zero_phase=True), tap for tap. On a jittering clock the sum
// approximates the integrals by the trapezoidal rule, to leading order in the longest step h_max within
//
//   |error| <= h_max^2 / 12 (int |(g y)''| ds + max |y| int |g''| ds) / int g ds,
//
// which is a flaw of the low-pass, not of the equations: both sides get the same weights.
//
// Edges. A window that an end of the recording cuts is renormalised by (1), which keeps constants exact but makes a
// poorer low-pass, and the filter that made the joint states has its transient there. Outputs nearer to an end than
// max(edge_outputs D h, edge_seconds) are dropped. With the defaults, 45 000 samples and D = 50 give 896 outputs,
// samples 100 to 44 850 (two outputs fewer at each end than the 900 instants T_k).
//
// D = 1 is the identity on either clock (a sinc at the samples' own Nyquist frequency is one on a uniform clock, and
// means nothing on another): the outputs are the samples, less those of the edges.

#ifndef IDIM_CORE_SIGNAL_DECIMATOR_H_
#define IDIM_CORE_SIGNAL_DECIMATOR_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/base/status.h"
#include "core/signal/clock.h"

namespace idim {

struct DecimatorOptions {
  // Nominal steps from one output to the next, >= 1.
  int decimation = 1;
  // Outputs dropped at each end in outputs' spacings, >= 0 (ignored with decimation 1, whose windows are never cut) ...
  double edge_outputs = 2.0;
  // ... and at least this much time [s], >= 0.
  double edge_seconds = 0.0;

  bool IsValid(std::string* error) const;
};

class Decimator {
 public:
  // Sinc zeros on each side of the window's centre.
  static constexpr int kHalfWidth = 10;

  // t: the N instants that `clock` was analysed from. BadInput: nothing is left between the edges; a jittering clock
  // with a gap longer than D nominal steps.
  static Result<Decimator> Create(const Eigen::VectorXd& t, const Clock& clock, const DecimatorOptions& options);

  int samples() const { return samples_; }
  int outputs() const { return static_cast<int>(times_.size()); }
  // [s], the instants T_k of the outputs kept.
  const Eigen::VectorXd& times() const { return times_; }
  const DecimatorOptions& options() const { return options_; }

  // The outputs that a recorded sample contributes to: out[first + j] += weights[j] y_i, j < count. `first` does not
  // decrease with the sample, so one pass with a ring of max_open() accumulators serves any number of columns; count
  // may be 0.
  struct Contribution {
    int first = 0;
    int count = 0;
    const double* weights = nullptr;  // valid as long as the decimator
  };
  Contribution At(int sample) const;
  // The last sample that contributes to an output; once it is added the output is complete.
  int LastSample(int output) const { return last_sample_[output]; }
  int FirstSample(int output) const { return first_sample_[output]; }
  // The greatest number of outputs that are begun and not complete at a time.
  int max_open() const { return max_open_; }

  // The window of an output that nothing cuts, 20 D + 1 taps of sum 1 about its centre.
  // Uniform clock or D = 1 only (CHECK).
  const std::vector<double>& Taps() const;

  // x: N x c columns at the recorded instants. Returns outputs() x c.
  Eigen::MatrixXd Apply(const Eigen::MatrixXd& x) const;

 private:
  Decimator() = default;

  DecimatorOptions options_;
  int samples_ = 0;
  Eigen::VectorXd times_;
  std::vector<int> first_sample_, last_sample_;  // of each output
  int max_open_ = 0;

  // Weights are stored sample by sample in [0, head_) and [tail_, N), where windows are cut or the clock jitters; in
  // between they are the taps, one row of `phases_` for each remainder of the sample by D.
  int head_ = 0, tail_ = 0;
  int half_ = 0;              // half width of the window in samples of a uniform clock
  int grid_offset_ = 0;       // output 0 is instant T_(grid_offset_)
  std::vector<double> taps_;  // empty where the clock jitters and D > 1
  std::vector<double> phases_;
  struct Stored {
    int first = 0;
    int count = 0;
    size_t offset = 0;  // into weights_
  };
  std::vector<Stored> stored_;  // of the head's samples, then of the tail's
  std::vector<double> weights_;
};

}  // namespace idim

#endif  // IDIM_CORE_SIGNAL_DECIMATOR_H_
