#pragma once
/// Search for pairs: a lane a body. Fast bodies, whose bounds take many cells, and those with many partners have a whole warp.
#include "backend/cuda/heavy_kernels.cuh"

namespace rubble::RUBBLE_CORE {

/// A number of each warp of a block, counted up by its lanes.
class WarpCounter {
 public:
  __device__ explicit WarpCounter(const Tile<kWarp>& tile) : tile_(tile) {
    __syncwarp(tile.mask);
    if (tile.lane == 0) number() = 0;
    __syncwarp(tile.mask);
  }
  __device__ int next() const { return atomicAdd(&number(), 1); }
  /// Once all lanes have counted.
  __device__ int total() const {
    __syncwarp(tile_.mask);
    return number();
  }

 private:
  __device__ static int& number() {
    __shared__ int numbers[kThreads / kWarp];
    return numbers[threadIdx.x / kWarp];
  }
  const Tile<kWarp>& tile_;
};

/// FindPairs for 32 bodies, where none has parts.
struct FindPairsByWarp {
  static constexpr const char* kName = FindPairs<false>::kName;
  static constexpr int kWidth = kWarp;
  /// Rows of cells that a lane looks through alone.
  static constexpr int kRows = 48;
  __device__ void operator()(const View& s, int warp, const Tile<kWidth>& tile) const {
    const int i = warp * kWarp + tile.lane;
    const bool on = i < s.bodies, wide = on && s.bounds[i].level >= 0 && cellsAround(s, s.bounds[i], s.bounds[i].level).rows() > kRows;
    if (on && !wide) FindPairs<false>{}(s, i);
    forEachOfWarp(tile, wide, i, [&](int body) {
      const WarpCounter partners(tile);
      int* const slots = s.pairSlot + body * kPairSlots;
      searchPartners(s, body, [&](int other) {
        if (const int k = partners.next(); k < kPairSlots) slots[k] = other;
      }, tile.lane, kWarp);
      const int count = partners.total();
      if (tile.lane == 0) s.pairCount[body] = count;
    });
  }
};

/// WritePairs for 32 bodies, where none has parts.
struct WritePairsByWarp {
  static constexpr const char* kName = WritePairs<false>::kName;
  static constexpr int kWidth = kWarp;
  __device__ void operator()(const View& s, int warp, const Tile<kWidth>& tile) const {
    const int i = warp * kWarp + tile.lane;
    const bool on = i < s.bodies, many = on && s.pairOffset[i + 1] - s.pairOffset[i] > kPairSlots;
    if (on && !many) WritePairs<false>{}(s, i);
    forEachOfWarp(tile, many, i, [&](int body) {
      Pair* const first = s.pair + s.pairOffset[body];
      const WarpCounter partners(tile);
      searchPartners(s, body, [&](int other) { first[partners.next()] = {body, other, 0, 0}; }, tile.lane, kWarp);
      sortTogether(first, partners.total(), tile.lane, kWarp, [](const Pair& a, const Pair& b) { return before(a, b); }, [&] { __syncwarp(tile.mask); });
    });
  }
};

}  // namespace rubble::RUBBLE_CORE
