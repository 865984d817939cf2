#pragma once
/// RAII owners of CUDA runtime resources.
#include <cstddef>
#include <cstdio>
#include <memory>
#include <utility>

#include "backend/cuda/cuda_check.h"
#include "state/solver_tables.h"

namespace rubble {

/// Zeroed device memory. Calls are synchronous, so any stream may use the result.
struct DeviceMemory {
  static void* allocate(std::size_t bytes) {
    void* p = nullptr;
    const cudaError_t status = cudaMalloc(&p, bytes ? bytes : 1);
    if (status == cudaErrorMemoryAllocation) throw outOfMemory(bytes);
    checkCuda(status, "cudaMalloc");
    checkCuda(cudaMemset(p, 0, bytes), "cudaMemset");
    checkCuda(cudaDeviceSynchronize(), "cudaMemset");
    return p;
  }
  static void release(void* p) { cudaFree(p); }
  static void copy(void* to, const void* from, std::size_t bytes) {
    checkCuda(cudaMemcpy(to, from, bytes, cudaMemcpyDeviceToDevice), "cudaMemcpy on the device");
    checkCuda(cudaDeviceSynchronize(), "cudaMemcpy on the device");
  }

 private:
  static Error outOfMemory(std::size_t wanted) {
    cudaGetLastError();
    std::size_t free = 0, total = 0;
    cudaMemGetInfo(&free, &total);
    char text[160];
    const auto mb = [](std::size_t bytes) { return static_cast<double>(bytes) / 1e6; };
    std::snprintf(text, sizeof text,
                  "CUDA: out of device memory: %.1f MB wanted for one array, %.1f of %.1f MB free",
                  mb(wanted), mb(free), mb(total));
    return Error(text);
  }
};

/// A device buffer. Growing discards its content.
class DeviceBuffer {
 public:
  DeviceBuffer() = default;
  ~DeviceBuffer() { DeviceMemory::release(data_); }
  DeviceBuffer(const DeviceBuffer&) = delete;
  DeviceBuffer& operator=(const DeviceBuffer&) = delete;

  /// Synchronizes with the device if it has to grow.
  void reserve(std::size_t bytes) {
    if (bytes <= bytes_) return;
    reserveExactly(bytes + bytes / 2);
  }
  void reserveExactly(std::size_t bytes) {
    checkCuda(cudaDeviceSynchronize(), "wait for the device");
    DeviceMemory::release(std::exchange(data_, nullptr));
    bytes_ = 0;
    data_ = static_cast<std::byte*>(DeviceMemory::allocate(bytes));
    bytes_ = bytes;
  }
  std::byte* data() const { return data_; }
  std::size_t size() const { return bytes_; }

 private:
  std::byte* data_ = nullptr;
  std::size_t bytes_ = 0;
};

/// One object in page-locked host memory, the target of asynchronous copies.
template <class T> class Pinned {
 public:
  Pinned() {
    void* p = nullptr;
    checkCuda(cudaMallocHost(&p, sizeof(T)), "cudaMallocHost");
    value_.reset(new (p) T{});
  }
  T& operator*() const { return *value_; }
  T* operator->() const { return value_.get(); }
  T* get() const { return value_.get(); }

 private:
  struct Release {
    void operator()(T* p) const { cudaFreeHost(p); }
  };
  std::unique_ptr<T, Release> value_;
};

/// A page-locked host buffer for asynchronous copies. Growing discards its content.
class PinnedBuffer {
 public:
  PinnedBuffer() = default;
  ~PinnedBuffer() { cudaFreeHost(data_); }
  PinnedBuffer(const PinnedBuffer&) = delete;
  PinnedBuffer& operator=(const PinnedBuffer&) = delete;

  /// No copy may be pending.
  void reserve(std::size_t bytes) {
    if (bytes <= bytes_) return;
    checkCuda(cudaFreeHost(std::exchange(data_, nullptr)), "cudaFreeHost");
    bytes_ = 0;
    const std::size_t grown = bytes + bytes / 2;
    void* p = nullptr;
    checkCuda(cudaMallocHost(&p, grown), "cudaMallocHost");
    data_ = static_cast<std::byte*>(p);
    bytes_ = grown;
  }
  std::byte* data() const { return data_; }

 private:
  std::byte* data_ = nullptr;
  std::size_t bytes_ = 0;
};

/// A CUDA event. One that was never recorded counts as completed.
class StreamEvent {
 public:
  StreamEvent() { checkCuda(cudaEventCreateWithFlags(&event_, cudaEventDisableTiming), "cudaEventCreate"); }
  ~StreamEvent() { cudaEventDestroy(event_); }
  StreamEvent(const StreamEvent&) = delete;
  StreamEvent& operator=(const StreamEvent&) = delete;
  void record(cudaStream_t stream) const { checkCuda(cudaEventRecord(event_, stream), "cudaEventRecord"); }
  bool tryRecord(cudaStream_t stream) const noexcept {
    return cudaEventRecord(event_, stream) == cudaSuccess;
  }
  /// Later work of the stream waits for the event.
  void holdBack(cudaStream_t stream) const {
    checkCuda(cudaStreamWaitEvent(stream, event_, 0), "cudaStreamWaitEvent");
  }
  bool tryHoldBack(cudaStream_t stream) const noexcept {
    return cudaStreamWaitEvent(stream, event_, 0) == cudaSuccess;
  }
  void wait() const { checkCuda(cudaEventSynchronize(event_), "cudaEventSynchronize"); }
  bool passed() const {
    const cudaError_t status = cudaEventQuery(event_);
    if (status != cudaErrorNotReady) checkCuda(status, "cudaEventQuery");
    return status == cudaSuccess;
  }

 private:
  cudaEvent_t event_ = nullptr;
};

/// A non-blocking stream, which does not synchronize with the default stream.
class Stream {
 public:
  Stream() { checkCuda(cudaStreamCreateWithFlags(&stream_, cudaStreamNonBlocking), "cudaStreamCreate"); }
  ~Stream() { cudaStreamDestroy(stream_); }
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;
  cudaStream_t get() const { return stream_; }
  void wait() const { checkCuda(cudaStreamSynchronize(stream_), "step on the device"); }

 private:
  cudaStream_t stream_ = nullptr;
};

namespace RUBBLE_CORE {
using DeviceTables = SolverTables<DeviceMemory>;
}

}  // namespace rubble
