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

/// FindCorrections for the own ones of 32 bodies, and ShareMotion unless that posts letters. Four lanes share
/// the motion of a body, so that those of the warp fill whole lines: stores of a few bytes each take as long
/// on the connection as whole lines.
struct FindAndShareMotion {
  static constexpr const char* kStage = FindCorrections::kStage;
  static constexpr int kWidth = kWarp, kLanesPerBody = 4;
  ShareMotion share;
  __device__ void operator()(const SolverData& s, int warp, const Tile<kWidth>& tile) const {
    const int first = warp * kWarp, i = first + tile.lane;
    const bool own = i < s.bodies && OwnBody{share.p}(s, i);
    if (own) FindCorrections{}(s, i);
    const unsigned sent = tile.ballot(own && !share.p.box && share.p.owner[i] >= 0);
    __syncwarp(tile.mask);
    for (int k = tile.lane / kLanesPerBody; k < kWarp; k += kWarp / kLanesPerBody)
      if (sent >> k & 1) sharePart(s, first + k, tile.lane % kLanesPerBody);
  }

 private:
  __device__ void sharePart(const SolverData& s, int i, int part) const {
    static_assert(sizeof(Displacement) == 2 * sizeof(Lanes) && sizeof(Quat) == sizeof(Lanes));
    // parts 0 and 1: halves of dx; part 2: dq
    const auto of = [&](const SolverData& t) {
      return part < 2 ? reinterpret_cast<Lanes*>(t.dx + i) + part : reinterpret_cast<Lanes*>(t.dq + i);
    };
    forEachPeer(share.p, [&](const PeerTables& to) {
      if (part < 3)
        to.put(*of(to.s), *of(s)), to.put(to.s.nextCorrection[i][part], s.nextCorrection[i][part]);
      else
        to.put(to.s.fast[i], s.fast[i]);
    });
  }
};

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
