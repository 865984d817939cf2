#pragma once
/// Turns functors of the step into kernels, and provides the kernels that replace decisions of the host.
#include <cooperative_groups.h>
#include <cuda_runtime.h>

#include "backend/cuda/tile.cuh"
#include "backend/division.h"

namespace rubble::RUBBLE_CORE {

inline constexpr int kThreads = 128;

/// Stop flag of a step. When a table is too small the step stops: all later kernels see the flag and return.
/// The host grows the table and continues from that operation.
struct Control {
  int stop;        ///< 0, or 1 + the operation that could not be performed
  int lacking;     ///< kind of the table that is too small (Per)
  int needed;      ///< elements needed
  int wideColors;  ///< colors up to the last that is worth a launch
};
/// Of a sequence of operations, and of the one that runs beside it for a while (KernelLauncher::together).
struct Controls {
  Control main, beside;
};
/// Control::lacking of a step that another device does not answer. Control::needed is its rank.
inline constexpr int kLostPeer = -1;

/// Allows the dependent kernel to launch. It still waits for the end of this one.
__device__ inline void callNext() {
#if defined(__CUDA_ARCH__) && __CUDA_ARCH__ >= 900
  cudaTriggerProgrammaticLaunchCompletion();
#endif
}
/// With programmatic dependent launch (CudaExecutor::launchNext) a kernel may have started early. It waits
/// here until the previous one has ended and its writes are visible.
__device__ inline void awaitEnd() {
#if defined(__CUDA_ARCH__) && __CUDA_ARCH__ >= 900
  cudaGridDependencySynchronize();
#endif
}
/// First call of each kernel of the step. Afterwards the next one may start, which hides launch latency.
__device__ inline void awaitPrevious() {
  awaitEnd();
  callNext();
}
/// Minimum compute capability for programmatic dependent launch.
inline constexpr int kEarlyLaunchMajor = 9;

/// When a kernel is skipped, and when it starts.
struct Gate {
  const Control* control;
  bool beside = false;  ///< independent of the previous kernel: waits for it at the end instead of the start
  __device__ bool closed() const { return control->stop != 0; }

  template <class Work> __device__ void enter(Work&& work) const {
    if (beside)
      callNext();
    else
      awaitPrevious();
    if (!closed()) work();
    if (beside) awaitPrevious();
  }
};

/// A number of elements, known on the host or counted on the device.
struct Count {
  int fixed;                  ///< added to the counted number
  const int* counted;         ///< device counter, or null
  const int* list = nullptr;  ///< the elements, if they are not the first ones
  int parts = 1;              ///< of each listed joint; the elements are those of partInGroups()
  int joints = 0;             ///< number of joints, listed or not
  __device__ int get() const { return (counted ? *counted + fixed : fixed) * parts; }
};
/// Do the elements of a kernel include the parts of joints?
template <class Kernel>
inline constexpr bool kHasJointParts = Divided<Kernel>::kCut == Cut::Joints ||
                                       Divided<Kernel>::kCut == Cut::OwnJoints;
template <class Kernel> __device__ int elementOf(const Count& n, int k) {
  if constexpr (kHasJointParts<Kernel>)
    if (n.parts > 1) {
      const PartIndex at = partInGroups(k, *n.counted, n.parts);
      return numberInGroups({n.list[at.joint], at.part}, n.joints, n.parts);
    }
  return n.list ? n.list[k] : k;
}

/// Stops a sequence of operations if another one has stopped.
static __global__ void passStopOn(const Control* from, Control* to) {
  awaitPrevious();
  if (from->stop != 0 && to->stop == 0) *to = *from;
}

__device__ inline void lack(Control* control, int operation, int lacking, int needed) {
  control->lacking = lacking;
  control->needed = needed;
  control->stop = operation + 1;
}

/// A kernel whose elements count something: kernel(s, i, tile, tally), where each thread has a Tally of its
/// own, and tell(s, tally) at the end, where whole warps add them up. An atomic of each element, all on one
/// address, would keep a part of the second-level cache from everything else.
template <class Kernel>
concept Counts = requires {
  typename Kernel::Tally;
};

/// kernel(s, elementAt(k)) for all k < count, as a grid-stride loop. The lanes of a tile stay together.
template <class Kernel, class ElementAt>
__device__ void runStrided(const SolverData& s, const Kernel& kernel, int count, ElementAt&& elementAt) {
  constexpr unsigned kWidth = widthOf<Kernel>();
  static_assert(kThreads % kWidth == 0);
  const int stride = static_cast<int>(gridDim.x * blockDim.x / kWidth);
  const auto forEach = [&](auto&& act) {
    for (int k = static_cast<int>((blockIdx.x * blockDim.x + threadIdx.x) / kWidth); k < count; k += stride)
      act(elementAt(k));
  };
  if constexpr (Counts<Kernel>) {
    typename Kernel::Tally tally;
    forEach([&](int i) { apply(kernel, s, i, tally); });
    __syncwarp();
    kernel.tell(s, tally);
  } else {
    forEach([&](int i) { apply(kernel, s, i); });
  }
}

/// kernel(s, i) for n elements.
template <class Kernel>
__global__ void __launch_bounds__(kThreads)
    runKernel(const __grid_constant__ SolverData s, const Kernel kernel, Count n, Gate gate) {
  gate.enter([&] { runStrided(s, kernel, n.get(), [&](int k) { return elementOf<Kernel>(n, k); }); });
}

/// A kernel with launch bounds: a number of blocks per multiprocessor, which limits its registers.
template <class Kernel>
concept Limited = requires {
  Kernel::kBlocks;
};
template <Limited Kernel>
__global__ void __launch_bounds__(kThreads, Kernel::kBlocks)
    runLimited(const __grid_constant__ SolverData s, const Kernel kernel, Count n, Gate gate) {
  gate.enter([&] { runStrided(s, kernel, n.get(), [&](int k) { return elementOf<Kernel>(n, k); }); });
}

/// A kernel whose elements are slices of aggregates: kWidth lanes for those of the finest level, which are
/// small, and a warp for others.
template <class Kernel>
concept OfSlices = requires {
  Kernel::kOfSlices;
};
template <OfSlices Kernel>
__global__ void __launch_bounds__(kThreads)
    runOfSlices(const __grid_constant__ SolverData s, const Kernel kernel, Count n, Gate gate) {
  gate.enter([&] {
    const int fine = s.levelSlice[1], all = n.get(), threads = static_cast<int>(gridDim.x * blockDim.x),
              thread = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
    const auto each = [&]<int kWidth>(int begin, int end, int thread) {
      for (int k = begin + thread / kWidth; k < end; k += threads / kWidth) {
        const int i = elementOf<Kernel>(n, k);
        if (!n.list || (i < fine) == (kWidth < kWarp)) kernel(s, i, Tile<kWidth>::ofThread());
      }
    };
    each.template operator()<kWarp>(n.list ? 0 : fine, all, thread);
    // from the last warp on, which had the fewest of the others
    const int inWarp = thread % kWarp, fromLast = threads - kWarp - (thread - inWarp) + inWarp;
    each.template operator()<Kernel::kWidth>(0, n.list ? all : fine, fromLast);
  });
}

/// kernel(s, i) for offsets[range] <= i < offsets[range + 1].
template <class Kernel>
__global__ void __launch_bounds__(kThreads, 6)
    runRange(const __grid_constant__ SolverData s, const Kernel kernel, const int* offsets, int range,
             Gate gate) {
  awaitPrevious();
  if (gate.closed()) return;
  const int begin = offsets[range];
  runStrided(s, kernel, offsets[range + 1] - begin, [&](int k) { return begin + k; });
}

/// 0 to modulo - 1, repeated.
struct WriteIndices {
  int* array;
  int modulo;
  __device__ void operator()(const SolverData&, int i) const { array[i] = i % modulo; }
};

/// For key k: its first place among `count` sorted keys. Keys compare as unsigned numbers, so negative keys
/// come last.
struct FindFirst {
  const int* sorted;
  int count;
  int* offsets;
  __device__ void operator()(const SolverData&, int k) const {
    int low = 0, high = count;
    while (low < high) {
      const int middle = low + (high - low) / 2;
      if (static_cast<unsigned>(sorted[middle]) < static_cast<unsigned>(k))
        low = middle + 1;
      else
        high = middle;
    }
    offsets[k] = low;
  }
};

/// Input of a scan: zero beyond the last element.
struct CountAt {
  const int* counts;
  const int* counted;
  int fixed, limit;
  __host__ __device__ int count() const {
    const int n = counted ? *counted : fixed;
    return n < limit ? n : limit;
  }
  __host__ __device__ int operator()(int i) const { return i < count() ? counts[i] : 0; }
};

/// Capacity of a table whose elements a step counts, and the operation that needs it.
struct Room {
  int per, capacity, operation;
};

__device__ inline void checkRoom(Control* control, int count, const Room& room) {
  if (count > room.capacity) lack(control, room.operation, room.per, count);
}

/// A counter whose table must have room for it; null: none.
struct RoomCheck {
  int* counter = nullptr;
  Room room{};
};

/// Arrays to be cleared in one launch.
struct Clears {
  static constexpr int kMost = 12;
  struct Array {
    int* first;
    const int* counted;  ///< device counter of its elements, or null
    int most;            ///< elements at most
  } array[kMost];
  int count = 0;
};

/// Clears arrays and checks room. Should that lack, blocks that see it leave out their share, for the step is
/// continued from the operation that checks.
static __global__ void __launch_bounds__(kThreads)
    clearArrays(const __grid_constant__ Clears clears, RoomCheck check, Control* control) {
  awaitPrevious();
  if (control->stop != 0) return;
  const int thread = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x),
            threads = static_cast<int>(gridDim.x * blockDim.x);
  for (int k = 0; k < clears.count; ++k) {
    const Clears::Array& a = clears.array[k];
    const int n = a.counted ? min(*a.counted, a.most) : a.most;
    for (int i = thread; i < n; i += threads) a.first[i] = 0;
  }
  if (thread == 0 && check.counter) checkRoom(control, *check.counter, check.room);
}

/// How all threads of a grid share the n elements of a kernel. `claimed`: counter of the phase, zero before
/// it.
template <class Kernel> struct OnGrid {
  Kernel kernel;
  __device__ void operator()(const SolverData& s, int n, int* claimed) const {
    runStrided(s, kernel, n, [](int k) { return k; });
  }
};
/// share(begin, end) for ranges of n elements, each claimed by a warp when it has time: elements differ much
/// in cost.
template <class Share> __device__ void shareClaimed(int n, int range, int* claimed, Share&& share) {
  const Tile<kWarp> tile = Tile<kWarp>::ofThread();
  for (;;) {
    int begin = 0;
    if (tile.lane == 0) begin = atomicAdd(claimed, range);
    begin = __shfl_sync(tile.mask, begin, 0);
    if (begin >= n) return;
    share(begin, min(begin + range, n));
  }
}
/// One element per lane.
template <class Kernel> struct ClaimedOnGrid {
  Kernel kernel;
  __device__ void operator()(const SolverData& s, int n, int* claimed) const {
    constexpr int kRangesPerWarp = 8;
    const int warps = static_cast<int>(gridDim.x * blockDim.x) / kWarp,
              range = kWarp * max(n / (kWarp * kRangesPerWarp * warps), 1);
    shareClaimed(n, range, claimed, [&](int begin, int end) {
      for (int k = begin + static_cast<int>(threadIdx.x) % kWarp; k < end; k += kWarp) kernel(s, k);
    });
  }
};
template <class Kernel, When kW> struct GridPhase {
  OnGrid<Kernel> kernel;
  Count count;
  int* claimed;
  __device__ void run(const SolverData& s) const { kernel(s, count.get(), claimed); }
  /// In a round, or at the end, if the phase belongs there.
  template <bool atEnd>
  __device__ void runIn(const SolverData& s, const cooperative_groups::grid_group& grid) const {
    if constexpr ((kW == When::AtEnd) == atEnd) {
      if constexpr (kW != When::Beside) grid.sync();
      run(s);
    }
  }
  __device__ void begin() const { *claimed = 0; }
};

/// Rounds of phases until one leaves *left at zero. Cooperative: all blocks of the grid are resident.
inline constexpr int kGridThreads = 256;
template <class Take, class... Others>
__global__ void __launch_bounds__(kGridThreads)
    runRounds(const __grid_constant__ SolverData s, int* left, int* turn, int most, Gate gate, Take take,
              Others... others) {
  if (gate.closed()) return;
  const auto grid = cooperative_groups::this_grid();
  int round = *turn;
  for (; round < most && *static_cast<volatile int*>(left) != 0; ++round) {
    take.run(s);
    grid.sync();
    if (grid.thread_rank() == 0) *left = 0, *turn = round + 1, (others.begin(), ...);
    (others.template runIn<false>(s, grid), ...);
    grid.sync();
  }
  if (round > 0) (others.template runIn<true>(s, grid), ...);
}

}  // namespace rubble::RUBBLE_CORE
