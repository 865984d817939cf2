#pragma once
/// Elements with long lists: those with so many parts that a few lanes would finish long after all others,
/// such as a plate under a heap. They are listed once per step, and a whole block or warp processes each.
#include "backend/cuda/kernels.cuh"

namespace rubble::RUBBLE_CORE {

/// Indices of elements with long lists. Their order varies and does not influence results.
struct LongList {
  int* count;
  int* element;
  __device__ void add(int i) const { element[claimTogether(count)] = i; }
};

/// Who solves the elements of a world on several GPUs; without owners, this device.
struct PeerOwners {
  const int* owner = nullptr;
  int rank = 0;
  __device__ bool isMine(int i) const { return !owner || owner[i] == rank || owner[i] < 0; }
};
/// The elements of a list that this device solves.
struct KeepOwn {
  static constexpr const char* kStage = "ranks";
  LongList from, to;
  PeerOwners owners;
  __device__ void operator()(const SolverData&, int k) const {
    if (owners.isMine(from.element[k])) to.add(from.element[k]);
  }
};

/// A body with more constraints than this has high degree. Bodies of a heap have about 20, and a warp sorts
/// two per lane.
inline constexpr int kLongIncidences = 64;
__device__ inline int degreeOf(const SolverData& s, int body) {
  return s.incidenceOffset[body + 1] - s.incidenceOffset[body];
}
__device__ inline bool isHighDegree(const SolverData& s, int body) {
  return !kStrict && degreeOf(s, body) > kLongIncidences;
}

/// Sorts n elements in place by a bitonic network. `threads` threads of a block or warp call it, each with
/// its rank; sync() is their barrier. Each merge starts with a mirrored pass, followed by passes at halved
/// distances. Elements beyond the end are not touched.
template <class T, class Before, class Sync>
__device__ void sortTogether(T* first, int n, int rank, int threads, Before&& before, Sync&& sync) {
  for (int width = 2; width / 2 < n; width *= 2) {
    for (int step = width / 2; step > 0; step /= 2) {
      for (int t = rank;; t += threads) {
        const int low = t / step * (2 * step) + t % step;
        if (low >= n) break;
        const int high = step == width / 2 ? low / width * width + (width - 1 - low % width) : low + step;
        if (high >= n || !before(first[high], first[low])) continue;
        const T kept = first[low];
        first[low] = first[high];
        first[high] = kept;
      }
      sync();
    }
  }
}

/// Calls together(i) with all lanes for each lane's i whose flag is set.
template <class Simd4Kernel>
__device__ void forEachOfWarp(const Tile<kWarp>& tile, bool mine, int i, Simd4Kernel&& together) {
  for (unsigned left = tile.ballot(mine); left != 0; left &= left - 1)
    together(__shfl_sync(tile.mask, i, __ffs(static_cast<int>(left)) - 1));
}
/// Number of warps for a stage over n bodies with one body per lane.
RUBBLE_HD inline int warpsFor(int n) { return (n + kWarp - 1) / kWarp; }

/// SortIncidences for 32 bodies: one lane per short list, and all lanes for one long list at a time. Lists of
/// high-degree bodies are recorded and sorted by one block each.
struct SortIncidencesByWarp {
  static constexpr const char* kStage = SortIncidences::kStage;
  static constexpr int kWidth = kWarp, kFew = 8;
  LongList highDegree;
  __device__ void operator()(const SolverData& s, int warp, const Tile<kWidth>& tile) const {
    const int i = warp * kWarp + tile.lane, count = i < s.bodies ? degreeOf(s, i) : 0;
    if (count > kLongIncidences) highDegree.add(i);
    if (count <= kFew && i < s.bodies) SortIncidences{}(s, i);
    forEachOfWarp(tile, count > kFew && count <= kLongIncidences, i, [&](int body) {
      sortByRank(s.incidence + s.incidenceOffset[body], degreeOf(s, body), tile);
    });
  }

 private:
  /// Rank sort: the place of an incidence is the number of smaller ones.
  __device__ static void sortByRank(Incidence* first, int count, const Tile<kWidth>& tile) {
    constexpr int kTurns = kLongIncidences / kWarp;
    Incidence own[kTurns] = {};
    int place[kTurns] = {};
#pragma unroll
    for (int t = 0; t < kTurns; ++t)
      if (const int k = t * kWarp + tile.lane; k < count) own[t] = first[k];
    for (int j = 0; j < count; ++j) {
      const std::uint32_t mine = j < kWarp ? own[0].code : own[kTurns - 1].code,
                          code = __shfl_sync(tile.mask, mine, j % kWarp);
#pragma unroll
      for (int t = 0; t < kTurns; ++t) place[t] += code < own[t].code ? 1 : 0;
    }
    __syncwarp(tile.mask);
#pragma unroll
    for (int t = 0; t < kTurns; ++t)
      if (t * kWarp + tile.lane < count) first[place[t]] = own[t];
    static_assert(kTurns == 2);
  }
};
inline constexpr int kSortThreads = 512;
static __global__ void __launch_bounds__(kSortThreads)
    sortHighDegree(const __grid_constant__ SolverData s, LongList highDegree, Gate gate) {
  awaitPrevious();
  if (gate.closed()) return;
  for (int h = static_cast<int>(blockIdx.x); h < *highDegree.count; h += static_cast<int>(gridDim.x)) {
    const int body = highDegree.element[h];
    sortTogether(
        s.incidence + s.incidenceOffset[body], degreeOf(s, body), static_cast<int>(threadIdx.x), kSortThreads,
        [](const Incidence& a, const Incidence& b) { return a.code < b.code; }, [] { __syncthreads(); });
  }
}

/// leavesColor() evaluated by a warp.
__device__ inline bool leavesColorTogether(const SolverData& s, int i, bool mayGoDown,
                                           const Tile<kWarp>& tile, int& next) {
  const auto neighbors = [&](auto&& visit) {
    for (int k = s.incidenceOffset[i] + tile.lane; k < s.incidenceOffset[i + 1]; k += kWarp)
      if (s.incidence[k].other >= 0) visit(s.incidence[k].other);
  };
  const auto join = [&](std::uint64_t taken) {
    const unsigned low = __reduce_or_sync(tile.mask, static_cast<unsigned>(taken)),
                   high = __reduce_or_sync(tile.mask, static_cast<unsigned>(taken >> 32));
    return std::uint64_t{high} << 32 | low;
  };
  Surroundings around = lookAround(s, i, neighbors);
  around = {tile.ballot(around.clashes) != 0, tile.ballot(!around.highest) == 0, join(around.taken)};
  if (around.clashes) next = smallestFreeColor(s, neighbors, join);
  return around.clashes || (mayGoDown && goesDown(around, s.color[i], next));
}

/// FindClashes for 32 bodies: one lane each, high-degree bodies by all lanes.
struct FindClashesByWarp {
  static constexpr const char* kStage = FindClashes::kStage;
  static constexpr int kWidth = kWarp;
  __device__ void operator()(const SolverData& s, int warp, const Tile<kWidth>& tile) const {
    const int i = warp * kWarp + tile.lane;
    const bool on = i < s.bodies && isDynamic(s, i), highDegree = on && isHighDegree(s, i);
    if (on && !highDegree) FindClashes{}(s, i);
    forEachOfWarp(tile, highDegree, i, [&](int body) {
      int next = 0;
      const bool leaves = leavesColorTogether(s, body, true, tile, next);
      if (tile.lane != 0) return;
      if (leaves)
        FindClashes::note(s, body, next);
      else
        FindClashes::raiseColors(s, s.color[body]);
    });
  }
};

/// ProposeColors for 32 bodies, as SortIncidencesByWarp.
struct ProposeColorsByWarp {
  static constexpr int kWidth = kWarp;
  ProposeColors kernel;
  int count;
  __device__ void operator()(const SolverData& s, int warp, const Tile<kWidth>& tile) const {
    const int k = warp * kWarp + tile.lane, i = k < count ? s.clashing[k] : -1;
    const bool highDegree = i >= 0 && i < kVertexNode && isHighDegree(s, i);
    if (i >= 0 && !highDegree) kernel(s, k);
    forEachOfWarp(tile, highDegree, i, [&](int body) {
      int next = 0;
      if (!leavesColorTogether(s, body, false, tile, next) || tile.lane != 0) return;
      s.nextColor[body] = next;
      atomicCount(&s.counters->clashes, 1);
    });
  }
};
template <> struct OnGrid<ProposeColors> {
  ProposeColors kernel;
  __device__ void operator()(const SolverData& s, int n, int*) const {
    runStrided(s, ProposeColorsByWarp{kernel, n}, warpsFor(n), [](int k) { return k; });
  }
};

}  // namespace rubble::RUBBLE_CORE
