#pragma once
/// The primal update: several lanes a body gather its rows, while the last warps of the block solve the local problems gathered before. Hubs take
/// a block each.
#include "backend/cuda/heavy_kernels.cuh"

namespace rubble::RUBBLE_CORE {

/// Colours of at most this many bodies share a launch of one block: an extra launch would take longer than they do.
inline constexpr int kTailBodies = 128, kTailVertices = 64;
/// Threads of a block that gather; two warps more solve.
inline constexpr int kGatherThreads = 192, kSolvers = 2 * kWarp, kSolveThreads = kGatherThreads + kSolvers;
/// Blocks of a colour's kernel for its hubs, which are few.
inline constexpr int kHubBlocks = 16;
/// Blocks of a colour's kernel that a multiprocessor holds at a time.
inline constexpr int kSolveBlocks = 3;
/// Lanes a body: few where bodies fill the device, so that sums over lanes are short; more where they don't, so that a body takes fewer
/// rounds. By the population alone, and not by the kernel that finds the colour: the order of sums must be the same each time.
inline constexpr int kCrowdWidth = 4, kManyWidth = 8, kFewWidth = 16;
inline constexpr int kCrowd = 32768, kMany = 4096;

/// Adds the joints among the entries [k, end) of a body, a lane each. Rare, and large: a call keeps its registers out of the kernels that contacts fill.
static __device__ __noinline__ void addJointsApart(const View& s, int k, int end, int stride, Block6* sum) {
  for (; k < end; k += stride)
    if (const std::uint32_t code = s.entry[k].code; entryType(code) != kContactType) addJoint(s, code, *sum);
}

static __device__ __noinline__ void addRollingApart(const View& s, int k, int end, int stride, Block6* sum) {
  for (; k < end && entryType(s.entry[k].code) == kContactType; k += stride) addRolling(s, s.entry[k].code, *sum);
}

/// Forces and Hessians of the row blocks of a body that are this lane's, of `kWidth`. any(): does one of them say yes?
template <int kWidth, class Any>
__device__ Block6 gatherRows(const View& s, int body, int lane, Any&& any) {
  constexpr int kStride = kWidth / kLanes;
  const int begin = s.entryOffset[body], end = s.entryOffset[body + 1], point = lane % kLanes;
  int k = begin + lane / kLanes;
  const Displacement own = s.moved[body];
  Block6 sum;
  // entries are sorted by type, contacts first
  for (; k < end; k += kStride) {
    const Entry entry = s.entry[k];
    if (entryType(entry.code) != kContactType) break;
    // known from the entry, the displacement of the other body need not wait for the rows
    const ContactRows& r = s.contact[entryIndex(entry.code)];
    const bool onA = entrySide(entry.code) == 0;
    const Displacement other = s.moved[entry.other >= 0 ? entry.other : onA ? r.b : r.a];
    stampContact<Real>(s.step, r, onA, onA ? own : other, onA ? other : own, point, sum);
  }
  if (s.rolls && point == 0) {
    Block6 rolling = sum;
    addRollingApart(s, begin + lane / kLanes, end, kStride, &rolling);
    sum = rolling;
  }
  // a lane that stopped before the end met a joint
  if (any(k < end)) {
    Block6 joints = sum;
    addJointsApart(s, begin + lane, end, kWidth, &joints);
    sum = joints;
  }
  return sum;
}

/// Sums of the rows of the bodies of a batch, several times: gatherers may be ahead of solvers by so many batches.
inline constexpr int kBuffers = 3;
using BatchSums = Real[kGatherThreads / kCrowdWidth][kPaddedReals + 1];

/// Barriers of a block by number; that of __syncthreads() is 0.
inline constexpr int kFull = 1, kEmpty = kFull + kBuffers;
__device__ inline void waitAt(int barrier) { asm volatile("barrier.sync %0, %1;" ::"r"(barrier), "n"(kSolveThreads) : "memory"); }
__device__ inline void passBy(int barrier) {
  __threadfence_block();
  asm volatile("barrier.arrive %0, %1;" ::"r"(barrier), "n"(kSolveThreads) : "memory");
}

/// Solves `count` bodies of one colour, which share no rows: `shares` blocks that call it together. Ends with all threads at a barrier.
template <int kWidth>
__device__ void solveBodies(const View& s, const int* bodies, int count, int share, int shares, BatchSums (&sums)[kBuffers]) {
  constexpr int kBodies = kGatherThreads / kWidth;
  static_assert(kBodies <= kSolvers);
  const Tile<kWidth> tile = Tile<kWidth>::ofThread();
  const int thread = static_cast<int>(threadIdx.x), slot = thread / kWidth, solver = thread - kGatherThreads;
  const int first = share * kBodies, stride = shares * kBodies;
  const int batches = first < count ? (count - first + stride - 1) / stride : 0;
  for (int batch = 0, buffer = 0; batch < batches; ++batch, buffer = buffer + 1 < kBuffers ? buffer + 1 : 0) {
    const int begin = first + batch * stride;
    if (solver < 0) {
      Block6 own;
      if (begin + slot < count) own = gatherRows<kWidth>(s, bodies[begin + slot], tile.lane, [&](bool yes) { return tile.ballot(yes) != 0; });
      Real mine[kRealsPerLane<kWidth>];
      sumBlocks(tile, own, mine);
      if (batch >= kBuffers) waitAt(kEmpty + buffer);
#pragma unroll
      for (int k = 0; k < kRealsPerLane<kWidth>; ++k) sums[buffer][slot][tile.lane * kRealsPerLane<kWidth> + k] = mine[k];
      passBy(kFull + buffer);
    } else {
      const bool on = solver < kBodies && begin + solver < count;
      const int body = on ? bodies[begin + solver] : 0;
      Block6 block, rows;
      Pose x;
      if (on) x = startBlock(s, body, block);
      waitAt(kFull + buffer);
      if (on) memcpy(static_cast<void*>(&rows), sums[buffer][solver], sizeof rows);
      // the last ones are waited for by nobody
      if (batch + kBuffers < batches) passBy(kEmpty + buffer);
      if (on) {
        addBlock(block, rows);
        finishBlock(s, body, block, x);
      }
    }
  }
  __syncthreads();
}

/// A hub by all threads of a block. `sums` is shared memory.
static __device__ __noinline__ void solveHub(const View& s, int body, Real (&sums)[kSolveThreads / kWarp][kWarp]) {
  const Tile<kWarp> tile = Tile<kWarp>::ofThread();
  const int thread = static_cast<int>(threadIdx.x), warp = thread / kWarp;
  const Block6 own = gatherRows<kSolveThreads>(s, body, thread, [](bool yes) { return __syncthreads_or(yes) != 0; });
  Real mine[kRealsPerLane<kWarp>];
  sumBlocks(tile, own, mine);
  sums[warp][tile.lane] = mine[0];
  __syncthreads();
  if (warp == 0) {
    mine[0] = 0;
    for (int w = 0; w < kSolveThreads / kWarp; ++w) mine[0] += sums[w][tile.lane];
    const Block6 rows = gatherSums(tile, mine);
    if (tile.lane == 0) {
      Block6 block;
      const Pose x = startBlock(s, body, block);
      addBlock(block, rows);
      finishBlock(s, body, block, x);
    }
  }
  __syncthreads();
}

/// The hubs of a colour: `shares` blocks share them out.
__device__ inline void solveHubs(const View& s, int color, const HeavyList& hubs, int share, int shares, BatchSums (&sums)[kBuffers]) {
  static_assert(sizeof sums >= sizeof(Real[kSolveThreads / kWarp][kWarp]));
  for (int h = share; h < *hubs.count; h += shares)
    if (const int body = hubs.element[h]; s.color[body] == color && isSwept(s, body))
      solveHub(s, body, reinterpret_cast<Real(&)[kSolveThreads / kWarp][kWarp]>(sums));
}

__device__ inline void solveColorTogether(const View& s, int color, int share, int shares, BatchSums (&sums)[kBuffers]) {
  const int begin = s.colorOffset[color], count = s.colorOffset[color + 1] - begin;
  if (count > kCrowd)
    solveBodies<kCrowdWidth>(s, s.colorBody + begin, count, share, shares, sums);
  else if (count > kMany)
    solveBodies<kManyWidth>(s, s.colorBody + begin, count, share, shares, sums);
  else
    solveBodies<kFewWidth>(s, s.colorBody + begin, count, share, shares, sums);
}

/// One colour. The first `hubBlocks` blocks take its hubs.
static __global__ void __launch_bounds__(kSolveThreads, kSolveBlocks)
    solveColor(const __grid_constant__ View s, int color, HeavyList hubs, int hubBlocks, const Control* control) {
  __shared__ BatchSums sums[kBuffers];
  if (control->stop != 0 || color >= s.counters->colors) return;
  const int share = static_cast<int>(blockIdx.x) - hubBlocks;
  if (share < 0) solveHubs(s, color, hubs, static_cast<int>(blockIdx.x), hubBlocks, sums);
  else solveColorTogether(s, color, share, static_cast<int>(gridDim.x) - hubBlocks, sums);
}

/// Lanes of a vertex: they share out its elements and contacts.
inline constexpr int kVertexWidth = 8;
__device__ inline void solveVertexTogether(const View& s, int v) {
  const Tile<kVertexWidth> tile = Tile<kVertexWidth>::ofThread();
  Block3 own;
  for (int k = s.refOffset[v] + tile.lane; k < s.refOffset[v + 1]; k += kVertexWidth) addElement(s, s.ref[k], own);
  for (int k = s.pointEntryOffset[v] + tile.lane; k < s.pointEntryOffset[v + 1]; k += kVertexWidth) addPointContact(s, s.pointEntry[k], own);
  Block3 block = startVertexBlock(s, v);
  block.f += tile.sum(own.f);
  block.h += Sym3{tile.sum(own.h.xx), tile.sum(own.h.xy), tile.sum(own.h.xz), tile.sum(own.h.yy), tile.sum(own.h.yz), tile.sum(own.h.zz)};
  if (tile.lane == 0) finishVertexBlock(s, v, block);
}

/// The vertices of one colour: all threads of a grid or of a block.
__device__ inline void solveVertices(const View& s, int color, int thread, int threads) {
  const int end = s.vertexColorOffset[color + 1];
  for (int k = s.vertexColorOffset[color] + thread / kVertexWidth; k < end; k += threads / kVertexWidth) solveVertexTogether(s, s.colorVertex[k]);
}
static __global__ void __launch_bounds__(kThreads) solveVertexColor(const __grid_constant__ View s, int color, const Control* control) {
  if (control->stop != 0 || color >= s.counters->colors) return;
  solveVertices(s, color, static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x), static_cast<int>(gridDim.x * blockDim.x));
}

/// The colours from `first` on, one after another in one block, whatever their size. Notes how many colours are worth a launch.
static __global__ void __launch_bounds__(kSolveThreads) solveTail(const __grid_constant__ View s, int first, HeavyList hubs, Control* control) {
  if (control->stop != 0) return;
  __shared__ BatchSums sums[kBuffers];
  const int colors = s.counters->colors;
  for (int c = static_cast<int>(threadIdx.x); c < colors; c += kSolveThreads)
    if (s.colorOffset[c + 1] - s.colorOffset[c] > kTailBodies ||
        (s.vertices > 0 && s.vertexColorOffset[c + 1] - s.vertexColorOffset[c] > kTailVertices))
      atomicMax(&control->wideColors, c + 1);
  for (int c = first; c < colors; ++c) {
    if (s.bodies > 0) {
      solveHubs(s, c, hubs, 0, 1, sums);
      solveColorTogether(s, c, 0, 1, sums);
    }
    if (s.vertices == 0) continue;
    // the vertices of a colour share nothing with its bodies, but all must be done before the next colour
    solveVertices(s, c, static_cast<int>(threadIdx.x), kSolveThreads);
    __syncthreads();
  }
}

}  // namespace rubble::RUBBLE_CORE
