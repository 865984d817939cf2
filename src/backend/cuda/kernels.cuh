#pragma once
/// How a functor of the step becomes a kernel, and the few kernels that replace decisions of the host.
#include <cooperative_groups.h>
#include <cuda_runtime.h>

#include "backend/cuda/tile.cuh"

namespace rubble::RUBBLE_CORE {

inline constexpr int kThreads = 128;

/// A step that lacks room stops: every later kernel sees it and does nothing, and the host goes on from there
/// with more room.
struct Control {
  int stop;        ///< 0, or 1 + the operation that could not be done
  int lacking;     ///< what there is too little of: a Per
  int needed;      ///< how many
  int wideColors;  ///< colours up to the last that is worth a launch
};

/// The next kernel may come, though it will wait for this one to end.
__device__ inline void callNext() {
#if defined(__CUDA_ARCH__) && __CUDA_ARCH__ >= 900
  cudaTriggerProgrammaticLaunchCompletion();
#endif
}
/// The first thing that a kernel of the step does. It may have been launched while the one before it was
/// running (CudaExecutor::launchNext), and waits here until that one has ended and all that it wrote can be
/// seen; then the next one may come. What is hidden so is the launch.
__device__ inline void awaitPrevious() {
#if defined(__CUDA_ARCH__) && __CUDA_ARCH__ >= 900
  cudaGridDependencySynchronize();
#endif
  callNext();
}
/// Devices of this compute capability and higher can do that.
inline constexpr int kEarlyLaunchMajor = 9;

/// When a kernel has nothing to do, and when it begins.
struct Gate {
  const Control* control;
  bool beside = false;  ///< the kernel before it: it waits for that one last, and not first
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
  int fixed;           ///< added to what is counted
  const int* counted;  ///< or null
  __device__ int get() const { return counted ? *counted + fixed : fixed; }
};

__device__ inline void lack(Control* control, int operation, int lacking, int needed) {
  control->lacking = lacking;
  control->needed = needed;
  control->stop = operation + 1;
}

/// kernel(s, i) for all i of [begin, begin + count), whatever the size of the grid. The lanes of a tile go
/// along together.
template <class Kernel>
__device__ void runStrided(const SolverData& s, const Kernel& kernel, int begin, int count) {
  constexpr unsigned kWidth = widthOf<Kernel>();
  static_assert(kThreads % kWidth == 0);
  const int stride = static_cast<int>(gridDim.x * blockDim.x / kWidth);
  for (int k = static_cast<int>((blockIdx.x * blockDim.x + threadIdx.x) / kWidth); k < count; k += stride)
    apply(kernel, s, begin + k);
}

/// kernel(s, i) for all i < n.
template <class Kernel>
__global__ void __launch_bounds__(kThreads)
    runKernel(const __grid_constant__ SolverData s, const Kernel kernel, Count n, Gate gate) {
  gate.enter([&] { runStrided(s, kernel, 0, n.get()); });
}

/// A kernel that wants so many blocks on a multiprocessor at a time, and its registers limited for it.
template <class Kernel>
concept Limited = requires {
  Kernel::kBlocks;
};
template <Limited Kernel>
__global__ void __launch_bounds__(kThreads, Kernel::kBlocks)
    runLimited(const __grid_constant__ SolverData s, const Kernel kernel, Count n, Gate gate) {
  gate.enter([&] { runStrided(s, kernel, 0, n.get()); });
}

/// kernel(s, i) for offsets[range] <= i < offsets[range + 1].
template <class Kernel>
__global__ void __launch_bounds__(kThreads, 6)
    runRange(const __grid_constant__ SolverData s, const Kernel kernel, const int* offsets, int range,
             Gate gate) {
  awaitPrevious();
  if (gate.closed()) return;
  runStrided(s, kernel, offsets[range], offsets[range + 1] - offsets[range]);
}

struct FillArray {
  int* array;
  int value;
  __device__ void operator()(const SolverData&, int i) const { array[i] = value; }
};

/// 0 to modulo - 1, again and again.
struct WriteIndices {
  int* array;
  int modulo;
  __device__ void operator()(const SolverData&, int i) const { array[i] = i % modulo; }
};

/// Of key k: its first place among `count` sorted keys. Keys are compared as unsigned numbers, so that
/// negative ones are the last.
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

/// Input of a scan: zeros beyond the last element.
struct CountAt {
  const int* counts;
  const int* counted;
  int fixed, limit;
  __host__ __device__ int operator()(int i) const {
    const int n = counted ? *counted : fixed;
    return i < n && i < limit ? counts[i] : 0;
  }
};

/// Room for elements that a step counts, and the operation that needs it.
struct Room {
  int per, capacity, operation;
};

__device__ inline void checkRoom(Control* control, int count, const Room& room) {
  if (count > room.capacity) lack(control, room.operation, room.per, count);
}

/// The total of a scan over at most `limit` elements, from behind the last one.
static __global__ void keepTotal(Control* control, const int* offsets, int limit, int* total, Room room) {
  awaitPrevious();
  if (control->stop != 0) return;
  *total = offsets[limit];
  checkRoom(control, *total, room);
}

static __global__ void requireRoom(Control* control, const int* count, Room room) {
  awaitPrevious();
  if (control->stop == 0) checkRoom(control, *count, room);
}

/// kernel(s, k) for as many elements as a warp has lanes, those from batch * kWarp on.
template <class Kernel> struct InBatches {
  Kernel kernel;
  __device__ void operator()(const SolverData& s, int batch, int count, const Tile<kWarp>& tile) const {
    if (const int k = batch * kWarp + tile.lane; k < count) kernel(s, k);
  }
};

/// Rounds of `take`, a thread an element, and `propose`, a warp for as many elements as it has lanes, until a
/// round leaves *left at zero. All blocks of the grid run at a time.
inline constexpr int kRoundThreads = 256;
template <class Take, class Propose>
__global__ void __launch_bounds__(kRoundThreads)
    runRounds(const __grid_constant__ SolverData s, Take take, InBatches<Propose> propose, const int* count,
              int* left, int* rounds, int maxRounds, Gate gate) {
  if (gate.closed()) return;
  const auto grid = cooperative_groups::this_grid();
  const int n = *count, first = static_cast<int>(grid.thread_rank()), stride = static_cast<int>(grid.size());
  for (int round = 0; round < maxRounds && *static_cast<volatile int*>(left) != 0; ++round) {
    for (int k = first; k < n; k += stride) take(s, k);
    grid.sync();
    if (first == 0) *left = 0, *rounds = round + 1;
    grid.sync();
    for (int batch = first / kWarp; batch * kWarp < n; batch += stride / kWarp)
      propose(s, batch, n, Tile<kWarp>::ofThread());
    grid.sync();
  }
}

}  // namespace rubble::RUBBLE_CORE
