// Small words that all pages spell alike.

#ifndef IDIM_APPS_PAGES_WORDS_H_
#define IDIM_APPS_PAGES_WORDS_H_

#include <Eigen/Core>
#include <string>

namespace idim {

std::string JointTitle(Eigen::Index joint);  // "joint 1" of 0
std::string Words(const std::string& id);    // "power viscous" of "power_viscous"
// An error to a hundredth of a per cent; `none` for a negative one, which was never computed.
std::string ErrorText(double percent, const std::string& none);

}  // namespace idim

#endif  // IDIM_APPS_PAGES_WORDS_H_
