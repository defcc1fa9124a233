#include "core/base/parallel_for.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace idim {

void ParallelFor(int threads, int count, const std::function<void(int k)>& work) {
  std::atomic<int> next{0};
  std::mutex mutex;
  std::exception_ptr first;
  const auto run = [&] {
    try {
      for (int k = next++; k < count; k = next++) work(k);
    } catch (...) {
      next = count;
      const std::lock_guard<std::mutex> lock(mutex);
      if (!first) first = std::current_exception();
    }
  };
  const int extra = std::max(0, std::min(threads, count) - 1);
  std::vector<std::thread> others;
  others.reserve(static_cast<size_t>(extra));  // so that nothing but a thread can fail while some run
  try {
    for (int t = 0; t < extra; ++t) others.emplace_back(run);
  } catch (const std::system_error&) {
    // As many as the system gives.
  }
  run();
  for (std::thread& thread : others) thread.join();
  if (first) std::rethrow_exception(first);
}

}  // namespace idim
