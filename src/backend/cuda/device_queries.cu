#include "backend/cuda/device_queries.h"

#include <thrust/iterator/counting_iterator.h>
#include <thrust/iterator/transform_iterator.h>
#include <cub/device/device_scan.cuh>

#include <cstddef>
#include <cstring>
#include <utility>

#include <tbb/parallel_for.h>

#include "backend/cuda/kernels.cuh"

namespace rubble::RUBBLE_CORE {

namespace {

template <class Kernel>
__global__ void __launch_bounds__(kThreads)
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

/// Rays by `kLanes` lanes each, which share the bodies along the way.
template <int kLanes> struct CastRays {
  static constexpr const char* kStage = RunQuery::kStage;
  static constexpr int kWidth = kLanes;
  const QueryData* queries;
  QueryHit* hits;

  __device__ void operator()(const SolverData& s, int i, const Tile<kWidth>& tile) const {
    const QueryHit own = answer<QueryKind::Ray>(s, queries[i], {}, tile.lane, kWidth);
    // the lane with the best answer writes it
    int best = tile.lane;
    QueryHit bestHit = own;
#pragma unroll
    for (int offset = kWidth / 2; offset > 0; offset /= 2) {
      const int other = __shfl_xor_sync(tile.mask, best, offset, kWidth);
      const QueryHit hit{__shfl_xor_sync(tile.mask, bestHit.body, offset, kWidth),
                         __shfl_xor_sync(tile.mask, bestHit.fraction, offset, kWidth),
                         {},
                         {}};
      if (comesBefore(s, hit, bestHit) || (!comesBefore(s, bestHit, hit) && other < best))
        best = other, bestHit = hit;
    }
    if (tile.lane == best) hits[i] = own;
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

SolverData DeviceQueries::withGrid(const SolverData& device, const StepConstants& constants,
                                   cudaStream_t stream) {
  SolverData s = device;
  still_.reserve(sizeof(StepConstants));
  s.step = reinterpret_cast<StepConstants*>(still_.data());
  if (std::exchange(filled_, true)) return s;
  // bodies do not move during queries
  StepConstants still = constants;
  still.dt = 0;
  if (std::memcmp(constants_.get(), &still, sizeof still) != 0) {
    *constants_ = still;
    copyTo(s.step, constants_.get(), sizeof still, stream);
  }
  const auto clear = [&](void* p, std::size_t bytes) {
    checkCuda(cudaMemsetAsync(p, 0, bytes, stream), "cudaMemsetAsync");
  };
  clear(s.bucketCount, sizeof(int) * static_cast<std::size_t>(s.cells));
  // the counters of grid levels are the last ones
  clear(s.counters->levelCount, sizeof(Counters) - offsetof(Counters, levelCount));
  launch(s, ComputeBounds{}, s.bodies, stream);
  // one element more than buckets: the total follows the last one
  const auto counts = thrust::make_transform_iterator(thrust::make_counting_iterator(0),
                                                      CountAt{s.bucketCount, nullptr, s.cells, s.cells});
  std::size_t bytes = 0;
  const auto scan = [&](void* scratch) {
    checkCuda(cub::DeviceScan::ExclusiveSum(scratch, bytes, counts, s.bucketOffset, s.cells + 1, stream),
              "scan");
  };
  scan(nullptr);
  scratch_.reserve(bytes);
  bytes = scratch_.size();
  scan(scratch_.data());
  launch(s, FillGrid{}, s.bodies, stream);
  return s;
}

std::span<const QueryHit> DeviceQueries::castRays(const SolverData& device, const StepConstants& constants,
                                                  const QueryBatch& batch, cudaStream_t stream) {
  const SolverData s = withGrid(device, constants, stream);
  const std::size_t count = batch.data.size(), bytes = sizeof(QueryData) * count;
  batch_.reserve(bytes), sent_.reserve(bytes), hits_.reserve(sizeof(QueryHit) * count);
  constexpr std::size_t kGrain = 1024;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, kGrain), [&](const auto& range) {
    std::memcpy(sent_.data() + sizeof(QueryData) * range.begin(), batch.data.data() + range.begin(),
                sizeof(QueryData) * range.size());
  });
  copyTo(batch_.data(), sent_.data(), bytes, stream);
  const auto* const queries = reinterpret_cast<const QueryData*>(batch_.data());
  auto* const hits = reinterpret_cast<QueryHit*>(hits_.data());
  withLanes<1, kWarp>(lanesFor<1, kWarp>(batch.count(), residentThreads()), [&]<int kLanes>() {
    launch(s, CastRays<kLanes>{queries, hits}, batch.count(), stream);
  });
  checkCuda(cudaStreamSynchronize(stream), "queries");
  return {hits, count};
}

}  // namespace rubble::RUBBLE_CORE
