#pragma once
/// Objects with ids.
#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "platform/large_pages.h"

namespace rubble {

/// Reserves `count` more elements. Repeated calls cost no more than push_back.
template <class List> void reserveMore(List& list, int count = 1) {
  const std::size_t needed = list.size() + static_cast<std::size_t>(count);
  if (needed > list.capacity()) list.reserve(std::max(needed, 2 * list.capacity()));
}

/// Live objects of one kind by slot. A freed slot is reused with the next generation. Copies share their
/// items until one of them is edited (copy on write), so a snapshot is free.
template <class Id, class Def> class Slots {
 public:
  /// Makes room, so that `count` calls of add() or remove(), and any of edit(), need no memory.
  void prepare(int count = 1) { reserveMore(own(items_), count), reserveMore(own(free_), count); }
  /// The id that the k-th add() from now on gives.
  Id next(int k = 0) const {
    const int reused = static_cast<int>(free_->size()) - 1 - k;
    if (reused < 0) return {static_cast<std::int32_t>(items_->size()) - reused - 1, 0};
    const std::int32_t index = (*free_)[static_cast<std::size_t>(reused)];
    return {index, item(index).generation + 1};
  }
  Id add(Def def) {
    auto& items = own(items_);
    std::vector<std::int32_t>& free = own(free_);
    if (free.empty()) {
      items.push_back({std::move(def), 0, true});
      return {static_cast<std::int32_t>(items.size() - 1), 0};
    }
    const std::int32_t index = free.back();
    free.pop_back();
    Item& item = items[static_cast<std::size_t>(index)];
    item = {std::move(def), item.generation + 1, true};
    return {index, item.generation};
  }
  void remove(Id id) {
    Item& item = own(items_)[static_cast<std::size_t>(id.index)];
    item.def = Def(), item.alive = false;
    own(free_).push_back(id.index);
  }
  /// Undoes the last add(), which has given this id.
  void takeBack(Id id) {
    if (id.generation == 0) return own(items_).pop_back();
    remove(id);
    --own(items_)[static_cast<std::size_t>(id.index)].generation;
  }
  bool alive(Id id) const {
    return id.index >= 0 && id.index < size() && item(id.index).alive &&
           item(id.index).generation == id.generation;
  }
  const Def& operator[](Id id) const { return item(id.index).def; }
  /// The item for writing.
  Def& edit(Id id) { return own(items_)[static_cast<std::size_t>(id.index)].def; }
  std::optional<Id> at(int index) const {
    return item(index).alive ? std::optional<Id>(Id{index, item(index).generation}) : std::nullopt;
  }
  int size() const { return static_cast<int>(items_->size()); }
  int count() const { return size() - static_cast<int>(free_->size()); }
  /// visit(items, free) for writing. An item has a definition, a generation, and is alive or not.
  template <class F> void forLists(F&& visit) { visit(own(items_), own(free_)); }
  std::vector<Id> ids() const {
    std::vector<Id> out;
    for (int i = 0; i < size(); ++i)
      if (const auto id = at(i)) out.push_back(*id);
    return out;
  }

 private:
  struct Item {
    Def def;
    std::uint32_t generation;
    bool alive;
  };
  const Item& item(int index) const { return (*items_)[static_cast<std::size_t>(index)]; }
  /// Copies a shared list before it is written.
  template <class T> static T& own(std::shared_ptr<T>& shared) {
    if (shared.use_count() > 1) shared = std::make_shared<T>(*shared);
    return *shared;
  }

  using Items = std::vector<Item, platform::LargePageAllocator<Item>>;
  std::shared_ptr<Items> items_ = std::make_shared<Items>();
  std::shared_ptr<std::vector<std::int32_t>> free_ = std::make_shared<std::vector<std::int32_t>>();
};

}  // namespace rubble
