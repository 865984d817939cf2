#pragma once
/// Batches of bytes on their way to the device, in the order of a stream.
#include "backend/cuda/device_memory.h"

namespace rubble {

/// The host fills page-locked memory and goes on as soon as a copy is enqueued: the next batch is filled
/// beside it.
class Upload {
 public:
  /// Host memory for so many bytes; waits only if the last batch but one has not been copied yet.
  std::byte* begin(std::size_t bytes) {
    turn_ ^= 1;
    sent_[turn_].wait();
    host_[turn_].reserve(bytes);
    bytes_ = bytes;
    return host_[turn_].data();
  }
  /// Where the bytes are on the device, for what is enqueued in the stream before the next batch.
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
