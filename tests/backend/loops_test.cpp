/// Loops over threads of the library and over tasks of a host.
#include <algorithm>
#include <atomic>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "platform/threads.h"
#include "tests/support/many_threads.h"

namespace rubble {
namespace {

const test::ManyThreads kThreadsOfLoops(8);

/// A host that runs tasks one after another, the last one first.
TaskSystem backward(int parts) {
  TaskSystem tasks;
  tasks.parts = parts;
  tasks.run = [](int n, void (*task)(void*, int), void* context) {
    for (int k = n; k-- > 0;) task(context, k);
  };
  return tasks;
}

void expectAllOnce(Threads& threads, int n, int grain) {
  std::vector<std::atomic<int>> taken(static_cast<std::size_t>(n));
  std::atomic<int> ranges = 0, shortest = n;
  std::mutex mutex;
  threads.run([&] {
    forEachShare(n, grain, [&](int begin, int end) {
      EXPECT_EQ(begin % 4, 0) << n;
      for (int i = begin; i < end; ++i) ++taken[static_cast<std::size_t>(i)];
      ++ranges;
      const std::lock_guard lock(mutex);
      shortest = std::min<int>(shortest, end - begin);
    });
  });
  const auto label = std::to_string(n) + " by " + std::to_string(grain);
  for (const auto& each : taken) ASSERT_EQ(each, 1) << label;
  EXPECT_GE(shortest, std::min(n, grain)) << label;
  EXPECT_LE(ranges, 8 * threads.count()) << label;
}

TEST(Loops, SharesHaveEachElementOnceInRangesOfAGrainAndMore) {
  std::vector<std::unique_ptr<Threads>> all;
  for (const int count : {1, 2, 3, 5, 8}) {
    all.push_back(std::make_unique<Threads>(count));
    all.push_back(std::make_unique<Threads>(0, backward(count)));
  }
  for (const auto& threads : all)
    for (const int n : {1, 2, 7, 8, 9, 15, 16, 63, 64, 100, 1000, 12345})
      for (const int grain : {4, 8, 52}) expectAllOnce(*threads, n, grain);
}

TEST(Loops, OfNothingRunNothing) {
  forEachShare(0, 8, [](int, int) { FAIL(); });
  forEachRange(0, 8, [](std::size_t, std::size_t) { FAIL(); });
  forEachTask(0, [](std::size_t) { FAIL(); });
}

}  // namespace
}  // namespace rubble
