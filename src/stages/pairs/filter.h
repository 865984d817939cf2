#pragma once
/// Collision filters: layers and masks, groups, and excluded pairs.
#include "state/solver_data.h"

namespace rubble::RUBBLE_CORE {

RUBBLE_HD inline bool filtersAllow(const BodyFilter& a, const BodyFilter& b) {
  if (a.group != 0 && a.group == b.group) return a.group > 0;
  return (a.layers & b.mask) != 0 && (b.layers & a.mask) != 0;
}

RUBBLE_HD inline bool isSensor(const SolverData& s, int body) {
  return s.filtered && s.filter[body].sensor != 0;
}

/// Where the search for a pair begins in a hash table of `size` elements, a power of two.
RUBBLE_HD inline int firstPlace(const ExcludedPair& pair, int size) {
  const auto mixed = (static_cast<std::uint32_t>(pair.low) * 0x9e3779b1u ^
                      static_cast<std::uint32_t>(pair.high) ^
                      static_cast<std::uint32_t>(pair.world) * 0xc2b2ae35u) *
                     0x85ebca6bu;
  return static_cast<int>((mixed ^ mixed >> 15) & static_cast<std::uint32_t>(size - 1));
}
RUBBLE_HD inline bool isExcluded(const SolverData& s, const ExcludedPair& pair) {
  if (s.exclusions == 0) return false;
  int k = firstPlace(pair, s.exclusions);
  while (s.exclusion[k].low >= 0 && s.exclusion[k] != pair) k = (k + 1) & (s.exclusions - 1);
  return s.exclusion[k].low >= 0;
}

/// May a body collide with every body that it touches? Its partners then need no test.
RUBBLE_HD inline bool collidesWithAll(const SolverData& s, int body) {
  return s.params[body].kind == BodyKind::Dynamic && !s.filtered && s.exclusions == 0;
}

/// Pairs with a dynamic body, or with a kinematic body and a sensor.
RUBBLE_HD inline bool mayCollide(const SolverData& s, int a, int b) {
  if (collidesWithAll(s, a)) return true;
  const BodyKind ka = s.params[a].kind, kb = s.params[b].kind;
  if (ka != BodyKind::Dynamic && kb != BodyKind::Dynamic) {
    const bool moves = ka == BodyKind::Kinematic || kb == BodyKind::Kinematic;
    if (!moves || (!isSensor(s, a) && !isSensor(s, b))) return false;
  }
  if (s.filtered && !filtersAllow(s.filter[a], s.filter[b])) return false;
  if (s.exclusions == 0) return true;
  const int idA = s.idOf[a], idB = s.idOf[b];
  return !isExcluded(s, {min(idA, idB), max(idA, idB), s.worldOf(a)});
}

}  // namespace rubble::RUBBLE_CORE
