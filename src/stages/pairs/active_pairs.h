#pragma once
/// Activation: the points of a pair that take part in a step, and the active pairs, which have such points.
/// Only active pairs have a manifold. In a dry wall, for example, most pairs are bricks side by side with a
/// gap, which never interact.
#include "stages/pairs/broad_phase.h"

namespace rubble::RUBBLE_CORE {

/// Finds the detection margin of a pair.
RUBBLE_HD inline void setMargin(const SolverData& s, const OrderedPair& o, PairPose& pose) {
  const PairSpeed speed = pairSpeed(s, o.a, o.b, s.params[o.a], s.params[o.b]);
  pose.margin = pairMargin(s, o.a, o.b, pose.length, speed), pose.bullet = speed.bullet;
}
/// The relative pose of a pair, without a margin.
RUBBLE_HD inline PairPose pairPoseWithoutMargin(const SolverData& s, const OrderedPair& o) {
  return {loadUnchanging(s.orientation[o.a]), loadUnchanging(s.orientation[o.b]), centerDistance(s, o.a, o.b),
          pairLength(s.params[o.a], s.params[o.b]), 0};
}
/// The relative pose of a pair as the narrow phase needs it.
RUBBLE_HD inline PairPose pairPose(const SolverData& s, const OrderedPair& o) {
  PairPose pose = pairPoseWithoutMargin(s, o);
  setMargin(s, o, pose);
  return pose;
}

/// Bounds the speed that an imminent impact may give to a body at rest. Its neighbors then use the detection
/// margin of a fast body, so that rows exist for what it may be driven into.
struct FindImpactSpeedBounds {
  static constexpr const char* kStage = "impact speed";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    const Pair p = s.pair[i];
    const BodyParams &po = s.params[p.owner], &pb = s.params[p.other];
    const PairSpeed speed = pairSpeed(s, p.owner, p.other, po, pb);
    if (!isImpact(s.stepOf(p.owner), speed.closing, pairLength(po, pb)) || speed.bullet ||
        isSensor(s, p.owner) || isSensor(s, p.other))
      return;
    const auto agitate = [&](int body, const BodyParams& own, const BodyParams& other) {
      const int bits = floatBits(speed.closing * shareOfImpact(own, other));
      if (own.kind == BodyKind::Dynamic && bits > atomicLoad(&s.impactSpeedBound[body]))
        atomicRaise(&s.impactSpeedBound[body], bits);
    };
    agitate(p.owner, po, pb), agitate(p.other, pb, po);
  }
};

/// May the pose of a body change?
RUBBLE_HD inline bool moves(const SolverData& s, int body) {
  if (s.params[body].kind == BodyKind::Kinematic)
    return s.velocity[body] != Vec3{0, 0, 0} || s.angularVelocity[body] != Vec3{0, 0, 0};
  return s.params[body].kind == BodyKind::Dynamic ? !isAsleep(s, body) : !s.plan.sleeping;
}

/// Points of a manifold at x^t.
template <class L> struct PointsAt {
  Vec3T<L> lever;  ///< from the center of A to the middle of the gap [m]
  L depth;         ///< penetration [m]
};
using PointAt = PointsAt<Real>;
template <class L>
RUBBLE_HD RUBBLE_NEAR PointsAt<L> pointsAt(const Manifold& m, int lane, const Vec3& normal, const Quat& qa,
                                           const Quat& qb, const Vec3& t) {
  using A = LaneAccess<L>;
  const Vec3T<L> onA{A::load(m.aX, lane), A::load(m.aY, lane), A::load(m.aZ, lane)};
  const Vec3T<L> onB{A::load(m.bX, lane), A::load(m.bY, lane), A::load(m.bZ, lane)};
  const Vec3T<L> xa = rotate(splatQuat<L>(qa), onA), xb = splatVector<L>(t) + rotate(splatQuat<L>(qb), onB);
  const L half = A::splat(Real(.5));
  const Vec3T<L> n = splatVector<L>(normal);
  const L depth = dot(n, xa - xb);
  if (m.rollsA == m.rollsB) return {half * (xa + xb), depth};
  // the round side alone says where it touches
  return {m.rollsA ? xa - n * (half * depth) : xb + n * (half * depth), depth};
}
RUBBLE_HD inline PointAt pointAt(const Manifold& m, int k, const Vec3& normal, const Quat& qa, const Quat& qb,
                                 const Vec3& t) {
  return pointsAt<Real>(m, k, normal, qa, qb, t);
}

/// Closing speed of points at x^t; `t` = p_B - p_A [m/s].
template <class L>
RUBBLE_HD RUBBLE_NEAR L closingSpeed(const SolverData& s, const OrderedPair& o, const Vec3& n,
                                     const Vec3T<L>& lever, const Vec3& t) {
  const auto of = [&](const Vec3& a) { return splatVector<L>(a); };
  return dot(of(n), of(s.velocity[o.a]) + cross(of(s.angularVelocity[o.a]), lever) - of(s.velocity[o.b]) -
                        cross(of(s.angularVelocity[o.b]), lever - of(t)));
}

/// Does a point at this depth stop a fast approach in the step? `length`: L of its pair [m].
RUBBLE_HD inline bool hits(const StepConstants& c, Real closing, Real depth, Real length) {
  return depth + closing * c.dt > Real(0) && isImpact(c, closing, length);
}

/// Displacement of a body at its inertial target.
RUBBLE_HD inline Displacement targetDisplacement(const SolverData& s, int body) {
  if (!isDynamic(s, body)) return loadUnchanging(s.dx[body]);
  const Pose& y = loadUnchanging(s.target[body]).y;
  return {y.p, 0, logRotation(y.q), 0};
}

/// A point stays open if its gap at the inertial targets exceeds this share of L [1]. The gap of resting
/// bodies is round-off and must not decide.
inline constexpr Real kInactiveGap = Real(1e-3);

/// Do the bodies of a pair separate at a point, with no other impact on them?
RUBBLE_HD inline bool partsAlone(const SolverData& s, const OrderedPair& o, Real closing,
                                 Real impactSpeedBound) {
  // the impact speed bound includes this pair itself
  return closing < Real(0) &&
         impactSpeedBound <= Real(1.001) * pairSpeed(s, o.a, o.b, s.params[o.a], s.params[o.b]).closing;
}

/// Is a point active? It is if it carries load, or if it does not stay open at the inertial targets of both
/// bodies.
struct ActivationRule {
  Displacement a, b;  ///< displacements at the targets
  RUBBLE_HD bool operator()(const SolverData& s, const OrderedPair& o, const PairPose& pair, const Vec3& n,
                            const PointAt& p, Real lambda) const {
    if (!s.step->inactiveRows || lambda != Real(0)) return true;
    const Real closing = closingSpeed(s, o, n, p.lever, pair.t),
               impactSpeedBound = impactSpeedBoundOf(s, o.a, o.b);
    if (hits(s.stepOf(o.a), closing, p.depth, pair.length)) return true;
    // an impact in this step moves the body away from its inertial target
    if (inheritedViolation(*s.step, p.depth) + s.step->dt * impactSpeedBound > Real(0) &&
        !partsAlone(s, o, closing, impactSpeedBound))
      return true;
    const Vec3 move = a.dp + cross(a.dw, p.lever) - b.dp - cross(b.dw, p.lever - pair.t);
    return inheritedViolation(*s.step, p.depth) + dot(n, move) >= -kInactiveGap * pair.length;
  }
};
RUBBLE_HD inline ActivationRule activationRule(const SolverData& s, const OrderedPair& o) {
  return {targetDisplacement(s, o.a), targetDisplacement(s, o.b)};
}

/// Largest distance at which points of two bodies can be active by any clause of ActivationRule [m].
RUBBLE_HD inline Real activationReach(const SolverData& s, const OrderedPair& o, const PairPose& pair,
                                      Real apart) {
  const BodyParams &pa = s.params[o.a], &pb = s.params[o.b];
  const auto target = [&](int body, Real radius, Vec3& move) {
    if (!isDynamic(s, body)) {
      move = s.dx[body].dp;
      return length(s.dx[body].dw) * radius;
    }
    const Pose& y = loadUnchanging(s.target[body]).y;
    move = y.p;
    // an angle is less than pi times the sine of its half
    return Real(3.1416) * length(y.q.v) * radius;
  };
  Vec3 moveA, moveB;
  // a lever ends at the middle of the gap
  const Real turns = target(o.a, pa.radius + apart, moveA) + target(o.b, pb.radius + apart, moveB);
  const Real fastest = max(pairSpeed(s, o.a, o.b, pa, pb).closing, impactSpeedBoundOf(s, o.a, o.b));
  return max(length(moveA - moveB) + turns + kInactiveGap * pair.length, s.step->dt * fastest);
}

/// Index of the same pair in the previous step, or -1.
RUBBLE_HD inline int findOldPair(const SolverData& s, int pair) {
  const Pair p = s.pair[pair];
  const int begin = s.oldPairOffset[p.owner], end = s.oldPairOffset[p.owner + 1];
  // mostly where it was: pairs of a body change rarely
  const int last = begin + pair - s.pairOffset[p.owner];
  if (last < end && samePair(s.oldPair[last], p)) return last;
  for (int k = begin; k < end; ++k)
    if (samePair(s.oldPair[k], p)) return k;
  return -1;
}
/// The manifold of a pair of the previous step, or -1.
RUBBLE_HD inline int manifoldOfOld(const SolverData& s, int oldPair) {
  return s.oldActivePairOffset[oldPair + 1] > s.oldActivePairOffset[oldPair] ? s.oldActivePairOffset[oldPair]
                                                                             : -1;
}
/// Resets a pair one of whose bodies was edited, and wakes both bodies.
RUBBLE_HD inline void forgetOldPair(const SolverData& s, int oldPair) {
  Pair& p = s.oldPair[oldPair];
  s.asleep[p.owner] = 0;
  if (p.other >= 0) s.asleep[p.other] = 0;
  p.other = -1;
  if (const int m = manifoldOfOld(s, oldPair); m >= 0) s.oldManifold[m].count = 0;
}
/// The manifold of a pair in this step, or null.
RUBBLE_HD inline const Manifold* manifoldOf(const SolverData& s, int pair) {
  return s.isActive[pair] ? &s.manifold[s.activePairOffset[pair]] : nullptr;
}

/// Can the pair be skipped by its last test? Planes have no radius, and sensors need the actual distance.
RUBBLE_HD inline bool mayStaySeparated(const SolverData& s, const Pair& p) {
  return s.step->inactiveRows && s.step->recycleTolerance > Real(0) &&
         s.params[p.other].shape.kind != ShapeKind::Plane && !isSensor(s, p.owner) && !isSensor(s, p.other);
}
/// Does the last full test show that the pair stays apart?
RUBBLE_HD inline bool staysSeparated(const SolverData& s, const OrderedPair& o, const PairPose& pose,
                                     const PairTest& test) {
  if (!(test.separation > Real(0))) return false;
  const Real apart = leastDistance(test, pose, s.params[o.b].radius);
  return apart > Real(0) && apart > activationReach(s, o, pose, apart);
}

/// Finds the pairs that may have active points. For all others, the relative motion since their last test is
/// smaller than the separation that it found. They have no manifold, and only that test is stored.
struct FindActivePairs {
  static constexpr const char* kStage = "narrow";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    const Pair p = s.pair[i];
    const int old = findOldPair(s, i), manifold = old < 0 ? -1 : manifoldOfOld(s, old);
    const PairTest test = old < 0 ? PairTest{} : s.oldPairTest[old];
    s.pairTest[i] = test;
    s.manifoldBefore[i] = manifold;
    s.isActive[i] = 1;
    // most pairs of a pile have rows, and nothing else needs to be known of them
    if ((manifold >= 0 && s.oldManifold[manifold].row >= 0) || !mayStaySeparated(s, p)) return;
    const OrderedPair o = ordered(p);
    if (old >= 0)
      s.isActive[i] = !staysSeparated(s, o, pairPose(s, o), test);
    else if (isPrimitivePair(s, o.a, o.b))
      s.newPair[atomicCount(&s.counters->newPairs, 1)] = i;
  }
};

/// Tests new pairs of primitive shapes at once, because most new pairs do not touch.
struct TestNewPairs {
  static constexpr const char* kStage = "narrow";
  RUBBLE_HD void operator()(const SolverData& s, int t) const {
    const int i = s.newPair[t];
    const OrderedPair o = ordered(s.pair[i]);
    const PairPose pose = pairPose(s, o);
    const PairTest test = pairTest(collide(s.params[o.a].shape, s.params[o.b].shape, pose), pose);
    s.pairTest[i] = test;
    s.isActive[i] = !staysSeparated(s, o, pose, test);
  }
};

/// Lists the active pairs.
struct ListActivePairs {
  static constexpr const char* kStage = "narrow";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (s.isActive[i]) s.activePair[s.activePairOffset[i]] = i;
  }
};

}  // namespace rubble::RUBBLE_CORE
