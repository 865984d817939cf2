#pragma once
/// Continuous collision detection for bodies that move farther in a step than they are thick, and could
/// tunnel. Contact rows are built at x^t and cannot anticipate where such a body hits. After the iterations
/// its motion from x^t to the solved pose is therefore swept against other bodies. At the first time of
/// impact it stops for the rest of the step.
///
/// A CCD stop never changes velocities. Momentum is exchanged only by the ordinary contact in the next step,
/// so a miss has no effect. Such a body loses the rest of one step per impact.
#include <limits>

#include "collision/sweep.h"
#include "stages/coarse/forest.h"
#include "stages/contacts/contacts.h"

namespace rubble::RUBBLE_CORE {

/// Gap at the time of impact, over L [1]. The next step then counts the bodies as touching (kInactiveGap),
/// and their aggregates move them together. Without that, light bodies in a head-on collision lose momentum
/// at few iterations.
inline constexpr Real kMeetingGap = Real(1e-3);
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

/// Flags the bodies that moved far, and whether there are any.
struct FlagFast {
  static constexpr const char* kStage = "ccd";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    s.stopBits[i] = s.stopPair[i] = s.stopSeen[i] = s.stopRound[i] = 0;
    const BodyParams& p = s.params[i];
    if (p.kind != BodyKind::Dynamic && p.kind != BodyKind::Kinematic) return;
    const Displacement& d = s.dx[i];
    // a rotation moves no point by more than its arc
    const Real way2 = dot(d.dp, d.dp), turn = length(d.dw) * (p.radius - p.shape.radius),
               inner = innerRadiusOf(s.shapeTables(), p.shape);
    // contacts that yield may have slowed a body that was about to move far
    const Real ahead = s.step->dt * length(s.velocity[i]);
    if (!(way2 > Real(0)) || (max(std::sqrt(way2), ahead) + turn <= inner && s.fast[i] == 0)) return;
    s.fast[i] = 1;
    atomicRaise(&s.counters->anyFast, 1);
    atomicRaise(&s.counters->swept, s.counters->pairs);
  }
};

/// Value of stopPair for a body that stops with its CCD island (assembly_stops.h), in place of a pair.
inline constexpr int kStopsTogether = std::numeric_limits<int>::max();
/// The body that stores a stop: the root of a CCD island, or the body itself.
RUBBLE_HD inline int stopOwner(const SolverData& s, int body) {
  return s.stopPair[body] == kStopsTogether ? findRoot(s.root, body) : body;
}

/// A stopped body may block others whose search assumed its full motion. The search is therefore repeated in
/// up to this many rounds, for pairs whose motion has been shortened.
inline constexpr int kStopRounds = 4;

/// Before a round: records how far fast bodies move according to the stops found so far.
struct NoteStops {
  static constexpr const char* kStage = "ccd";
  int round;
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (s.counters->anyFast == 0 || s.fast[i] == 0) return;
    const int bits = s.stopBits[i], owner = stopOwner(s, i);
    if (bits <= s.stopSeen[owner]) return;
    atomicRaise(&s.stopSeen[owner], bits);
    s.stopRound[owner] = round;
  }
};

/// The motion of a body in the step, according to the stops found so far.
RUBBLE_HD inline Way wayIn(const SolverData& s, int body) {
  if (s.params[body].kind == BodyKind::Static) return {};
  const Displacement& d = s.dx[body];
  return {Vec3d(d.dp), Vec3d(d.dw), 1 - static_cast<double>(fromFloatBits(s.stopSeen[stopOwner(s, body)]))};
}

/// Has the motion of a body of the pair changed since the last round?
RUBBLE_HD inline bool isSought(const SolverData& s, const OrderedPair& o, int round) {
  return round == 0 || s.stopRound[stopOwner(s, o.a)] == round || s.stopRound[stopOwner(s, o.b)] == round;
}

/// Has the manifold rows in this step?
RUBBLE_HD inline bool hasRows(const Manifold* m) { return m && m->count > 0 && m->row >= 0; }

/// Time of impact of two convex parts, `thin` thick. If they have rows or touch already, the contact governs
/// and CCD only bounds the penetration. Excess comes from rotations, which rows know to first order, or from
/// rows that did not converge.
RUBBLE_HD inline TimeOfImpact meetingOfPair(const Placed& a, const Way& wayA, const Placed& b,
                                            const Way& wayB, const Manifold* m, Real thin, bool bothMove,
                                            double tolerance) {
  const double allowed = static_cast<double>(kHeldDepth * thin),
               more = static_cast<double>((bothMove ? kDeeperYet : kDeeperYetAtRest) * thin);
  const auto beyond = [&](const Vec3d& n, bool turnsWithB) {
    return meetingBeyond(a, wayA, b, wayB, n, turnsWithB, allowed, more);
  };
  if (hasRows(m)) return beyond(Vec3d(m->normal), m->normalOnB);
  const TimeOfImpact first = meeting(a, wayA, b, wayB, tolerance);
  if (first.fraction > 0) return first;
  if (first.at.n != Vec3d{}) return beyond(first.at.n, false);
  // overlapping and separating at x^t: a rotation may increase the penetration
  return m && m->count > 0 ? beyond(Vec3d(m->normal), m->normalOnB) : TimeOfImpact{kNeverMet, first.at};
}

/// Does `body` stop at `other`? A fast body does, and so does a dynamic body at a kinematic or static one.
RUBBLE_HD inline bool stopsAt(const SolverData& s, int body, int other) {
  if (s.params[body].kind != BodyKind::Dynamic) return false;
  return s.fast[body] != 0 || s.params[other].kind != BodyKind::Dynamic;
}

/// May the pair cause a CCD stop?
RUBBLE_HD inline bool mayStop(const SolverData& s, const OrderedPair& o) {
  return (s.fast[o.a] || s.fast[o.b]) && !isSensor(s, o.a) && !isSensor(s, o.b);
}

/// Upper bound of the approach of any two points of the bodies [m].
RUBBLE_HD inline Real approach(const SolverData& s, const OrderedPair& o, const Way& a, const Way& b) {
  const BodyParams &pa = s.params[o.a], &pb = s.params[o.b];
  const double both = min(a.until, b.until);
  const double moves = max(length(a.move - b.move) * both, length(a.move * a.until - b.move * b.until));
  return static_cast<Real>(moves +
                           length(a.turn) * a.until * static_cast<double>(pa.radius - pa.shape.radius) +
                           length(b.turn) * b.until * static_cast<double>(pb.radius - pb.shape.radius));
}

RUBBLE_HD inline bool bothDynamic(const SolverData& s, const OrderedPair& o) {
  return s.params[o.a].kind == BodyKind::Dynamic && s.params[o.b].kind == BodyKind::Dynamic;
}

/// Is the motion of a pair, whose thinner part is `thin` thick, long enough to tunnel, or is one pressed into
/// the other?
RUBBLE_HD inline bool mayPass(const SolverData& s, const OrderedPair& o, const Way& a, const Way& b,
                              Real thin, const Manifold* m) {
  return (hasRows(m) && !bothDynamic(s, o)) || approach(s, o, a, b) > thin;
}

/// Records that the bodies of pair i meet at this fraction of their motion.
RUBBLE_HD inline void noteMeeting(const SolverData& s, int i, const OrderedPair& o, double fraction) {
  const int bits = floatBits(static_cast<Real>(1 - fraction));
  s.toiBits[i] = max(s.toiBits[i], bits);
  if (stopsAt(s, o.a, o.b)) atomicRaise(&s.stopBits[o.a], bits);
  if (stopsAt(s, o.b, o.a)) atomicRaise(&s.stopBits[o.b], bits);
}

/// Times of impact of pairs of primitive shapes; stores the remaining fraction of the motion.
struct FindStops {
  static constexpr const char* kStage = "ccd";
  int round;
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (round == 0) s.toiBits[i] = 0;
    const OrderedPair o = ordered(s.pair[i]);
    if (!isPrimitivePair(s, o.a, o.b) || !mayStop(s, o) || !isSought(s, o, round)) return;
    const BodyParams &pa = s.params[o.a], &pb = s.params[o.b];
    const Way wayA = wayIn(s, o.a), wayB = wayIn(s, o.b);
    const Real thin = thinner(innerRadius(pa.shape), innerRadius(pb.shape));
    if (!mayPass(s, o, wayA, wayB, thin, manifoldOf(s, i))) return;
    const Placed a = placed(pa.shape, {0, 0, 0}, Quatd(s.orientation[o.a]));
    const Placed b = placed(pb.shape, s.position[o.b] - s.position[o.a], Quatd(s.orientation[o.b]));
    const double tolerance = static_cast<double>(kMeetingGap * pairLength(pa, pb));
    const TimeOfImpact m = meetingOfPair(a, wayA, b, wayB, manifoldOf(s, i), thin, bothDynamic(s, o),
                                         tolerance);
    if (m.fraction > 1) return;
    noteMeeting(s, i, o, m.fraction);
  }
};

/// The pair at which a body stops; of several at the same time the last one.
struct ChooseStops {
  static constexpr const char* kStage = "ccd";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    const int bits = s.toiBits[i];
    if (bits == 0) return;
    const OrderedPair o = ordered(s.pair[i]);
    if (stopsAt(s, o.a, o.b) && s.stopBits[o.a] == bits) atomicRaise(&s.stopPair[o.a], i + 1);
    if (stopsAt(s, o.b, o.a) && s.stopBits[o.b] == bits) atomicRaise(&s.stopPair[o.b], i + 1);
  }
};

/// The motions of stopped bodies. A kinematic body carries a body that it has met along for the rest of the
/// step. A dynamic one does not, because the carried motion would not be swept; the rows of the next step
/// resolve that contact.
struct StopBodies {
  static constexpr const char* kStage = "ccd";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (s.toiBits[i] == 0) return;
    const OrderedPair o = ordered(s.pair[i]);
    if (s.stopPair[o.a] == i + 1) stop(s, o.a, o.b);
    if (s.stopPair[o.b] == i + 1) stop(s, o.b, o.a);
  }

  RUBBLE_HD static void stop(const SolverData& s, int body, int other) {
    atomicCount(&s.counters->stopped, 1);
    const Real left = fromFloatBits(s.stopBits[body]), done = Real(1) - left;
    Displacement d = s.dx[body];
    d.dp *= done, d.dw *= done;
    if (s.params[other].kind == BodyKind::Kinematic) {
      const Displacement& e = s.dx[other];
      const Vec3 arm = Vec3(s.position[body] - s.position[other]) + d.dp - done * e.dp;
      d.dp += left * (e.dp + cross(e.dw, arm));
      d.dw = logRotation(expRotation(left * e.dw) * expRotation(d.dw));
    }
    s.ccdMotion[body] = d;
  }
};

}  // namespace rubble::RUBBLE_CORE
