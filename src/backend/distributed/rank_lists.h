#pragma once
/// Elements of tables that go from rank to rank.
#include <cstring>
#include <utility>

#include "backend/distributed/transport.h"
#include "state/array.h"

namespace rubble {

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
  explicit RankCourier(Transport& transport)
      : transport_(transport), out_(count()), in_(count()), sizes_(count()) {}

  int rank() const { return transport_.rank(); }
  int ranks() const { return transport_.ranks(); }

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
    counts_.assign(count(), 0);
    for (int i = 0; i < n; ++i)
      if (const int r = rankOf(i); r >= 0) ++counts_[static_cast<std::size_t>(r)];
    std::size_t all = 0;
    for (std::size_t r = 0; r < count(); ++r) all += sizes_[r] = (counts_[r] + kPerByte - 1) / kPerByte;
    if (all == 0) return;
    const std::size_t me = static_cast<std::size_t>(rank());
    out_[me].assign(sizes_[me], std::byte{0});
    std::size_t to = 0;
    for (int i = 0; i < n; ++i)
      if (rankOf(i) == rank()) {
        out_[me][to / kPerByte] |= static_cast<std::byte>(values[i] << (to % kPerByte * bits));
        ++to;
      }
    gatherBlocks(all);
    std::size_t at = 0;
    for (std::size_t r = 0; r < count(); at += sizes_[r++]) counts_[r] = at * kPerByte;
    for (int i = 0; i < n; ++i)
      if (const int r = rankOf(i); r >= 0) {
        const std::size_t from = counts_[static_cast<std::size_t>(r)]++;
        values[i] = std::to_integer<int>(all_[from / kPerByte] >> (from % kPerByte * bits)) &
                    ((1 << bits) - 1);
      }
  }

  /// Asks for elements of several kinds: needs[kind][rank]. Returns the lists of both sides.
  std::vector<RankTraffic> ask(std::vector<RankLists> needs);

 private:
  std::size_t count() const { return static_cast<std::size_t>(transport_.ranks()); }
  void gatherBlocks(std::size_t all) {
    all_.resize(all);
    transport_.gather(out_[static_cast<std::size_t>(rank())], all_, sizes_);
  }
  template <class... T> static void pack(const std::vector<int>& list, std::byte* to, T*... arrays) {
    const auto put = [&](const auto* array) {
      for (const int i : list) std::memcpy(to, &array[i], sizeof array[i]), to += sizeof array[i];
    };
    (put(arrays), ...);
  }
  template <class... T>
  static void unpack(const std::vector<int>& list, const std::byte* from, T*... arrays) {
    const auto take = [&](auto* array) {
      for (const int i : list)
        std::memcpy(static_cast<void*>(&array[i]), from, sizeof array[i]), from += sizeof array[i];
    };
    (take(arrays), ...);
  }

  Transport& transport_;
  std::vector<std::vector<std::byte>> out_, in_;
  std::vector<std::byte> all_;
  std::vector<std::size_t> sizes_, counts_;
  std::vector<Transport::Send> sends_;
  std::vector<Transport::Receive> receives_;
};

}  // namespace rubble
