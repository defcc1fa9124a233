#include "apps/pages/words.h"

#include <algorithm>

#include "core/base/text.h"

namespace idim {

std::string JointTitle(Eigen::Index joint) { return "joint " + std::to_string(joint + 1); }

std::string Words(const std::string& id) {
  std::string words = id;
  std::replace(words.begin(), words.end(), '_', ' ');
  return words;
}

std::string ErrorText(double percent, const std::string& none) {
  return percent < 0.0 ? none : Format("%.2f", percent);
}

}  // namespace idim
