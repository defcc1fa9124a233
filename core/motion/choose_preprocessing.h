// Cut-off and decimation from the recordings themselves, where the study gives none.
//
// Per joint, S(f) is the power spectral density of the position, from Welch's spectrum of its second differences (which
// takes the steep motion spectrum's leakage away) divided by their gain, on a uniform clock directly, on a jittering
// one from a smoothing spline at 0.4 of the nominal rate. The noise floor F is the median of S over the upper half of
// the usable band. Two frequencies come out of it:
//
//   crossing   the lowest frequency at which S - F falls to F (mean over a third of an octave): above it a Wiener
//   filter would
//              take the position for noise, below it for motion; the same for q, dq and ddq;
//   bandwidth  99.9 % of the power of the velocity, (2 pi f)^2 (S - F) up to the crossing, lies below it.
//
// The cut-off is the largest crossing of any joint, but within 5 and 20 bandwidths and at most 0.4 of the sampling
// rate. The lower limit is the rule of thumb of Gautier's identification papers (e.g. M. Gautier, A. Janot, P.-O.
// Vandanjon, IEEE TCST 21, 2013): five times the dynamics or more, so that the low-pass distorts neither magnitude nor
// derivatives. Above the upper limit positions carry vibration of the structure, which a rigid model does not explain;
// the factor 20 was set where it comes within a quarter of what people chose for the two arms whose recordings were at
// hand (TX-40: 120 Hz, people 100 Hz; UR10e: 7.8 and 9.8 Hz, people 9.4 Hz). The bandwidth is the upper median over the
// joints, because a joint that hardly moves has the bandwidth of its neighbours' vibration, and the largest over the
// recordings. The result is rounded to two digits.
//
// Decimation: D = rate / cut-off rounded down, which puts the decimated Nyquist frequency at half the cut-off, as in
// the reference (100 Hz, 5 kHz, D = 50). There the low-pass still passes 1 / (1 + 2^-8) = 99.6 %, so that what the
// parallel decimation leaves is not distorted. Gautier's D = 0.8 rate / (2 f_p), f_p the pass band of the decimation,
// gives the same for f_p = 0.4 cut-offs.

#ifndef IDIM_CORE_MOTION_CHOOSE_PREPROCESSING_H_
#define IDIM_CORE_MOTION_CHOOSE_PREPROCESSING_H_

#include <vector>

#include "core/base/status.h"
#include "core/motion/preprocessing.h"
#include "core/recording/recording.h"
#include "core/recording/study.h"

namespace idim {

// One choice for all recordings of a study. What the request holds is taken as it is; the other number is chosen, a
// decimation for the cut-off that applies. `reason` of the result says all of it. BadInput: a request out of range;
// with nothing requested, recordings shorter than 64 samples or in which no joint moves; a gap in a clock longer than
// five nominal steps (shorter gaps lower the cut-off so far that half a period spans them).
Result<Preprocessing> ChoosePreprocessing(const std::vector<const Recording*>& recordings,
                                          const PreprocessingRequest& request,
                                          const PreprocessingOptions& options = {});

}  // namespace idim

#endif  // IDIM_CORE_MOTION_CHOOSE_PREPROCESSING_H_
