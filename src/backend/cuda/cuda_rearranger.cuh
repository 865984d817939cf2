#pragma once
/// Work between steps (stages/pairs/order.h): executor operations over counts known on the host, and their
/// scratch memory.
#include <cub/device/device_radix_sort.cuh>

#include <memory>
#include <vector>

#include "backend/cuda/cuda_executor.cuh"

namespace rubble::RUBBLE_CORE {

/// Writes the index of each element.
struct NumberElements {
  static constexpr const char* kStage = "order";
  int* to;
  __device__ void operator()(const SolverData&, int i) const { to[i] = i; }
};

/// The destructor synchronizes with the device and frees the scratch memory.
class CudaRearranger {
 public:
  CudaRearranger(CudaExecutor& executor, const Stream& stream) : executor_(executor), stream_(stream) {
    executor_.beginWork();
  }
  ~CudaRearranger() {
    executor_.endWork();
    cudaStreamSynchronize(stream_.get());
  }
  CudaRearranger(const CudaRearranger&) = delete;
  CudaRearranger& operator=(const CudaRearranger&) = delete;

  const SolverData& view() const { return executor_.view(); }
  template <class Kernel> void forEach(const Kernel& kernel, int n) { executor_.forEach(kernel, n); }
  void clear(Array<int> SolverData::*array, int n) { executor_.clear(array, n); }
  void scan(Array<int> SolverData::*counts, Array<int> SolverData::*offsets, int n) {
    executor_.scan(counts, offsets, n);
  }
  void aliasRows() { executor_.aliasRows(); }
  void swapManifolds() { executor_.swapManifolds(); }

  template <class T> T* room(int n) {
    return reinterpret_cast<T*>(roomOf(sizeof(T) * static_cast<std::size_t>(n)));
  }
  void order(const std::uint64_t* keys, int* to, int n) {
    auto* const sorted = room<std::uint64_t>(n);
    int* const indices = room<int>(n);
    forEach(NumberElements{indices}, n);
    std::size_t bytes = 0;
    const auto sort = [&](void* scratch) {
      checkCuda(
          cub::DeviceRadixSort::SortPairs(scratch, bytes, keys, sorted, indices, to, n, 0, 64, stream_.get()),
          "sort");
    };
    sort(nullptr);
    sort(roomOf(bytes));
    executor_.interrupted();
  }
  template <class T> void copy(T* to, const T* from, int n) {
    checkCuda(cudaMemcpyAsync(to, from, sizeof(T) * static_cast<std::size_t>(n), cudaMemcpyDeviceToDevice,
                              stream_.get()),
              "cudaMemcpyAsync");
    executor_.interrupted();
  }

 private:
  std::byte* roomOf(std::size_t bytes) {
    rooms_.push_back(std::make_unique<DeviceBuffer>());
    rooms_.back()->reserveExactly(bytes);
    return rooms_.back()->data();
  }

  CudaExecutor& executor_;
  const Stream& stream_;
  std::vector<std::unique_ptr<DeviceBuffer>> rooms_;
};

}  // namespace rubble::RUBBLE_CORE
