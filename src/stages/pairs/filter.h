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

RUBBLE_HD inline bool excluded(const SolverData& s, int a, int b) {
  if (s.exclusions == 0) return false;
  const int idA = s.idOf[a], idB = s.idOf[b], low = min(idA, idB), high = max(idA, idB);
  for (int k = s.exclusionOffset[low]; k < s.exclusionOffset[low + 1]; ++k)
    if (s.exclusionBody[k] == high) return true;
  return false;
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
  return !excluded(s, a, b);
}

}  // namespace rubble::RUBBLE_CORE
