#pragma once
/// Owner of the memory behind a SolverData. Each array has a capacity by its kind; growing keeps the content.
#include <algorithm>
#include <cstddef>
#include <utility>

#include "state/arrays.h"

namespace rubble::RUBBLE_CORE {

/// `Memory`: allocate(bytes) (zeroed), release(pointer), copy(to, from, bytes).
template <class Memory> class SolverTables {
 public:
  explicit SolverTables(Memory memory = {}) : SolverTables(std::in_place, std::move(memory)) {
    // complete from here on: what throws calls the destructor
    view_.counters = static_cast<Counters*>(memory_.allocate(sizeof(Counters)));
    std::ranges::fill(capacity_, 1);
    forEachArray([&](const auto& array) { moveTo(1, array, 0); });
    aliasRowsIn(view_.manifold);
  }
  ~SolverTables() {
    memory_.release(view_.counters);
    forEachArray([&](const auto& array) {
      if (!array.aliases) memory_.release(view_.*array.member);
    });
  }
  SolverTables(const SolverTables&) = delete;
  SolverTables& operator=(const SolverTables&) = delete;

  const Memory& memory() const { return memory_; }
  SolverData& view() { return view_; }
  const SolverData& view() const { return view_; }
  int capacity(Per per) const { return capacity_[static_cast<int>(per)]; }
  /// Elements that the memory of a table holds: of contact rows, as many as the manifolds that they alias.
  template <class T> int room(const ArrayInfo<T>& array) const {
    return capacity(array.aliases ? Per::ActivePair : array.per);
  }

  /// Grows the arrays of a kind to at least `count` elements, by half more, so that repeated growth stays
  /// cheap.
  void reserve(Per per, int count) {
    int& capacity = capacity_[static_cast<int>(per)];
    if (count <= capacity) return;
    const int grown = capacity > 1 ? count + count / 2 : count;
    // also where memory ends halfway: some arrays have moved by then, and all keep the old capacity
    const Realias realias{*this, rowsAlias(view_.oldManifold)};
    forEachArray([&](const auto& array) {
      if (array.per == per) moveTo(grown, array, capacity);
    });
    capacity = grown;
  }

  std::size_t bytes() const {
    std::size_t sum = sizeof(Counters);
    forEachArray([&](const auto& array) {
      if (view_.*array.member) sum += array.aliases ? 0 : bytesOf(array, capacity(array.per));
    });
    return sum;
  }

  /// Contact rows alias the old manifolds. Once all manifolds of the step are found, the old ones are unused,
  /// and there are no more rows than active pairs. Between steps the rows of the last step stay valid there,
  /// until the next step overwrites them with manifolds.
  void aliasRows() { aliasRowsIn(view_.oldManifold); }

  /// Makes the manifolds of this step the old ones of the next.
  void swapManifolds() {
    std::swap(view_.pair, view_.oldPair);
    std::swap(view_.pairTest, view_.oldPairTest);
    std::swap(view_.activePairOffset, view_.oldActivePairOffset);
    std::swap(view_.manifold, view_.oldManifold);
    std::swap(view_.pairOffset, view_.oldPairOffset);
    std::swap(view_.pointPair, view_.oldPointPair);
    std::swap(view_.pointContact, view_.oldPointContact);
    std::swap(view_.pointPairOffset, view_.oldPointPairOffset);
    std::swap(view_.rolling, view_.oldRolling);
  }

 private:
  SolverTables(std::in_place_t, Memory memory) : memory_(std::move(memory)) {}

  /// Points the contact rows to the manifolds again at the end of its scope.
  struct Realias {
    SolverTables& tables;
    bool amongOld;
    ~Realias() { tables.aliasRowsIn(amongOld ? tables.view_.oldManifold : tables.view_.manifold); }
  };
  static_assert(sizeof(ContactRows) <= sizeof(Manifold) && alignof(ContactRows) <= alignof(Manifold));
  bool rowsAlias(const Manifold* place) const {
    return place && static_cast<const void*>(view_.contact) == place;
  }
  /// Moves an array, which has room for `before` elements, to memory for `count`.
  template <class T> void moveTo(int count, const ArrayInfo<T>& array, int before) {
    if (array.aliases) return;
    Array<T>& pointer = view_.*array.member;
    T* const fresh = static_cast<T*>(memory_.allocate(bytesOf(array, count)));
    if (pointer) memory_.copy(fresh, pointer, bytesOf(array, before));
    memory_.release(pointer);
    pointer = arrayOf(fresh, sizeOf(array, count));
  }
  void aliasRowsIn(Manifold* place) {
    view_.contact = arrayOf(reinterpret_cast<ContactRows*>(place),
                            static_cast<std::size_t>(capacity(Per::ActivePair)));
  }

  template <class T> static std::size_t sizeOf(const ArrayInfo<T>& array, int count) {
    return static_cast<std::size_t>(count + array.extra);
  }
  template <class T> static std::size_t bytesOf(const ArrayInfo<T>& array, int count) {
    return sizeof(T) * sizeOf(array, count);
  }

  Memory memory_;
  SolverData view_;
  int capacity_[kPerCount] = {};
};

}  // namespace rubble::RUBBLE_CORE
