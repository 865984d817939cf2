#pragma once
/// Cooked shapes, found by the geometry that they are made of.
#include <memory>
#include <unordered_map>

#include "collision/cooked_shape.h"
#include "cook/cook.h"

namespace rubble {

/// Shapes that are still in use somewhere. It keeps none alive.
class CookedShapes {
 public:
  /// The cooked shape of the same geometry, type and rounding. It is made if there is none: throws Error with
  /// `path` for geometry that cannot be cooked.
  std::shared_ptr<const CookedShape> get(const Shape& shape, const Path& path) {
    const auto [begin, end] = entries_.equal_range(shape.geometry.get());
    for (auto at = begin; at != end; ++at) {
      const Entry& entry = at->second;
      // the address may be that of other geometry before
      if (entry.type != shape.type || entry.rounding != shape.rounding || entry.geometry.expired()) continue;
      if (auto found = entry.cooked.lock()) return found;
    }
    auto made = std::make_shared<const CookedShape>(cook(shape, path));
    if (entries_.size() >= most_) {
      std::erase_if(entries_, [](const auto& at) { return at.second.cooked.expired(); });
      most_ = std::max(kLeast, 2 * entries_.size());
    }
    entries_.emplace(shape.geometry.get(), Entry{shape.geometry, shape.type, shape.rounding, made});
    return made;
  }

 private:
  struct Entry {
    std::weak_ptr<const ShapeGeometry> geometry;
    ShapeType type;
    double rounding;
    std::weak_ptr<const CookedShape> cooked;
  };
  static constexpr std::size_t kLeast = 64;

  std::unordered_multimap<const ShapeGeometry*, Entry> entries_;
  std::size_t most_ = kLeast;  ///< entries before those without use are removed
};

}  // namespace rubble
