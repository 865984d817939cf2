#pragma once
/// Bodies by colour: a block counts its bodies in shared memory, since all bodies have one of few colours.
#include "backend/cuda/kernels.cuh"

namespace rubble::RUBBLE_CORE {

/// Colours that a block counts by itself; bodies of higher ones, which are few, are counted one by one.
inline constexpr int kSharedColors = 64;
inline constexpr int kBodiesPerThread = 8;
inline constexpr int kColorBodies = kThreads * kBodiesPerThread;

/// The colour of body i, or -1 if it has none.
__device__ inline int sweptColor(const View& s, int i) { return i < s.bodies && isSwept(s, i) ? s.color[i] : -1; }

/// CountColors.
static __global__ void __launch_bounds__(kThreads) countColors(const __grid_constant__ View s, Gate gate) {
  if (gate.closed()) return;
  __shared__ int count[kSharedColors];
  for (int c = static_cast<int>(threadIdx.x); c < kSharedColors; c += kThreads) count[c] = 0;
  __syncthreads();
  const int first = static_cast<int>(blockIdx.x) * kColorBodies + static_cast<int>(threadIdx.x);
#pragma unroll
  for (int k = 0; k < kBodiesPerThread; ++k) {
    const int c = sweptColor(s, first + k * kThreads);
    if (c >= 0) atomicAdd(c < kSharedColors ? &count[c] : &s.colorCount[c], 1);
  }
  __syncthreads();
  for (int c = static_cast<int>(threadIdx.x); c < kSharedColors; c += kThreads)
    if (count[c] > 0) atomicAdd(&s.colorCount[c], count[c]);
}

/// FillColors: a block takes room for all its bodies of a colour at a time.
static __global__ void __launch_bounds__(kThreads) fillColors(const __grid_constant__ View s, Gate gate) {
  if (gate.closed()) return;
  __shared__ int count[kSharedColors];
  for (int c = static_cast<int>(threadIdx.x); c < kSharedColors; c += kThreads) count[c] = 0;
  __syncthreads();
  const int first = static_cast<int>(blockIdx.x) * kColorBodies + static_cast<int>(threadIdx.x);
  int color[kBodiesPerThread], rank[kBodiesPerThread];
#pragma unroll
  for (int k = 0; k < kBodiesPerThread; ++k) {
    color[k] = sweptColor(s, first + k * kThreads);
    if (color[k] >= 0 && color[k] < kSharedColors) rank[k] = atomicAdd(&count[color[k]], 1);
  }
  __syncthreads();
  for (int c = static_cast<int>(threadIdx.x); c < kSharedColors; c += kThreads)
    if (count[c] > 0) count[c] = s.colorOffset[c] + atomicAdd(&s.colorCount[c], -count[c]) - count[c];
  __syncthreads();
#pragma unroll
  for (int k = 0; k < kBodiesPerThread; ++k) {
    const int body = first + k * kThreads, c = color[k];
    if (c < 0) continue;
    if (c < kSharedColors)
      s.colorBody[count[c] + rank[k]] = body;
    else
      FillColors{}(s, body);
  }
}

}  // namespace rubble::RUBBLE_CORE
