#pragma once
/// Zero-copy views of the state of all bodies as strided arrays, in the memory of the backend. For renderers,
/// learning frameworks and other libraries.
#include <cstdint>
#include <type_traits>

namespace rubble {

/// An array of body state. Shape: one row per body slot.
enum class StateArray {
  Position,         ///< center of mass, world [m]: 3 doubles on every backend
  Orientation,      ///< body -> world: quaternion, 4 numbers, scalar first
  Velocity,         ///< [m/s]: 3 numbers
  AngularVelocity,  ///< world axes [rad/s]: 3 numbers
  Force,            ///< at the center of mass [N]: 3 numbers; zeroed by each step
  Torque,           ///< world axes [N m]: 3 numbers; zeroed by each step
};

/// An array of the joints. Shape: one row per axis of each joint, one number per row. Joints are in the order
/// of World::joints(), axes in that of JointDef::axes. Forces act on A along the axis: positive forces
/// increase the position.
enum class JointArray {
  Position,        ///< [m], [rad]; angles count whole revolutions
  Speed,           ///< [m/s], [rad/s]
  DriveForce,      ///< of the last step [N], [N m]
  LimitForce,      ///< the same
  FrictionForce,   ///< the same
  LowerLimit,      ///< [m], [rad]; may be infinite
  UpperLimit,      ///< the same
  TargetPosition,  ///< of the drive [m], [rad]; can be written
  TargetSpeed,     ///< of the drive [m/s], [rad/s]; can be written
  AppliedForce,    ///< for the next step [N], [N m]: can be written only
};

/// What sensors measure. Rows are body slots, or joints in the order of World::joints(). Body axes are those
/// of StateArray::Orientation.
enum class SensorArray {
  ContactForce,  ///< by body: sum of the contacts with other bodies in the last step, world axes [N]: 3
                 ///< numbers
  Touch,         ///< by body: sum of the normal forces of these contacts [N]: 1 number
  /// By body: acceleration of the center of mass in the last step, less gravity, body axes [m/s2]: 3 numbers.
  /// An accelerometer at rest shows 9.81 upward.
  Acceleration,
  AngularRate,  ///< by body: angular velocity, body axes [rad/s]: 3 numbers
  JointForce,   ///< by joint: on body B at its anchor in the last step, world axes [N]: 3 numbers
  JointTorque,  ///< by joint: on body B about its anchor, world axes [N m]: 3 numbers
};

/// An array of the vertices of deformable objects. Shape: one row per vertex, 3 numbers per row. Objects are
/// in the order in which they were added, vertices in that of their object.
enum class VertexArray {
  Position,  ///< world [m]: doubles on every backend
  Velocity,  ///< [m/s]
};

/// A two-dimensional strided array. The members match the entries of __cuda_array_interface__ version 3.
struct ArrayView {
  const void* data = nullptr;        ///< first element of row 0
  std::int64_t shape[2] = {0, 0};    ///< rows, numbers per row
  std::int64_t strides[2] = {0, 0};  ///< between rows, between numbers [bytes]
  const char* typestr = "<f4";       ///< "<f4" float, "<f8" double, "<i4" int
  bool device = false;               ///< true: GPU memory; false: host memory
  /// CUDA stream on which the data is ready, as in __cuda_array_interface__: 1 the legacy default stream, 2
  /// the per-thread default stream, otherwise a handle. 0: no synchronization is needed, or the caller does
  /// it.
  std::uintptr_t stream = 0;
  /// World::epoch() when the view was made. The view is valid while that number is unchanged.
  std::int64_t epoch = 0;
};

/// A view of rows of `numbers` numbers each, one after the other in host memory: float, double or int.
template <class T> ArrayView packedArray(const T* data, std::int64_t rows, std::int64_t numbers = 1) {
  static_assert(std::is_same_v<T, float> || std::is_same_v<T, double> || std::is_same_v<T, std::int32_t>);
  constexpr std::int64_t kSize = sizeof(T);
  const char* const type = std::is_same_v<T, std::int32_t> ? "<i4" : kSize == 8 ? "<f8" : "<f4";
  return {data, {rows, numbers}, {kSize * numbers, kSize}, type};
}

/// Poses of all body slots after a step, in host memory (World::takePoses).
struct PoseFrame {
  std::int64_t step = 0;  ///< number of steps taken
  double time = 0;        ///< simulated time [s]
  ArrayView position;     ///< as StateArray::Position
  ArrayView orientation;  ///< as StateArray::Orientation
};

}  // namespace rubble
