#pragma once
/// Kernels of several GPUs: lists of the elements of a rank, and stores with the barrier that follows.
#include "backend/cuda/peer_signals.cuh"
#include "backend/peers/peer_kernels.h"

namespace rubble::RUBBLE_CORE {

/// Does a test select from another list?
template <class Test> inline constexpr bool kSelectsOfList = requires(const Test& test, const SolverData& s) {
  test.of(s, 0);
};
/// Appends the elements of [0, n), or of another list, that pass a test to a list, block by block: in order
/// within a block. One kernel in place of the three of a library's selection (docs/research/tuning-log.md).
template <class Test>
__global__ void __launch_bounds__(kThreads)
    listElements(const __grid_constant__ SolverData s, const Test test, Count n, int* list, int* listed,
                 Gate gate) {
  constexpr int kWarps = kThreads / kWarp;
  constexpr int kEach = 8;  // elements of a thread for each addition to the length
  __shared__ int sums[kWarps], begin;
  gate.enter([&] {
    const int count = n.get(), warp = static_cast<int>(threadIdx.x) / kWarp;
    const Tile<kWarp> tile = Tile<kWarp>::ofThread();
    for (int base = static_cast<int>(blockIdx.x) * kThreads * kEach; base < count;
         base += static_cast<int>(gridDim.x) * kThreads * kEach) {
      // warp by warp, kEach times kWarp elements
      const int first = base + warp * kEach * kWarp + tile.lane;
      unsigned passed[kEach];
      int own = 0, element[kEach];
#pragma unroll
      for (int k = 0; k < kEach; ++k) {
        const int at = first + k * kWarp, i = at < count ? elementOf<Test>(n, at) : -1;
        const bool passes = i >= 0 && test(s, i);
        if constexpr (kSelectsOfList<Test>)
          element[k] = passes ? test.of(s, i) : -1;
        else
          element[k] = i;
        passed[k] = tile.ballot(passes);
        own += __popc(passed[k]);
      }
      if (tile.lane == 0) sums[warp] = own;
      __syncthreads();
      if (threadIdx.x == 0) {
        int sum = 0;
        for (int w = 0; w < kWarps; ++w) {
          const int of = sums[w];
          sums[w] = sum, sum += of;
        }
        begin = atomicAdd(listed, sum);
      }
      __syncthreads();
      int place = begin + sums[warp];
#pragma unroll
      for (int k = 0; k < kEach; ++k) {
        if (passed[k] >> tile.lane & 1)
          list[place + __popc(passed[k] & ((1u << tile.lane) - 1))] = element[k];
        place += __popc(passed[k]);
      }
      __syncthreads();
    }
  });
}
/// Writes a list behind the `first` elements of the one that begins it.
static __global__ void __launch_bounds__(kThreads)
    joinLists(const int* first, Count more, int* list, int* listed, Gate gate) {
  gate.enter([&] {
    const int begin = *first, count = more.get(),
              thread = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
    for (int k = thread; k < count; k += static_cast<int>(gridDim.x * blockDim.x))
      list[begin + k] = more.list[k];
    if (thread == 0) *listed = begin + count;
  });
}
/// Bodies for each thread that stores poses of a color: few are seen by others.
inline constexpr int kBodiesPerStore = 64;
/// Places for each thread that joins lists: few are taken.
inline constexpr int kEntriesPerJoin = 64;

struct CloseOtherTrees : PeerKernel {
  __device__ void operator()(const SolverData& s, int n) const {
    if (const TreeNode& node = s.treeNode[n];
        node.tree == n && node.body >= 0 && !p.isMine(p.owner[node.body]))
      s.treeConverged[n] = 1;
  }
};

/// A tile of lanes per slice.
struct SeeSlicesByTile {
  static constexpr int kWidth = 8;
  SeeSlices see;
  __device__ void operator()(const SolverData& s, int i, const Tile<kWidth>& tile) const {
    see(s, i, tile.lane, kWidth);
  }
};
template <> struct OnDevice<SeeSlices> { using Type = SeeSlicesByTile; };

/// Adds to counters of other devices.
struct GivePartnersAcross {
  static constexpr const char* kStage = GivePartners::kStage;
  GivePartners give;
  __device__ void operator()(const SolverData& s, int i) const {
    give.give(s, i, [](int* counter, int n) { return atomicAdd_system(counter, n); });
  }
};
template <> struct OnDevice<GivePartners> { using Type = GivePartnersAcross; };

/// Lanes share the motion of a body so that those of a warp fill whole lines: stores of a few bytes each
/// take as long on the connection as whole lines.
struct ShareMotionByTile {
  static constexpr const char* kStage = ShareMotion::kStage;
  static constexpr bool kPosts = ShareMotion::kPosts;
  static constexpr int kWidth = 4;
  ShareMotion share;
  __device__ void operator()(const SolverData& s, int i, const Tile<kWidth>& tile) const {
    static_assert(sizeof(Displacement) == 2 * sizeof(Lanes) && sizeof(Quat) == sizeof(Lanes));
    if (share.p.owner[i] < 0) return;
    const int lane = tile.lane;
    // lanes 0 and 1: halves of dx; lane 2: dq
    const auto part = [&](const SolverData& of) {
      return lane < 2 ? reinterpret_cast<Lanes*>(of.dx + i) + lane : reinterpret_cast<Lanes*>(of.dq + i);
    };
    forEachPeer(share.p, [&](const PeerTables& to) {
      if (lane < 3)
        to.put(*part(to.s), *part(s)), to.put(to.s.nextCorrection[i][lane], s.nextCorrection[i][lane]);
      else
        to.put(to.s.fast[i], s.fast[i]);
    });
  }
};
template <> struct OnDevice<ShareMotion> { using Type = ShareMotionByTile; };

/// ShareColor for the bodies of a color among those that others see.
struct ShareSeenOfColor : PeerPost {
  int color;
  __device__ void operator()(const SolverData& s, int body) const {
    if (isSwept(s, body) && s.color[body] == color) sharePose(s, p, body);
  }
};
static __global__ void __launch_bounds__(kThreads)
    storeColor(const __grid_constant__ SolverData s, const ShareSeenOfColor push, Count shared,
               PeerSignals signals, Control* control) {
  awaitPrevious();
  if (control->stop != 0 || push.color >= s.counters->colors) return;
  runStrided(s, push, shared.get(), [&](int k) { return shared.list[k]; });
  meetAfterStores(signals, control);
}

/// The barrier after other kernels, unless `condition` points to zero.
static __global__ void __launch_bounds__(kMostPeers)
    meetAll(PeerSignals signals, const int* condition, Control* control) {
  awaitPrevious();
  if (control->stop == 0 && (!condition || *condition != 0)) meetPeers(signals, control);
}

/// Each color has a launch of its own: between two there is an exchange.
static __global__ void requireColors(Control* control, const int* colors, Room room) {
  awaitPrevious();
  if (control->stop != 0) return;
  control->wideColors = *colors;
  checkRoom(control, *colors, room);
}

}  // namespace rubble::RUBBLE_CORE
