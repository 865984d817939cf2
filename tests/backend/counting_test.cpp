/// Prefix sums and counting sorts on several threads against loops.
#include "backend/cpu/counting.h"

#include <gtest/gtest.h>

#include "tests/support/random.h"

namespace rubble {
namespace {

using test::Random;

constexpr int kThreads[] = {1, 2, 5, 16};
/// Below one range, at the edges of ranges, and above.
constexpr int kSizes[] = {0, 1, kLeastOfRange - 1, 2 * kLeastOfRange, 5 * kLeastOfRange + 3};

int below(Random& random, int n) { return static_cast<int>(random.uniform(0, n)); }

TEST(Counting, SumsAreThoseOfALoopOnAnyNumberOfThreads) {
  Random random(1);
  Threads pool(2);
  for (const int n : kSizes) {
    std::vector<int> counts(static_cast<std::size_t>(n) + 1);
    for (int& count : counts) count = below(random, 5);
    std::vector<int> expected{0};
    for (int i = 0; i < n; ++i) expected.push_back(expected.back() + counts[static_cast<std::size_t>(i)]);
    for (const int threads : kThreads) {
      std::vector<int> sums(expected.size(), -1), cleared = counts;
      pool.run([&] {
        scanOnThreads(counts.data(), sums.data(), n, threads);
        clearOnThreads(cleared.data(), n, threads);
      });
      EXPECT_EQ(sums, expected) << n << " on " << threads;
      EXPECT_EQ(std::count(cleared.begin(), cleared.end() - 1, 0), n);
      EXPECT_EQ(cleared.back(), counts.back()) << "the element behind the last one is left alone";
    }
  }
}

TEST(Counting, SortKeepsTheOrderOfEqualKeysOnAnyNumberOfThreads) {
  Random random(2);
  Threads pool(2);
  for (const int members : {1, 700, kLeastOfRange + 7, 3 * kLeastOfRange}) {
    constexpr int kRows = 3, kKeysOfRow = 40;
    const int n = (kRows - 1) * members + (members + 1) / 2, count = kRows * kKeysOfRow;
    std::vector<int> keys;
    std::vector<std::vector<int>> expected(static_cast<std::size_t>(count));
    for (int i = 0; i < n; ++i) {
      keys.push_back(i / members * kKeysOfRow + below(random, 2 * kKeysOfRow));
      if (keys.back() >= (i / members + 1) * kKeysOfRow) keys.back() = -1;
      if (keys.back() >= 0) expected[static_cast<std::size_t>(keys.back())].push_back(i % members);
    }
    CountingSort sort;
    for (const int threads : kThreads) {
      std::vector<int> offsets(static_cast<std::size_t>(count) + 1), order(keys.size());
      pool.run([&] { sort.run(keys.data(), n, members, count, offsets.data(), order.data(), threads); });
      for (std::size_t k = 0; k < expected.size(); ++k)
        EXPECT_EQ(std::vector<int>(order.begin() + offsets[k], order.begin() + offsets[k + 1]), expected[k])
            << members << " on " << threads << ", key " << k;
    }
  }
}

}  // namespace
}  // namespace rubble
