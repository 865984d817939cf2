#pragma once
/// Cooked shapes that have geometry, found by it.
#include <memory>
#include <unordered_map>
#include <vector>

#include "collision/cooked_shape.h"

namespace rubble {

/// A cooked shape and its place in tables.
struct CookedEntry {
  Shape key;
  std::shared_ptr<const CookedShape> cooked;
  int indexBase;  ///< offset of its indices in the shape tables
};

class CookedShapes {
 public:
  const std::vector<CookedEntry>& entries() const { return entries_; }
  int count() const { return static_cast<int>(entries_.size()); }
  /// The entry of a shape with the same geometry, type and rounding, or null.
  const CookedEntry* find(const Shape& shape) const {
    const auto [begin, end] = places_.equal_range(shape.geometry.get());
    for (auto at = begin; at != end; ++at) {
      const CookedEntry& entry = entries_[static_cast<std::size_t>(at->second)];
      if (entry.key.type == shape.type && entry.key.rounding == shape.rounding) return &entry;
    }
    return nullptr;
  }
  void add(CookedEntry entry) {
    const auto place = places_.emplace(entry.key.geometry.get(), count());
    try {
      entries_.push_back(std::move(entry));
    } catch (...) {
      places_.erase(place);
      throw;
    }
  }
  /// Makes room, so that take() of these needs no memory.
  void prepare(const CookedShapes& more) {
    const std::size_t needed = entries_.size() + more.entries_.size();
    if (needed > entries_.capacity()) entries_.reserve(std::max(needed, 2 * entries_.capacity()));
    places_.reserve(needed);
  }
  /// Moves the entries of another list behind its own.
  void take(CookedShapes&& more) noexcept {
    for (auto& [geometry, place] : more.places_) place += count();
    places_.merge(more.places_);
    std::move(more.entries_.begin(), more.entries_.end(), std::back_inserter(entries_));
  }
  /// Calls fill(entries) on an empty list.
  template <class Fill> void fill(Fill&& fill) {
    fill(entries_);
    for (int k = 0; k < count(); ++k)
      places_.emplace(entries_[static_cast<std::size_t>(k)].key.geometry.get(), k);
  }

 private:
  std::vector<CookedEntry> entries_;
  std::unordered_multimap<const ShapeGeometry*, int> places_;  ///< in `entries_`
};

}  // namespace rubble
