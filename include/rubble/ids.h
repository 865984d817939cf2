#pragma once
#include <cstdint>
#include <functional>

namespace rubble {

/// A stable name of a body or joint. A slot is used again after a removal, then with another generation: an
/// old id never finds a new body.
template <class Tag> struct Id {
  std::int32_t index = -1;
  std::uint32_t generation = 0;
  friend bool operator==(const Id&, const Id&) = default;
};

using BodyId = Id<struct BodyTag>;
using JointId = Id<struct JointTag>;
using SoftId = Id<struct SoftTag>;  ///< a deformable object
using AttachmentId = Id<struct AttachmentTag>;

}  // namespace rubble

template <class Tag> struct std::hash<rubble::Id<Tag>> {
  std::size_t operator()(const rubble::Id<Tag>& id) const noexcept {
    return std::hash<std::uint64_t>{}((std::uint64_t(id.generation) << 32) | std::uint32_t(id.index));
  }
};
