#pragma once
/// The state of all bodies as plain arrays, where the engine keeps them: for renderers, learners and other
/// libraries that take strided memory.
#include <cstdint>

namespace rubble {

/// What a World keeps of every body, one row a body slot.
enum class StateArray {
  Position,         ///< centre of mass, world [m]: 3 numbers of 8 bytes on every backend
  Orientation,      ///< body -> world: 4 numbers, the scalar first
  Velocity,         ///< [m/s]: 3 numbers
  AngularVelocity,  ///< world axes [rad/s]: 3 numbers
  Force,            ///< at the centre, for the next step [N]: 3 numbers; zero again after it
  Torque,           ///< for the next step [N m]: 3 numbers; zero again after it
};

/// A two-dimensional array in the terms of version 3 of __cuda_array_interface__: data, shape, strides,
/// typestr and stream are its entries.
struct ArrayView {
  const void* data = nullptr;        ///< first element of the first row
  std::int64_t shape[2] = {0, 0};    ///< rows, numbers of a row
  std::int64_t strides[2] = {0, 0};  ///< from row to row and from number to number [bytes]
  const char* typestr = "<f4";       ///< "<f4" float, "<f8" double, "<i4" int
  bool device = false;               ///< memory of the GPU; else of the host
  /// CUDA stream that has the data ready, as the interface says: 1 the legacy default stream, 2 that of the
  /// thread, else a handle; 0: none (host memory, or the caller sees to it).
  std::uintptr_t stream = 0;
  std::int64_t
      epoch = 0;  ///< World::epoch() when the view was made: while that is the same, the view is valid
};

/// Poses of all body slots after a step, in host memory.
struct PoseFrame {
  std::int64_t step = 0;  ///< steps that had been taken
  double time = 0;        ///< [s]
  ArrayView position;     ///< as StateArray::Position
  ArrayView orientation;  ///< as StateArray::Orientation
};

}  // namespace rubble
