#pragma once
/// The primal update of a strict build (RUBBLE_STRICT): one thread per body or vertex, so that every sum has
/// the order of the CPU. Slow, for finding other differences between the backends.
#include "backend/cuda/primal_kernels.cuh"

namespace rubble::RUBBLE_CORE {

__device__ inline void solveColorInOrder(const SolverData& s, int color, int thread, int threads) {
  const int begin = s.colorOffset[color], count = s.colorOffset[color + 1] - begin;
  for (int k = thread; k < count; k += threads) SolveBody<Real>{}(s, s.colorBody[begin + k]);
  if (s.vertices == 0) return;
  const int first = s.vertexColorOffset[color], vertices = s.vertexColorOffset[color + 1] - first;
  for (int k = thread; k < vertices; k += threads) SolveVertex{}(s, s.colorVertex[first + k]);
}

static __global__ void __launch_bounds__(kThreads)
    solveColorStrictly(const __grid_constant__ SolverData s, int color, const Control* control) {
  awaitPrevious();
  if (control->stop == 0 && color < s.counters->colors)
    solveColorInOrder(s, color, static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x),
                      static_cast<int>(gridDim.x * blockDim.x));
}

/// The colors from `first` on in one block.
static __global__ void __launch_bounds__(kThreads)
    solveTailStrictly(const __grid_constant__ SolverData s, int first, const Control* control) {
  awaitPrevious();
  if (control->stop != 0) return;
  for (int c = first; c < s.counters->colors; ++c) {
    solveColorInOrder(s, c, static_cast<int>(threadIdx.x), static_cast<int>(blockDim.x));
    __syncthreads();
  }
}

}  // namespace rubble::RUBBLE_CORE
