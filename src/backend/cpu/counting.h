#pragma once
/// Prefix sums and counting sorts on the threads of the caller. Results do not depend on their number.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <numeric>
#include <utility>
#include <vector>

#include "platform/threads.h"

namespace rubble {

/// Most ranges of a loop below, and the least elements of one: shorter loops run serially.
inline constexpr int kMostRanges = 64, kLeastOfRange = 16384;

/// The number of ranges for n elements on so many threads.
inline int rangesFor(int n, int threads) {
  return std::clamp(n / kLeastOfRange, 1, std::clamp(threads, 1, kMostRanges));
}
/// Calls f(k, begin, end) for the k-th of `ranges` ranges that make up [0, n).
template <class F> void forEachOfRanges(int n, int ranges, F&& f) {
  const auto at = [&](std::size_t k) {
    return static_cast<int>(static_cast<std::size_t>(n) * k / static_cast<std::size_t>(ranges));
  };
  if (ranges == 1) return f(std::size_t{0}, 0, n);
  forEachTask(static_cast<std::size_t>(ranges), [&](std::size_t k) { f(k, at(k), at(k + 1)); });
}

/// Sets n elements to zero.
inline void clearOnThreads(int* array, int n, int threads) {
  forEachOfRanges(n, rangesFor(n, threads), [&](std::size_t, int begin, int end) {
    std::memset(array + begin, 0, sizeof(int) * static_cast<std::size_t>(end - begin));
  });
}

/// out[i] = in[0] + ... + in[i - 1] for i = 0 .. n. `out` has n + 1 elements and is not `in`.
inline void scanOnThreads(const int* in, int* out, int n, int threads) {
  const int ranges = rangesFor(n, threads);
  std::array<int, kMostRanges> first{};
  if (ranges > 1)
    forEachOfRanges(n, ranges, [&](std::size_t k, int begin, int end) {
      first[k] = std::accumulate(in + begin, in + end, 0);
    });
  int total = 0;
  for (int& sum : first) total += std::exchange(sum, total);
  forEachOfRanges(n, ranges, [&](std::size_t k, int begin, int end) {
    int sum = first[k];
    for (int i = begin; i < end; ++i) {
      out[i] = sum;
      sum += in[i];
    }
    if (end == n) out[n] = sum;
  });
}

/// A counting sort that keeps the order of equal keys. Its memory is kept for the next one.
class CountingSort {
 public:
  /// The numbers 0 .. members - 1 of `n` keys, which lie in rows of `members`, by ascending key: those of key
  /// k are order[offset[k]] .. order[offset[k + 1] - 1]. Keys are below `count`; negative ones are left out.
  void run(const int* key, int n, int members, int count, int* offset, int* order, int threads) {
    const int ranges = rangesFor(n, threads);
    const auto keys = static_cast<std::size_t>(count);
    const std::size_t needed = keys * (static_cast<std::size_t>(ranges) + 1);
    if (places_.size() < needed) places_.resize(needed);
    int* const total = places_.data() + keys * static_cast<std::size_t>(ranges);
    const auto forEachKey = [&](std::size_t range, int begin, int end, auto&& f) {
      int* const own = places_.data() + keys * range;
      for (int row = 0; row < n; row += members)
        for (int m = begin; m < std::min(end, n - row); ++m)
          if (const int k = key[row + m]; k >= 0) f(own, k, m);
    };
    // each range of members counts its keys, then finds where the first of each belongs
    forEachOfRanges(members, ranges, [&](std::size_t range, int begin, int end) {
      std::fill_n(places_.data() + keys * range, keys, 0);
      forEachKey(range, begin, end, [](int* own, int k, int) { ++own[k]; });
    });
    forEachOfRanges(count, rangesFor(count, threads), [&](std::size_t, int begin, int end) {
      for (int k = begin; k < end; ++k) {
        int sum = 0;
        for (std::size_t range = 0; range < static_cast<std::size_t>(ranges); ++range)
          sum += std::exchange(places_[keys * range + static_cast<std::size_t>(k)], sum);
        total[k] = sum;
      }
    });
    scanOnThreads(total, offset, count, threads);
    forEachOfRanges(members, ranges, [&](std::size_t range, int begin, int end) {
      forEachKey(range, begin, end, [&](int* own, int k, int m) { order[offset[k] + own[k]++] = m; });
    });
  }

 private:
  std::vector<int> places_;  ///< [ranges][count], and the numbers of equal keys
};

}  // namespace rubble
