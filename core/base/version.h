// Which idim this is.

#ifndef IDIM_CORE_BASE_VERSION_H_
#define IDIM_CORE_BASE_VERSION_H_

namespace idim {

// "0.2.0": the version of the CMake project.
const char* Version();

}  // namespace idim

#endif  // IDIM_CORE_BASE_VERSION_H_
