#pragma once
/// Persistent state of a pair: its last full narrow-phase test, and the manifold with the state of its
/// points.
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "collision/collide.h"
#include "forces/contact.h"

namespace rubble::RUBBLE_CORE {

/// Normals of one contact in consecutive steps differ by less than this (cosine of 30 degrees).
inline constexpr Real kSameNormal = Real(.866);
/// An old point within this share of L of a new one, on either body, is matched with it even if its feature
/// differs.
inline constexpr Real kSamePoint = Real(.03);

/// Relative pose at the last full test of a pair. Its manifold was computed there; without one, `separation`
/// proves that none is needed until the bodies come closer.
struct alignas(8 * sizeof(Real)) PairTest {
  Vec3 offset;          ///< R_A^T (p_B - p_A) [m]
  Quat rotation;        ///< q_A^-1 q_B
  Real separation = 0;  ///< lower bound of the distance [m]; if not positive, none is known
};

/// Integer types that leave no padding in a manifold in either precision. States are compared byte by byte.
using ManifoldInt = std::conditional_t<sizeof(Real) == 4, std::int32_t, std::int64_t>;
using ManifoldBits = std::conditional_t<sizeof(Real) == 4, std::uint8_t, std::uint16_t>;

/// Geometry of the last full test, and the state of its points. 256 bytes in single precision, so that each
/// manifold starts at a cache sector.
struct Manifold {
  Lanes aX, aY, aZ;                 ///< contact point on the surface of A, in the frame of A [m]
  Lanes bX, bY, bZ;                 ///< the same for B
  Lanes lambdaN, lambda1, lambda2;  ///< warm-start multipliers, tangent basis of `normal` [N]
  Lanes kN, kT;                     ///< stiffness [N/m]; 0: new
  Lanes drift1, drift2;             ///< tangential drift since the point stuck, same basis [m]
  ManifoldInt feature[kLanes];
  Vec3 localNormal;           ///< unit normal from A to B in the frame of A, or of B if normalOnB
  Vec3 normal;                ///< in world axes, at the last step
  ManifoldInt row;            ///< index of its contact rows in this step; -1: none
  ManifoldBits stick;         ///< bit k: point k sticks
  ManifoldBits impact;        ///< bit k: point k has an impact in this step
  ManifoldBits activePoints;  ///< bit k: point k is active in this step
  ManifoldBits normalOnB : 1;
  ManifoldBits recycled : 1;                          ///< reused without a full test in this step
  ManifoldBits count : 8 * sizeof(ManifoldBits) - 5;  ///< points; 0: no contact
  ManifoldBits passes : 1;                            ///< a one-way surface lets the other body pass: no rows
  ManifoldBits rollsA : 1;                            ///< all points are on a round side of A
  ManifoldBits rollsB : 1;                            ///< the same for B
};
static_assert(sizeof(Manifold) == 64 * sizeof(Real));

/// Are its points on a round side?
RUBBLE_HD inline bool rolls(const Manifold& m) { return m.rollsA || m.rollsB; }

RUBBLE_HD inline Vec3 pointOnA(const Manifold& m, int k) { return {m.aX[k], m.aY[k], m.aZ[k]}; }
RUBBLE_HD inline Vec3 pointOnB(const Manifold& m, int k) { return {m.bX[k], m.bY[k], m.bZ[k]}; }
RUBBLE_HD inline void setPointOnA(Manifold& m, int k, const Vec3& x) {
  m.aX[k] = x.x, m.aY[k] = x.y, m.aZ[k] = x.z;
}
RUBBLE_HD inline void setPointOnB(Manifold& m, int k, const Vec3& x) {
  m.bX[k] = x.x, m.bY[k] = x.y, m.bZ[k] = x.z;
}

/// Input of the narrow phase: a pair at x^t.
struct PairPose {
  Quat qA, qB;
  Vec3 t;               ///< p_B - p_A [m]
  Real length;          ///< L: bounding diameter of the smaller body [m]
  Real margin;          ///< detection margin [m]
  bool bullet = false;  ///< the bodies may pass through one another in this step
};

/// Bodies this close are in contact, over L [1].
inline constexpr Real kTouchGap = Real(2e-3);

/// Does a pair get rows? Fast bodies get none before they touch, because the contact points cannot be
/// predicted at x^t; CCD covers them until then. Afterwards all points within the margin get rows.
RUBBLE_HD inline bool touchesNow(const RawManifold& raw, const PairPose& pair) {
  if (!pair.bullet) return true;
  bool touches = false;
  for (int k = 0; k < raw.count; ++k)
    touches |= dot(raw.n, raw.points[k].onB - raw.points[k].onA) <= kTouchGap * pair.length;
  return touches;
}

RUBBLE_HD inline PairTest pairTest(const RawManifold& raw, const PairPose& pair) {
  return {rotateInverse(pair.qA, pair.t), conjugate(pair.qA) * pair.qB, raw.separation};
}

/// Motion of B relative to A since the last full test.
struct PairMotion {
  Vec3 move;  ///< of the center of B [m]
  Vec3 turn;  ///< axis times sin(angle / 2); a point at radius r moved by at most 2 r |turn|
};
RUBBLE_HD inline PairMotion motionSince(const PairTest& test, const PairPose& pair) {
  return {rotateInverse(pair.qA, pair.t) - test.offset,
          (conjugate(pair.qA) * pair.qB * conjugate(test.rotation)).v};
}

/// Has the pair moved so little since its last full test that its manifold of `count` points can be reused?
RUBBLE_HD inline bool recyclable(const PairTest& test, int count, const PairPose& pair, Real tolerance) {
  if (!(tolerance > Real(0))) return false;
  const PairMotion m = motionSince(test, pair);
  if (dot(m.move, m.move) > tolerance * tolerance * pair.length * pair.length) return false;
  if (Real(4) * dot(m.turn, m.turn) > tolerance * tolerance) return false;
  // separated bodies must stay separated by more than their possible motion
  return count > 0 || test.separation - Real(2) * tolerance * pair.length > pair.margin;
}

/// Lower bound of the distance of a pair from its last full test [m]. `radius`: bounding sphere of B.
RUBBLE_HD inline Real leastDistance(const PairTest& test, const PairPose& pair, Real radius) {
  const PairMotion m = motionSince(test, pair);
  return test.separation - length(m.move) - Real(2) * radius * length(m.turn);
}

/// Manifold of a full test, without state from the last step.
RUBBLE_HD inline Manifold newManifold(const RawManifold& raw, const PairPose& pair) {
  Manifold m;
  const Lanes zero = splatLanes(0);
  m.aX = m.aY = m.aZ = m.bX = m.bY = m.bZ = zero;
  m.lambdaN = m.lambda1 = m.lambda2 = m.kN = m.kT = m.drift1 = m.drift2 = zero;
  for (int k = 0; k < kLanes; ++k) {
    m.feature[k] = -1;
    if (k >= raw.count) continue;
    setPointOnA(m, k, rotateInverse(pair.qA, raw.points[k].onA));
    setPointOnB(m, k, rotateInverse(pair.qB, raw.points[k].onB - pair.t));
    m.feature[k] = raw.points[k].feature;
  }
  m.normal = raw.n;
  m.localNormal = rotateInverse(raw.normalOnB ? pair.qB : pair.qA, raw.n);
  m.count = static_cast<std::uint8_t>(raw.count) & 7;
  m.row = -1;
  m.stick = m.impact = m.activePoints = 0;
  m.normalOnB = raw.normalOnB;
  m.recycled = m.passes = m.rollsA = m.rollsB = false;
  return m;
}

/// State of a point that is carried to the next step. Tangential vectors keep the part of their world
/// direction that lies in the new tangent plane.
template <class L> struct PointMemoryT { L lambdaN, lambda1, lambda2, kN, kT, drift1, drift2; };
using PointMemory = PointMemoryT<Real>;
template <class L>
RUBBLE_HD RUBBLE_NEAR PointMemoryT<L> memoriesOf(const Manifold& old, int lane, const Vec3& normal) {
  Vec3 o1, o2, t1, t2;
  tangentBasis(old.normal, o1, o2);
  tangentBasis(normal, t1, t2);
  const auto of = [&](const Lanes& field) { return LaneAccess<L>::load(field, lane); };
  const auto inWorld = [&](L a, L b) {
    return Vec3T<L>{o1.x * a + o2.x * b, o1.y * a + o2.y * b, o1.z * a + o2.z * b};
  };
  const Vec3T<L> lambda = inWorld(of(old.lambda1), of(old.lambda2)),
                 drift = inWorld(of(old.drift1), of(old.drift2));
  return {of(old.lambdaN), along<L>(t1, lambda), along<L>(t2, lambda), of(old.kN),
          of(old.kT),      along<L>(t1, drift),  along<L>(t2, drift)};
}
RUBBLE_HD inline PointMemory memoryOf(const Manifold& old, int k, const Vec3& normal) {
  return memoriesOf<Real>(old, k, normal);
}
template <class L> RUBBLE_HD RUBBLE_NEAR void remember(Manifold& m, int lane, const PointMemoryT<L>& p) {
  const auto store = [&](Lanes& field, const L& a) { LaneAccess<L>::store(field, lane, a); };
  store(m.lambdaN, p.lambdaN), store(m.lambda1, p.lambda1), store(m.lambda2, p.lambda2);
  store(m.kN, p.kN), store(m.kT, p.kT);
  store(m.drift1, p.drift1), store(m.drift2, p.drift2);
}

/// Copies the state of point `from` of `old` to point `to`.
RUBBLE_HD inline void transferLoad(const Manifold& old, int from, Manifold& m, int to) {
  remember(m, to, memoryOf(old, from, m.normal));
  if (old.stick >> from & 1) m.stick |= static_cast<std::uint8_t>(1u << to);
}

/// Resets the state of points that are inactive in this step.
RUBBLE_HD inline void forgetPoints(Manifold& m) {
  m.kN = m.kT = m.drift1 = m.drift2 = splatLanes(0);
  m.stick = 0;
}

/// The normal of an old manifold, rotated with the body in which it is fixed.
RUBBLE_HD inline Vec3 turnedNormal(const Manifold& old, const PairPose& pair) {
  return rotate(old.normalOnB ? pair.qB : pair.qA, old.localNormal);
}

/// The old manifold, reused for a pair that hardly moved.
template <class L> RUBBLE_HD Manifold recycledManifold(const Manifold& old, const PairPose& pair) {
  Manifold m = old;
  m.normal = turnedNormal(old, pair);
  const unsigned used = (1u << m.count) - 1;
  for (int lane = 0; lane < m.count; lane += static_cast<int>(sizeof(L) / sizeof(Real))) {
    PointMemoryT<L> memory = memoriesOf<L>(old, lane, m.normal);
    // zeros of unused points keep their sign
    const auto isUsed = LaneAccess<L>::flags(used, lane) != LaneAccess<L>::splat(0);
    const auto keep = [&](L& a, const Lanes& before) {
      a = select(isUsed, a, LaneAccess<L>::load(before, lane));
    };
    keep(memory.lambda1, old.lambda1), keep(memory.lambda2, old.lambda2);
    keep(memory.drift1, old.drift1), keep(memory.drift2, old.drift2);
    remember(m, lane, memory);
  }
  m.stick = static_cast<ManifoldBits>(old.stick & used);
  m.row = -1;
  m.impact = 0;
  m.recycled = true, m.passes = false;
  return m;
}

/// The manifold of a full test. Its points are matched with the old ones, first by feature, then by position.
/// `old` may be null.
RUBBLE_HD inline Manifold testedManifold(const RawManifold& raw, const PairPose& pair, const Manifold* old) {
  Manifold m = newManifold(raw, pair);
  if (!old || old->count == 0 || m.count == 0 || dot(m.normal, old->normal) < kSameNormal) return m;

  unsigned usedOld = 0, matched = 0;
  for (int k = 0; k < m.count; ++k) {
    for (int j = 0; j < old->count; ++j) {
      if ((usedOld >> j & 1) || old->feature[j] != m.feature[k]) continue;
      transferLoad(*old, j, m, k);
      usedOld |= 1u << j, matched |= 1u << k;
      break;
    }
  }
  const Real reach2 = kSamePoint * kSamePoint * pair.length * pair.length;
  for (int k = 0; k < m.count; ++k) {
    if (matched >> k & 1) continue;
    int nearest = -1;
    Real nearest2 = reach2;
    for (int j = 0; j < old->count; ++j) {
      if (usedOld >> j & 1) continue;
      const Real d2 = min(lengthSquared(pointOnA(m, k) - pointOnA(*old, j)),
                          lengthSquared(pointOnB(m, k) - pointOnB(*old, j)));
      if (d2 < nearest2) nearest = j, nearest2 = d2;
    }
    if (nearest < 0) continue;
    transferLoad(*old, nearest, m, k);
    usedOld |= 1u << nearest;
  }
  return m;
}

/// Full test of two primitive shapes.
RUBBLE_HD inline RawManifold collide(const ShapeData& sa, const ShapeData& sb, const PairPose& pair) {
  RawManifold raw = collide(sa, pair.qA, sb, pair.qB, pair.t, pair.margin, pair.length);
  if (!touchesNow(raw, pair)) raw.count = 0;
  return raw;
}

}  // namespace rubble::RUBBLE_CORE
