#pragma once
/// Which points of a pair take part in a step, and which pairs have any that may: only these have a manifold.
/// Bodies that stand side by side with a gap are most pairs of a dry wall whose bricks are turned, and have
/// nothing to do with one another.
#include "stages/pairs/broad_phase.h"

namespace rubble::RUBBLE_CORE {

/// A pair of bodies as the pair tests need it.
RUBBLE_HD inline PairPose pairPose(const SolverData& s, const OrderedPair& o) {
  const BodyParams &pa = s.params[o.a], &pb = s.params[o.b];
  const Real size = pairLength(pa, pb);
  const PairSpeed speed = pairSpeed(s, o.a, o.b, pa, pb);
  return {s.orientation[o.a],
          s.orientation[o.b],
          centreDistance(s, o.a, o.b),
          size,
          pairMargin(s, o.a, o.b, size, speed),
          speed.bullet};
}

/// A body at rest that is about to be struck has rows with what it may be driven into: its neighbours look
/// for it as for a fast one.
struct FindImpactSpeedBounds {
  static constexpr const char* kStage = "impactSpeedBound";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    const Pair p = s.pair[i];
    const BodyParams &po = s.params[p.owner], &pb = s.params[p.other];
    const PairSpeed speed = pairSpeed(s, p.owner, p.other, po, pb);
    if (!isImpact(s.step, speed.closing, pairLength(po, pb)) || speed.bullet || isSensor(s, p.owner) ||
        isSensor(s, p.other))
      return;
    const auto agitate = [&](int body, const BodyParams& own, const BodyParams& other) {
      const int bits = floatBits(speed.closing * shareOfImpact(own, other));
      if (own.kind == BodyKind::Dynamic && bits > s.impactSpeedBound[body])
        atomicRaise(&s.impactSpeedBound[body], bits);
    };
    agitate(p.owner, po, pb), agitate(p.other, pb, po);
  }
};

/// May a body be elsewhere than in the last step?
RUBBLE_HD inline bool moves(const SolverData& s, int body) {
  if (s.params[body].kind == BodyKind::Kinematic)
    return s.velocity[body] != Vec3{0, 0, 0} || s.angularVelocity[body] != Vec3{0, 0, 0};
  return s.params[body].kind == BodyKind::Dynamic ? !isAsleep(s, body) : !s.step.sleeping;
}

/// Point k of a manifold at x^t.
struct PointAt {
  Vec3 lever;  ///< from the centre of A to the middle of the gap [m]
  Real depth;  ///< penetration [m]
};
RUBBLE_HD inline PointAt pointAt(const Manifold& m, int k, const Vec3& normal, const Quat& qa, const Quat& qb,
                                 const Vec3& t) {
  const Vec3 xa = rotate(qa, pointOnA(m, k)), xb = t + rotate(qb, pointOnB(m, k));
  return {(xa + xb) * Real(.5), dot(normal, xa - xb)};
}

/// Speed at which a point closes at x^t; `t` = p_B - p_A. [m/s]
RUBBLE_HD inline Real closingSpeed(const SolverData& s, const OrderedPair& o, const Vec3& n,
                                   const Vec3& lever, const Vec3& t) {
  return dot(n, s.velocity[o.a] + cross(s.angularVelocity[o.a], lever) - s.velocity[o.b] -
                    cross(s.angularVelocity[o.b], lever - t));
}

/// Does a point at this depth stop a fast approach in the step? `length` of its pair [m].
RUBBLE_HD inline bool hits(const StepConstants& c, Real closing, Real depth, Real length) {
  return depth + closing * c.dt > Real(0) && isImpact(c, closing, length);
}

/// Displacement of a body at its inertial target.
RUBBLE_HD inline Displacement targetDisplacement(const SolverData& s, int body) {
  if (!isDynamic(s, body)) return s.dx[body];
  const Pose& y = s.target[body].y;
  return {y.p, 0, logRotation(y.q), 0};
}

/// A point counts as staying open if its gap at the inertial targets is more than this share of L: the gap of
/// bodies that merely rest is round-off, and of no consequence.
inline constexpr Real kInactiveGap = Real(1e-3);

/// Do the bodies of a pair part at a point, struck by no other?
RUBBLE_HD inline bool partsAlone(const SolverData& s, const OrderedPair& o, Real closing,
                                 Real impactSpeedBound) {
  // the pair is one of those that agitate its bodies
  return closing < Real(0) &&
         impactSpeedBound <= Real(1.001) * pairSpeed(s, o.a, o.b, s.params[o.a], s.params[o.b]).closing;
}

/// Does a point take part in the step? It does if it bears a load, or if it does not stay open at the
/// inertial targets of both bodies.
struct ActivationRule {
  Displacement a, b;  ///< at the targets
  RUBBLE_HD bool operator()(const SolverData& s, const OrderedPair& o, const PairPose& pair, const Vec3& n,
                            const PointAt& p, Real lambda) const {
    if (!s.step.dormantRows || lambda != Real(0)) return true;
    const Real closing = closingSpeed(s, o, n, p.lever, pair.t),
               impactSpeedBound = impactSpeedBoundOf(s, o.a, o.b);
    if (hits(s.step, closing, p.depth, pair.length)) return true;
    // a body that is struck in this step goes elsewhere than its target says
    if (inheritedViolation(s.step, p.depth) + s.step.dt * impactSpeedBound > Real(0) &&
        !partsAlone(s, o, closing, impactSpeedBound))
      return true;
    const Vec3 move = a.dp + cross(a.dw, p.lever) - b.dp - cross(b.dw, p.lever - pair.t);
    return inheritedViolation(s.step, p.depth) + dot(n, move) >= -kInactiveGap * pair.length;
  }
};
RUBBLE_HD inline ActivationRule activationRule(const SolverData& s, const OrderedPair& o) {
  return {targetDisplacement(s, o.a), targetDisplacement(s, o.b)};
}

/// How near points of two bodies must be to take part in the step, by any clause of the ActivationRule [m].
RUBBLE_HD inline Real activationReach(const SolverData& s, const OrderedPair& o, const PairPose& pair,
                                      Real apart) {
  const BodyParams &pa = s.params[o.a], &pb = s.params[o.b];
  const auto target = [&](int body, Real radius, Vec3& move) {
    if (!isDynamic(s, body)) {
      move = s.dx[body].dp;
      return length(s.dx[body].dw) * radius;
    }
    const Pose& y = s.target[body].y;
    move = y.p;
    // an angle is less than pi times the sine of its half
    return Real(3.1416) * length(y.q.v) * radius;
  };
  Vec3 moveA, moveB;
  // a lever ends in the middle of the gap
  const Real turns = target(o.a, pa.radius + apart, moveA) + target(o.b, pb.radius + apart, moveB);
  const Real fastest = max(pairSpeed(s, o.a, o.b, pa, pb).closing, impactSpeedBoundOf(s, o.a, o.b));
  return max(length(moveA - moveB) + turns + kInactiveGap * pair.length, s.step.dt * fastest);
}

/// The pair of the step before, or -1.
RUBBLE_HD inline int findOldPair(const SolverData& s, const Pair& p) {
  for (int k = s.oldPairOffset[p.owner]; k < s.oldPairOffset[p.owner + 1]; ++k)
    if (samePair(s.oldPair[k], p)) return k;
  return -1;
}
/// The manifold that a pair of the step before had, or -1.
RUBBLE_HD inline int manifoldOfOld(const SolverData& s, int oldPair) {
  return s.oldActivePairOffset[oldPair + 1] > s.oldActivePairOffset[oldPair] ? s.oldActivePairOffset[oldPair]
                                                                             : -1;
}
/// A body of a pair was edited: it begins anew, and what the body touched can not sleep on.
RUBBLE_HD inline void forgetOldPair(const SolverData& s, int oldPair) {
  Pair& p = s.oldPair[oldPair];
  s.asleep[p.owner] = 0;
  if (p.other >= 0) s.asleep[p.other] = 0;
  p.other = -1;
  if (const int m = manifoldOfOld(s, oldPair); m >= 0) s.oldManifold[m].count = 0;
}
/// The manifold that a pair has in this step, or null.
RUBBLE_HD inline const Manifold* manifoldOf(const SolverData& s, int pair) {
  return s.isActive[pair] ? &s.manifold[s.activePairOffset[pair]] : nullptr;
}

/// May a pair be known to stay apart? A plane has no radius, and of sensors is asked how near they are.
RUBBLE_HD inline bool mayStayApart(const SolverData& s, const Pair& p) {
  return s.step.dormantRows && s.step.recycleTolerance > Real(0) &&
         s.params[p.other].shape.kind != ShapeKind::Plane && !isSensor(s, p.owner) && !isSensor(s, p.other);
}
/// Is it, by its last full test?
RUBBLE_HD inline bool staysApart(const SolverData& s, const OrderedPair& o, const PairPose& pose,
                                 const PairTest& test) {
  if (!(test.separation > Real(0))) return false;
  const Real apart = leastDistance(test, pose, s.params[o.b].radius);
  return apart > Real(0) && apart > activationReach(s, o, pose, apart);
}

/// Which pairs may have points that take part in the step. All others are known to stay apart: since their
/// last test, which found them apart, their bodies have come nearer by less than they would have to. They
/// have no manifold, and all that is known of them is that test.
struct FindActivePairs {
  static constexpr const char* kStage = "narrow";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    const Pair p = s.pair[i];
    const int old = findOldPair(s, p), manifold = old < 0 ? -1 : manifoldOfOld(s, old);
    const PairTest test = old < 0 ? PairTest{} : s.oldPairTest[old];
    s.pairTest[i] = test;
    s.manifoldBefore[i] = manifold;
    s.isActive[i] = 1;
    if (!mayStayApart(s, p)) return;
    const OrderedPair o = ordered(p);
    if (old < 0) {
      if (isPrimitivePair(s, o.a, o.b)) s.newPair[atomicCount(&s.counters->newPairs, 1)] = i;
    } else if (staysApart(s, o, pairPose(s, o), test)) {
      s.isActive[i] = manifold >= 0 && s.oldManifold[manifold].row >= 0;
    }
  }
};

/// Pairs of plain shapes that were none in the step before: tested at once, for most that come near one
/// another do not touch.
struct TestNewPairs {
  static constexpr const char* kStage = "narrow";
  RUBBLE_HD void operator()(const SolverData& s, int t) const {
    const int i = s.newPair[t];
    const OrderedPair o = ordered(s.pair[i]);
    const PairPose pose = pairPose(s, o);
    const PairTest test = pairTest(collide(s.params[o.a].shape, s.params[o.b].shape, pose), pose);
    s.pairTest[i] = test;
    s.isActive[i] = !staysApart(s, o, pose, test);
  }
};

/// The pairs that have manifolds.
struct ListActivePairs {
  static constexpr const char* kStage = "narrow";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (s.isActive[i]) s.activePair[s.activePairOffset[i]] = i;
  }
};

}  // namespace rubble::RUBBLE_CORE
