#include "backend/distributed/rank_lists.h"

namespace rubble {

std::vector<RankTraffic> RankCourier::ask(std::vector<RankLists> needs) {
  const std::size_t kinds = needs.size();
  // first how many elements of each kind, from every rank to every rank
  std::vector<int> own(kinds * count()), asked(kinds * count());
  for (std::size_t kind = 0; kind < kinds; ++kind)
    for (std::size_t r = 0; r < count(); ++r) own[r * kinds + kind] = static_cast<int>(needs[kind][r].size());
  const auto part = [&](std::vector<int>& of, std::size_t r) {
    return std::as_writable_bytes(std::span(of).subspan(r * kinds, kinds));
  };
  sends_.clear(), receives_.clear();
  for (std::size_t r = 0; r < count(); ++r) {
    if (static_cast<int>(r) == rank()) continue;
    sends_.push_back({static_cast<int>(r), part(own, r)});
    receives_.push_back({static_cast<int>(r), part(asked, r)});
  }
  transport_.exchange(sends_, receives_);

  std::vector<RankTraffic> out(kinds);
  sends_.clear(), receives_.clear();
  for (std::size_t r = 0; r < count(); ++r) {
    std::size_t given = 0, taken = 0;
    for (std::size_t kind = 0; kind < kinds; ++kind) {
      given += static_cast<std::size_t>(asked[r * kinds + kind]);
      taken += needs[kind][r].size();
    }
    out_[r].resize(taken * sizeof(int)), in_[r].resize(given * sizeof(int));
    std::byte* to = out_[r].data();
    for (std::size_t kind = 0; kind < kinds; ++kind)
      if (const std::vector<int>& list = needs[kind][r]; !list.empty())
        std::memcpy(to, list.data(), list.size() * sizeof(int)), to += list.size() * sizeof(int);
    if (taken > 0) sends_.push_back({static_cast<int>(r), out_[r]});
    if (given > 0) receives_.push_back({static_cast<int>(r), in_[r]});
  }
  transport_.exchange(sends_, receives_);
  for (std::size_t kind = 0; kind < kinds; ++kind) out[kind].give.resize(count());
  for (std::size_t r = 0; r < count(); ++r) {
    const std::byte* from = in_[r].data();
    for (std::size_t kind = 0; kind < kinds; ++kind) {
      std::vector<int>& list = out[kind].give[r];
      list.resize(static_cast<std::size_t>(asked[r * kinds + kind]));
      if (!list.empty())
        std::memcpy(list.data(), from, list.size() * sizeof(int)), from += list.size() * sizeof(int);
    }
  }
  for (std::size_t kind = 0; kind < kinds; ++kind) out[kind].take = std::move(needs[kind]);
  return out;
}

}  // namespace rubble
