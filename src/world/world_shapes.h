#pragma once
/// The shapes of a world, with their uses and their places in the tables.
#include <bit>

#include "world/cooked_shapes.h"
#include "world/shape_space.h"

namespace rubble {

struct ShapeRecord {
  Shape shape;
  std::shared_ptr<const CookedShape> cooked = nullptr;  ///< null: a shape without geometry
  ShapePlace place = {};                                ///< in the tables, if it has geometry
  int bodies = 0;                                       ///< that have it
  int held = 0;                                         ///< calls of World::addShape()
  std::int32_t next = -1;                               ///< in the bucket of its hash
};

/// Copies share their content until one of them is edited, as those of Slots.
class WorldShapes {
 public:
  /// Are they one shape of a world?
  static bool identical(const Shape& a, const Shape& b) {
    return a.type == b.type && a.halfExtents == b.halfExtents && a.radius == b.radius &&
           a.halfLength == b.halfLength && a.rounding == b.rounding && a.geometry == b.geometry &&
           a.userData == b.userData;
  }

  bool alive(ShapeId id) const { return records_.alive(id); }
  const ShapeRecord& operator[](ShapeId id) const { return records_[id]; }
  std::vector<ShapeId> ids() const { return records_.ids(); }
  int count() const { return records_.count(); }
  /// The id that the k-th add() from now on gives.
  ShapeId next(int k) const { return records_.next(k); }
  const ShapeSpace& space() const { return space_; }
  std::optional<ShapeId> find(const Shape& shape) const {
    if (buckets_->empty()) return {};
    for (int at = (*buckets_)[bucketOf(shape)]; at >= 0;) {
      const ShapeId id = *records_.at(at);
      if (identical(records_[id].shape, shape)) return id;
      at = records_[id].next;
    }
    return {};
  }

  /// Makes room, so that `added` calls of add(), `dropped` calls of drop() and any of use() need no memory.
  void prepare(int added, int dropped) {
    records_.prepare(std::max(added, dropped));
    space_.prepare(dropped);
    const std::size_t needed = static_cast<std::size_t>(count() + added);
    if (needed > buckets_->size()) {
      auto larger = std::make_shared<Buckets>(std::bit_ceil(needed), -1);
      buckets_ = std::move(larger);
      for (int k = 0; k < records_.size(); ++k)
        if (const auto id = records_.at(k)) link(*id);
    } else if (buckets_.use_count() > 1) {
      buckets_ = std::make_shared<Buckets>(*buckets_);
    }
  }
  ShapeId add(ShapeRecord record) {
    const ShapeId id = records_.add(std::move(record));
    link(id);
    return id;
  }
  /// `space`: with the places of shapes that are added next.
  void setSpace(ShapeSpace&& space) noexcept { space_ = std::move(space); }
  void use(ShapeId id, int ShapeRecord::*uses) { ++(records_.edit(id).*uses); }
  /// Does a shape end that loses so many uses?
  bool ends(ShapeId id, int lost) const { return records_[id].bodies + records_[id].held == lost; }
  /// Takes back a use. The last one ends the shape.
  void drop(ShapeId id, int ShapeRecord::*uses) {
    ShapeRecord& record = records_.edit(id);
    if (--(record.*uses), !ends(id, 0)) return;
    if (record.cooked) space_.give(record.place, *record.cooked);
    std::int32_t* at = &(*buckets_)[bucketOf(record.shape)];
    while (*at != id.index) at = &records_.edit(*records_.at(*at)).next;
    *at = record.next;
    records_.remove(id);
  }
  /// visit(records, space): for a reader, which calls linkAll() after it.
  template <class Visit> void forMembers(Visit&& visit) { visit(records_, space_); }
  void linkAll() {
    buckets_ = std::make_shared<Buckets>();
    prepare(0, 0);
  }

 private:
  using Buckets = std::vector<std::int32_t>;

  std::size_t bucketOf(const Shape& s) const {
    std::size_t hash = std::hash<const void*>{}(s.geometry.get());
    const auto add = [&](std::uint64_t bits) {
      constexpr std::uint64_t kGolden = 0x9e3779b97f4a7c15u;
      hash = (hash ^ bits) * kGolden;
      hash ^= hash >> 32;
    };
    // 0. makes one of the two zeros, which are equal
    for (const double size :
         {s.halfExtents.x, s.halfExtents.y, s.halfExtents.z, s.radius, s.halfLength, s.rounding})
      add(std::bit_cast<std::uint64_t>(size + 0.));
    add(static_cast<std::uint64_t>(s.type)), add(s.userData);
    return hash & (buckets_->size() - 1);
  }
  void link(ShapeId id) {
    ShapeRecord& record = records_.edit(id);
    record.next = std::exchange((*buckets_)[bucketOf(record.shape)], id.index);
  }

  Slots<ShapeId, ShapeRecord> records_;
  std::shared_ptr<Buckets> buckets_ = std::make_shared<Buckets>();  ///< first of each, -1: none; a power of 2
  ShapeSpace space_;
};

}  // namespace rubble
