// The covariance of a sum over samples that are correlated in time (Newey & West 1987, Andrews 1991).

#ifndef IDIM_CORE_STATISTICS_LONG_RUN_COVARIANCE_H_
#define IDIM_CORE_STATISTICS_LONG_RUN_COVARIANCE_H_

#include <Eigen/Core>
#include <utility>
#include <vector>

namespace idim {

// Begin and end of the samples of each recording.
using SampleRanges = std::vector<std::pair<Eigen::Index, Eigen::Index>>;

// Andrews 1991, eq. (5.3), (6.2), (6.4), Bartlett: from AR(1) of each column of rows (samples x c), all of the same
// weight. At most a third of the shortest recording.
int ChooseLag(const Eigen::MatrixXd& rows, const SampleRanges& recordings);

// c x c: sum of autocovariances of rows (samples x c) up to `lag` with Bartlett weights, as the mean square of sums
// over moving windows, which reach over the ends. Not negative.
Eigen::MatrixXd LongRunCovariance(const Eigen::MatrixXd& rows, const SampleRanges& recordings, int lag);

}  // namespace idim

#endif  // IDIM_CORE_STATISTICS_LONG_RUN_COVARIANCE_H_
