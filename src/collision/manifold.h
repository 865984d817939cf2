#pragma once
/// What lasts of a pair: what its last full test found, and the manifold with everything that its points hand
/// on to the next step.
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "collision/collide.h"
#include "forces/contact.h"

namespace rubble::RUBBLE_CORE {

/// Normals of the same contact in two steps differ by less than this (cos 30 deg).
inline constexpr Real kSameNormal = Real(.866);
/// An old point within this share of L of a new one, on either body, is the same point though its feature
/// changed.
inline constexpr Real kSamePoint = Real(.03);

/// The last full test of a pair, which is the origin of its manifold, or the proof that it needs none as long
/// as its bodies come no nearer.
struct alignas(8 * sizeof(Real)) PairTest {
  Vec3 offset;          ///< R_A^T (p_B - p_A) [m]
  Quat rotation;        ///< q_A^-1 q_B
  Real separation = 0;  ///< lower bound of the distance [m]; not above 0: none is known
};

/// Integers that fill a manifold to the last bit in either precision: states are compared byte by byte, so
/// none may be left to chance.
using ManifoldInt = std::conditional_t<sizeof(Real) == 4, std::int32_t, std::int64_t>;
using ManifoldBits = std::conditional_t<sizeof(Real) == 4, std::uint8_t, std::uint16_t>;

/// Geometry found at the last full test, and what the points hand on. In single precision 256 bytes: each
/// begins with a sector of a cache.
struct Manifold {
  Lanes aX, aY, aZ;                 ///< point on the surface of A, in its frame [m]
  Lanes bX, bY, bZ;                 ///< on B
  Lanes lambdaN, lambda1, lambda2;  ///< multipliers to go on with, tangent basis of `normal` [N]
  Lanes kN, kT;                     ///< [N/m], 0: new
  Lanes drift1, drift2;             ///< tangential drift since the point stuck, same basis [m]
  ManifoldInt feature[kLanes];
  Vec3 localNormal;     ///< from A to B in the frame of A, or of B if normalOnB
  Vec3 normal;          ///< world, in the last step
  ManifoldInt row;      ///< index of its rows in this step, -1 if it has none
  ManifoldBits stick;   ///< bit k: point k stuck
  ManifoldBits impact;  ///< bit k: point k stops a fast approach in this step
  ManifoldBits awake;   ///< bit k: point k takes part in this step
  ManifoldBits normalOnB : 1;
  ManifoldBits recycled : 1;                          ///< not tested anew in this step
  ManifoldBits count : 8 * sizeof(ManifoldBits) - 2;  ///< points, 0: not touching
};
static_assert(sizeof(Manifold) == 64 * sizeof(Real));

RUBBLE_HD inline Vec3 pointOnA(const Manifold& m, int k) { return {m.aX[k], m.aY[k], m.aZ[k]}; }
RUBBLE_HD inline Vec3 pointOnB(const Manifold& m, int k) { return {m.bX[k], m.bY[k], m.bZ[k]}; }

/// A pair at x^t, as the tests need it.
struct PairPose {
  Quat qA, qB;
  Vec3 t;               ///< p_B - p_A [m]
  Real length;          ///< L: bounding diameter of the smaller body [m]
  Real margin;          ///< detection margin [m]
  bool bullet = false;  ///< they may pass one another altogether in this step
};

/// Bodies touch that are this near, over L [1].
inline constexpr Real kTouchGap = Real(2e-3);

/// Has a pair rows? Bodies that fly by one another at high speed have none before they touch, for nobody can
/// tell at x^t where they will; from then on all points that can meet have.
RUBBLE_HD inline bool meetsNow(const RawManifold& raw, const PairPose& pair) {
  if (!pair.bullet) return true;
  bool touches = false;
  for (int k = 0; k < raw.count; ++k)
    touches |= dot(raw.n, raw.points[k].onB - raw.points[k].onA) <= kTouchGap * pair.length;
  return touches;
}

RUBBLE_HD inline PairTest pairTest(const RawManifold& raw, const PairPose& pair) {
  return {rotateInverse(pair.qA, pair.t), conjugate(pair.qA) * pair.qB, raw.separation};
}

/// How B has moved since the test, seen from A.
struct PairMotion {
  Vec3 move;  ///< of its centre [m]
  Vec3 turn;  ///< axis times the sine of half the angle: a point at distance r has gone 2 r |turn| around the
              ///< centre
};
RUBBLE_HD inline PairMotion motionSince(const PairTest& test, const PairPose& pair) {
  return {rotateInverse(pair.qA, pair.t) - test.offset,
          (conjugate(pair.qA) * pair.qB * conjugate(test.rotation)).v};
}

/// Has the pair moved so little since its last full test that a manifold of so many points still holds?
RUBBLE_HD inline bool recyclable(const PairTest& test, int count, const PairPose& pair, Real tolerance) {
  if (!(tolerance > Real(0))) return false;
  const PairMotion m = motionSince(test, pair);
  if (dot(m.move, m.move) > tolerance * tolerance * pair.length * pair.length) return false;
  if (Real(4) * dot(m.turn, m.turn) > tolerance * tolerance) return false;
  // a pair apart must stay apart by more than what it may have moved
  return count > 0 || test.separation - Real(2) * tolerance * pair.length > pair.margin;
}

/// Lower bound of the distance of a pair by its last full test; `radius` is that of the bounding sphere of B.
/// [m]
RUBBLE_HD inline Real leastDistance(const PairTest& test, const PairPose& pair, Real radius) {
  const PairMotion m = motionSince(test, pair);
  return test.separation - length(m.move) - Real(2) * radius * length(m.turn);
}

/// Manifold of a new test, with nothing handed on yet.
RUBBLE_HD inline Manifold freshManifold(const RawManifold& raw, const PairPose& pair) {
  Manifold m;
  const Lanes zero = splatLanes(0);
  m.aX = m.aY = m.aZ = m.bX = m.bY = m.bZ = zero;
  m.lambdaN = m.lambda1 = m.lambda2 = m.kN = m.kT = m.drift1 = m.drift2 = zero;
  for (int k = 0; k < kLanes; ++k) {
    m.feature[k] = -1;
    if (k >= raw.count) continue;
    const Vec3 a = rotateInverse(pair.qA, raw.points[k].onA),
               b = rotateInverse(pair.qB, raw.points[k].onB - pair.t);
    m.aX[k] = a.x, m.aY[k] = a.y, m.aZ[k] = a.z;
    m.bX[k] = b.x, m.bY[k] = b.y, m.bZ[k] = b.z;
    m.feature[k] = raw.points[k].feature;
  }
  m.normal = raw.n;
  m.localNormal = rotateInverse(raw.normalOnB ? pair.qB : pair.qA, raw.n);
  m.count = static_cast<std::uint8_t>(raw.count) & 63;
  m.row = -1;
  m.stick = m.impact = m.awake = 0;
  m.normalOnB = raw.normalOnB;
  m.recycled = false;
  return m;
}

/// What a point hands on from step to step besides its place: tangential vectors keep their world direction
/// as far as it lies in the new tangent plane.
struct PointMemory {
  Real lambdaN, lambda1, lambda2, kN, kT, drift1, drift2;
};
RUBBLE_HD inline PointMemory memoryOf(const Manifold& old, int k, const Vec3& normal) {
  Vec3 o1, o2, t1, t2;
  tangentBasis(old.normal, o1, o2);
  tangentBasis(normal, t1, t2);
  const Vec3 lambda = o1 * old.lambda1[k] + o2 * old.lambda2[k];
  const Vec3 drift = o1 * old.drift1[k] + o2 * old.drift2[k];
  return {old.lambdaN[k], dot(t1, lambda), dot(t2, lambda), old.kN[k],
          old.kT[k],      dot(t1, drift),  dot(t2, drift)};
}
RUBBLE_HD inline void remember(Manifold& m, int k, const PointMemory& p) {
  m.lambdaN[k] = p.lambdaN, m.lambda1[k] = p.lambda1, m.lambda2[k] = p.lambda2;
  m.kN[k] = p.kN, m.kT[k] = p.kT;
  m.drift1[k] = p.drift1, m.drift2[k] = p.drift2;
}

/// Point `from` of `old` hands on to point `to`.
RUBBLE_HD inline void handOn(const Manifold& old, int from, Manifold& m, int to) {
  remember(m, to, memoryOf(old, from, m.normal));
  if (old.stick >> from & 1) m.stick |= static_cast<std::uint8_t>(1u << to);
}

/// Points that take no part in a step are new to the next one.
RUBBLE_HD inline void forgetPoints(Manifold& m) {
  m.kN = m.kT = m.drift1 = m.drift2 = splatLanes(0);
  m.stick = 0;
}

/// The normal of a manifold that turns with its pair.
RUBBLE_HD inline Vec3 turnedNormal(const Manifold& old, const PairPose& pair) {
  return rotate(old.normalOnB ? pair.qB : pair.qA, old.localNormal);
}

/// The old manifold of a pair that hardly moved.
RUBBLE_HD inline Manifold recycledManifold(const Manifold& old, const PairPose& pair) {
  Manifold m = old;
  m.normal = turnedNormal(old, pair);
  m.stick = 0;
  for (int k = 0; k < m.count; ++k) handOn(old, k, m, k);
  m.row = -1;
  m.impact = 0;
  m.recycled = true;
  return m;
}

/// The manifold of a new test, whose points are matched with the old ones, first by feature, then by place.
/// `old` may be null.
RUBBLE_HD inline Manifold testedManifold(const RawManifold& raw, const PairPose& pair, const Manifold* old) {
  Manifold m = freshManifold(raw, pair);
  if (!old || old->count == 0 || m.count == 0 || dot(m.normal, old->normal) < kSameNormal) return m;

  unsigned usedOld = 0, matched = 0;
  for (int k = 0; k < m.count; ++k) {
    for (int j = 0; j < old->count; ++j) {
      if ((usedOld >> j & 1) || old->feature[j] != m.feature[k]) continue;
      handOn(*old, j, m, k);
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
    handOn(*old, nearest, m, k);
    usedOld |= 1u << nearest;
  }
  return m;
}

/// The test of two plain shapes.
RUBBLE_HD inline RawManifold collide(const ShapeData& sa, const ShapeData& sb, const PairPose& pair) {
  RawManifold raw = collide(sa, pair.qA, sb, pair.qB, pair.t, pair.margin, pair.length);
  if (!meetsNow(raw, pair)) raw.count = 0;
  return raw;
}

}  // namespace rubble::RUBBLE_CORE
