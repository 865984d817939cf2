#pragma once
/// Tiles: groups of lanes of a warp that process one element together. Reductions use a fixed tree and are
/// bitwise reproducible.
#include <cuda_runtime.h>

#include <cstring>

#include "stages/step.h"

namespace rubble::RUBBLE_CORE {

inline constexpr int kWarp = 32;
inline constexpr unsigned kAllLanes = 0xffffffffu;

/// A tile of kWidth lanes, a power of two up to a warp. All lanes make the same calls.
template <int kWidth> struct Tile {
  static_assert(kWidth >= 1 && kWidth <= kWarp && (kWidth & (kWidth - 1)) == 0);
  int lane;
  unsigned mask;  ///< lanes of the warp in the tile

  /// The tile of the calling thread; blocks are one-dimensional.
  __device__ static Tile ofThread() {
    const unsigned thread = threadIdx.x % kWarp, first = thread & ~static_cast<unsigned>(kWidth - 1);
    return {static_cast<int>(thread - first), (kAllLanes >> (kWarp - kWidth)) << first};
  }

  __device__ Real sum(Real a) const {
#pragma unroll
    for (int step = kWidth / 2; step > 0; step /= 2) a += __shfl_xor_sync(mask, a, step, kWidth);
    return a;
  }
  __device__ Real max(Real a) const {
#pragma unroll
    for (int step = kWidth / 2; step > 0; step /= 2) a = fmaxf(a, __shfl_xor_sync(mask, a, step, kWidth));
    return a;
  }
  __device__ Vec3 sum(const Vec3& a) const { return {sum(a.x), sum(a.y), sum(a.z)}; }
  __device__ int sum(int a) const {
#pragma unroll
    for (int step = kWidth / 2; step > 0; step /= 2) a += __shfl_xor_sync(mask, a, step, kWidth);
    return a;
  }
  /// Exclusive prefix sum over the lanes.
  __device__ int sumBefore(int a) const {
    int total = a;
#pragma unroll
    for (int step = 1; step < kWidth; step *= 2) {
      const int other = __shfl_up_sync(mask, total, step, kWidth);
      if (lane >= step) total += other;
    }
    return total - a;
  }
  /// Bit k: the flag of lane k. The vote of a part of a warp would be taken part by part.
  __device__ unsigned ballot(bool yes) const {
    if constexpr (kWidth == kWarp) return __ballot_sync(mask, yes);
    unsigned bits = static_cast<unsigned>(yes) << lane;
#pragma unroll
    for (int step = kWidth / 2; step > 0; step /= 2) bits |= __shfl_xor_sync(mask, bits, step, kWidth);
    return bits;
  }
};

/// Number of reals in a Block6, and number of sums that each lane keeps.
inline constexpr int kBlockReals = static_cast<int>(sizeof(Block6) / sizeof(Real));
inline constexpr int kPaddedReals = 32;
static_assert(kBlockReals <= kPaddedReals && sizeof(Block6) == sizeof(Real) * kBlockReals);
template <int kWidth> inline constexpr int kRealsPerLane = kPaddedReals / kWidth;

/// Reduce-scatter of blocks over a tile: lane l gets the sums of the reals from kRealsPerLane * l on. Lanes
/// exchange halves in each step, which takes 31 shuffles instead of 27 log2(kWidth).
template <int kWidth>
__device__ void sumBlocks(const Tile<kWidth>& tile, const Block6& block,
                          Real (&sums)[kRealsPerLane<kWidth>]) {
  Real v[kPaddedReals] = {};
  memcpy(v, &block, sizeof block);
#pragma unroll
  for (int step = kWidth / 2, n = kPaddedReals / 2; step > 0; step /= 2, n /= 2) {
    const bool upper = (tile.lane & step) != 0;
#pragma unroll
    for (int k = 0; k < kPaddedReals / 2; ++k) {
      if (k >= n) break;
      const Real sent = upper ? v[k] : v[k + n], kept = upper ? v[k + n] : v[k];
      v[k] = kept + __shfl_xor_sync(tile.mask, sent, step, kWidth);
    }
  }
#pragma unroll
  for (int k = 0; k < kRealsPerLane<kWidth>; ++k) sums[k] = v[k];
}

/// Stores the sums that sumBlocks() left in the lanes.
template <int kWidth>
__device__ void storeSums(const Tile<kWidth>& tile, const Real (&sums)[kRealsPerLane<kWidth>], Block6& to) {
  Real* const numbers = reinterpret_cast<Real*>(&to);
#pragma unroll
  for (int k = 0; k < kRealsPerLane<kWidth>; ++k)
    if (const int i = tile.lane * kRealsPerLane<kWidth> + k; i < kBlockReals) numbers[i] = sums[k];
}

/// Loads what storeSums() stored.
template <int kWidth>
__device__ void loadSums(const Tile<kWidth>& tile, const Block6& from, Real (&sums)[kRealsPerLane<kWidth>]) {
  const Real* const numbers = reinterpret_cast<const Real*>(&from);
#pragma unroll
  for (int k = 0; k < kRealsPerLane<kWidth>; ++k) {
    const int i = tile.lane * kRealsPerLane<kWidth> + k;
    sums[k] = i < kBlockReals ? numbers[i] : Real(0);
  }
}

/// All-gather of the sums that sumBlocks() left in the lanes.
template <int kWidth>
__device__ Block6 gatherSums(const Tile<kWidth>& tile, const Real (&sums)[kRealsPerLane<kWidth>]) {
  Real v[kBlockReals];
#pragma unroll
  for (int k = 0; k < kBlockReals; ++k)
    v[k] = __shfl_sync(tile.mask, sums[k % kRealsPerLane<kWidth>], k / kRealsPerLane<kWidth>, kWidth);
  Block6 block;
  memcpy(static_cast<void*>(&block), v, sizeof block);
  return block;
}

/// Sum over the lanes of a tile, the same in all lanes.
template <int kWidth> __device__ Block3 sumOf(const Tile<kWidth>& tile, const Block3& own) {
  Block3 sum;
  sum.f = tile.sum(own.f);
  sum.h = {tile.sum(own.h.xx), tile.sum(own.h.xy), tile.sum(own.h.xz),
           tile.sum(own.h.yy), tile.sum(own.h.yz), tile.sum(own.h.zz)};
  return sum;
}

template <int kWidth> __device__ Block6 sumOf(const Tile<kWidth>& tile, const Block6& own) {
  Real v[kBlockReals];
  memcpy(v, &own, sizeof own);
#pragma unroll
  for (int k = 0; k < kBlockReals; ++k) v[k] = tile.sum(v[k]);
  Block6 sum;
  memcpy(static_cast<void*>(&sum), v, sizeof sum);
  return sum;
}

/// Sum over a warp, all of whose lanes are here.
__device__ inline int sumOfWarp(int own) { return __reduce_add_sync(~0u, own); }
/// *p += 1 with warp aggregation: one atomic for the converged threads. Returns a unique number per thread,
/// from the old *p on.
__device__ inline int claimTogether(int* p) {
  const unsigned here = __activemask();
  const int lane = static_cast<int>(threadIdx.x % kWarp), first = __ffs(static_cast<int>(here)) - 1;
  int base = 0;
  if (lane == first) base = atomicAdd(p, __popc(here));
  return __shfl_sync(here, base, first) + __popc(here & ((1u << lane) - 1));
}

/// Lanes that share an element: the most of the given numbers, in ascending order, with which `count`
/// elements take no more than `threads` threads; else the fewest. It depends on the count and the device
/// alone, so that the order of sums is reproducible.
template <int kFewest, int... kMore>
__host__ __device__ constexpr int lanesFor(std::int64_t count, std::int64_t threads) {
  int lanes = kFewest;
  ((lanes = count * kMore <= threads ? kMore : lanes), ...);
  return lanes;
}
/// Calls f.operator()<lanes>() for that one of the given numbers.
template <int... kLanes, class F> __host__ __device__ void withLanes(int lanes, F&& f) {
  ((lanes == kLanes ? f.template operator()<kLanes>() : void()), ...);
}

/// Maps a stage to its device kernel. A kernel with `kWidth` lanes has operator()(SolverData, element,
/// Tile<kWidth>) in place of the stage's operator()(SolverData, element). It is constructed from the stage's
/// functor.
template <class Kernel> struct OnDevice { using Type = Kernel; };
/// A strict build runs the stages unchanged: one thread per element, sums in the order of the CPU.
#if defined(RUBBLE_STRICT)
inline constexpr bool kStrict = true;
#else
inline constexpr bool kStrict = false;
#endif
template <class Kernel>
using DeviceKernel = std::conditional_t<kStrict, Kernel, typename OnDevice<Kernel>::Type>;

template <class Kernel> auto onDevice(const Kernel& kernel) {
  using Type = DeviceKernel<Kernel>;
  if constexpr (std::is_constructible_v<Type, const Kernel&>)
    return Type(kernel);
  else
    return Type{};
}

template <class Kernel>
concept Tiled = requires {
  Kernel::kWidth;
};

/// Threads per element.
template <class Kernel> constexpr int widthOf() {
  if constexpr (Tiled<Kernel>)
    return Kernel::kWidth;
  else
    return 1;
}

/// kernel(s, i, lane) for the element of this thread's tile.
template <class Kernel, class... Tally>
__device__ void apply(const Kernel& kernel, const SolverData& s, int i, Tally&... tally) {
  if constexpr (Tiled<Kernel>)
    kernel(s, i, Tile<Kernel::kWidth>::ofThread(), tally...);
  else
    kernel(s, i, tally...);
}

}  // namespace rubble::RUBBLE_CORE
