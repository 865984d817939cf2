#pragma once
/// Poses from the arrays of a world into the renderer's buffer without a copy to the host. Only the CUDA
/// build has one.
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include <rubble/arrays.h>

#include "render/camera.h"

namespace rubble::render {

/// Place of what has none [m].
inline constexpr float kNowhere = 1e18f;

/// Where the pose of a body is: the row of its pose in the engine's arrays, and the frame of its shape in
/// that of the engine.
struct PoseSource {
  std::int32_t row = -1;         ///< -1: no body
  float radius = 0;              ///< of a sphere about the pose that holds it [m]
  float place[3] = {};           ///< [m]
  float turn[4] = {0, 0, 0, 1};  ///< scalar last
};
/// A range of slots with common bounds.
struct SlotRange {
  std::uint32_t first = 0, count = 0;
};
/// StateArray::Position and Orientation of a world, and what the renderer's frame is relative to.
struct PoseArrays {
  ArrayView position, orientation;
  Vec3 origin;
};

class PoseFeed {
 public:
  virtual ~PoseFeed() = default;
  /// One source a slot; ranges cover all slots.
  virtual void setSlots(std::span<const PoseSource> sources, std::span<const SlotRange> ranges) = 0;
  /// Writes the pose of every slot into an OpenGL buffer of `slots` poses, and the bounds of each range to
  /// the host; returns when both are there. `storage` counts how often the buffer got another memory.
  virtual void fill(unsigned buffer, int storage, const PoseArrays& arrays, std::span<Bounds> bounds) = 0;
};

/// Null if this build, or the device that OpenGL draws with, cannot; then `why` says why. Needs the context
/// current.
std::unique_ptr<PoseFeed> makePoseFeed(std::string& why);

}  // namespace rubble::render
