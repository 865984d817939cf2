#include "backend/cuda/device_queries.h"

#include <thrust/iterator/counting_iterator.h>
#include <thrust/iterator/transform_iterator.h>
#include <cub/device/device_scan.cuh>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <utility>

#include "backend/cuda/kernels.cuh"
#include "tables/query_shapes.h"

namespace rubble::RUBBLE_CORE {

namespace {

/// Blocks per multiprocessor: threads are worth more to a query than registers (docs/research/edits.md).
inline constexpr int kQueryBlocks = 8;

template <class Kernel>
__global__ void __launch_bounds__(kThreads, kQueryBlocks)
    runPlain(const __grid_constant__ SolverData s, const Kernel kernel, int n) {
  const int i = static_cast<int>((blockIdx.x * blockDim.x + threadIdx.x) / widthOf<Kernel>());
  if (i < n) apply(kernel, s, i);
}

template <class Kernel> void launch(const SolverData& s, const Kernel& kernel, int n, cudaStream_t stream) {
  if (n <= 0) return;
  const unsigned threads = static_cast<unsigned>(n) * widthOf<Kernel>();
  runPlain<Kernel><<<(threads + kThreads - 1) / kThreads, kThreads, 0, stream>>>(s, kernel, n);
  checkCuda(cudaGetLastError(), Kernel::kStage);
}

/// The workers of a query: a warp. One lane alone would diverge from the others of its warp.
struct WarpLanes {
  Tile<kWarp> tile;
  int lane = tile.lane;
  static constexpr int count = kWarp;
  __device__ double least(double a) const {
#pragma unroll
    for (int offset = kWarp / 2; offset > 0; offset /= 2)
      a = min(a, __shfl_xor_sync(tile.mask, a, offset, kWarp));
    return a;
  }
};

/// Has this lane the best hit of its warp?
__device__ bool isBest(const EngineHit& own, const Tile<kWarp>& tile) {
  int best = tile.lane;
  EngineHit hit = own;
#pragma unroll
  for (int offset = kWarp / 2; offset > 0; offset /= 2) {
    const int lane = __shfl_xor_sync(tile.mask, best, offset, kWarp);
    const EngineHit other{__shfl_xor_sync(tile.mask, hit.body, offset, kWarp),
                          __shfl_xor_sync(tile.mask, hit.fraction, offset, kWarp),
                          {},
                          {}};
    if (comesBefore(other, hit) || (!comesBefore(hit, other) && lane < best)) best = lane, hit = other;
  }
  return tile.lane == best;
}

/// FindHit by a warp.
template <QueryKind kKind> struct FindHitByWarp {
  static constexpr const char* kStage = "queries";
  static constexpr int kWidth = kWarp;
  const EngineQuery* queries;
  QueryShapes own;
  EngineHit* hits;
  __device__ void operator()(const SolverData& s, int i, const Tile<kWarp>& tile) const {
    const EngineHit hit = answer<kKind, Search::ByGrid>(s, queries[i], own, WarpLanes{tile});
    if (isBest(hit, tile)) hits[i] = hit;
  }
};

/// Query blockIdx.y by all threads of a row of blocks, body by body. Each warp writes its best hit.
template <QueryKind kKind>
__global__ void __launch_bounds__(kThreads, kQueryBlocks)
    findHitsOneByOne(const __grid_constant__ SolverData s, const EngineQuery* queries, QueryShapes own,
                     EngineHit* hits) {
  const int threads = static_cast<int>(gridDim.x * kThreads),
            thread = static_cast<int>(blockIdx.x * kThreads + threadIdx.x);
  const Tile<kWarp> tile = Tile<kWarp>::ofThread();
  const EngineHit hit = answer<kKind, Search::OneByOne>(s, queries[blockIdx.y], own,
                                                        OneLane{thread, threads});
  if (isBest(hit, tile)) hits[static_cast<int>(blockIdx.y) * threads / kWarp + thread / kWarp] = hit;
}

/// The best of `each` hits of every query.
struct PickHit {
  static constexpr const char* kStage = "queries";
  static constexpr int kWidth = kWarp;
  const EngineHit* from;
  int each;
  EngineHit* hits;
  __device__ void operator()(const SolverData&, int i, const Tile<kWarp>& tile) const {
    EngineHit best{-1, 0, {}, {}};
    for (int k = tile.lane; k < each; k += kWarp)
      if (const EngineHit& hit = from[i * each + k]; comesBefore(hit, best)) best = hit;
    if (isBest(best, tile)) hits[i] = best;
  }
};

/// Writes ray i of arrays as a query.
struct ReadRays {
  static constexpr const char* kStage = "queries";
  RayReader rays;
  EngineQuery* queries;
  __device__ void operator()(const SolverData&, int i) const { queries[i] = rays(i); }
};

/// Writes the answer to query i to arrays.
struct WriteRayHits {
  static constexpr const char* kStage = "queries";
  const EngineQuery* queries;
  const EngineHit* hits;
  RayHitWriter to;
  __device__ void operator()(const SolverData&, int i) const {
    const EngineHit& hit = hits[i];
    const double reach = queries[i].reach;
    to(i, hit.body >= 0, hit.body >= 0 ? hit.fraction * reach : reach, hit.body, hit.normal);
  }
};

void copyTo(void* device, const void* host, std::size_t bytes, cudaStream_t stream) {
  if (bytes > 0)
    checkCuda(cudaMemcpyAsync(device, host, bytes, cudaMemcpyHostToDevice, stream),
              "cudaMemcpyAsync of queries");
}
std::int64_t residentThreads() {
  int device = 0, processors = 0, threads = 0;
  checkCuda(cudaGetDevice(&device), "cudaGetDevice");
  checkCuda(cudaDeviceGetAttribute(&processors, cudaDevAttrMultiProcessorCount, device), "processors");
  checkCuda(cudaDeviceGetAttribute(&threads, cudaDevAttrMaxThreadsPerMultiProcessor, device), "threads");
  return std::int64_t{processors} * threads;
}

}  // namespace

void DeviceQueries::scan(const int* counts, int n, int* offsets, cudaStream_t stream) {
  // one element more than counts: the total follows the last one
  const auto input = thrust::make_transform_iterator(thrust::make_counting_iterator(0),
                                                     CountAt{counts, nullptr, n, n});
  std::size_t bytes = 0;
  const auto run = [&](void* scratch) {
    checkCuda(cub::DeviceScan::ExclusiveSum(scratch, bytes, input, offsets, n + 1, stream), "scan");
  };
  run(nullptr);
  scratch_.reserve(bytes);
  bytes = scratch_.size();
  run(scratch_.data());
}

SolverData DeviceQueries::withGrid(const SolverData& device, const StepConstants* constants,
                                   cudaStream_t stream) {
  SolverData s = device;
  const std::size_t bytes = sizeof(StepConstants) * static_cast<std::size_t>(s.worlds);
  still_.reserve(bytes);
  s.step = reinterpret_cast<StepConstants*>(still_.data());
  s.pausing = false;
  if (std::exchange(filled_, true)) return s;
  // bodies do not move during queries
  constantsSent_.wait();
  constants_.reserve(bytes);
  auto* const still = reinterpret_cast<StepConstants*>(constants_.data());
  for (int w = 0; w < s.worlds; ++w) still[w] = constants[w], still[w].dt = 0;
  copyTo(s.step, still, bytes, stream);
  constantsSent_.record(stream);
  const auto clear = [&](void* p, std::size_t bytes) {
    checkCuda(cudaMemsetAsync(p, 0, bytes, stream), "cudaMemsetAsync");
  };
  clear(s.bucketCount, sizeof(int) * static_cast<std::size_t>(s.cells));
  // the counters of grid levels are the last ones
  clear(s.counters->levelCount, sizeof(Counters) - offsetof(Counters, levelCount));
  launch(s, ComputeBounds{}, s.bodies, stream);
  scan(s.bucketCount, s.cells, s.bucketOffset, stream);
  launch(s, FillGrid{}, s.bodies, stream);
  return s;
}

DeviceQueries::Asked DeviceQueries::send(const EngineQueries& asked, cudaStream_t stream) {
  batch_.reserve(asked.queries.size_bytes());
  copyTo(batch_.data(), asked.queries.data(), asked.queries.size_bytes(), stream);
  Asked out{reinterpret_cast<const EngineQuery*>(batch_.data()), {}, static_cast<int>(asked.queries.size())};
  if (asked.shapes.empty()) return out;
  const QueryShelf shelf(asked.shapes);
  const HostTables& tables = shelf.tables();
  const SolverData& s = tables.view();
  const auto copied = [&]<class T>(const T* array, std::size_t count, DeviceBuffer& to) {
    to.reserve(sizeof(T) * count);
    copyTo(to.data(), array, sizeof(T) * count, stream);
    return reinterpret_cast<const T*>(to.data());
  };
  const auto size = [](int n) { return static_cast<std::size_t>(n); };
  out.shapes = {copied(shelf.shapes().data(), shelf.shapes().size(), shapes_),
                {copied(s.shapeVector, size(tables.shapeVectors), vectors_),
                 copied(s.shapeIndex, size(tables.shapeIndices), indices_),
                 copied(s.shapePart, size(tables.shapeParts), parts_)}};
  // the shelf goes
  checkCuda(cudaStreamSynchronize(stream), "shapes of queries");
  return out;
}

std::span<const EngineHit> DeviceQueries::hits(const SolverData& device, const StepConstants* constants,
                                               const EngineQueries& asked, cudaStream_t stream) {
  const std::size_t count = asked.queries.size();
  hits_.reserve(sizeof(EngineHit) * count);
  auto* const hits = reinterpret_cast<EngineHit*>(hits_.data());
  const Asked q = send(asked, stream);
  const int threads = static_cast<int>(residentThreads());
  withHitKind(asked.kind, [&]<QueryKind kKind>() {
    if (q.count <= kFewQueries && !filled_) {
      const int blocks = std::max(1, std::min(device.bodies, threads) / kThreads),
                each = blocks * kThreads / kWarp;
      scratch_.reserve(sizeof(EngineHit) * static_cast<std::size_t>(each) * count);
      auto* const found = reinterpret_cast<EngineHit*>(scratch_.data());
      const dim3 grid(static_cast<unsigned>(blocks), static_cast<unsigned>(q.count));
      if (q.count > 0) {
        findHitsOneByOne<kKind><<<grid, kThreads, 0, stream>>>(device, q.queries, q.shapes, found);
        checkCuda(cudaGetLastError(), "queries");
        launch(device, PickHit{found, each, hits}, q.count, stream);
      }
    } else {
      const SolverData s = withGrid(device, constants, stream);
      launch(s, FindHitByWarp<kKind>{q.queries, q.shapes, hits}, q.count, stream);
    }
  });
  checkCuda(cudaStreamSynchronize(stream), "queries");
  return {hits, count};
}

RayHitArrays DeviceQueries::hits(const SolverData& device, const StepConstants* constants,
                                 const EngineRays& rays, cudaStream_t stream) {
  const int n = static_cast<int>(rays.origins.shape[0]);
  const auto count = static_cast<std::size_t>(n);
  const auto memory = []<class T>(DeviceBuffer& buffer, std::size_t numbers, T*) {
    buffer.reserve(sizeof(T) * numbers);
    return reinterpret_cast<T*>(buffer.data());
  };
  auto* const queries = memory(batch_, count, static_cast<EngineQuery*>(nullptr));
  auto* const answers = memory(answers_, count, static_cast<EngineHit*>(nullptr));
  auto* const numbers = memory(rayHits_, 5 * count, static_cast<float*>(nullptr));
  const RayHitWriter to{numbers, reinterpret_cast<int*>(numbers + count), numbers + 2 * count};
  const SolverData s = withGrid(device, constants, stream);
  launch(s, ReadRays{RayReader(rays), queries}, n, stream);
  launch(s, FindHitByWarp<QueryKind::Ray>{queries, {}, answers}, n, stream);
  launch(s, WriteRayHits{queries, answers, to}, n, stream);
  return hitArrays(to, n);
}

EngineOverlaps DeviceQueries::overlaps(const SolverData& device, const StepConstants* constants,
                                       const EngineQueries& asked, cudaStream_t stream) {
  const SolverData s = withGrid(device, constants, stream);
  const Asked q = send(asked, stream);
  const std::size_t size = asked.queries.size() + 1;
  counts_.reserve(sizeof(int) * 2 * size), offsets_.reserve(sizeof(int) * size);
  auto* const counts = reinterpret_cast<int*>(counts_.data());
  int *const from = counts + size, *const offsets = reinterpret_cast<int*>(offsets_.data());
  launch(s, CountOverlaps<Search::ByGrid>{q.queries, q.shapes, counts}, q.count, stream);
  scan(counts, q.count, from, stream);
  checkCuda(cudaMemcpyAsync(offsets, from, sizeof(int) * size, cudaMemcpyDeviceToHost, stream), "overlaps");
  checkCuda(cudaStreamSynchronize(stream), "overlaps");
  const auto found = static_cast<std::size_t>(offsets[q.count]);
  found_.reserve(sizeof(int) * found), bodies_.reserve(sizeof(int) * found);
  auto* const ids = reinterpret_cast<int*>(found_.data());
  auto* const bodies = reinterpret_cast<int*>(bodies_.data());
  launch(s, FillOverlaps<Search::ByGrid>{q.queries, q.shapes, from, ids}, q.count, stream);
  checkCuda(cudaMemcpyAsync(bodies, ids, sizeof(int) * found, cudaMemcpyDeviceToHost, stream), "overlaps");
  checkCuda(cudaStreamSynchronize(stream), "overlaps");
  return {{offsets, size}, {bodies, found}};
}

}  // namespace rubble::RUBBLE_CORE
