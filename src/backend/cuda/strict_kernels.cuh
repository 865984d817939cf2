#pragma once
/// Kernels of a build with RUBBLE_STRICT: a thread an element, and every sum in the order of the CPU, so that both have the same bits.
/// They are slow, and there to find out what else differs.
#include "backend/cuda/primal_kernels.cuh"

namespace rubble::RUBBLE_CORE {

/// Adds the sums of four lanes as addLanes() does on the CPU.
__device__ inline void addLanesInOrder(Block6& to, const Block6 (&lanes)[kLanes]) {
  Real* const out = reinterpret_cast<Real*>(&to);
  const auto number = [&](int lane, int k) { return reinterpret_cast<const Real*>(&lanes[lane])[k]; };
  static_assert(kLanes == 4);
  for (int k = 0; k < kBlockReals; ++k) out[k] += (number(0, k) + number(1, k)) + (number(2, k) + number(3, k));
}

__device__ inline void solveBodyInOrder(const View& s, int i) {
  Block6 block, points[kLanes];
  const Pose x = startBlock(s, i, block);
  int k = s.entryOffset[i];
  const int end = s.entryOffset[i + 1];
  for (; k < end && entryType(s.entry[k].code) == kContactType; ++k)
    for (int lane = 0; lane < kLanes; ++lane) addContact<Real>(s, s.entry[k].code, lane, points[lane]);
  if (k > s.entryOffset[i]) addLanesInOrder(block, points);
  for (; k < end; ++k) addJoint(s, s.entry[k].code, block);
  finishBlock(s, i, block, x);
}

__device__ inline void solveColorInOrder(const View& s, int color, int thread, int threads) {
  const int begin = s.colorOffset[color], count = s.colorOffset[color + 1] - begin;
  for (int k = thread; k < count; k += threads) solveBodyInOrder(s, s.colorBody[begin + k]);
  if (s.vertices == 0) return;
  const int first = s.vertexColorOffset[color], vertices = s.vertexColorOffset[color + 1] - first;
  for (int k = thread; k < vertices; k += threads) SolveVertex{}(s, s.colorVertex[first + k]);
}

static __global__ void __launch_bounds__(kThreads) solveColorStrictly(const __grid_constant__ View s, int color, const Control* control) {
  awaitPrevious();
  if (control->stop == 0 && color < s.counters->colors)
    solveColorInOrder(s, color, static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x), static_cast<int>(gridDim.x * blockDim.x));
}

/// The colours from `first` on in one block.
static __global__ void __launch_bounds__(kThreads) solveTailStrictly(const __grid_constant__ View s, int first, const Control* control) {
  awaitPrevious();
  if (control->stop != 0) return;
  for (int c = first; c < s.counters->colors; ++c) {
    solveColorInOrder(s, c, static_cast<int>(threadIdx.x), static_cast<int>(blockDim.x));
    __syncthreads();
  }
}

struct AssembleTreesInOrder {
  static constexpr const char* kName = AssembleTrees<Real>::kName;
  AssembleTrees<Real> stage;
  explicit AssembleTreesInOrder(const AssembleTrees<Real>& own) : stage(own) {}
  __device__ void operator()(const View& s, int n) const {
    Block6 ownPoints[kLanes], sharedPoints[kLanes];
    const auto add = [&](std::uint32_t code, bool both) {
      for (int lane = 0; lane < kLanes; ++lane) addContact<Real>(s, code, lane, (both ? sharedPoints : ownPoints)[lane]);
    };
    const auto sum = [&](Block6& own, Block6& shared) {
      addLanesInOrder(own, ownPoints);
      addLanesInOrder(shared, sharedPoints);
    };
    stage.assemble(s, n, add, sum);
  }
};
template <>
struct InOrder<AssembleTrees<Real>> {
  using Type = AssembleTreesInOrder;
};

struct SumChunkInOrder {
  static constexpr const char* kName = SumChunk<Real>::kName;
  __device__ void operator()(const View& s, int i) const {
    Chunk& chunk = s.chunk[i];
    const Group& group = s.group[chunk.group];
    Block6 sum, points[kLanes];
    bool touches = false;
    for (int k = chunk.begin; k < chunk.end; ++k) addInertialForce(s, group, s.member[k], sum);
    for (int k = s.externalOffset[i]; k < s.externalOffset[i + 1]; ++k) {
      const std::uint32_t code = s.external[k];
      if (entryType(code) == kContactType)
        for (int lane = 0; lane < kLanes; ++lane)
          addExternalContact<Real>(s, group, s.contact[entryIndex(code)], entrySide(code), lane, points[lane]);
      else
        addExternalJoint(s, chunk.group, code, sum);
      touches |= entryType(code) == kContactType;
    }
    if (touches) addLanesInOrder(sum, points);
    chunk.sum = sum;
  }
};
template <>
struct InOrder<SumChunk<Real>> {
  using Type = SumChunkInOrder;
};

}  // namespace rubble::RUBBLE_CORE
