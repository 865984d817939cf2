#pragma once
#include <cstdint>
#include <functional>

namespace rubble {

/// Stable handle of a body, joint or other object: slot index and generation. A removed slot is reused with
/// the next generation, so a stale id never matches a new object.
template <class Tag> struct Id {
  std::int32_t index = -1;
  std::uint32_t generation = 0;
  friend bool operator==(const Id&, const Id&) = default;
};

using BodyId = Id<struct BodyTag>;
using JointId = Id<struct JointTag>;
using ShapeId = Id<struct ShapeTag>;
using DeformableId = Id<struct DeformableTag>;  ///< a deformable object (Jolt: soft body)
using AttachmentId = Id<struct AttachmentTag>;

}  // namespace rubble

template <class Tag> struct std::hash<rubble::Id<Tag>> {
  std::size_t operator()(const rubble::Id<Tag>& id) const noexcept {
    return std::hash<std::uint64_t>{}((std::uint64_t(id.generation) << 32) | std::uint32_t(id.index));
  }
};
