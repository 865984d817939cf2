#pragma once
/// Joint and sensor arrays in device memory, by the functors of tables/joint_rows.h.
#include "backend/cuda/device_memory.h"
#include "tables/joint_rows.h"

namespace rubble::RUBBLE_CORE {

/// All calls are in the order of a stream. `device`: tables on the device with their present sizes.
class DeviceJointRows {
 public:
  void set(const JointRows& rows, cudaStream_t stream);
  ArrayView view(const SolverData& device, JointArray which, cudaStream_t stream);
  /// `bodies`: ids; `pairs`: pairs of the last step.
  ArrayView view(const SolverData& device, SensorArray which, int bodies, int pairs, cudaStream_t stream);
  ArrayView contactForces(const SolverData& device, std::span<const std::array<int, 2>> pairs,
                          cudaStream_t stream);
  /// `rows` and `values` are device memory.
  void scatter(const SolverData& device, JointArray which, const ArrayView& rows, const ArrayView& values,
               cudaStream_t stream);

 private:
  template <class T> static T* in(const DeviceBuffer& buffer) { return reinterpret_cast<T*>(buffer.data()); }

  int axes_ = 0, joints_ = 0, sides_ = 0;
  DeviceBuffer axisRefs_, jointRefs_, axisSides_;
  DeviceBuffer axisNumbers_[static_cast<int>(JointArray::AppliedForce) + 1],
      sensorNumbers_[static_cast<int>(SensorArray::JointTorque) + 1], forces_, sums_, pairs_, pairForces_;
};

}  // namespace rubble::RUBBLE_CORE
