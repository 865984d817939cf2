#pragma once
/// Bodies and vertices by color. Colors are few, so each thread block counts in shared memory. Within a
/// color, nodes with the most work come first: the time of a batch is that of its longest node.
#include "backend/cuda/long_list_kernels.cuh"

namespace rubble::RUBBLE_CORE {

/// Colors counted in shared memory. Nodes of higher colors are few and counted one by one.
inline constexpr int kSharedColors = 64;
/// Few: a node takes four dependent reads, and those of one thread follow one another.
inline constexpr int kNodesPerThread = 2;
inline constexpr int kColorNodes = kThreads * kNodesPerThread;
/// Classes of nodes within a color by amount of work, most first.
inline constexpr int kWorkClasses = 4, kColorBins = kSharedColors * kWorkClasses;
struct ColorBins {
  int* population;            ///< [kSharedColors][kWorkClasses]
  int* filled;                ///< nodes placed so far
  const PeerOwners owners{};  ///< of bodies
};

/// Bodies except those of high degree, which other blocks solve. Classes by number of constraints.
struct ColoredBodies {
  using Fill = FillColors;
  __device__ static bool has(const SolverData& s, int i, const PeerOwners& owners) {
    return i < s.bodies && owners.isMine(i) && isSwept(s, i) && !isHighDegree(s, i);
  }
  __device__ static int colorOf(const SolverData& s, int i) { return s.color[i]; }
  __device__ static int classOf(const SolverData& s, int i) {
    const int degree = degreeOf(s, i);
    return degree > 12 ? 0 : degree > 8 ? 1 : degree > 4 ? 2 : 3;
  }
  __device__ static int* count(const SolverData& s) { return s.colorCount; }
  __device__ static const int* offset(const SolverData& s) { return s.colorOffset; }
  __device__ static int* list(const SolverData& s) { return s.colorBody; }
};
/// Vertices. Classes by number of elements and contacts, weighted by cost: about one, two, four and more
/// rounds of eight lanes.
struct ColoredVertices {
  using Fill = FillVertexColors;
  __device__ static bool has(const SolverData& s, int v, const PeerOwners&) {
    return v < s.vertices && isDynamicVertex(s, v);
  }
  __device__ static int colorOf(const SolverData& s, int v) { return s.vertexColor[v]; }
  __device__ static int classOf(const SolverData& s, int v) {
    const auto size = [v](const int* offset) { return offset[v + 1] - offset[v]; };
    const int work = size(s.tetraCornerOffset) + size(s.refOffset) + 2 * size(s.pointIncidenceOffset);
    return work > 32 ? 0 : work > 20 ? 1 : work > 10 ? 2 : 3;
  }
  __device__ static int* count(const SolverData& s) { return s.vertexColorCount; }
  __device__ static const int* offset(const SolverData& s) { return s.vertexColorOffset; }
  __device__ static int* list(const SolverData& s) { return s.colorVertex; }
};

/// The bin of node i, or -1 if it has none. Bins from kColorBins on are nodes of higher colors.
template <class Nodes> __device__ int binOf(const SolverData& s, int i, const PeerOwners& owners) {
  return Nodes::has(s, i, owners) ? Nodes::colorOf(s, i) * kWorkClasses + Nodes::classOf(s, i) : -1;
}

/// CountColors or CountVertexColors.
template <class Nodes>
static __global__ void __launch_bounds__(kThreads)
    countColors(const __grid_constant__ SolverData s, ColorBins bins, Gate gate) {
  awaitPrevious();
  if (gate.closed()) return;
  __shared__ int count[kColorBins];
  for (int b = static_cast<int>(threadIdx.x); b < kColorBins; b += kThreads) count[b] = 0;
  __syncthreads();
  int* const population = Nodes::count(s);
  const int first = static_cast<int>(blockIdx.x) * kColorNodes + static_cast<int>(threadIdx.x);
  int bin[kNodesPerThread];
#pragma unroll
  for (int k = 0; k < kNodesPerThread; ++k) bin[k] = binOf<Nodes>(s, first + k * kThreads, bins.owners);
#pragma unroll
  for (int k = 0; k < kNodesPerThread; ++k)
    if (const int b = bin[k]; b >= 0)
      atomicAdd(b < kColorBins ? &count[b] : &population[b / kWorkClasses], 1);
  __syncthreads();
  for (int b = static_cast<int>(threadIdx.x); b < kColorBins; b += kThreads) {
    if (count[b] == 0) continue;
    atomicAdd(&bins.population[b], count[b]);
    atomicAdd(&population[b / kWorkClasses], count[b]);
  }
}

/// FillColors or FillVertexColors. A block reserves the range of a bin for all of its nodes at once.
template <class Nodes>
static __global__ void __launch_bounds__(kThreads)
    fillColors(const __grid_constant__ SolverData s, ColorBins bins, Gate gate) {
  awaitPrevious();
  if (gate.closed()) return;
  __shared__ int count[kColorBins];
  for (int b = static_cast<int>(threadIdx.x); b < kColorBins; b += kThreads) count[b] = 0;
  __syncthreads();
  const int first = static_cast<int>(blockIdx.x) * kColorNodes + static_cast<int>(threadIdx.x);
  int bin[kNodesPerThread], rank[kNodesPerThread];
#pragma unroll
  for (int k = 0; k < kNodesPerThread; ++k) bin[k] = binOf<Nodes>(s, first + k * kThreads, bins.owners);
#pragma unroll
  for (int k = 0; k < kNodesPerThread; ++k)
    if (bin[k] >= 0 && bin[k] < kColorBins) rank[k] = atomicAdd(&count[bin[k]], 1);
  __syncthreads();
  for (int b = static_cast<int>(threadIdx.x); b < kColorBins; b += kThreads) {
    if (count[b] == 0) continue;
    int place = Nodes::offset(s)[b / kWorkClasses] + atomicAdd(&bins.filled[b], count[b]);
    for (int before = b / kWorkClasses * kWorkClasses; before < b; ++before) place += bins.population[before];
    count[b] = place;
  }
  __syncthreads();
#pragma unroll
  for (int k = 0; k < kNodesPerThread; ++k) {
    const int node = first + k * kThreads, b = bin[k];
    if (b < 0) continue;
    if (b < kColorBins)
      Nodes::list(s)[count[b] + rank[k]] = node;
    else
      typename Nodes::Fill{}(s, node);
  }
}

}  // namespace rubble::RUBBLE_CORE
