# Warnings are errors. No -march above the x86-64 baseline: Debian's Ceres is built with 16-byte Eigen alignment.
add_library(idim_compile_options INTERFACE)
target_compile_options(idim_compile_options INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Werror)
# Position-independent functions would else not be inlined where they are defined: nobody replaces them at load time.
target_compile_options(idim_compile_options INTERFACE -fno-semantic-interposition)
set(CMAKE_CXX_FLAGS_RELEASE "-O3 -DNDEBUG")

option(IDIM_SANITIZE "AddressSanitizer and UndefinedBehaviorSanitizer" OFF)
if(IDIM_SANITIZE)
  # Eigen would otherwise wrap malloc under AddressSanitizer, which Ceres' own Eigen does not.
  set(IDIM_SANITIZE_FLAGS -fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer
                          -DEIGEN_MALLOC_ALREADY_ALIGNED=1)
  add_compile_options(${IDIM_SANITIZE_FLAGS})
  add_link_options(${IDIM_SANITIZE_FLAGS})
  # The instrumentation makes GCC 12 see uninitialised values in <regex> where there are none.
  target_compile_options(idim_compile_options INTERFACE $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
endif()
