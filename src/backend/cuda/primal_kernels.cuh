#pragma once
/// The primal update: several lanes a body gather its points, and one warp solves the local problems of a block's bodies.
#include "backend/cuda/kernels.cuh"

namespace rubble::RUBBLE_CORE {

/// Colours of at most this many bodies share a launch of one block: an extra launch would take longer than they do.
inline constexpr int kTailBodies = 128;
inline constexpr int kTailThreads = 512;
/// Blocks of a colour's kernel that a multiprocessor holds at a time.
inline constexpr int kSolveBlocks = 4;
/// Lanes a body: few where bodies fill the device, so that none is idle; more where they don't, so that a body takes fewer rounds. By the
/// population alone, and not by the kernel that finds the colour: the order of sums must be the same each time.
inline constexpr int kCrowdWidth = 8, kFewWidth = 16;
inline constexpr int kCrowd = 4096;

/// Rare, and large: a call keeps its registers out of the kernels that contacts fill.
static __device__ __noinline__ void addJointApart(const View& s, std::uint32_t code, Block6* sum) {
  Block6 own;
  addJoint(s, code, own);
  *sum = own;
}

/// Forces and Hessians of the row blocks of a body that are this lane's.
template <int kWidth>
__device__ Block6 gatherRows(const View& s, int body, int lane) {
  constexpr int kStride = kWidth / kLanes;
  const int end = s.entryOffset[body + 1], point = lane % kLanes;
  int k = s.entryOffset[body] + lane / kLanes;
  Block6 own;
  // the code of the next round is on its way while this one is worked on
  std::uint32_t next = k < end ? s.entry[k].code : 0;
  for (; k < end; k += kStride) {
    const std::uint32_t code = next;
    if (k + kStride < end) next = s.entry[k + kStride].code;
    if (entryType(code) == kContactType) {
      addContact<Real>(s, code, point, own);
    } else if (point == 0) {
      Block6 joint;
      addJointApart(s, code, &joint);
      addBlock(own, joint);
    }
  }
  return own;
}

template <int kBlockThreads>
using BlockSums = Real[kBlockThreads / kCrowdWidth][kPaddedReals + 1];

/// Solves `count` bodies of one colour, which share no rows: all blocks of a grid that call it together.
template <int kBlockThreads, int kWidth>
__device__ void solveBodies(const View& s, const int* bodies, int count, BlockSums<kBlockThreads>& sums) {
  constexpr int kBodies = kBlockThreads / kWidth;
  const Tile<kWidth> tile = Tile<kWidth>::ofThread();
  const int thread = static_cast<int>(threadIdx.x), slot = thread / kWidth, stride = static_cast<int>(gridDim.x) * kBodies;
  for (int first = static_cast<int>(blockIdx.x) * kBodies; first < count; first += stride) {
    Block6 own;
    if (first + slot < count) own = gatherRows<kWidth>(s, bodies[first + slot], tile.lane);
    Real mine[kRealsPerLane<kWidth>];
    sumBlocks(tile, own, mine);
#pragma unroll
    for (int k = 0; k < kRealsPerLane<kWidth>; ++k) sums[slot][tile.lane * kRealsPerLane<kWidth> + k] = mine[k];
    __syncthreads();
    if (thread < kBodies && first + thread < count) {
      const int body = bodies[first + thread];
      Block6 block, rows;
      const Pose x = startBlock(s, body, block);
      memcpy(static_cast<void*>(&rows), sums[thread], sizeof rows);
      addBlock(block, rows);
      finishBlock(s, body, block, x);
    }
    __syncthreads();
  }
}

template <int kBlockThreads>
__device__ void solveColorTogether(const View& s, int color, BlockSums<kBlockThreads>& sums) {
  const int begin = s.colorOffset[color], count = s.colorOffset[color + 1] - begin;
  if (count > kCrowd)
    solveBodies<kBlockThreads, kCrowdWidth>(s, s.colorBody + begin, count, sums);
  else
    solveBodies<kBlockThreads, kFewWidth>(s, s.colorBody + begin, count, sums);
}

/// One colour.
static __global__ void __launch_bounds__(kThreads, kSolveBlocks)
    solveColor(const __grid_constant__ View s, int color, const Control* control) {
  __shared__ BlockSums<kThreads> sums;
  if (control->stop == 0 && color < s.counters->colors) solveColorTogether<kThreads>(s, color, sums);
}

/// The colours from `first` on, one after another in one block, whatever their size. Notes how many colours are worth a launch.
static __global__ void __launch_bounds__(kTailThreads) solveTail(const __grid_constant__ View s, int first, Control* control) {
  if (control->stop != 0) return;
  __shared__ BlockSums<kTailThreads> sums;
  const int colors = s.counters->colors;
  for (int c = static_cast<int>(threadIdx.x); c < colors; c += kTailThreads)
    if (s.colorOffset[c + 1] - s.colorOffset[c] > kTailBodies) atomicMax(&control->wideColors, c + 1);
  for (int c = first; c < colors; ++c) solveColorTogether<kTailThreads>(s, c, sums);
}

}  // namespace rubble::RUBBLE_CORE
