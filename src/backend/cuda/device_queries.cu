#include "backend/cuda/device_queries.h"

#include <thrust/iterator/counting_iterator.h>
#include <thrust/iterator/transform_iterator.h>
#include <cub/device/device_scan.cuh>

#include <cstring>
#include <utility>

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

/// RunQuery by a warp, whose lanes share the bodies along the way of one query.
struct RunQueryByTile {
  static constexpr const char* kStage = RunQuery::kStage;
  static constexpr int kWidth = kWarp;
  RunQuery query;

  __device__ void operator()(const SolverData& s, int i, const Tile<kWidth>& tile) const {
    const QueryHit own = answer(s, query.queries[i], query.own, tile.lane, kWidth);
    // the lane with the best answer writes it
    int best = tile.lane;
    QueryHit bestHit = own;
    for (int offset = kWidth / 2; offset > 0; offset /= 2) {
      const int other = __shfl_xor_sync(tile.mask, best, offset, kWidth);
      const QueryHit hit{__shfl_xor_sync(tile.mask, bestHit.body, offset, kWidth),
                         __shfl_xor_sync(tile.mask, bestHit.fraction, offset, kWidth),
                         {},
                         {}};
      if (comesBefore(s, hit, bestHit) || (!comesBefore(s, bestHit, hit) && other < best))
        best = other, bestHit = hit;
    }
    if (tile.lane == best) query.hits[i] = own;
  }
};

/// Offsets of arrays that follow one another.
class Layout {
 public:
  template <class T> std::size_t add(std::size_t count) {
    constexpr std::size_t kAlign = 256;
    return std::exchange(bytes_, (bytes_ + count * sizeof(T) + kAlign - 1) / kAlign * kAlign);
  }
  std::size_t bytes() const { return bytes_; }

 private:
  std::size_t bytes_ = 0;
};

std::int64_t residentThreads() {
  int device = 0, processors = 0, threads = 0;
  checkCuda(cudaGetDevice(&device), "cudaGetDevice");
  checkCuda(cudaDeviceGetAttribute(&processors, cudaDevAttrMultiProcessorCount, device), "processors");
  checkCuda(cudaDeviceGetAttribute(&threads, cudaDevAttrMaxThreadsPerMultiProcessor, device), "threads");
  return std::int64_t{processors} * threads;
}

void copyTo(void* device, const void* host, std::size_t bytes, cudaStream_t stream) {
  if (bytes > 0)
    checkCuda(cudaMemcpyAsync(device, host, bytes, cudaMemcpyHostToDevice, stream),
              "cudaMemcpyAsync of queries");
}
/// Waits for the copy.
void fetch(std::vector<int>& to, const void* device, cudaStream_t stream) {
  if (!to.empty())
    checkCuda(cudaMemcpyAsync(to.data(), device, sizeof(int) * to.size(), cudaMemcpyDeviceToHost, stream),
              "cudaMemcpyAsync of answers");
  checkCuda(cudaStreamSynchronize(stream), "queries");
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
  copyTo(*s.step, &still, sizeof still, stream);
  const auto clear = [&](void* p, std::size_t bytes) {
    checkCuda(cudaMemsetAsync(p, 0, bytes, stream), "cudaMemsetAsync");
  };
  clear(s.bucketCount, sizeof(int) * static_cast<std::size_t>(s.cells));
  clear(s.counters->levelCount, sizeof(Counters::levelCount));
  clear(s.counters->levelHalf, sizeof(Counters::levelHalf));
  clear(s.counters->levelReach, sizeof(Counters::levelReach));
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

DeviceQueries::Sent DeviceQueries::send(const QueryBatch& batch, cudaStream_t stream) {
  const HostTables* const shelf = batch.shelf ? &*batch.shelf : nullptr;
  const auto size = [&](int HostTables::*n) { return shelf ? static_cast<std::size_t>(shelf->*n) : 0; };
  Layout layout;
  const std::size_t queries = layout.add<QueryData>(batch.data.size()),
                    vectors = layout.add<Vec4>(size(&HostTables::shapeVectors)),
                    indices = layout.add<int>(size(&HostTables::shapeIndices)),
                    parts = layout.add<ShapePart>(size(&HostTables::shapeParts));
  batch_.reserve(layout.bytes());
  sent_.reserve(layout.bytes());
  std::byte* const from = sent_.data();
  std::memcpy(from + queries, batch.data.data(), sizeof(QueryData) * batch.data.size());
  if (shelf) {
    const SolverData& s = shelf->view();
    std::memcpy(from + vectors, s.shapeVector, sizeof(Vec4) * size(&HostTables::shapeVectors));
    std::memcpy(from + indices, s.shapeIndex, sizeof(int) * size(&HostTables::shapeIndices));
    std::memcpy(from + parts, s.shapePart, sizeof(ShapePart) * size(&HostTables::shapeParts));
  }
  copyTo(batch_.data(), from, layout.bytes(), stream);
  std::byte* const to = batch_.data();
  return {reinterpret_cast<const QueryData*>(to + queries),
          {reinterpret_cast<const Vec4*>(to + vectors), reinterpret_cast<const int*>(to + indices),
           reinterpret_cast<const ShapePart*>(to + parts)}};
}

std::vector<QueryHit> DeviceQueries::run(const SolverData& device, const StepConstants& constants,
                                         const QueryBatch& batch, cudaStream_t stream) {
  const SolverData s = withGrid(device, constants, stream);
  const Sent sent = send(batch, stream);
  hits_.reserve(sizeof(QueryHit) * batch.data.size());
  QueryHit* const hits = reinterpret_cast<QueryHit*>(hits_.data());
  const RunQuery query{sent.queries, sent.shapes, hits};
  // a warp for each query shortens the wait for few of them
  if (lanesFor<1, kWarp>(batch.count(), residentThreads()) == kWarp)
    launch(s, RunQueryByTile{query}, batch.count(), stream);
  else
    launch(s, query, batch.count(), stream);
  checkCuda(cudaStreamSynchronize(stream), "queries");
  return {hits, hits + batch.count()};
}

void DeviceQueries::overlaps(const SolverData& device, const StepConstants& constants,
                             const QueryBatch& batch, cudaStream_t stream, std::vector<int>& offsets,
                             std::vector<int>& bodies) {
  const SolverData s = withGrid(device, constants, stream);
  const Sent sent = send(batch, stream);
  const int n = batch.count();
  offsets.resize(batch.data.size());
  answers_.reserve(sizeof(int) * offsets.size());
  launch(s, CountOverlaps{sent.queries, sent.shapes, reinterpret_cast<int*>(answers_.data())}, n, stream);
  fetch(offsets, answers_.data(), stream);
  offsets.push_back(0);
  int sum = 0;
  for (int& offset : offsets) sum += std::exchange(offset, sum);
  bodies.resize(static_cast<std::size_t>(sum));
  Layout layout;
  const std::size_t starts = layout.add<int>(offsets.size()), found = layout.add<int>(bodies.size());
  answers_.reserve(layout.bytes());
  copyTo(answers_.data() + starts, offsets.data(), sizeof(int) * offsets.size(), stream);
  launch(s,
         FillOverlaps{sent.queries, sent.shapes, reinterpret_cast<const int*>(answers_.data() + starts),
                      reinterpret_cast<int*>(answers_.data() + found)},
         n, stream);
  fetch(bodies, answers_.data() + found, stream);
}

}  // namespace rubble::RUBBLE_CORE
