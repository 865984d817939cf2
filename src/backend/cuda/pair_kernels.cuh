#pragma once
/// Bounds: each warp reduces the values of a grid level before it writes them, which avoids contention on the
/// few counters. Pairs of a body in order: one lane per body, and one warp per crowded body, whose cells are
/// searched again.
#include "backend/cuda/long_list_kernels.cuh"
#include "backend/peers/peer_data.h"

namespace rubble::RUBBLE_CORE {

struct ComputeBoundsByWarp {
  static constexpr const char* kStage = ComputeBounds::kStage;
  __device__ void operator()(const SolverData& s, int i) const {
    const Bounds b = ComputeBounds::place(s, i);
    if (b.level < 0) return;
    const unsigned peers = __match_any_sync(__activemask(), b.level);
    const int lane = static_cast<int>(threadIdx.x % kWarp), first = __ffs(static_cast<int>(peers)) - 1;
    int& members = s.counters->levelCount[b.level];
    int k = kListedBodies;
    if (lane == first && members <= kListedBodies) k = atomicAdd(&members, __popc(peers));
    k = __shfl_sync(peers, k, first) + __popc(peers & ((1u << lane) - 1));
    ComputeBounds::list(s, b.level, k, i);
    raiseExtents(s, b, [&](int* most, int value) {
      const int greatest = __reduce_max_sync(peers, value);
      if (lane == first && greatest > *most) atomicMax(most, greatest);
    });
  }
};
template <> struct OnDevice<ComputeBounds> { using Type = ComputeBoundsByWarp; };

/// Several lanes for the search of one body.
template <class Search, int kTile> struct SearchByTile {
  static constexpr const char* kStage = Search::kStage;
  static constexpr int kWidth = kTile;
  Search search;
  __device__ void operator()(const SolverData& s, int i, const Tile<kWidth>& tile) const {
    search(s, i, tile.lane, kWidth);
  }
};
/// FindNeighbors with as many lanes for a body as the number of searches leaves room for: the fewer, the
/// longer one would take alone. Coarse bodies have lanes of several blocks, the last ones, which have the
/// fewest of the others.
static __global__ void __launch_bounds__(kThreads)
    findNeighbors(const __grid_constant__ SolverData s, Gate gate) {
  gate.enter([&] {
    constexpr int kCoarseLanes = 1024;
    const int n = s.counters->searched, threads = static_cast<int>(gridDim.x * blockDim.x),
              thread = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x),
              fromLast = threads - 1 - thread, lanes = lanesFor<1, 2, 8, kWarp>(n, threads);
    const bool all = allSearch(s);
    for (int k = thread / lanes; k < n; k += threads / lanes)
      if (const int i = all ? k : s.searcher[k]; all || !isCoarse(s, s.bounds[i]))
        FindNeighbors::find(s, i, all, thread % lanes, lanes);
    const int coarse = all || fromLast >= kCoarseLanes ? 0 : s.counters->coarse;
    for (int k = 0; k < coarse; ++k)
      FindNeighbors::find(s, s.counters->coarseBody[k], all, fromLast, min(threads, kCoarseLanes));
  });
}
/// FindNeighbors where there are many worlds. A block copies the boxes of the worlds of its bodies to shared
/// memory, where a look does not wait for the cache (5 % of a step of `loose`).
class NeighborsOfWorlds {
 public:
  /// Of the bodies [first, first + kThreads) of n. All threads of a block call it.
  __device__ static void find(const SolverData& s, int first, int n) {
    __shared__ Box boxes[kMostBoxes];
    const int thread = static_cast<int>(threadIdx.x), i = first + thread;
    // rows behind those of the last world belong to none
    const int last = min(first + kThreads, s.bodiesEnd(s.worlds - 1)) - 1;
    if (first > last) return;
    const int begin = isScanned(s, s.worldOf(first)) ? s.bodiesBegin(s.worldOf(first)) : first,
              end = isScanned(s, s.worldOf(last)) ? s.bodiesEnd(s.worldOf(last)) : last + 1;
    __syncthreads();
    for (int k = begin + thread; k < end; k += kThreads)
      boxes[k - begin] = {s.neighborSearch[k].center, s.bounds[k].level, s.neighborSearch[k].half};
    __syncthreads();
    if (i > last || !isInGrid(s, i)) return;
    const int world = s.worldOf(i);
    if (!isScanned(s, world)) return FindNeighbors{}(s, i);
    const Bounds& b = s.bounds[i];
    if (isLongLevel(b.level)) return;
    const NeighborSearch own = s.neighborSearch[i];
    for (int k = s.bodiesBegin(world); k < s.bodiesEnd(world); ++k)
      if (const Box box = boxes[k - begin];
          box.level >= 0 && isAhead(i, b, k, box.level) && boundsTouch(box, own))
        storeNeighbor(s, i, k, false);
    searchPlanes(s, world, own, [&](int plane) { storeNeighbor(s, i, plane, false); });
  }

 private:
  /// The first and the last body of a block may each be the only one of its world in it.
  static constexpr int kMostBoxes = kThreads + 2 * (kScannedBodies - 1);
  struct alignas(16) Box {
    Vec3 center;
    int level;
    Vec3 half;
  };
};
static __global__ void __launch_bounds__(kThreads)
    findNeighborsOfWorlds(const __grid_constant__ SolverData s, int n, Gate gate) {
  gate.enter([&] {
    if (s.counters->searched == 0) return;
    for (int first = static_cast<int>(blockIdx.x) * kThreads; first < n;
         first += static_cast<int>(gridDim.x) * kThreads)
      NeighborsOfWorlds::find(s, first, n);
  });
}

/// What a warp has found to sweep against: few lanes find most of it, so all lanes share it afterwards.
class SweepsOfWarp {
 public:
  __device__ explicit SweepsOfWarp(const Tile<kWarp>& tile) : tile_(tile), list_(listOfWarp()) {
    if (tile.lane == 0) list_.count = 0;
    __syncwarp(tile.mask);
  }
  template <class Sweep> __device__ void add(int other, Sweep&& sweep) const {
    if (const int k = atomicAdd(&list_.count, 1); k < kMost)
      list_.body[k] = other;
    else
      sweepNow(other, sweep);
  }
  template <class Sweep> __device__ void finish(Sweep&& sweep) const {
    __syncwarp(tile_.mask);
    const int count = min(list_.count, kMost);
    for (int k = tile_.lane; k < count; k += kWarp) sweep(list_.body[k]);
    __syncwarp(tile_.mask);
    if (tile_.lane == 0) list_.count = 0;
    __syncwarp(tile_.mask);
  }
  __device__ int agree(int number) const { return __shfl_sync(tile_.mask, number, 0); }

 private:
  static constexpr int kMost = 127;
  /// Not inlined: rare.
  template <class Sweep> __device__ __noinline__ static void sweepNow(int other, const Sweep& sweep) {
    sweep(other);
  }
  struct List {
    int count, body[kMost];
  };
  __device__ static List& listOfWarp() {
    __shared__ List lists[kGridThreads / kWarp];
    return lists[threadIdx.x / kWarp];
  }
  const Tile<kWarp>& tile_;
  List& list_;
};
/// A warp for each body: searches differ much in length.
struct FindUnpairedImpactsByWarp {
  static constexpr const char* kStage = FindUnpairedImpacts::kStage;
  static constexpr int kWidth = kWarp;
  FindUnpairedImpacts search;
  __device__ void operator()(const SolverData& s, int k, const Tile<kWidth>& tile) const {
    search(s, k, tile.lane, kWidth, SweepsOfWarp(tile));
  }
};
template <> struct OnGrid<FindUnpairedImpacts> {
  FindUnpairedImpacts kernel;
  __device__ void operator()(const SolverData& s, int n, int* claimed) const {
    shareClaimed(n, 1, claimed,
                 [&](int k, int) { FindUnpairedImpactsByWarp{kernel}(s, k, Tile<kWarp>::ofThread()); });
  }
};
template <> struct OnGrid<FindImpacts> : ClaimedOnGrid<FindImpacts> {};
template <> struct OnGrid<FindGeneralImpacts> : ClaimedOnGrid<FindGeneralImpacts> {};

/// act(i, tile) with a warp for each crowded body.
template <class Act> __device__ void forEachCrowded(const SolverData& s, Act&& act) {
  const int warps = static_cast<int>(gridDim.x * blockDim.x) / kWarp;
  for (int k = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x) / kWarp; k < s.counters->crowded;
       k += warps)
    act(s.crowdedBody[k], Tile<kWarp>::ofThread());
}

/// A counter per warp of a block, incremented by its lanes.
class WarpCounter {
 public:
  __device__ explicit WarpCounter(const Tile<kWarp>& tile) : tile_(tile) {
    __syncwarp(tile.mask);
    if (tile.lane == 0) number() = 0;
    __syncwarp(tile.mask);
  }
  __device__ int next() const { return atomicAdd(&number(), 1); }
  /// Valid after all lanes have counted.
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

/// A kernel for the bodies at home.
template <class Kernel> struct AtHome {
  static constexpr const char* kStage = Kernel::kStage;
  Kernel kernel;
  PeerHome home;
  __device__ void operator()(const SolverData& s, int i) const {
    if (home.has(i)) kernel(s, i);
  }
};

/// FindPairs for worlds without shapes of several parts: one lane per neighbor, or few lanes in turns.
class PairSearch {
 public:
  /// Of a body whose neighbors are all in slots.
  template <int kWidth> __device__ static void findFew(const SolverData& s, int i, const Tile<kWidth>& tile) {
    const int near = neighborsOf(s, i);
    if (near > kPairSlots) return;
    const int* const slots = s.pairSlot + i * kPairSlots;
    std::uint32_t partners = 0;
    for (int base = 0; base < near; base += kWidth) {
      const int k = base + tile.lane;
      partners |= tile.ballot(k < near && FindPairs<false>::isPartner(s, i, slots[k])) << base;
    }
    if (tile.lane == 0) finish(s, i, partners, __popc(partners));
  }
  /// Of a crowded body, whose cells are searched again.
  __device__ static void findMany(const SolverData& s, int i, const Tile<kWarp>& tile) {
    if (neighborsOf(s, i) <= kPairSlots) return;
    int* const slots = s.pairSlot + i * kPairSlots;
    const WarpCounter partners(tile);
    searchPartners(
        s, i,
        [&](int other) {
          if (const int k = partners.next(); k < kPairSlots) slots[k] = other;
        },
        tile.lane, kWarp);
    const int count = partners.total();
    if (tile.lane == 0) finish(s, i, static_cast<std::uint32_t>((1ull << min(count, kPairSlots)) - 1), count);
  }

 private:
  __device__ static int neighborsOf(const SolverData& s, int i) {
    return s.bounds[i].level >= 0 ? s.neighborSearch[i].found : 0;
  }
  __device__ static void finish(const SolverData& s, int i, std::uint32_t partners, int count) {
    s.neighborSearch[i].partners = partners, s.pairCount[i] = count;
  }
};
template <int kWidth>
static __global__ void __launch_bounds__(kThreads)
    findPairs(const __grid_constant__ SolverData s, int n, Gate gate) {
  gate.enter([&] {
    forEachCrowded(s, [&](int i, const Tile<kWarp>& tile) { PairSearch::findMany(s, i, tile); });
    const int threads = static_cast<int>(gridDim.x * blockDim.x);
    for (int i = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x) / kWidth; i < n;
         i += threads / kWidth)
      PairSearch::findFew(s, i, Tile<kWidth>::ofThread());
  });
}

/// WritePairs for the bodies at home, for worlds without shapes of several parts.
static __global__ void __launch_bounds__(kThreads)
    writePairs(const __grid_constant__ SolverData s, int n, PeerHome home, Gate gate) {
  gate.enter([&] {
    const auto countOf = [&](int i) { return s.pairOffset[i + 1] - s.pairOffset[i]; };
    forEachCrowded(s, [&](int i, const Tile<kWarp>& tile) {
      if (!home.has(i) || countOf(i) <= kPairSlots) return;
      Pair* const first = s.pair + s.pairOffset[i];
      const WarpCounter partners(tile);
      searchPartners(
          s, i, [&](int other) { first[partners.next()] = pairOf(s, i, other); }, tile.lane, kWarp);
      sortTogether(
          first, partners.total(), tile.lane, kWarp,
          [](const Pair& a, const Pair& b) { return before(a, b); }, [&] { __syncwarp(tile.mask); });
    });
    const int threads = static_cast<int>(gridDim.x * blockDim.x);
    for (int i = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x); i < n; i += threads)
      if (home.has(i) && countOf(i) <= kPairSlots) WritePairs<false>::writeFew(s, i, s.pairOffset[i]);
  });
}

}  // namespace rubble::RUBBLE_CORE
