#pragma once
/// Owners of constraints, from those of their bodies.
#include <array>

#include "backend/distributed/rank_division.h"

namespace rubble::RUBBLE_CORE {

/// The bodies of a joint, kWorldBody among them.
template <class F> std::array<int, kSides<F>> endsOf(const SolverData& s, int joint) {
  std::array<int, kSides<F>> out;
  for (int side = 0; side < kSides<F>; ++side)
    out[static_cast<std::size_t>(side)] = bodyOf(s.specsOf<F>()[joint], side);
  return out;
}

/// The owner of the first dynamic body; if there is none, of the first body.
template <class Bodies> int RankDivision::ownerOf(const Bodies& bodies) const {
  const auto has = [&](int body) { return body >= 0 && body < data().bodies; };
  for (const int body : bodies)
    if (has(body) && moves_[static_cast<std::size_t>(body)]) return owner_[static_cast<std::size_t>(body)];
  for (const int body : bodies)
    if (has(body)) return owner_[static_cast<std::size_t>(body)];
  return kEveryRank;
}

/// Does this rank own a dynamic body of it, or, if there is none, the constraint?
template <class Bodies> bool RankDivision::actsHere(const Bodies& bodies) const {
  bool moves = false;
  for (const int body : bodies) {
    if (body < 0 || body >= data().bodies || !moves_[static_cast<std::size_t>(body)]) continue;
    if (isMine(owner_[static_cast<std::size_t>(body)])) return true;
    moves = true;
  }
  return !moves && isMine(ownerOf(bodies));
}

}  // namespace rubble::RUBBLE_CORE
