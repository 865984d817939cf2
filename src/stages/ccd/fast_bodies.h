#pragma once
/// Continuous collision detection for bodies that move farther in a step than they are thick, and could
/// tunnel. Contact rows are built at x^t and cannot anticipate where such a body hits. After the iterations
/// its motion from x^t to the solved pose is therefore swept against other bodies. At the first time of
/// impact it stops for the rest of the step.
///
/// A CCD stop never changes velocities. Momentum is exchanged only by the ordinary contact in the next step,
/// so a miss has no effect. Such a body loses the rest of one step per impact.
#include "stages/ccd/carriers.h"
#include "stages/contacts/one_way.h"
#include "stages/pairs/broad_phase.h"

namespace rubble::RUBBLE_CORE {

/// Gap at the time of impact, over L [1]. The next step then counts the bodies as touching (kInactiveGap),
/// and their aggregates move them together. Without that, light bodies in a head-on collision lose momentum
/// at few iterations.
inline constexpr Real kImpactGap = Real(1e-3);
/// Penetration that CCD allows between bodies in contact, over half the thickness of the thinner one [1]. The
/// rows of the next step correct it. With this bound no body's center passes the surface that supports it.
inline constexpr Real kHeldDepth = Real(.15);
/// The same against meshes and height fields, whose contacts are gathered anew in every step. A body that
/// rolls fast through a hollow penetrates that deep.
inline constexpr Real kHeldInSurface = Real(.5);
/// Additional penetration per step that CCD allows to bodies beyond that depth, likewise [1]. It is smaller
/// against immovable bodies, where the load that presses the body in may persist.
inline constexpr Real kDeeperYet = Real(.2), kDeeperYetAtRest = Real(.02);
/// Rows against a distance field have held a point if they leave it no deeper than this share of L [1].
inline constexpr Real kHeldPoint = Real(.05);

/// Bounding box of a body on a share of its motion, from `begin` to `end` [1].
RUBBLE_HD inline Bounds boundsOfMotion(const SolverData& s, int i, Real begin, Real end) {
  const BodyParams& p = s.params[i];
  const Displacement& d = s.dx[i];
  const Real turn = min(end * length(d.dw), Real(1)) * p.radius;
  Bounds b{};
  b.path = (end - begin) * d.dp;
  b.center = Vec3(s.position[i]) + Real(.5) * (begin + end) * d.dp;
  b.half = boundingHalf(p.shape, s.orientation[i]) + Real(.5) * abs(b.path) + Vec3{turn, turn, turn};
  b.level = -1;
  return b;
}

/// Does the motion of a body lead to where the broad phase found no pairs? That is out of its box by more
/// than the allowed penetration, or off its path by more than its radius (pathReach()).
RUBBLE_HD inline bool leavesPath(const SolverData& s, int i, const Bounds& motion) {
  const BodyParams& p = s.params[i];
  const Bounds& b = s.bounds[i];
  const Vec3 out = abs(motion.center - b.center) + motion.half - b.half, off = abs(motion.path - b.path);
  const Real slack = max(ownMargin(s, p), kHeldDepth * innerRadiusOf(s.shapeTables(), p.shape));
  return max(out.x, max(out.y, out.z)) > slack || max(off.x, max(off.y, off.z)) > p.radius;
}

/// Value of SolverData::fast of a body in the list of those that search for others without a pair.
inline constexpr int kSearched = 2;
RUBBLE_HD inline void listSearched(const SolverData& s, int i) {
  if (s.fast[i] == kSearched || s.params[i].kind != BodyKind::Dynamic || isSensor(s, i)) return;
  s.fast[i] = kSearched;
  s.searchedBody[atomicCount(&s.counters->searchedBodies, 1)] = i;
}

/// Flags and lists the bodies that moved far, and lists those of them that left their paths.
struct FlagFast {
  static constexpr const char* kStage = "ccd";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    s.ccdShareBits[i] = s.ccdPair[i] = s.ccdSeenBits[i] = s.ccdRound[i] = 0;
    s.ccdCarrier[i] = s.ccdRunInto[i] = 0;
    const BodyParams& p = s.params[i];
    if (p.kind != BodyKind::Dynamic && p.kind != BodyKind::Kinematic) return;
    const Displacement& d = s.dx[i];
    const Real way2 = dot(d.dp, d.dp), turn = turnedBy(s, i), inner = innerRadiusOf(s.shapeTables(), p.shape);
    // contacts that yield may have slowed a body that was about to move far
    const Real ahead = s.step->dt * length(s.velocity[i]);
    const bool moves = movesInStep(s, i),
               isFast = moves && (max(std::sqrt(way2), ahead) + turn > inner || s.fast[i] != 0);
    s.fast[i] = isFast;
    if (moves && mayCarry(p) && atomicLoad(&s.counters->carriers) == 0) atomicRaise(&s.counters->carriers, 1);
    if (!isFast) return;
    s.fastBody[atomicCount(&s.counters->fastBodies, 1)] = i;
    atomicRaise(&s.counters->swept, s.counters->pairs);
    if (leavesPath(s, i, boundsOfMotion(s, i, 0, 1))) listSearched(s, i);
  }
};

/// A stopped body may block others whose search assumed its full motion. The search is therefore repeated in
/// up to this many rounds, for pairs whose motion has been shortened, while it finds impacts.
inline constexpr int kCcdRounds = 3;

/// A body has `bits` of its motion left, or more, when it meets something.
RUBBLE_HD inline void raiseCcdShare(const SolverData& s, int body, int bits) {
  atomicRaise(&s.ccdShareBits[body], bits);
  if (atomicLoad(&s.counters->ccdImpacts) == 0) atomicRaise(&s.counters->ccdImpacts, 1);
}

/// Before a round: records how far fast bodies move according to the stops found so far. By fast body.
struct BeginCcdRound {
  static constexpr const char* kStage = "ccd";
  RUBBLE_HD void operator()(const SolverData& s, int k) const {
    const int i = s.fastBody[k];
    const int bits = s.ccdShareBits[i], owner = ccdOwner(s, i);
    if (const int mover = s.ccdRunInto[i]; mover != 0) atomicRaise(&s.ccdCarrier[owner], kSurely + mover);
    if (bits <= atomicLoad(&s.ccdSeenBits[owner])) return;
    atomicRaise(&s.ccdSeenBits[owner], bits);
    s.ccdRound[owner] = s.counters->ccdRounds + 1;
  }
};

/// Lists the bodies that have been stopped in a round. By fast body.
struct ListStopped {
  static constexpr const char* kStage = "ccd";
  RUBBLE_HD void operator()(const SolverData& s, int k) const {
    const int i = s.fastBody[k];
    if (s.ccdRound[ccdOwner(s, i)] == s.counters->ccdRounds) listSearched(s, i);
  }
};

/// The motion of a body in the step, according to the stops found so far.
RUBBLE_HD RUBBLE_OUT_OF_LINE inline SweptMotion motionIn(const SolverData& s, int body) {
  if (s.params[body].kind == BodyKind::Static) return {};
  const auto until = [&](int k) {
    return 1 - static_cast<double>(fromFloatBits(s.ccdSeenBits[ccdOwner(s, k)]));
  };
  const Displacement& d = s.dx[body];
  SweptMotion motion{Vec3d(d.dp), Vec3d(d.dw), until(body)};
  if (motion.until < 1)
    motion.after = carriedOn(s, body, carrierOf(s, body), motion.until, until).way / (1 - motion.until);
  return motion;
}

/// Has the motion of a body of the pair changed since the last round?
RUBBLE_HD inline bool needsSearch(const SolverData& s, const OrderedPair& o) {
  const int round = s.counters->ccdRounds;
  return round == 0 || s.ccdRound[ccdOwner(s, o.a)] == round || s.ccdRound[ccdOwner(s, o.b)] == round;
}

/// Has the manifold rows in this step?
RUBBLE_HD inline bool hasRows(const Manifold* m) { return m && m->count > 0 && m->row >= 0; }

/// Time of impact of two convex parts, `thin` thick. If they have rows or touch already, the contact governs
/// and CCD only bounds the penetration. Excess comes from rotations, which rows know to first order, or from
/// rows that did not converge.
RUBBLE_HD inline TimeOfImpact timeOfImpactOfPair(const Placed& a, const SweptMotion& motionA, const Placed& b,
                                                 const SweptMotion& motionB, const Manifold* m, Real thin,
                                                 bool bothMove, double tolerance) {
  const double allowed = static_cast<double>(kHeldDepth * thin),
               more = static_cast<double>((bothMove ? kDeeperYet : kDeeperYetAtRest) * thin);
  const auto beyond = [&](const Vec3d& n, bool turnsWithB) {
    return timeOfImpactBeyond(a, motionA, b, motionB, n, turnsWithB, allowed, more);
  };
  if (hasRows(m)) return beyond(Vec3d(m->normal), m->normalOnB);
  const TimeOfImpact first = timeOfImpact(a, motionA, b, motionB, tolerance);
  if (first.fraction > 0) return first;
  if (first.at.n != Vec3d{}) return beyond(first.at.n, false);
  // overlapping and separating at x^t: a rotation may increase the penetration
  return m && m->count > 0 ? beyond(Vec3d(m->normal), m->normalOnB) : TimeOfImpact{kNoImpact, first.at};
}

/// Does `body` stop at `other`? A fast body does, and so does a dynamic body at a kinematic or static one and
/// at its carrier.
RUBBLE_HD inline bool stopsAtImpact(const SolverData& s, int body, int other) {
  if (s.params[body].kind != BodyKind::Dynamic || carries(s, body, other)) return false;
  return s.fast[body] != 0 || s.params[other].kind != BodyKind::Dynamic || carries(s, other, body);
}

/// May the pair cause a CCD stop?
RUBBLE_HD inline bool mayImpact(const SolverData& s, const OrderedPair& o) {
  return (s.fast[o.a] || s.fast[o.b]) && !isSensor(s, o.a) && !isSensor(s, o.b);
}

/// Lists the pairs that may cause a stop, and finds carriers. Few pairs have a fast body, and all later looks
/// at pairs are at these alone.
struct ListSweptPairs {
  static constexpr const char* kStage = "ccd";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    const OrderedPair o = ordered(s.pair[i]);
    if (s.counters->carriers != 0) findCarrier(s, o.a, o.b), findCarrier(s, o.b, o.a);
    if (mayImpact(s, o)) s.sweptPair[atomicCount(&s.counters->sweptPairs, 1)] = {i, 0};
  }
};

/// Upper bound of the approach of any two points of the bodies [m].
RUBBLE_HD inline Real approach(const SolverData& s, const OrderedPair& o, const SweptMotion& a,
                               const SweptMotion& b) {
  const BodyParams &pa = s.params[o.a], &pb = s.params[o.b];
  const auto apart = [&](double t) { return length(wayUntil(a, t) - wayUntil(b, t)); };
  const double both = min(a.until, b.until),
               moves = max(length(a.move - b.move) * both, max(apart(max(a.until, b.until)), apart(1)));
  return static_cast<Real>(moves +
                           length(a.turn) * a.until * static_cast<double>(pa.radius - pa.shape.radius) +
                           length(b.turn) * b.until * static_cast<double>(pb.radius - pb.shape.radius));
}

/// Half extents of a body on its motion, about its center.
RUBBLE_HD inline Vec3 halfOfMotion(const SolverData& s, int i, const SweptMotion& m) {
  const BodyParams& p = s.params[i];
  const Real turn = static_cast<Real>(min(length(m.turn) * m.until, 1.0)) * p.radius;
  return boundingHalf(p.shape, s.orientation[i]) + Vec3{turn, turn, turn};
}
/// Do a sphere of radius `reach` and a box of half extents `half`, both about from + t way, contain the
/// origin for some t in [0, 1]?
RUBBLE_HD RUBBLE_OUT_OF_LINE inline bool passesOrigin(const Vec3d& from, const Vec3d& way, double reach,
                                                      const Vec3d& half) {
  const double size2 = dot(way, way), t = size2 > 0 ? clamp(-dot(from, way) / size2, 0.0, 1.0) : 0.0;
  return lengthSquared(from + way * t) <= reach * reach && passes(from, inverseOf(way), half, 1);
}
/// Do the bounding spheres and boxes of two bodies touch on their motions up to `limit`? They move on
/// straight lines until one of them stops. They are larger by the gap at which an impact is found.
RUBBLE_HD RUBBLE_OUT_OF_LINE inline bool boundsMeet(const SolverData& s, int i, int j, const SweptMotion& a,
                                                    const SweptMotion& b, double limit = 1) {
  constexpr double kTouching = 2 * static_cast<double>(kImpactGap);
  const double radii = static_cast<double>(s.params[i].radius + s.params[j].radius), gap = kTouching * radii,
               reach = radii + gap;
  const auto between = [&](double t) {
    return s.position[j] - s.position[i] + wayUntil(b, t) - wayUntil(a, t);
  };
  const Vec3d corner[4] = {between(0), between(min(min(a.until, b.until), limit)),
                           between(min(max(a.until, b.until), limit)), between(limit)};
  const Vec3d half = Vec3d(halfOfMotion(s, i, a) + halfOfMotion(s, j, b)) + Vec3d{gap, gap, gap};
  for (int k = 0; k < 3; ++k) {
    const Vec3d way = corner[k + 1] - corner[k];
    // motions that do not change have one segment
    if (k > 0 && way == Vec3d{}) continue;
    if (passesOrigin(corner[k], way, reach, half)) return true;
  }
  return false;
}
/// The same for any shape: planes have no bounds.
RUBBLE_HD inline bool mayMeet(const SolverData& s, int i, int j, const SweptMotion& a, const SweptMotion& b,
                              double limit = 1) {
  const auto isPlane = [&](int body) { return s.params[body].shape.kind == ShapeKind::Plane; };
  return isPlane(i) || isPlane(j) || boundsMeet(s, i, j, a, b, limit);
}

RUBBLE_HD inline bool bothDynamic(const SolverData& s, const OrderedPair& o) {
  return s.params[o.a].kind == BodyKind::Dynamic && s.params[o.b].kind == BodyKind::Dynamic;
}

/// Do the bodies of a pair, whose thinner part is `thin` thick, meet on motions long enough to tunnel, or is
/// one pressed into the other?
RUBBLE_HD inline bool mayPass(const SolverData& s, const OrderedPair& o, const SweptMotion& a,
                              const SweptMotion& b, Real thin, const Manifold* m) {
  if (hasRows(m)) return !bothDynamic(s, o) || approach(s, o, a, b) > thin;
  return approach(s, o, a, b) > thin && mayMeet(s, o.a, o.b, a, b);
}

/// Records that the bodies of a pair meet at this fraction of their motion. `n`: normal from A to B.
RUBBLE_HD inline void recordImpact(const SolverData& s, SweptPair& swept, const OrderedPair& o,
                                   double fraction, const Vec3d& n) {
  const int i = swept.pair;
  if (s.oneWay && !hasRows(manifoldOf(s, i)) && !stopsOneWay(s, o, partsOf(s, s.pair[i], o), n)) return;
  const int bits = floatBits(static_cast<Real>(1 - fraction));
  swept.toiBits = max(swept.toiBits, bits);
  if (stopsAtImpact(s, o.a, o.b)) raiseCcdShare(s, o.a, bits);
  if (stopsAtImpact(s, o.b, o.a)) raiseCcdShare(s, o.b, bits);
}

/// Times of impact of pairs of primitive shapes; stores the remaining fraction of the motion. By swept pair.
struct FindImpacts {
  static constexpr const char* kStage = "ccd";
  RUBBLE_HD void operator()(const SolverData& s, int k) const {
    SweptPair& swept = s.sweptPair[k];
    const int i = swept.pair;
    const OrderedPair o = ordered(s.pair[i]);
    if (!isPrimitivePair(s, o.a, o.b) || !needsSearch(s, o)) return;
    const BodyParams &pa = s.params[o.a], &pb = s.params[o.b];
    const SweptMotion motionA = motionIn(s, o.a), motionB = motionIn(s, o.b);
    const Real thin = thinner(innerRadius(pa.shape), innerRadius(pb.shape));
    if (!mayPass(s, o, motionA, motionB, thin, manifoldOf(s, i))) return;
    const Placed a = placed(pa.shape, {0, 0, 0}, Quatd(s.orientation[o.a]));
    const Placed b = placed(pb.shape, s.position[o.b] - s.position[o.a], Quatd(s.orientation[o.b]));
    const double tolerance = static_cast<double>(kImpactGap * pairLength(pa, pb));
    const TimeOfImpact m = timeOfImpactOfPair(a, motionA, b, motionB, manifoldOf(s, i), thin,
                                              bothDynamic(s, o), tolerance);
    if (m.fraction > 1) return;
    recordImpact(s, swept, o, m.fraction, m.at.n);
  }
};

/// The pair at which a body stops; of several at the same time the last one. By swept pair.
struct ChooseCcdPairs {
  static constexpr const char* kStage = "ccd";
  RUBBLE_HD void operator()(const SolverData& s, int k) const {
    const auto [i, bits] = s.sweptPair[k];
    if (bits == 0) return;
    const OrderedPair o = ordered(s.pair[i]);
    if (stopsAtImpact(s, o.a, o.b) && s.ccdShareBits[o.a] == bits) atomicRaise(&s.ccdPair[o.a], i + 1);
    if (stopsAtImpact(s, o.b, o.a) && s.ccdShareBits[o.b] == bits) atomicRaise(&s.ccdPair[o.b], i + 1);
  }
};

/// The motion of a body that stops in this step. A carrier, or -1, moves it in the rest of the step.
RUBBLE_HD inline Displacement stoppedMotion(const SolverData& s, int body, int carrier) {
  const auto until = [&](int k) {
    const bool withIsland = s.ccdPair[k] == kStopsWithIsland;
    return 1 - static_cast<double>(
                   fromFloatBits(withIsland ? s.ccdSeenBits[findRoot(s.root, k)] : s.ccdShareBits[k]));
  };
  const Real done = Real(1) - fromFloatBits(s.ccdShareBits[body]);
  Displacement d = s.dx[body];
  d.dp *= done, d.dw *= done;
  if (carrier < 0) return d;
  const Carried rest = carriedOn(s, body, carrier, static_cast<double>(done), until);
  d.dp += Vec3(rest.way);
  d.dw = logRotation(expRotation(Vec3(rest.turn)) * expRotation(d.dw));
  return d;
}

/// The motions of stopped bodies. A kinematic body carries a body that it has met along for the rest of the
/// step, a static one holds it. By swept pair.
struct StopBodies {
  static constexpr const char* kStage = "ccd";
  RUBBLE_HD void operator()(const SolverData& s, int k) const {
    const auto [i, bits] = s.sweptPair[k];
    if (bits == 0) return;
    const OrderedPair o = ordered(s.pair[i]);
    if (s.ccdPair[o.a] == i + 1) stop(s, o.a, o.b);
    if (s.ccdPair[o.b] == i + 1) stop(s, o.b, o.a);
  }

 private:
  RUBBLE_HD static void stop(const SolverData& s, int body, int other) {
    atomicCount(&s.counters->stopped, 1);
    const BodyKind kind = s.params[other].kind;
    s.ccdMotion[body] = stoppedMotion(s, body,
                                      kind == BodyKind::Kinematic ? other
                                      : kind == BodyKind::Dynamic ? lastCarrierOf(s, body)
                                                                  : -1);
  }
};

}  // namespace rubble::RUBBLE_CORE
