#pragma once
/// Places of shapes in the tables that they share.
#include <algorithm>
#include <vector>

#include "tables/edits.h"
#include "world/slots.h"

namespace rubble {

/// A table, of which shapes have ranges.
class RangeSpace {
 public:
  /// The first element of a range that nothing else has: the first free one of that size, or the end.
  int take(int size) {
    const auto fits = std::ranges::find_if(free_, [size](const Range& r) { return r.size >= size; });
    if (fits == free_.end()) return std::exchange(end_, end_ + size);
    const int first = fits->first;
    fits->first += size, fits->size -= size;
    if (fits->size == 0) free_.erase(fits);
    return first;
  }
  /// Makes room, so that `count` calls of give() need no memory.
  void prepare(int count) { reserveMore(free_, count); }
  void give(int first, int size) noexcept {
    if (size == 0) return;
    auto next = std::ranges::lower_bound(free_, first, {}, &Range::first);
    if (next != free_.begin() && std::prev(next)->end() == first) {
      --next;
      next->size += size;
    } else {
      next = free_.insert(next, {first, size});
    }
    if (const auto after = std::next(next); after != free_.end() && after->first == next->end()) {
      next->size += after->size;
      free_.erase(after);
    }
    if (free_.back().end() == end_) end_ = free_.back().first, free_.pop_back();
  }
  template <class Visit> void forMembers(Visit&& visit) { visit(free_), visit(end_); }

  struct Range {
    int first, size;
    int end() const { return first + size; }
  };

 private:
  std::vector<Range> free_;  ///< ascending, with something between any two and behind the last one
  int end_ = 0;
};

class ShapeSpace {
 public:
  ShapePlace take(const CookedShape& shape) {
    return {vectors_.take(sizeOf(shape.vectors)), indices_.take(sizeOf(shape.indices)),
            parts_.take(sizeOf(shape.parts))};
  }
  /// Makes room, so that `count` calls of give() need no memory.
  void prepare(int count) { vectors_.prepare(count), indices_.prepare(count), parts_.prepare(count); }
  void give(const ShapePlace& place, const CookedShape& shape) noexcept {
    vectors_.give(place.vectors, sizeOf(shape.vectors));
    indices_.give(place.indices, sizeOf(shape.indices));
    parts_.give(place.parts, sizeOf(shape.parts));
  }
  template <class Visit> void forMembers(Visit&& visit) {
    for (RangeSpace* const space : {&vectors_, &indices_, &parts_}) space->forMembers(visit);
  }

 private:
  template <class List> static int sizeOf(const List& list) { return static_cast<int>(list.size()); }

  RangeSpace vectors_, indices_, parts_;
};

}  // namespace rubble
