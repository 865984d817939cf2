#pragma once
/// One-way surfaces (Material::oneWay): which bodies pass, decided for two bodies and kept until they part.
#include "stages/contacts/contacts.h"

namespace rubble::RUBBLE_CORE {

/// A body is in front of a one-way surface if the contact normal is within 60 degrees of its direction.
inline constexpr Real kInFront = Real(.5);

/// The direction of the material of a part of a body, world axes. Zero: it is not one-way.
RUBBLE_HD inline Vec3 oneWayOf(const SolverData& s, int body, int part) {
  const Vec3 way = surfaceOf(s, body, part).oneWay;
  return way == Vec3{0, 0, 0} ? way : rotate(s.orientation[body], way);
}
RUBBLE_HD inline bool isInFront(const Vec3& way, const Vec3& n) {
  return way == Vec3{0, 0, 0} || dot(way, n) >= kInFront;
}

/// The directions of the two sides of a pair.
struct OneWays {
  Vec3 ofA, ofB;
  RUBBLE_HD bool any() const { return ofA != Vec3{0, 0, 0} || ofB != Vec3{0, 0, 0}; }
  /// Do they hold at a normal from A to B?
  RUBBLE_HD bool hold(const Vec3& n) const { return isInFront(ofA, n) && isInFront(ofB, -n); }
  /// Has B come to A, or A to B, from behind? `v`: velocity of B relative to A.
  RUBBLE_HD bool comesFromBehind(const Vec3& v) const {
    return dot(ofA, v) > Real(0) || dot(ofB, v) < Real(0);
  }
};
RUBBLE_HD inline OneWays oneWaysOf(const SolverData& s, const OrderedPair& o, const PairParts& parts) {
  return {oneWayOf(s, o.a, parts.ofA), oneWayOf(s, o.b, parts.ofB)};
}
RUBBLE_HD inline OneWays oneWaysOf(const SolverData& s, const Pair& pair, const OrderedPair& o) {
  return oneWaysOf(s, o, partsOf(s, pair, o));
}

RUBBLE_HD inline bool sameBodies(const Pair& p, const Pair& q) {
  return p.owner == q.owner && p.other == q.other;
}

/// The contacts of the one-way surfaces of two bodies in this step and the last.
struct OneWayState {
  bool oneWay = false;                 ///< one of them has a one-way surface there
  bool touches = false;                ///< a point is closer than kTouchGap
  bool inFront = true;                 ///< of all surfaces
  bool behind = false;                 ///< a point is deep, and the bodies have come together from behind
  bool known = false, passed = false;  ///< decided in the last step, and how

  RUBBLE_HD bool passes() const {
    return known && touches ? passed : !inFront || (touches && !known && behind);
  }
};

/// Decides for all manifolds of one-way surfaces of two bodies, at their first manifold.
struct DecideOneWay {
  static constexpr const char* kStage = "one-way";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    const Pair p = s.pair[s.activePair[i]];
    if (i > 0 && sameBodies(s.pair[s.activePair[i - 1]], p)) return;
    const OrderedPair o = ordered(p);
    const Real touch = kTouchGap * pairLength(s.params[o.a], s.params[o.b]);
    const Vec3 relative = s.velocity[o.b] - s.velocity[o.a], t = centerDistance(s, o.a, o.b);
    OneWayState state;
    int end = i;
    for (; end < s.counters->activePairs && sameBodies(s.pair[s.activePair[end]], p); ++end) {
      const OneWays ways = oneWaysOf(s, s.pair[s.activePair[end]], o);
      if (!ways.any()) continue;
      state.oneWay = true;
      const Manifold& m = s.manifold[end];
      for (int k = 0; k < m.count; ++k) {
        const Real depth = pointAt(m, k, m.normal, s.orientation[o.a], s.orientation[o.b], t).depth;
        state.touches = state.touches || depth > -touch;
        state.behind = state.behind || (depth > touch && ways.comesFromBehind(relative));
      }
      state.inFront = state.inFront && (m.count == 0 || ways.hold(m.normal));
    }
    if (!state.oneWay) return;
    for (int k = s.oldPairOffset[p.owner]; k < s.oldPairOffset[p.owner + 1]; ++k) {
      const int old = s.oldPair[k].other == p.other ? manifoldOfOld(s, k) : -1;
      if (old < 0 || s.oldManifold[old].count == 0 || !oneWaysOf(s, s.oldPair[k], o).any()) continue;
      state.known = true;
      state.passed = state.passed || s.oldManifold[old].passes;
    }
    if (!state.passes()) return;
    for (int k = i; k < end; ++k)
      if (oneWaysOf(s, s.pair[s.activePair[k]], o).any()) letPass(s, k);
  }

 private:
  RUBBLE_HD static void letPass(const SolverData& s, int i) {
    Manifold& m = s.manifold[i];
    m.passes = true;
    m.lambdaN = m.lambda1 = m.lambda2 = splatLanes(0);
    forgetPoints(m);
    if (s.hasRows[i] == 0) return;
    s.hasRows[i] = 0;
    atomicCount(&s.counters->contacts, -countPoints(m.activePoints));
    if (m.recycled) atomicCount(&s.counters->recycled, -1);
  }
};

/// Does one of the bodies pass a one-way surface of the other in this step?
RUBBLE_HD inline bool arePassing(const SolverData& s, int a, int b) {
  for (int side = 0; side < 2; ++side) {
    const int owner = side == 0 ? a : b, other = side == 0 ? b : a;
    for (int k = s.pairOffset[owner]; k < s.pairOffset[owner + 1]; ++k)
      if (s.pair[k].other == other)
        if (const Manifold* const m = manifoldOf(s, k); m && m->passes) return true;
  }
  return false;
}

/// Does an impact of two parts without rows at normal n, from A to B, stop their bodies?
RUBBLE_HD inline bool stopsOneWay(const SolverData& s, const OrderedPair& o, const PairParts& parts,
                                  const Vec3d& n) {
  const OneWays ways = oneWaysOf(s, o, parts);
  return !ways.any() || (ways.hold(Vec3(n)) && !arePassing(s, o.a, o.b));
}

}  // namespace rubble::RUBBLE_CORE
