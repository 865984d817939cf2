#pragma once
/// Asynchronous copies of poses to the host. Poses are copied to a staging buffer in the order of the steps,
/// then to page-locked memory by a separate stream.
#include "backend/cuda/cuda_stepper.h"
#include "backend/engine.h"
#include "tables/state_rows.h"

namespace rubble::RUBBLE_CORE {

class DevicePoses {
 public:
  /// Copies position and orientation of the first ids of `device` after the steps enqueued so far.
  void begin(int buffer, const SolverData& device, int bodies, cudaStream_t steps) {
    Frame& f = frames_[buffer];
    f.rows = bodies;
    const std::size_t positions = sizeof(Vec3d) * static_cast<std::size_t>(f.rows),
                      turns = sizeof(Quat) * static_cast<std::size_t>(f.rows);
    f.angularRowsAt = (positions + kAlign - 1) / kAlign * kAlign;
    const std::size_t bytes = f.angularRowsAt + turns;
    f.aside.reserve(bytes);
    f.host.reserve(bytes);
    const auto copy = [](void* to, const void* from, std::size_t size, cudaMemcpyKind kind,
                         cudaStream_t stream) {
      checkCuda(cudaMemcpyAsync(to, from, size, kind, stream), "cudaMemcpyAsync of poses");
    };
    const auto copyAside = [&]<class T>(std::byte* to, const T* from) {
      if (device.ordered)
        gatherById(steps, to, from, device.placeOf, f.rows, sizeof(T) / sizeof(int));
      else
        copy(to, from, sizeof(T) * static_cast<std::size_t>(f.rows), cudaMemcpyDeviceToDevice, steps);
    };
    copyAside(f.aside.data(), device.position);
    copyAside(f.aside.data() + f.angularRowsAt, device.orientation);
    f.isAside.record(steps);
    f.isAside.holdBack(stream_.get());
    copy(f.host.data(), f.aside.data(), bytes, cudaMemcpyDeviceToHost, stream_.get());
    f.isHere.record(stream_.get());
  }
  bool ready(int buffer) const { return frames_[buffer].isHere.passed(); }
  void wait(int buffer) const { frames_[buffer].isHere.wait(); }
  ArrayView position(int buffer) const {
    return rowsOf(reinterpret_cast<const Vec3d*>(frames_[buffer].host.data()), frames_[buffer].rows);
  }
  ArrayView orientation(int buffer) const {
    return rowsOf(reinterpret_cast<const Quat*>(frames_[buffer].host.data() + frames_[buffer].angularRowsAt),
                  frames_[buffer].rows);
  }

 private:
  static constexpr std::size_t kAlign = 64;
  struct Frame {
    DeviceBuffer aside;
    PinnedBuffer host;
    StreamEvent isAside, isHere;
    std::size_t angularRowsAt = 0;
    int rows = 0;
  };
  Stream stream_;
  Frame frames_[2];
};

}  // namespace rubble::RUBBLE_CORE
