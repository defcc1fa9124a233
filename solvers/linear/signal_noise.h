// Noise of the control signals, from a system of gains itself.

#ifndef IDIM_SOLVERS_LINEAR_SIGNAL_NOISE_H_
#define IDIM_SOLVERS_LINEAR_SIGNAL_NOISE_H_

#include <Eigen/Core>

#include "solvers/linear/gain_system.h"

namespace idim {

// n x n, entry (j, k): standard deviation of the noise in the column of gain k in the rows of joint j, in the unit of
// the column (signal unit times transmission ratio). For j = k it is what ordinary least squares leaves of the column
// after all other columns of the equations of joint k alone, the known torque included. The signal is the response
// there, so that its own noise biases nothing, and other joints have no part in it; errors of the other columns and of
// the model count as noise of the signal. For j != k (signal on the motor side) the same
// noise through the transmission.
Eigen::MatrixXd SignalNoise(const GainSystem& system, double rank_tolerance);

}  // namespace idim

#endif  // IDIM_SOLVERS_LINEAR_SIGNAL_NOISE_H_
