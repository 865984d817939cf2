#pragma once
/// Bodies by colour: a block counts its bodies in shared memory, since all bodies have one of few colours. Inside a colour those with many row
/// blocks come first: bodies that are solved side by side take as long as the one that has most.
#include "backend/cuda/heavy_kernels.cuh"

namespace rubble::RUBBLE_CORE {

/// Colours that a block counts by itself; bodies of higher ones, which are few, are counted one by one.
inline constexpr int kSharedColors = 64;
inline constexpr int kBodiesPerThread = 8;
inline constexpr int kColorBodies = kThreads * kBodiesPerThread;
/// Bodies of one colour by the number of their row blocks: over 12, over 8, over 4, others.
inline constexpr int kDegreeClasses = 4, kColorBins = kSharedColors * kDegreeClasses;
struct ColorBins {
  int* population;  ///< [kSharedColors][kDegreeClasses]
  int* filled;      ///< bodies that have their place by now
};

/// The bin of body i, or -1 if it has none or is a hub, which is solved apart. Bins from kColorBins on: bodies of higher colours.
__device__ inline int binOf(const View& s, int i) {
  if (i >= s.bodies || !isSwept(s, i) || isHub(s, i)) return -1;
  const int degree = degreeOf(s, i);
  return s.color[i] * kDegreeClasses + (degree > 12 ? 0 : degree > 8 ? 1 : degree > 4 ? 2 : 3);
}

/// CountColors.
static __global__ void __launch_bounds__(kThreads) countColors(const __grid_constant__ View s, ColorBins bins, Gate gate) {
  awaitPrevious();
  if (gate.closed()) return;
  __shared__ int count[kColorBins];
  for (int b = static_cast<int>(threadIdx.x); b < kColorBins; b += kThreads) count[b] = 0;
  __syncthreads();
  const int first = static_cast<int>(blockIdx.x) * kColorBodies + static_cast<int>(threadIdx.x);
#pragma unroll
  for (int k = 0; k < kBodiesPerThread; ++k) {
    const int b = binOf(s, first + k * kThreads);
    if (b >= 0) atomicAdd(b < kColorBins ? &count[b] : &s.colorCount[b / kDegreeClasses], 1);
  }
  __syncthreads();
  for (int b = static_cast<int>(threadIdx.x); b < kColorBins; b += kThreads) {
    if (count[b] == 0) continue;
    atomicAdd(&bins.population[b], count[b]);
    atomicAdd(&s.colorCount[b / kDegreeClasses], count[b]);
  }
}

/// FillColors: a block takes room for all its bodies of a bin at a time.
static __global__ void __launch_bounds__(kThreads) fillColors(const __grid_constant__ View s, ColorBins bins, Gate gate) {
  awaitPrevious();
  if (gate.closed()) return;
  __shared__ int count[kColorBins];
  for (int b = static_cast<int>(threadIdx.x); b < kColorBins; b += kThreads) count[b] = 0;
  __syncthreads();
  const int first = static_cast<int>(blockIdx.x) * kColorBodies + static_cast<int>(threadIdx.x);
  int bin[kBodiesPerThread], rank[kBodiesPerThread];
#pragma unroll
  for (int k = 0; k < kBodiesPerThread; ++k) {
    bin[k] = binOf(s, first + k * kThreads);
    if (bin[k] >= 0 && bin[k] < kColorBins) rank[k] = atomicAdd(&count[bin[k]], 1);
  }
  __syncthreads();
  for (int b = static_cast<int>(threadIdx.x); b < kColorBins; b += kThreads) {
    if (count[b] == 0) continue;
    int place = s.colorOffset[b / kDegreeClasses] + atomicAdd(&bins.filled[b], count[b]);
    for (int before = b / kDegreeClasses * kDegreeClasses; before < b; ++before) place += bins.population[before];
    count[b] = place;
  }
  __syncthreads();
#pragma unroll
  for (int k = 0; k < kBodiesPerThread; ++k) {
    const int body = first + k * kThreads, b = bin[k];
    if (b < 0) continue;
    if (b < kColorBins) s.colorBody[count[b] + rank[k]] = body;
    else FillColors{}(s, body);
  }
}

}  // namespace rubble::RUBBLE_CORE
