#pragma once
/// Asynchronous uploads of byte batches, in stream order.
#include "backend/cuda/device_memory.h"

namespace rubble {

/// Double-buffered page-locked memory: the host fills the next batch while the previous one is copied.
class Upload {
 public:
  /// Host memory for that many bytes. Waits only if the batch before the last is still being copied.
  std::byte* begin(std::size_t bytes) {
    turn_ ^= 1;
    sent_[turn_].wait();
    host_[turn_].reserve(bytes);
    bytes_ = bytes;
    return host_[turn_].data();
  }
  /// Device address of the bytes, valid for work enqueued before the next batch.
  const std::byte* send(cudaStream_t stream) {
    device_.reserve(bytes_);
    checkCuda(cudaMemcpyAsync(device_.data(), host_[turn_].data(), bytes_, cudaMemcpyHostToDevice, stream),
              "cudaMemcpyAsync of edits");
    sent_[turn_].record(stream);
    return device_.data();
  }

 private:
  PinnedBuffer host_[2];
  StreamEvent sent_[2];
  DeviceBuffer device_;
  std::size_t bytes_ = 0;
  int turn_ = 0;
};

}  // namespace rubble
