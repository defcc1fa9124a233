#include "core/base/version.h"

namespace idim {

const char* Version() { return IDIM_VERSION; }

}  // namespace idim
