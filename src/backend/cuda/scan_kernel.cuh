#pragma once
/// Exclusive prefix sums in one kernel, with decoupled look-back (Merrill and Garland 2016): each block adds
/// up a tile, publishes the sum, and adds what the tiles before it have published.
#include <cub/block/block_exchange.cuh>
#include <cub/block/block_scan.cuh>

#include "backend/cuda/kernels.cuh"

namespace rubble::RUBBLE_CORE {

inline constexpr int kScanThreads = 256, kScanItems = 8, kScanTile = kScanThreads * kScanItems;
/// Tiles of the sums over `limit` counts and of the total, which follows them.
constexpr int scanTilesFor(int limit) { return limit / kScanTile + 1; }

/// What a tile publishes in a single word, zero before the scan: a sum, and whether that is the sum of the
/// tile alone or of all tiles up to its end.
class ScanWord {
 public:
  enum State : unsigned { kNothing, kOwn, kUpToEnd };

  ScanWord() = default;
  __device__ ScanWord(State state, int sum)
      : bits_(static_cast<unsigned long long>(state) << 32 | static_cast<unsigned>(sum)) {}
  __device__ State state() const { return static_cast<State>(bits_ >> 32); }
  __device__ int sum() const { return static_cast<int>(static_cast<unsigned>(bits_)); }

  __device__ void publish(const ScanWord& word) {
    *static_cast<volatile unsigned long long*>(&bits_) = word.bits_;
  }
  /// Waits for a block that has started before this one.
  __device__ ScanWord await() const {
    ScanWord word;
    do word.bits_ = *static_cast<const volatile unsigned long long*>(&bits_);
    while (word.state() == kNothing);
    return word;
  }

 private:
  unsigned long long bits_;
};

/// The sum of all tiles before one, for cub::BlockScan, whose first warp calls it with the sum of the tile.
struct ScanPrefix {
  ScanWord* tiles;
  int tile;
  int total = 0;  ///< of all tiles up to the end of this one; valid in the first warp

  __device__ int operator()(int sum) {
    const int lane = static_cast<int>(threadIdx.x) % kWarp;
    if (lane == 0) tiles[tile].publish({tile == 0 ? ScanWord::kUpToEnd : ScanWord::kOwn, sum});
    int before = 0;
    for (int last = tile - 1; last >= 0; last -= kWarp) {
      const int k = last - lane;
      const ScanWord word = k >= 0 ? tiles[k].await() : ScanWord(ScanWord::kUpToEnd, 0);
      const unsigned ends = __ballot_sync(kAllLanes, word.state() == ScanWord::kUpToEnd);
      const int nearest = ends == 0 ? kWarp : __ffs(static_cast<int>(ends)) - 1;
      before += __reduce_add_sync(kAllLanes, lane <= nearest ? word.sum() : 0);
      if (ends != 0) break;
    }
    total = before + sum;
    if (lane == 0 && tile > 0) tiles[tile].publish({ScanWord::kUpToEnd, total});
    return before;
  }
};

/// Stores the offsets, the total from the last element on, and in the counter to be checked, if wanted. The
/// last tile alone may stop the step: all others have published by then, so none returns while another one
/// waits for it.
static __global__ void __launch_bounds__(kScanThreads)
    scanCounts(const CountAt in, int* offsets, ScanWord* tiles, RoomCheck check, bool storesTotal,
               Control* control) {
  awaitPrevious();
  if (control->stop != 0) return;
  using Exchange = cub::BlockExchange<int, kScanThreads, kScanItems>;
  using Scan = cub::BlockScan<int, kScanThreads>;
  __shared__ union {
    typename Exchange::TempStorage exchange;
    typename Scan::TempStorage scan;
  } shared;
  const int tile = static_cast<int>(blockIdx.x), thread = static_cast<int>(threadIdx.x),
            first = tile * kScanTile + thread, count = in.count();
  int sums[kScanItems];
#pragma unroll
  for (int k = 0; k < kScanItems; ++k) {
    const int i = first + k * kScanThreads;
    sums[k] = i < count ? in.counts[i] : 0;
  }
  Exchange(shared.exchange).StripedToBlocked(sums, sums);
  __syncthreads();
  ScanPrefix prefix{tiles, tile};
  Scan(shared.scan).ExclusiveSum(sums, sums, prefix);
  __syncthreads();
  Exchange(shared.exchange).BlockedToStriped(sums, sums);
#pragma unroll
  for (int k = 0; k < kScanItems; ++k)
    if (const int i = first + k * kScanThreads; i <= in.limit) offsets[i] = sums[k];
  if (tile + 1 < static_cast<int>(gridDim.x) || thread != 0 || !check.counter) return;
  if (storesTotal) *check.counter = prefix.total;
  checkRoom(control, *check.counter, check.room);
}

}  // namespace rubble::RUBBLE_CORE
