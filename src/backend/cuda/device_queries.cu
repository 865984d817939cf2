#include "backend/cuda/device_queries.h"

#include <thrust/iterator/counting_iterator.h>
#include <thrust/iterator/transform_iterator.h>
#include <cub/device/device_scan.cuh>

#include <utility>

#include "backend/cuda/kernels.cuh"

namespace rubble::RUBBLE_CORE {

namespace {

template <class Kernel>
__global__ void __launch_bounds__(kThreads) runPlain(const __grid_constant__ View s, const Kernel kernel, int n) {
  const int i = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
  if (i < n) kernel(s, i);
}

template <class Kernel>
void launch(const View& s, const Kernel& kernel, int n, cudaStream_t stream) {
  if (n <= 0) return;
  runPlain<Kernel><<<static_cast<unsigned>((n + kThreads - 1) / kThreads), kThreads, 0, stream>>>(s, kernel, n);
  checkCuda(cudaGetLastError(), Kernel::kName);
}

/// Places of arrays one behind the other.
class Layout {
 public:
  template <class T>
  std::size_t add(std::size_t count) {
    constexpr std::size_t kAlign = 256;
    return std::exchange(bytes_, (bytes_ + count * sizeof(T) + kAlign - 1) / kAlign * kAlign);
  }
  std::size_t bytes() const { return bytes_; }

 private:
  std::size_t bytes_ = 0;
};

void copyTo(void* device, const void* host, std::size_t bytes, cudaStream_t stream) {
  if (bytes > 0) checkCuda(cudaMemcpyAsync(device, host, bytes, cudaMemcpyHostToDevice, stream), "cudaMemcpyAsync of queries");
}
/// Waits for it.
template <class T>
void fetch(std::vector<T>& to, const void* device, cudaStream_t stream) {
  if (!to.empty()) checkCuda(cudaMemcpyAsync(to.data(), device, sizeof(T) * to.size(), cudaMemcpyDeviceToHost, stream), "cudaMemcpyAsync of answers");
  checkCuda(cudaStreamSynchronize(stream), "queries on the device");
}

}  // namespace

void DeviceQueries::fillGrid(View& view, cudaStream_t stream) {
  // bodies stand still while they are asked about
  view.step.dt = 0;
  checkCuda(cudaMemsetAsync(view.bucketCount, 0, sizeof(int) * static_cast<std::size_t>(view.cells), stream), "cudaMemsetAsync");
  checkCuda(cudaMemsetAsync(view.counters->levelUsed, 0, sizeof(Counters::levelUsed), stream), "cudaMemsetAsync");
  checkCuda(cudaMemsetAsync(view.counters->levelHalf, 0, sizeof(Counters::levelHalf), stream), "cudaMemsetAsync");
  launch(view, ComputeBounds{}, view.bodies, stream);
  // one element more than there are buckets: the total stands behind the last
  const auto counts = thrust::make_transform_iterator(thrust::make_counting_iterator(0), CountAt{view.bucketCount, nullptr, view.cells, view.cells});
  std::size_t bytes = 0;
  checkCuda(cub::DeviceScan::ExclusiveSum(nullptr, bytes, counts, view.bucketOffset, view.cells + 1, stream), "scan");
  scratch_.reserve(bytes);
  bytes = scratch_.size();
  checkCuda(cub::DeviceScan::ExclusiveSum(scratch_.data(), bytes, counts, view.bucketOffset, view.cells + 1, stream), "scan");
  launch(view, FillGrid{}, view.bodies, stream);
}

DeviceQueries::Sent DeviceQueries::send(const QueryBatch& batch, cudaStream_t stream) {
  const View none{};
  const View& shelf = batch.shelf ? batch.shelf->view() : none;
  const auto size = [](int n) { return static_cast<std::size_t>(n); };
  Layout layout;
  const std::size_t queries = layout.add<QueryData>(batch.data.size()), vectors = layout.add<Vec4>(size(shelf.shapeVectors)),
                    indices = layout.add<int>(size(shelf.shapeIndices)), parts = layout.add<ShapePart>(size(shelf.shapeParts));
  batch_.reserve(layout.bytes());
  std::byte* const to = batch_.data();
  copyTo(to + queries, batch.data.data(), sizeof(QueryData) * batch.data.size(), stream);
  copyTo(to + vectors, shelf.shapeVector, sizeof(Vec4) * size(shelf.shapeVectors), stream);
  copyTo(to + indices, shelf.shapeIndex, sizeof(int) * size(shelf.shapeIndices), stream);
  copyTo(to + parts, shelf.shapePart, sizeof(ShapePart) * size(shelf.shapeParts), stream);
  return {reinterpret_cast<const QueryData*>(to + queries),
          {reinterpret_cast<const Vec4*>(to + vectors), reinterpret_cast<const int*>(to + indices), reinterpret_cast<const ShapePart*>(to + parts)}};
}

std::vector<EngineHit> DeviceQueries::run(View view, const QueryBatch& batch, cudaStream_t stream) {
  fillGrid(view, stream);
  const Sent sent = send(batch, stream);
  std::vector<QueryHit> hits(batch.data.size());
  answers_.reserve(sizeof(QueryHit) * hits.size());
  launch(view, RunQuery{sent.queries, sent.tables, reinterpret_cast<QueryHit*>(answers_.data())}, static_cast<int>(hits.size()), stream);
  fetch(hits, answers_.data(), stream);
  return engineHits(hits);
}

std::vector<std::vector<int>> DeviceQueries::overlaps(View view, const QueryBatch& batch, cudaStream_t stream) {
  fillGrid(view, stream);
  const Sent sent = send(batch, stream);
  const int n = static_cast<int>(batch.data.size());
  std::vector<int> offsets(batch.data.size());
  answers_.reserve(sizeof(int) * offsets.size());
  launch(view, CountOverlaps{sent.queries, sent.tables, reinterpret_cast<int*>(answers_.data())}, n, stream);
  fetch(offsets, answers_.data(), stream);
  offsets.push_back(0);
  int sum = 0;
  for (int& offset : offsets) sum += std::exchange(offset, sum);
  std::vector<int> bodies(static_cast<std::size_t>(sum));
  Layout layout;
  const std::size_t starts = layout.add<int>(offsets.size()), found = layout.add<int>(bodies.size());
  answers_.reserve(layout.bytes());
  copyTo(answers_.data() + starts, offsets.data(), sizeof(int) * offsets.size(), stream);
  launch(view, FillOverlaps{sent.queries, sent.tables, reinterpret_cast<const int*>(answers_.data() + starts), reinterpret_cast<int*>(answers_.data() + found)},
         n, stream);
  fetch(bodies, answers_.data() + found, stream);
  return bodiesByQuery(offsets, bodies);
}

}  // namespace rubble::RUBBLE_CORE
