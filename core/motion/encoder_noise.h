// Standard deviation of the encoder noise of each joint, estimated from the recording itself.
//
// Model: recorded q = motion + noise, the motion below the cut-off of the low-pass, the noise white. Then the residual
// r = q - S q of the low-pass S is (I - S) noise, and
//
//   E r_i^2 = sigma^2 c,    c = tr((I - S)(I - S)') / N                                                  (1)
//
// (1 - 2 s_0 + sum s_i^2 from the impulse response on a uniform clock; by Hutchinson's trace estimator with fixed-seed
// random signs, to about 1 %, on a jittering one).
//
// Robust: (1) is applied to blocks of four periods of the cut-off, and sigma^2 is the median over the blocks divided by
// the median of chi^2_nu / nu with nu = c times the block's samples. A few blocks with vibration or shocks above the
// cut-off do not move it.
//
// Dwells: quantised data at rest repeat themselves and leave no residual, which says nothing about the noise in motion.
// Blocks count only where the position passes at least 8 of its own steps (the smallest change in the block): then
// quantisation crosses at least two steps a period of the cut-off, its error lies above the cut-off, and the residual
// holds it in full. Data that are not quantised pass this at rest too. Floor: where one quantisation step explains all
// changes of a joint, sigma is at least step / sqrt(12).
//
// The noise is assumed white: the residual sees it above the cut-off, the joint states suffer from it below.

#ifndef IDIM_CORE_MOTION_ENCODER_NOISE_H_
#define IDIM_CORE_MOTION_ENCODER_NOISE_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/base/status.h"
#include "core/motion/preprocessing.h"
#include "core/recording/recording.h"

namespace idim {

struct EncoderNoise {
  Eigen::VectorXd sigma;                // n, [rad or m]
  Eigen::VectorXd quantization;         // n, step [rad or m] where one was detected, else 0
  std::vector<std::string> provenance;  // n, how each sigma was found, for a person
};

// `states` as EstimateJointStates() made them. A joint whose position never changes by 8 steps has no residual to judge
// by: it gets the floor, or, lacking a step too, the largest sigma of the other joints. BadInput:
// no joint moves at all.
Result<EncoderNoise> EstimateEncoderNoise(const Recording& recording, const Preprocessing& preprocessing,
                                          const JointStates& states);

// The step that all changes between consecutive samples are multiples of, or 0: at least 20 changes, 98 % of those
// below 50 steps within a tenth of a step of a multiple.
double QuantizationStep(const Eigen::Ref<const Eigen::VectorXd>& x);

}  // namespace idim

#endif  // IDIM_CORE_MOTION_ENCODER_NOISE_H_
