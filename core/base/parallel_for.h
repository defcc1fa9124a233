// One loop over independent items on several threads.

#ifndef IDIM_CORE_BASE_PARALLEL_FOR_H_
#define IDIM_CORE_BASE_PARALLEL_FOR_H_

#include <functional>

namespace idim {

// work(k) for k = 0 .. count - 1, each once, on `threads` (>= 1) threads, of which the caller's is one; returns when
// all are done. Which thread takes which k is open, so that work(k) writes what is of k alone, or locks. An exception
// of one of them (memory, say) ends the loop early and is thrown again here.
void ParallelFor(int threads, int count, const std::function<void(int k)>& work);

}  // namespace idim

#endif  // IDIM_CORE_BASE_PARALLEL_FOR_H_
