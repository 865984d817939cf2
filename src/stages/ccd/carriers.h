#pragma once
/// Carriers. A body that continuous collision detection stops would stand still in the world for the rest of
/// the step, whatever moves around it: in a vehicle, a wall would then pass over it. Such a body stops in the
/// frame of its carrier, which carries it along: a kinematic body beside it that moves as it does more nearly
/// than the world, or a concave one around it.
#include <limits>

#include "collision/sweep.h"
#include "stages/coarse/forest.h"
#include "stages/contacts/arcs.h"
#include "stages/pairs/filter.h"

namespace rubble::RUBBLE_CORE {

/// Value of ccdPair for a body that stops with its CCD island (islands.h), in place of a pair.
inline constexpr int kStopsWithIsland = std::numeric_limits<int>::max();
/// The body that stores a stop: the root of a CCD island, or the body itself.
RUBBLE_HD inline int ccdOwner(const SolverData& s, int body) {
  return s.ccdPair[body] == kStopsWithIsland ? findRoot(s.root, body) : body;
}

/// How far a rotation moves a point of a body in the step: by no more than its arc [m].
RUBBLE_HD inline Real turnedBy(const SolverData& s, int i) {
  return length(s.dx[i].dw) * (s.params[i].radius - s.params[i].shape.radius);
}
RUBBLE_HD inline bool movesInStep(const SolverData& s, int i) {
  return dot(s.dx[i].dp, s.dx[i].dp) > Real(0) || turnedBy(s, i) > Real(0);
}

/// Values of SolverData::ccdCarrier: 1 + a body that carries if nothing holds the other one, kHeldByWorld if
/// an immovable body is beside it, kSurely + 1 + a body that carries it anyhow. The largest value counts.
inline constexpr int kHeldByWorld = 1 << 29, kSurely = 1 << 30;
/// The carrier of a body, or -1: the world.
RUBBLE_HD inline int carrierOf(const SolverData& s, int body) {
  const int carrier = s.ccdCarrier[ccdOwner(s, body)];
  return carrier == kHeldByWorld ? -1 : (carrier & ~kSurely) - 1;
}
/// The same at the end of CCD, where what has run into a stopped body carries it.
RUBBLE_HD inline int lastCarrierOf(const SolverData& s, int body) {
  const int carrier = carrierOf(s, body);
  return carrier >= 0 ? carrier : s.ccdRunInto[body] - 1;
}
/// Does a dynamic body carry another one? Of the two that one stops, like at a kinematic body.
RUBBLE_HD inline bool carries(const SolverData& s, int body, int other) {
  return s.params[body].kind == BodyKind::Dynamic && carrierOf(s, other) == body;
}

/// A rigid motion. The displacement is that of a center [m], the rotation comes from turnOf() [rad].
struct Carried {
  Vec3d way, turn;
};
/// How carrier `k` moves what stands `arm` from its center [m] in a share of the step [1].
RUBBLE_HD inline Carried carriedWith(const SolverData& s, int k, const Vec3d& arm, double share) {
  const Displacement& d = s.dx[k];
  const Vec3d turn = Vec3d(d.dw) * share;
  return {Vec3d(d.dp) * share + rotate(turnOf(turn), arm) - arm, turn};
}
/// How carrier `k` moves a body in the rest of the step after `from` [1]. until(k): the share of the step
/// after which body k stops. A carrier that stops goes on with its own.
template <class Until>
RUBBLE_HD Carried carriedOn(const SolverData& s, int body, int k, double from, Until&& until) {
  constexpr int kMostCarriers = 4;
  Carried sum{};
  const Vec3d stop = s.position[body] + Vec3d(s.dx[body].dp) * from;
  for (int n = 0; k >= 0 && from < 1 && n < kMostCarriers; k = carrierOf(s, k), ++n) {
    const double end = until(k);
    if (end <= from) continue;
    const Vec3d center = s.position[k] + Vec3d(s.dx[k].dp) * from;
    const Carried more = carriedWith(s, k, stop + sum.way - center, end - from);
    sum.way += more.way, sum.turn += more.turn;
    from = end;
  }
  return sum;
}

/// A concave body carries one of less than this share of its radius that lies all in its box [1]. A larger
/// one may lie below it and not in it, and would be pushed through what it lies on.
inline constexpr Real kCargoSize = Real(.25);

/// Is a body small enough for concave body k to carry it, and in its box?
RUBBLE_HD inline bool isCargo(const SolverData& s, int body, int k) {
  const Real radius = s.params[body].radius;
  const ShapeData& shape = s.params[k].shape;
  if (radius > kCargoSize * s.params[k].radius || ccdOwner(s, k) == ccdOwner(s, body)) return false;
  const Vec3 at(rotateInverse(Quatd(s.orientation[k]), s.position[body] - s.position[k])),
      out = abs(at) - boundingHalf(shape, Quat{});
  return max(out.x, max(out.y, out.z)) <= -radius;
}
/// Does body k carry a body with which it has a pair? A dynamic body has for its carrier one that moves as it
/// does more nearly than the world, or one around it.
RUBBLE_HD RUBBLE_OUT_OF_LINE inline void findCarrier(const SolverData& s, int body, int k) {
  const BodyParams &p = s.params[k], &own = s.params[body];
  if (own.kind != BodyKind::Dynamic || isSensor(s, k)) return;
  int* const carrier = &s.ccdCarrier[ccdOwner(s, body)];
  if (p.kind != BodyKind::Dynamic) atomicRaise(carrier, kHeldByWorld);
  if (!mayCarry(p) || !movesInStep(s, k) || (p.kind == BodyKind::Dynamic && !isCargo(s, body, k))) return;
  const Vec3d arm = s.position[body] - s.position[k], way(s.dx[body].dp);
  const bool goesAlong = lengthSquared(way - carriedWith(s, k, arm, 1).way) < lengthSquared(way);
  if (goesAlong)
    atomicRaise(carrier, kSurely + k + 1);
  else if (p.kind == BodyKind::Dynamic)
    atomicRaise(carrier, k + 1);
}

}  // namespace rubble::RUBBLE_CORE
