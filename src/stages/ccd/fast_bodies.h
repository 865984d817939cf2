#pragma once
/// Bodies that go further in a step than they are thick, and so could pass through others. Contact rows are
/// made at x^t and can not know where such a body hits. So its way is checked after the iterations, from x^t
/// to where they have put it: at the first body in the way it stops for the rest of the step and keeps its
/// velocity. The next step finds the two in touch, and its rows deal with the impact: momentum is handed over
/// there and nowhere else, and what is missed is not touched. Such a body loses the rest of one step for each
/// impact.
#include <limits>

#include "collision/sweep.h"
#include "stages/coarse/forest.h"
#include "stages/contacts/contacts.h"

namespace rubble::RUBBLE_CORE {

/// Bodies meet when they are this near, over L [1]: so near that the next step counts them as touching
/// (kInactiveGap), and its groups move them together, without which light bodies that run into one another
/// head-on would not keep their momentum at few iterations.
inline constexpr Real kMeetingGap = Real(1e-3);
/// Bodies that are in touch, or have rows, may be left this deep in one another, over half the thickness of
/// the thinner one [1]: the rows of the next step push them out again. So no centre passes the surface that
/// it is held by.
inline constexpr Real kHeldDepth = Real(.15);
/// The same in meshes and height fields, whose rows are gathered anew in every step: in a hollow a body that
/// rolls fast lies that deep.
inline constexpr Real kHeldInSurface = Real(.5);
/// Bodies that are deeper may go so much further in a step, likewise: less into what does not move, where
/// what they are pressed by may come again.
inline constexpr Real kDeeperYet = Real(.2), kDeeperYetAtRest = Real(.02);
/// The rows of a point of a distance field have held if they leave it no deeper than this share of L.
inline constexpr Real kHeldPoint = Real(.05);

/// Which bodies went far, and whether there are any.
struct FlagFast {
  static constexpr const char* kStage = "stops";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    s.stopBits[i] = s.stopPair[i] = s.stopSeen[i] = s.stopRound[i] = 0;
    const BodyParams& p = s.params[i];
    if (p.kind != BodyKind::Dynamic && p.kind != BodyKind::Kinematic) return;
    const Displacement& d = s.dx[i];
    // the turn moves no point further than the way around
    const Real way2 = dot(d.dp, d.dp), turn = length(d.dw) * (p.radius - p.shape.radius),
               inner = innerRadiusOf(s.shapeTables(), p.shape);
    // one that was to go far may have been held by rows that give way
    const Real ahead = s.step.dt * length(s.velocity[i]);
    if (!(way2 > Real(0)) || (max(std::sqrt(way2), ahead) + turn <= inner && s.fast[i] == 0)) return;
    s.fast[i] = 1;
    atomicRaise(&s.counters->anyFast, 1);
    atomicRaise(&s.counters->swept, s.counters->pairs);
  }
};

/// In place of the pair that a body stops at: it stops with its assembly (assembly_stops.h).
inline constexpr int kStopsTogether = std::numeric_limits<int>::max();
/// The body with which a stop is noted.
RUBBLE_HD inline int stopOwner(const SolverData& s, int body) {
  return s.stopPair[body] == kStopsTogether ? findRoot(s.root, body) : body;
}

/// What has stopped is in the way of others that counted on its going on: so stops are sought again, in so
/// many rounds, for the pairs of bodies whose way has become shorter.
inline constexpr int kStopRounds = 4;

/// Before a round: how far fast bodies go as far as is known.
struct NoteStops {
  static constexpr const char* kStage = "stops";
  int round;
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (s.counters->anyFast == 0 || s.fast[i] == 0) return;
    const int bits = s.stopBits[i], owner = stopOwner(s, i);
    if (bits <= s.stopSeen[owner]) return;
    atomicRaise(&s.stopSeen[owner], bits);
    s.stopRound[owner] = round;
  }
};

/// The way of a body in the step, as far as is known.
RUBBLE_HD inline Way wayIn(const SolverData& s, int body) {
  if (s.params[body].kind == BodyKind::Static) return {};
  const Displacement& d = s.dx[body];
  return {Vec3d(d.dp), Vec3d(d.dw), 1 - static_cast<double>(fromFloatBits(s.stopSeen[stopOwner(s, body)]))};
}

/// Is there news for a pair in this round?
RUBBLE_HD inline bool isSought(const SolverData& s, const OrderedPair& o, int round) {
  return round == 0 || s.stopRound[stopOwner(s, o.a)] == round || s.stopRound[stopOwner(s, o.b)] == round;
}

/// Has a manifold rows in this step?
RUBBLE_HD inline bool hasRows(const Manifold* m) { return m && m->count > 0 && m->row >= 0; }

/// Where two convex parts, `thin` thick, meet on their ways. With rows between them, or in touch already,
/// these have the word: what the turn of a body, which rows know to first order only, or rows that did not
/// suffice would take too deep ends there.
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
  // in one another, and parting at x^t: a turn may take them further in
  return m && m->count > 0 ? beyond(Vec3d(m->normal), m->normalOnB) : TimeOfImpact{kNeverMet, first.at};
}

/// Which of two bodies stops where they meet: the fast one, and of a moved and a free one the free one.
RUBBLE_HD inline bool stopsAt(const SolverData& s, int body, int other) {
  if (s.params[body].kind != BodyKind::Dynamic) return false;
  return s.fast[body] != 0 || s.params[other].kind != BodyKind::Dynamic;
}

/// May the bodies of a pair stop one another?
RUBBLE_HD inline bool mayStop(const SolverData& s, const OrderedPair& o) {
  return (s.fast[o.a] || s.fast[o.b]) && !isSensor(s, o.a) && !isSensor(s, o.b);
}

/// No two points of the bodies approach one another by more [m].
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

/// Is the way of a pair, whose thinner part is `thin` thick, long enough to pass, or is one pressed into the
/// other?
RUBBLE_HD inline bool mayPass(const SolverData& s, const OrderedPair& o, const Way& a, const Way& b,
                              Real thin, const Manifold* m) {
  return (hasRows(m) && !bothDynamic(s, o)) || approach(s, o, a, b) > thin;
}

/// Notes that the bodies of pair i meet at this part of their ways.
RUBBLE_HD inline void noteMeeting(const SolverData& s, int i, const OrderedPair& o, double fraction) {
  const int bits = floatBits(static_cast<Real>(1 - fraction));
  s.toiBits[i] = max(s.toiBits[i], bits);
  if (stopsAt(s, o.a, o.b)) atomicRaise(&s.stopBits[o.a], bits);
  if (stopsAt(s, o.b, o.a)) atomicRaise(&s.stopBits[o.b], bits);
}

/// Where the bodies of a pair of plain shapes meet on their ways: the part of the way that is left then.
struct FindStops {
  static constexpr const char* kStage = "stops";
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

/// The pair that a body stops at: of several at the same time the last one.
struct ChooseStops {
  static constexpr const char* kStage = "stops";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    const int bits = s.toiBits[i];
    if (bits == 0) return;
    const OrderedPair o = ordered(s.pair[i]);
    if (stopsAt(s, o.a, o.b) && s.stopBits[o.a] == bits) atomicRaise(&s.stopPair[o.a], i + 1);
    if (stopsAt(s, o.b, o.a) && s.stopBits[o.b] == bits) atomicRaise(&s.stopPair[o.b], i + 1);
  }
};

/// The ways that the bodies of a pair make until they stop there. A kinematic body that they have met carries
/// them along; a dynamic one is a matter of the rows of the next step, for what it would carry them into
/// nobody has looked at.
struct StopBodies {
  static constexpr const char* kStage = "stops";
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
