#pragma once
/// Lists of the elements that a rank runs. They are made on the threads of the caller, and have one order for
/// any number of threads.
#include <array>
#include <numeric>
#include <vector>

#include "backend/distributed/rank_lists.h"
#include "backend/division.h"

namespace rubble::RUBBLE_CORE {

/// A list of elements. The first `counted` count toward the report of a step.
struct RankPart {
  std::vector<int> index;
  int counted = 0;
  Division::Part part() const { return {index.data(), counted, size()}; }
  int size() const { return static_cast<int>(index.size()); }
  void clear() { index.clear(), counted = 0; }
  /// This list becomes that of the elements of two others.
  void join(const RankPart& a, const RankPart& b) {
    index.resize(a.index.size() + b.index.size());
    auto to = index.begin();
    for (const RankPart* each : {&a, &b}) to = std::copy_n(each->index.begin(), each->counted, to);
    for (const RankPart* each : {&a, &b})
      to = std::copy(each->index.begin() + each->counted, each->index.end(), to);
    counted = a.counted + b.counted;
  }
};

/// Elements of a list by group, such as the bodies of each color.
struct RankGroups {
  std::vector<int> index;
  /// Of the counted elements of group g: offset[2 g]. Of its others: the next one.
  std::vector<int> offset = {0};
  Division::Part part(int group) const {
    const int* const of = offset.data() + 2 * group;
    return {index.data() + of[0], of[1] - of[0], of[2] - of[0]};
  }
};

/// Makes lists. Its memory is kept for the next one.
class RankLister {
 public:
  /// `threads`: most ranges that loops have use for.
  explicit RankLister(int threads) : threads_(threads) {}
  int threads() const { return threads_; }

  enum class Take { No, Counted, Other };
  /// The list of elementOf(i) for i < n, in this order, the counted ones before the others. takeOf(i) is
  /// called once for each i.
  template <class TakeOf, class ElementOf>
  void list(RankPart& to, int n, TakeOf&& takeOf, ElementOf&& elementOf) {
    struct Range {
      int counted = 0, others = 0;
    };
    const int ranges = rangesFor(n, threads_);
    std::array<Range, kMostRanges> sizes{};
    if (room_.size() < static_cast<std::size_t>(n)) room_.resize(static_cast<std::size_t>(n));
    // counted elements of a range from its front, others from its back
    forEachOfRanges(n, ranges, [&](std::size_t range, int begin, int end) {
      int front = begin, back = end;
      for (int i = begin; i < end; ++i) {
        const Take take = takeOf(i);
        if (take == Take::Counted)
          room_[static_cast<std::size_t>(front++)] = elementOf(i);
        else if (take == Take::Other)
          room_[static_cast<std::size_t>(--back)] = elementOf(i);
      }
      sizes[range] = {front - begin, end - back};
    });
    std::array<Range, kMostRanges> places{};
    int at = 0;
    for (std::size_t k = 0; k < kMostRanges; ++k) places[k].counted = at, at += sizes[k].counted;
    to.counted = at;
    for (std::size_t k = 0; k < kMostRanges; ++k) places[k].others = at, at += sizes[k].others;
    to.index.resize(static_cast<std::size_t>(at));
    forEachOfRanges(n, ranges, [&](std::size_t range, int begin, int end) {
      const auto& [counted, others] = sizes[range];
      std::copy_n(room_.begin() + begin, counted, to.index.begin() + places[range].counted);
      std::reverse_copy(room_.begin() + end - others, room_.begin() + end,
                        to.index.begin() + places[range].others);
    });
  }
  template <class TakeOf> void list(RankPart& to, int n, TakeOf&& takeOf) {
    list(to, n, takeOf, [](int i) { return i; });
  }

  /// Sorts the elements of a list by keyOf(element) < groups, in their order. Negative: in no group.
  template <class KeyOf> void group(RankGroups& to, const RankPart& from, int groups, KeyOf&& keyOf) {
    group(to, from.size(), from.counted, groups, keyOf,
          [&](int k) { return from.index[static_cast<std::size_t>(k)]; });
  }
  /// The same of all i < n.
  template <class KeyOf> void group(RankGroups& to, int n, int groups, KeyOf&& keyOf) {
    group(to, n, n, groups, keyOf, [](int k) { return k; });
  }

  /// `perJoint` parts of each element of a list.
  void listParts(RankPart& to, const RankPart& from, int perJoint) {
    to.index.resize(from.index.size() * static_cast<std::size_t>(perJoint));
    to.counted = from.counted * perJoint;
    forEachOfMany(to.size(), threads_, [&](int k) {
      to.index[static_cast<std::size_t>(k)] = from.index[static_cast<std::size_t>(k / perJoint)] * perJoint +
                                              k % perJoint;
    });
  }

 private:
  template <class KeyOf, class ElementOf>
  void group(RankGroups& to, int n, int counted, int groups, KeyOf&& keyOf, ElementOf&& elementOf) {
    const auto fit = [](std::vector<int>& room, int size) {
      if (room.size() < static_cast<std::size_t>(size)) room.resize(static_cast<std::size_t>(size));
    };
    fit(room_, n), fit(order_, n);
    forEachOfMany(n, threads_, [&](int k) {
      const int own = keyOf(elementOf(k));
      room_[static_cast<std::size_t>(k)] = own < 0 ? -1 : 2 * own + (k < counted ? 0 : 1);
    });
    to.offset.resize(2 * static_cast<std::size_t>(groups) + 1);
    sort_.run(room_.data(), n, n, 2 * groups, to.offset.data(), order_.data(), threads_);
    to.index.resize(static_cast<std::size_t>(to.offset.back()));
    forEachOfMany(to.offset.back(), threads_, [&](int k) {
      to.index[static_cast<std::size_t>(k)] = elementOf(order_[static_cast<std::size_t>(k)]);
    });
  }

  int threads_;
  std::vector<int> room_, order_;
  CountingSort sort_;
};

}  // namespace rubble::RUBBLE_CORE
