#include "core/base/parallel_for.h"

#include <gtest/gtest.h>

#include <mutex>
#include <set>
#include <stdexcept>
#include <thread>
#include <vector>

namespace idim::parallel_for_test {
namespace {

TEST(ParallelFor, DoesEachItemOnce) {
  for (const int threads : {1, 2, 7}) {
    for (const int count : {0, 1, 5, 1000}) {
      std::vector<int> times(static_cast<size_t>(count), 0);
      ParallelFor(threads, count, [&](int k) { ++times[static_cast<size_t>(k)]; });
      EXPECT_EQ(times, std::vector<int>(static_cast<size_t>(count), 1)) << threads << " threads";
    }
  }
}

// An item waits for the other: with fewer threads than asked for this would never end.
TEST(ParallelFor, UsesTheThreadsAskedFor) {
  std::mutex mutex;
  std::set<std::thread::id> ids;
  ParallelFor(2, 2, [&](int) {
    size_t seen = 0;
    while (seen < 2) {
      const std::lock_guard<std::mutex> lock(mutex);
      ids.insert(std::this_thread::get_id());
      seen = ids.size();
    }
  });
  EXPECT_EQ(ids.count(std::this_thread::get_id()), 1u);
}

TEST(ParallelFor, ThrowsWhatAnItemThrew) {
  for (const int threads : {1, 3}) {
    EXPECT_THROW(ParallelFor(threads, 100,
                             [](int k) {
                               if (k == 17) throw std::bad_alloc();
                             }),
                 std::bad_alloc);
  }
}

}  // namespace
}  // namespace idim::parallel_for_test
