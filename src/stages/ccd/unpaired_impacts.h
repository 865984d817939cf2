#pragma once
/// CCD for bodies that do not move as the broad phase predicted from the velocities before the step: an
/// impact or a joint accelerates or stops them within it. The motion of such a body is swept against all
/// bodies on its way with which it has no pair.
#include "stages/ccd/general_impacts.h"

namespace rubble::RUBBLE_CORE {

/// Is there a pair of part `part` of a body and a part of another one in this step? Against a surface, any
/// slot counts.
RUBBLE_HD inline bool arePaired(const SolverData& s, int body, int part, int other, int otherPart,
                                bool surface) {
  for (int side = 0; side < 2; ++side) {
    const int owner = side == 0 ? body : other, partner = side == 0 ? other : body;
    const int own = side == 0 ? part : otherPart, its = side == 0 ? otherPart : part;
    for (int k = s.pairOffset[owner]; k < s.pairOffset[owner + 1]; ++k) {
      const Pair& p = s.pair[k];
      if (p.other != partner) continue;
      if (surface ? static_cast<int>(p.first) == part : static_cast<int>(p.first) == own && p.second == its)
        return true;
    }
  }
  return false;
}

/// Time of impact of parts without a pair, one of which is a surface, if the penetration would exceed what
/// the rows of the next step correct. `thin`: half the thickness of the thinner part [m].
RUBBLE_HD RUBBLE_OUT_OF_LINE inline TimeOfImpact timeOfImpactWithSurface(const PlacedAny& part,
                                                                         const SweptMotion& motion,
                                                                         const PlacedAny& other,
                                                                         const SweptMotion& otherMotion,
                                                                         double tolerance, Real thin) {
  if (part.shape.kind == ShapeKind::Distance || other.shape.kind == ShapeKind::Distance) {
    const auto any = [](const Vec3d&, const TimeOfImpact&) { return true; };
    const ImpactRule rule{tolerance, true, static_cast<double>(thin)};
    return part.shape.kind == ShapeKind::Distance
               ? timeOfImpactWithField(part, motion, other, otherMotion, rule, any)
               : timeOfImpactWithField(other, otherMotion, part, motion, rule, any);
  }
  const Placed convex = asConvex(part);
  const double allowed = static_cast<double>(kHeldInSurface * thin),
               more = static_cast<double>(kDeeperYetAtRest * thin);
  const auto impactWith = [&](const Placed& triangle, const Vec3d& up) {
    const TimeOfImpact first = timeOfImpact(triangle, otherMotion, convex, motion, tolerance);
    return first.fraction > 0
               ? first
               : timeOfImpactBeyond(triangle, otherMotion, convex, motion, up, false, allowed, more);
  };
  return timeOfImpactWithTriangles(other, otherMotion, convex, motion, {tolerance, true, allowed},
                                   impactWith);
}
/// The same for any parts. Convex ones stop at any touch if `anyTouch` is set.
RUBBLE_HD inline TimeOfImpact timeOfImpactUnpaired(const PlacedAny& part, const SweptMotion& motion,
                                                   const PlacedAny& other, const SweptMotion& otherMotion,
                                                   double tolerance, bool anyTouch) {
  const ShapeTables& tables = part.tables;
  const Real thin = thinner(innerRadiusOf(tables, part.shape), innerRadiusOf(tables, other.shape));
  if (isSurface(part.shape.kind) || isSurface(other.shape.kind))
    return timeOfImpactWithSurface(part, motion, other, otherMotion, tolerance, thin);
  const Placed convex = asConvex(part), its = asConvex(other);
  const TimeOfImpact first = timeOfImpact(convex, motion, its, otherMotion, tolerance);
  if (first.fraction > 1 || anyTouch) return first;
  const double gap = gapAlong(movedBy(convex, motion, 1), movedBy(its, otherMotion, 1), first.at.n);
  return gap < -static_cast<double>(kHeldDepth * thin) ? first : TimeOfImpact{kNoImpact, first.at};
}

/// The normal of timeOfImpactUnpaired(), from the part to the other one.
RUBBLE_HD inline Vec3d normalOf(const PlacedAny& part, const PlacedAny& other, const TimeOfImpact& at) {
  // a surface comes first
  return isSurface(other.shape.kind) && part.shape.kind != ShapeKind::Distance ? -at.at.n : at.at.n;
}

/// Sweeps a body against those that its search finds: each at once, by the worker that finds it.
struct SweepAtOnce {
  template <class Sweep> RUBBLE_HD void add(int other, Sweep&& sweep) const { sweep(other); }
  /// Sweeps that are left.
  template <class Sweep> RUBBLE_HD void finish(Sweep&&) const {}
  /// A number of which workers may have read different values, the same for all.
  RUBBLE_HD int agree(int number) const { return number; }
};

/// By searched body: in the first round they search their way, in later ones those that have been stopped
/// search where they stand.
struct FindUnpairedImpacts {
  static constexpr const char* kStage = "ccd";
  RUBBLE_HD void operator()(const SolverData& s, int k) const { (*this)(s, k, 0, 1, SweepAtOnce{}); }
  /// Share of worker `lane` of `lanes`.
  template <class Sweeps>
  RUBBLE_HD void operator()(const SolverData& s, int k, int lane, int lanes, const Sweeps& sweeps) const {
    const int i = s.searchedBody[k], round = s.counters->ccdRounds;
    if (round == 0)
      searchWayToStop(s, i, lane, lanes, sweeps);
    else if (s.ccdRound[ccdOwner(s, i)] == round)
      searchPlace(s, i, lane, lanes, sweeps);
  }

 private:
  /// The first part of a way that is searched, in radii, and how many times longer the next one is [1].
  static constexpr Real kFirstPart = 2, kNextPart = 2;
  /// The shortest first part, as a share of the motion [1]. It bounds the number of parts.
  static constexpr Real kLeastPart = Real(1e-4);
  /// Round-off of fractions, rounded up: whether a worker sees a stop that another one has just found must
  /// not decide about impacts at the same time [1].
  static constexpr Real kSameTime = Real(1e-6);

  /// Searches ever longer parts of the way of a body until one ends after it stops. Neighbors stop most
  /// bodies of a crowd at once, and what lies beyond does not matter. Only the body itself stops: those that
  /// it has met find it where it stands in the next round, however far other workers have searched.
  template <class Sweeps>
  RUBBLE_HD void searchWayToStop(const SolverData& s, int i, int lane, int lanes,
                                 const Sweeps& sweeps) const {
    const SweptMotion motion = motionIn(s, i);
    const Real way = length(s.dx[i].dp), first = kFirstPart * s.params[i].radius;
    const auto sweep = [&](int other) {
      const double fraction = timeOfImpactWithBody(s, i, motion, other);
      if (fraction <= 1) raiseCcdShare(s, i, shareBits(fraction));
    };
    for (Real end = way > first ? max(first / way, kLeastPart) : Real(1);; end *= kNextPart) {
      const Real share = fromFloatBits(sweeps.agree(atomicLoad(&s.ccdShareBits[i]))),
                 stop = min(Real(1), Real(1) - share + kSameTime), until = min(end, stop);
      searchWay(
          s, i, boundsOfMotion(s, i, 0, until),
          [&](int other) {
            if (mayStop(s, i, motion, other, static_cast<double>(until))) sweeps.add(other, sweep);
          },
          lane, lanes);
      sweeps.finish(sweep);
      if (end >= stop) return;
    }
  }
  /// Bounding box of a body after it has stopped.
  RUBBLE_HD static Bounds boundsOfRest(const SolverData& s, int i, const SweptMotion& motion) {
    const Real end = static_cast<Real>(motion.until);
    Bounds b = boundsOfMotion(s, i, end, end);
    b.path = Vec3(motion.after * (1 - motion.until));
    b.center += Real(.5) * b.path, b.half += Real(.5) * abs(b.path);
    return b;
  }
  /// A stopped body waits where it stands for those whose way it then blocks.
  template <class Sweeps>
  RUBBLE_HD void searchPlace(const SolverData& s, int i, int lane, int lanes, const Sweeps& sweeps) const {
    const SweptMotion motion = motionIn(s, i);
    const auto sweep = [&](int other) {
      const double fraction = timeOfImpactWithBody(s, i, motion, other);
      if (!(fraction <= 1)) return;
      const int bits = shareBits(fraction);
      raiseCcdShare(s, i, bits);
      // a kinematic body does not stop: it pushes on what has no other carrier
      if (fraction > motion.until && s.params[other].kind == BodyKind::Kinematic && carrierOf(s, i) < 0)
        atomicRaise(&s.ccdRunInto[i], other + 1);
      if (stopsAtImpact(s, other, i)) raiseCcdShare(s, other, bits);
    };
    searchWay(
        s, i, boundsOfRest(s, i, motion),
        [&](int other) {
          if (mayStop(s, i, motion, other, 1)) sweeps.add(other, sweep);
        },
        lane, lanes);
    sweeps.finish(sweep);
  }

  /// The share of the motion after a fraction of it, as ccdShareBits stores it.
  RUBBLE_HD static int shareBits(double fraction) { return floatBits(static_cast<Real>(1 - fraction)); }

  /// May body i meet a body with which it has no pair? `limit`: later impacts may be left out.
  RUBBLE_HD RUBBLE_OUT_OF_LINE static bool mayStop(const SolverData& s, int i, const SweptMotion& motion,
                                                   int other, double limit) {
    // primitive partners have a pair; parts of others may be too far apart for one
    if (other == i || (isPrimitivePair(s, i, other) && arePartners(s, i, other))) return false;
    return !isSensor(s, other) && mayCollide(s, i, other) &&
           mayMeet(s, i, other, motion, motionIn(s, other), limit);
  }
  /// Fraction of its motion after which body i meets `other`.
  RUBBLE_HD RUBBLE_OUT_OF_LINE static double timeOfImpactWithBody(const SolverData& s, int i,
                                                                  const SweptMotion& motion, int other) {
    const ShapeData &own = s.params[i].shape, &its = s.params[other].shape;
    const bool surface = isSurface(own.kind) || isSurface(its.kind);
    const int ownParts = parts::count(s, own), itsParts = parts::count(s, its);
    const SweptMotion otherMotion = motionIn(s, other);
    const Real thin = thinner(innerRadiusOf(s.shapeTables(), own), innerRadiusOf(s.shapeTables(), its));
    if (approach(s, {i, other}, motion, otherMotion) <= thin) return kNoImpact;
    const double tolerance = static_cast<double>(kImpactGap * pairLength(s.params[i], s.params[other]));
    // bodies that the broad phase left out for their paths alone stop as pairs do
    const bool anyTouch = isPrimitivePair(s, i, other) && its.kind != ShapeKind::Plane &&
                          boundsTouch(s.bounds[i], s.bounds[other]);
    double first = kNoImpact;
    for (int k = 0; k < ownParts; ++k)
      for (int j = 0; j < itsParts; ++j) {
        if (arePaired(s, i, surfaceIsFirst(own.kind, its.kind) ? j : k, other, j, surface)) continue;
        const PlacedAny a = placedAny(s.shapeTables(), own, {0, 0, 0}, s.orientation[i], k);
        const PlacedAny b = placedAny(s.shapeTables(), its, s.position[other] - s.position[i],
                                      s.orientation[other], j);
        const TimeOfImpact m = timeOfImpactUnpaired(a, motion, b, otherMotion, tolerance, anyTouch);
        if (!(m.fraction > 0) || (s.oneWay && !stopsOneWay(s, {i, other}, {k, j}, normalOf(a, b, m))))
          continue;
        first = min(first, m.fraction);
      }
    return first;
  }
};

/// The motion of a body that has stopped at a body with which it has no pair.
struct StopUnpairedBodies {
  static constexpr const char* kStage = "ccd";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (s.counters->fastBodies == 0 || s.ccdShareBits[i] == 0 || s.ccdPair[i] != 0) return;
    atomicCount(&s.counters->stopped, 1);
    s.ccdMotion[i] = stoppedMotion(s, i, lastCarrierOf(s, i));
  }
};

}  // namespace rubble::RUBBLE_CORE
