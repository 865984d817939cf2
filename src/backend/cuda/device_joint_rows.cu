#include "backend/cuda/device_joint_rows.h"

namespace rubble::RUBBLE_CORE {

namespace {

constexpr int kThreads = 128;

template <class Kernel>
__global__ void runRows(const __grid_constant__ SolverData s, const Kernel kernel, int n) {
  const int k = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
  if (k < n) kernel(s, k);
}
template <class Kernel> void forEach(const SolverData& s, const Kernel& kernel, int n, cudaStream_t stream) {
  if (n <= 0) return;
  const auto blocks = static_cast<unsigned>((n + kThreads - 1) / kThreads);
  runRows<Kernel><<<blocks, kThreads, 0, stream>>>(s, kernel, n);
  checkCuda(cudaGetLastError(), "joint rows");
}

template <class T> void send(std::span<const T> from, DeviceBuffer& to, cudaStream_t stream) {
  const std::size_t bytes = from.size_bytes();
  to.reserve(bytes);
  if (bytes > 0)
    checkCuda(cudaMemcpyAsync(to.data(), from.data(), bytes, cudaMemcpyHostToDevice, stream),
              "cudaMemcpyAsync of joint rows");
}
void clear(const DeviceBuffer& buffer, std::size_t bytes, cudaStream_t stream) {
  if (bytes > 0) checkCuda(cudaMemsetAsync(buffer.data(), 0, bytes, stream), "cudaMemsetAsync");
}
ArrayView onDevice(ArrayView view, cudaStream_t stream) {
  view.device = true;
  view.stream = reinterpret_cast<std::uintptr_t>(stream);
  return view;
}

}  // namespace

void DeviceJointRows::set(const JointRows& rows, cudaStream_t stream) {
  const AxisTables tables(rows);
  axes_ = static_cast<int>(tables.axes.size()), joints_ = static_cast<int>(tables.joints.size());
  sides_ = static_cast<int>(tables.sides.size());
  send(std::span(tables.axes), axisRefs_, stream), send(std::span(tables.joints), jointRefs_, stream);
  send(std::span(tables.sides), axisSides_, stream);
}

ArrayView DeviceJointRows::view(const SolverData& device, JointArray which, cudaStream_t stream) {
  DeviceBuffer& to = axisNumbers_[static_cast<int>(which)];
  to.reserve(sizeof(Real) * static_cast<std::size_t>(axes_));
  forEach(device, ReadAxis{which, in<AxisRef>(axisRefs_), in<Real>(to)}, axes_, stream);
  return onDevice(packedArray(in<Real>(to), axes_, 1), stream);
}

ArrayView DeviceJointRows::view(const SolverData& device, SensorArray which, int bodies, int pairs,
                                cudaStream_t stream) {
  const int rows = isOfJoints(which) ? joints_ : bodies, numbers = numbersOf(which);
  if (countsContacts(which)) {
    const std::size_t bytes = sizeof(ForceSums) * static_cast<std::size_t>(device.bodies);
    sums_.reserve(bytes);
    clear(sums_, bytes, stream);
    forEach(device, SumContactForces{in<ForceSums>(sums_)}, pairs, stream);
  }
  DeviceBuffer& to = sensorNumbers_[static_cast<int>(which)];
  to.reserve(sizeof(Real) * static_cast<std::size_t>(rows * numbers));
  forEach(device, ReadSensor{which, in<ForceSums>(sums_), in<AxisRef>(jointRefs_), in<Real>(to)}, rows,
          stream);
  return onDevice(packedArray(in<Real>(to), rows, numbers), stream);
}

ArrayView DeviceJointRows::contactForces(const SolverData& device, std::span<const std::array<int, 2>> pairs,
                                         cudaStream_t stream) {
  const auto count = static_cast<int>(pairs.size());
  send(pairs, pairs_, stream);
  pairForces_.reserve(sizeof(Real) * 3 * pairs.size());
  forEach(device, ReadPairForce{in<int>(pairs_), in<Real>(pairForces_)}, count, stream);
  return onDevice(packedArray(in<Real>(pairForces_), count, 3), stream);
}

void DeviceJointRows::scatter(const SolverData& device, JointArray which, const ArrayView& rows,
                              const ArrayView& values, cudaStream_t stream) {
  const AxisValues given(axes_, rows, values);
  const auto count = static_cast<int>(rows.shape[0]);
  if (which != JointArray::AppliedForce)
    return forEach(device, WriteTarget{which, in<AxisRef>(axisRefs_), given}, count, stream);
  const std::size_t bytes = sizeof(Real) * static_cast<std::size_t>(axes_);
  forces_.reserve(bytes);
  clear(forces_, bytes, stream);
  forEach(device, NoteForce{given, in<Real>(forces_)}, count, stream);
  forEach(device,
          ApplyAxisForces{in<AxisRef>(axisRefs_), in<AxisSide>(axisSides_), sides_, in<Real>(forces_)},
          sides_, stream);
}

}  // namespace rubble::RUBBLE_CORE
