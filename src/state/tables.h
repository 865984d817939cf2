#pragma once
/// The memory behind a View: every array has room for as many elements as its kind needs; growing keeps what is there.
#include <cstddef>

#include "state/view.h"

namespace rubble::RUBBLE_CORE {

/// `Memory`: static allocate(bytes) (zeroed), release(pointer), copy(to, from, bytes).
template <class Memory>
class Tables {
 public:
  Tables() {
    view_.counters = static_cast<Counters*>(Memory::allocate(sizeof(Counters)));
    for (int per = 0; per < kPerCount; ++per) reserve(static_cast<Per>(per), 1);
  }
  ~Tables() {
    Memory::release(view_.counters);
    forEachArray([&](const auto& array) { Memory::release(view_.*array.member); });
  }
  Tables(const Tables&) = delete;
  Tables& operator=(const Tables&) = delete;

  View& view() { return view_; }
  const View& view() const { return view_; }
  int capacity(Per per) const { return capacity_[static_cast<int>(per)]; }

  /// Room for at least `count` elements of a kind; grows by half, so that rising needs cost few moves.
  void reserve(Per per, int count) {
    int& capacity = capacity_[static_cast<int>(per)];
    if (count <= capacity) return;
    const int grown = capacity > 1 ? count + count / 2 : count;
    forEachArray([&]<class T>(const ArrayInfo<T>& array) {
      if (array.per != per) return;
      T*& pointer = view_.*array.member;
      T* const fresh = static_cast<T*>(Memory::allocate(bytesOf(array, grown)));
      if (pointer) Memory::copy(fresh, pointer, bytesOf(array, capacity));
      Memory::release(pointer);
      pointer = fresh;
    });
    capacity = grown;
  }

  std::size_t bytes() const {
    std::size_t sum = sizeof(Counters);
    forEachArray([&](const auto& array) { if (view_.*array.member) sum += bytesOf(array, capacity(array.per)); });
    return sum;
  }

  /// The manifolds of this step become those that the next one starts from.
  void keepManifolds() {
    const auto swap = [](auto*& a, auto*& b) {
      auto* const c = a;
      a = b;
      b = c;
    };
    swap(view_.pair, view_.oldPair);
    swap(view_.manifold, view_.oldManifold);
    swap(view_.pairOffset, view_.oldPairOffset);
    swap(view_.pointPair, view_.oldPointPair);
    swap(view_.pointContact, view_.oldPointContact);
    swap(view_.pointPairOffset, view_.oldPointPairOffset);
    swap(view_.rolling, view_.oldRolling);
  }

 private:
  template <class T>
  static std::size_t bytesOf(const ArrayInfo<T>& array, int count) {
    return sizeof(T) * static_cast<std::size_t>(count + array.extra);
  }

  View view_;
  int capacity_[kPerCount] = {};
};

}  // namespace rubble::RUBBLE_CORE
