#pragma once
/// Elements of tables that go from rank to rank.
#include <array>
#include <atomic>
#include <cstring>
#include <utility>

#include "backend/cpu/counting.h"
#include "backend/distributed/transport.h"
#include "state/array.h"

namespace rubble {

/// Calls f(i) for i < n, in parallel if they are many.
template <class F> void forEachOfMany(int n, int threads, F&& f) {
  constexpr int kGrain = 1024;
  const auto range = [&](int begin, int end) {
    for (int i = begin; i < end; ++i) f(i);
  };
  if (threads <= 1 || n <= kGrain) return range(0, n);
  forEachShare(n, kGrain, range);
}

/// Indices of elements for each rank.
using RankLists = std::vector<std::vector<int>>;

inline void clearLists(RankLists& lists, int ranks) {
  lists.resize(static_cast<std::size_t>(ranks));
  for (std::vector<int>& list : lists) list.clear();
}

/// Elements that this rank gives to, and takes from, each rank. Both sides have them in the same order.
struct RankTraffic {
  RankLists give, take;
  void clear(int ranks) { clearLists(give, ranks), clearLists(take, ranks); }
};

/// Packs, exchanges and unpacks elements of arrays. The elements of the first array come first in a message.
class RankCourier {
 public:
  /// `threads`: of this rank, which run the calls below.
  explicit RankCourier(Transport& transport, int threads = 1)
      : transport_(transport),
        rank_(transport.rank()),
        ranks_(transport.ranks()),
        threads_(threads),
        out_(count()),
        in_(count()),
        sizes_(count()) {}

  int rank() const { return rank_; }
  int ranks() const { return ranks_; }

  template <class... T> void swap(const RankTraffic& traffic, T*... arrays) {
    constexpr std::size_t kBytes = (sizeof(T) + ...);
    sends_.clear(), receives_.clear();
    for (std::size_t r = 0; r < count(); ++r) {
      if (const auto& list = traffic.give[r]; !list.empty()) {
        out_[r].resize(kBytes * list.size());
        pack(list, out_[r].data(), arrays...);
        sends_.push_back({static_cast<int>(r), out_[r]});
      }
      if (const auto& list = traffic.take[r]; !list.empty()) {
        in_[r].resize(kBytes * list.size());
        receives_.push_back({static_cast<int>(r), in_[r]});
      }
    }
    transport_.exchange(sends_, receives_);
    for (const Transport::Receive& receive : receives_)
      unpack(traffic.take[static_cast<std::size_t>(receive.from)], receive.bytes.data(), arrays...);
  }

  /// Every rank receives the elements of all others. lists[r]: those of rank r, the same on all ranks.
  template <class... T> void gather(const RankLists& lists, T*... arrays) {
    constexpr std::size_t kBytes = (sizeof(T) + ...);
    std::size_t all = 0;
    for (std::size_t r = 0; r < count(); ++r) all += sizes_[r] = kBytes * lists[r].size();
    if (all == 0) return;
    const std::size_t me = static_cast<std::size_t>(rank());
    out_[me].resize(sizes_[me]);
    pack(lists[me], out_[me].data(), arrays...);
    gatherBlocks(all);
    std::size_t at = 0;
    for (std::size_t r = 0; r < count(); at += sizes_[r++])
      if (r != me) unpack(lists[r], all_.data() + at, arrays...);
  }

  /// Gathers one value of each rank.
  template <class T> std::vector<T> gatherValue(const T& own) {
    std::vector<T> out(count());
    std::fill(sizes_.begin(), sizes_.end(), sizeof(T));
    transport_.gather(std::as_bytes(std::span(&own, 1)), std::as_writable_bytes(std::span(out)), sizes_);
    return out;
  }

  /// Gathers small numbers, 0 to 2^bits - 1: element i of `values` from rank rankOf(i) if that is not
  /// negative; the others are unchanged.
  template <int bits, class RankOf> void gatherSmall(int* values, int n, RankOf&& rankOf) {
    constexpr std::size_t kPerByte = 8 / bits;
    const int ranges = rangesFor(n, threads_);
    // by range and rank: first how many elements, then the number of the first one
    counts_.assign(static_cast<std::size_t>(ranges) * count(), 0);
    const auto forEach = [&](auto&& f) {
      forEachOfRanges(n, ranges, [&](std::size_t range, int begin, int end) {
        std::size_t* const own = counts_.data() + range * count();
        for (int i = begin; i < end; ++i)
          if (const int r = rankOf(i); r >= 0) f(i, r, own[r]);
      });
    };
    forEach([](int, int, std::size_t& elements) { ++elements; });
    std::size_t all = 0;
    for (std::size_t r = 0; r < count(); ++r) {
      std::size_t elements = 0;
      for (std::size_t range = 0; range < static_cast<std::size_t>(ranges); ++range)
        elements += std::exchange(counts_[range * count() + r], elements);
      all += sizes_[r] = (elements + kPerByte - 1) / kPerByte;
    }
    if (all == 0) return;
    const std::vector<std::size_t> first = counts_;
    std::vector<std::byte>& out = out_[static_cast<std::size_t>(rank())];
    out.assign(sizes_[static_cast<std::size_t>(rank())], std::byte{0});
    forEach([&](int i, int r, std::size_t& next) {
      if (r != rank()) return;
      // two ranges may share a byte
      std::atomic_ref<std::uint8_t> byte(reinterpret_cast<std::uint8_t&>(out[next / kPerByte]));
      byte.fetch_or(static_cast<std::uint8_t>(values[i] << (next % kPerByte * bits)),
                    std::memory_order_relaxed);
      ++next;
    });
    gatherBlocks(all);
    counts_ = first;
    std::size_t at = 0;
    for (std::size_t r = 0; r < count(); at += sizes_[r++])
      for (std::size_t range = 0; range < static_cast<std::size_t>(ranges); ++range)
        counts_[range * count() + r] += at * kPerByte;
    forEach([&](int i, int, std::size_t& next) {
      values[i] = std::to_integer<int>(all_[next / kPerByte] >> (next % kPerByte * bits)) & ((1 << bits) - 1);
      ++next;
    });
  }

  /// Asks for elements of several kinds: needs[kind][rank]. Returns the lists of both sides.
  std::vector<RankTraffic> ask(std::vector<RankLists> needs);

 private:
  std::size_t count() const { return static_cast<std::size_t>(ranks_); }
  void gatherBlocks(std::size_t all) {
    all_.resize(all);
    transport_.gather(out_[static_cast<std::size_t>(rank())], all_, sizes_);
  }
  template <class... T> void pack(const std::vector<int>& list, std::byte* to, T*... arrays) const {
    const auto put = [&](const auto* array) {
      constexpr std::size_t kSize = sizeof array[0];
      forEachOfMany(static_cast<int>(list.size()), threads_, [&](int k) {
        const std::size_t at = static_cast<std::size_t>(k);
        std::memcpy(to + kSize * at, &array[list[at]], kSize);
      });
      to += kSize * list.size();
    };
    (put(arrays), ...);
  }
  template <class... T> void unpack(const std::vector<int>& list, const std::byte* from, T*... arrays) const {
    const auto take = [&](auto* array) {
      constexpr std::size_t kSize = sizeof array[0];
      forEachOfMany(static_cast<int>(list.size()), threads_, [&](int k) {
        const std::size_t at = static_cast<std::size_t>(k);
        std::memcpy(static_cast<void*>(&array[list[at]]), from + kSize * at, kSize);
      });
      from += kSize * list.size();
    };
    (take(arrays), ...);
  }

  Transport& transport_;
  int rank_, ranks_, threads_;
  std::vector<std::vector<std::byte>> out_, in_;
  std::vector<std::byte> all_;
  std::vector<std::size_t> sizes_, counts_;
  std::vector<Transport::Send> sends_;
  std::vector<Transport::Receive> receives_;
};

}  // namespace rubble
