#pragma once
/// Bodies that go further in a step than they are thick, and so could pass through others. Contact rows are made at x^t and can not know where
/// such a body hits. So its way is checked after the iterations, from x^t to where they have put it: at the first body in the way it stops
/// for the rest of the step and keeps its velocity. The next step finds the two in touch, and its rows deal with the impact: momentum is
/// handed over there and nowhere else, and what is missed is not touched. Such a body loses the rest of one step for each impact.
#include "collision/sweep.h"
#include "stages/contacts.h"

namespace rubble::RUBBLE_CORE {

/// Bodies meet when they are this near, over L [1]: so near that the next step counts them as touching (kDormantGap), and its groups move them
/// together, without which light bodies that run into one another head-on would not keep their momentum at few iterations.
inline constexpr Real kMeetingGap = Real(1e-3);
/// Bodies that are in touch, or have rows, may be left this deep in one another, over half the thickness of the thinner one [1]: the rows of the next
/// step push them out again. So no centre passes the surface that it is held by.
inline constexpr Real kHeldDepth = Real(.5);
/// The rows of a point of a distance field have held if they leave it no deeper than this share of L.
inline constexpr Real kHeldPoint = Real(.05);

/// Which bodies went far, and whether there are any.
struct FindFast {
  static constexpr const char* kName = "stops";
  RUBBLE_HD void operator()(const View& s, int i) const {
    s.stopBits[i] = s.stopPair[i] = s.fast[i] = 0;
    const BodyParams& p = s.params[i];
    if (p.kind != BodyKind::Dynamic && p.kind != BodyKind::Kinematic) return;
    const Displacement& d = s.moved[i];
    // the turn moves no point further than the way around
    const Real way2 = dot(d.dp, d.dp), turn = length(d.dw) * (p.radius - p.shape.radius), inner = innerRadiusOf(s.shapeTables(), p.shape);
    if (!(way2 > Real(0)) || std::sqrt(way2) + turn <= inner) return;
    s.fast[i] = 1;
    atomicRaise(&s.counters->swept, s.counters->pairs);
  }
};

RUBBLE_HD inline Way wayOf(const Displacement& d) { return {Vec3d(d.dp), Vec3d(d.dw)}; }

/// Half of the thickness of the thinner of two shapes; planes and surfaces have none of their own. [m]
RUBBLE_HD inline Real thinner(Real a, Real b) { return a > Real(0) && b > Real(0) ? min(a, b) : max(a, b); }

/// Has a manifold rows in this step?
RUBBLE_HD inline bool hasRows(const Manifold* m) { return m && m->count > 0 && m->row >= 0; }

/// Where two convex parts, `thin` thick, meet on their ways. With rows between them, or in touch already, these have the word: what the turn of a
/// body, which rows know to first order only, or rows that did not suffice would take too deep ends there.
RUBBLE_HD inline Meeting meetingOfPair(const Placed& a, const Displacement& da, const Placed& b, const Displacement& db, const Manifold* m, Real thin,
                                       double tolerance) {
  const double allowed = static_cast<double>(kHeldDepth * thin);
  const Way wayA{Vec3d(da.dp), Vec3d(da.dw)}, wayB{Vec3d(db.dp), Vec3d(db.dw)};
  if (hasRows(m)) return meetingBeyond(a, wayA, b, wayB, Vec3d(m->normal), m->normalOnB, allowed);
  const Meeting first = meeting(a, wayA, b, wayB, tolerance);
  if (first.fraction > 0) return first;
  return first.at.n == Vec3d{} ? Meeting{kNeverMet, first.at} : meetingBeyond(a, wayA, b, wayB, first.at.n, false, allowed);
}

/// Which of two bodies stops where they meet: the fast one, and of a moved and a free one the free one.
RUBBLE_HD inline bool stopsAt(const View& s, int body, int other) {
  if (s.params[body].kind != BodyKind::Dynamic) return false;
  return s.fast[body] != 0 || s.params[other].kind != BodyKind::Dynamic;
}

/// May the bodies of a pair stop one another?
RUBBLE_HD inline bool mayStop(const View& s, const OrderedPair& o) {
  return (s.fast[o.a] || s.fast[o.b]) && !isSensor(s, o.a) && !isSensor(s, o.b);
}

/// The way of a body in the step.
RUBBLE_HD inline Displacement wayIn(const View& s, int body) {
  return s.params[body].kind == BodyKind::Static ? Displacement{{0, 0, 0}, 0, {0, 0, 0}, 0} : s.moved[body];
}

/// No two points of the bodies approach one another by more [m].
RUBBLE_HD inline Real approach(const View& s, const OrderedPair& o, const Displacement& a, const Displacement& b) {
  const BodyParams &pa = s.params[o.a], &pb = s.params[o.b];
  return length(a.dp - b.dp) + length(a.dw) * (pa.radius - pa.shape.radius) + length(b.dw) * (pb.radius - pb.shape.radius);
}

/// Notes that the bodies of pair i meet at this part of their ways.
RUBBLE_HD inline void noteMeeting(const View& s, int i, const OrderedPair& o, double fraction) {
  const int bits = floatBits(static_cast<Real>(1 - fraction));
  s.meetBits[i] = bits;
  if (stopsAt(s, o.a, o.b)) atomicRaise(&s.stopBits[o.a], bits);
  if (stopsAt(s, o.b, o.a)) atomicRaise(&s.stopBits[o.b], bits);
}

/// Where the bodies of a pair of plain shapes meet on their ways: the part of the way that is left then.
struct FindStops {
  static constexpr const char* kName = "stops";
  RUBBLE_HD void operator()(const View& s, int i) const {
    s.meetBits[i] = 0;
    const OrderedPair o = ordered(s.pair[i]);
    if (!isPlainPair(s, o.a, o.b) || !mayStop(s, o)) return;
    const BodyParams &pa = s.params[o.a], &pb = s.params[o.b];
    const Displacement da = wayIn(s, o.a), db = wayIn(s, o.b);
    const Real thin = thinner(innerRadius(pa.shape), innerRadius(pb.shape));
    if (approach(s, o, da, db) <= thin) return;
    const Placed a = placed(pa.shape, {0, 0, 0}, Quatd(s.orientation[o.a]));
    const Placed b = placed(pb.shape, s.position[o.b] - s.position[o.a], Quatd(s.orientation[o.b]));
    const double tolerance = static_cast<double>(kMeetingGap * pairLength(pa, pb));
    const Meeting m = meetingOfPair(a, da, b, db, manifoldOf(s, i), thin, tolerance);
    if (m.fraction > 1) return;
    noteMeeting(s, i, o, m.fraction);
  }
};

/// The pair that a body stops at: of several at the same time the last one.
struct ChooseStops {
  static constexpr const char* kName = "stops";
  RUBBLE_HD void operator()(const View& s, int i) const {
    const int bits = s.meetBits[i];
    if (bits == 0) return;
    const OrderedPair o = ordered(s.pair[i]);
    if (stopsAt(s, o.a, o.b) && s.stopBits[o.a] == bits) atomicRaise(&s.stopPair[o.a], i + 1);
    if (stopsAt(s, o.b, o.a) && s.stopBits[o.b] == bits) atomicRaise(&s.stopPair[o.b], i + 1);
  }
};

/// The ways that the bodies of a pair make until they stop there. What they have met carries them along, unless it has stopped as well.
struct StopBodies {
  static constexpr const char* kName = "stops";
  RUBBLE_HD void operator()(const View& s, int i) const {
    if (s.meetBits[i] == 0) return;
    const OrderedPair o = ordered(s.pair[i]);
    if (s.stopPair[o.a] == i + 1) stop(s, o.a, o.b);
    if (s.stopPair[o.b] == i + 1) stop(s, o.b, o.a);
  }

  RUBBLE_HD static void stop(const View& s, int body, int other) {
    atomicCount(&s.counters->stopped, 1);
    const Real left = fromFloatBits(s.stopBits[body]), done = Real(1) - left;
    Displacement d = s.moved[body];
    d.dp *= done, d.dw *= done;
    if (s.params[other].kind != BodyKind::Static && s.stopBits[other] == 0) {
      const Displacement& e = s.moved[other];
      const Vec3 arm = Vec3(s.position[body] - s.position[other]) + d.dp - done * e.dp;
      d.dp += left * (e.dp + cross(e.dw, arm));
      d.dw = logRotation(expRotation(left * e.dw) * expRotation(d.dw));
    }
    s.stopped[body] = d;
  }
};

}  // namespace rubble::RUBBLE_CORE
