#pragma once
/// CCD for bodies that leave the region of the broad phase. Its boxes are swept by the velocities before the
/// step, but an impact or a joint may accelerate a body within it. The motion of such a body is swept against
/// all bodies on its path with which it has no pair.
#include "stages/ccd/general_stops.h"
#include "stages/pairs/broad_phase.h"

namespace rubble::RUBBLE_CORE {

/// Bounding box of the motion of a body.
RUBBLE_HD inline Bounds boundsOfWay(const SolverData& s, int i) {
  const BodyParams& p = s.params[i];
  const Displacement& d = s.dx[i];
  const Real turn = min(length(d.dw), Real(1)) * p.radius;
  Bounds b{};
  b.centre = Vec3(s.position[i]) + Real(.5) * d.dp;
  b.half = boundingHalf(p.shape, s.orientation[i]) + Real(.5) * abs(d.dp) + Vec3{turn, turn, turn};
  b.level = -1;
  return b;
}

/// Does the motion of a body leave its broad-phase box by more than the allowed penetration?
RUBBLE_HD inline bool leavesBounds(const SolverData& s, int i, const Bounds& way) {
  const BodyParams& p = s.params[i];
  const Bounds& b = s.bounds[i];
  const Vec3 out = abs(way.centre - b.centre) + way.half - b.half;
  const Real slack = max(ownMargin(s, p), kHeldDepth * innerRadiusOf(s.shapeTables(), p.shape));
  return out.x > slack || out.y > slack || out.z > slack;
}

/// Is there a pair of part `part` of a body and a part of another one in this step? Against a surface, any
/// slot counts.
RUBBLE_HD inline bool makePair(const SolverData& s, int body, int part, int other, int otherPart,
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

/// Time of impact of parts without a pair, if the penetration would exceed what the rows of the next step
/// correct.
RUBBLE_HD inline TimeOfImpact meetingUnforeseen(const PlacedAny& part, const Way& way, const PlacedAny& other,
                                                const Way& otherWay, double tolerance) {
  const ShapeTables& tables = part.tables;
  const Real thin = thinner(innerRadiusOf(tables, part.shape), innerRadiusOf(tables, other.shape));
  if (part.shape.kind == ShapeKind::Distance || other.shape.kind == ShapeKind::Distance) {
    const auto any = [](const Vec3d&, const TimeOfImpact&) { return true; };
    const MeetRule rule{tolerance, true, static_cast<double>(thin)};
    return part.shape.kind == ShapeKind::Distance ? meetField(part, way, other, otherWay, rule, any)
                                                  : meetField(other, otherWay, part, way, rule, any);
  }
  const Placed convex = asConvex(part);
  if (!isSurface(other.shape.kind)) {
    const Placed its = asConvex(other);
    const TimeOfImpact first = meeting(convex, way, its, otherWay, tolerance);
    if (first.fraction > 1) return first;
    const double gap = gapAlong(movedBy(convex, way, 1), movedBy(its, otherWay, 1), first.at.n);
    return gap < -static_cast<double>(kHeldDepth * thin) ? first : TimeOfImpact{kNeverMet, first.at};
  }
  const double allowed = static_cast<double>(kHeldInSurface * thin),
               more = static_cast<double>(kDeeperYetAtRest * thin);
  const auto meet = [&](const Placed& triangle, const Vec3d& up) {
    const TimeOfImpact first = meeting(triangle, otherWay, convex, way, tolerance);
    return first.fraction > 0 ? first
                              : meetingBeyond(triangle, otherWay, convex, way, up, false, allowed, more);
  };
  return meetTriangles(other, otherWay, convex, way, {tolerance, true, allowed}, meet);
}

struct FindLateStops {
  static constexpr const char* kStage = "ccd";
  RUBBLE_HD void operator()(const SolverData& s, int i) const { (*this)(s, i, 0, 1); }
  /// Share of worker `lane` of `lanes`.
  RUBBLE_HD void operator()(const SolverData& s, int i, int lane, int lanes) const {
    if (s.counters->anyFast == 0 || s.fast[i] == 0) return;
    if (s.params[i].kind != BodyKind::Dynamic || isSensor(s, i)) return;
    const Bounds way = boundsOfWay(s, i);
    if (!leavesBounds(s, i, way)) return;
    searchWay(
        s, i, way,
        [&](int other) {
          if (other == i || isSensor(s, other) || !mayCollide(s, i, other)) return;
          // primitive bodies whose boxes touched have a pair; parts of others may be too far apart for one
          if (isPrimitivePair(s, i, other) && boundsTouch(s.bounds[i], s.bounds[other])) return;
          const double fraction = meetBody(s, i, other);
          if (!(fraction <= 1)) return;
          const int bits = floatBits(static_cast<Real>(1 - fraction));
          atomicRaise(&s.stopBits[i], bits);
          if (stopsAt(s, other, i)) atomicRaise(&s.stopBits[other], bits);
        },
        lane, lanes);
  }

  /// Fraction of its motion after which body i meets `other`.
  RUBBLE_HD static double meetBody(const SolverData& s, int i, int other) {
    const ShapeData &own = s.params[i].shape, &its = s.params[other].shape;
    const bool surface = isSurface(own.kind) || isSurface(its.kind);
    const int ownParts = parts::count(s, own), itsParts = parts::count(s, its);
    const Way way = wayIn(s, i), otherWay = wayIn(s, other);
    const Real thin = thinner(innerRadiusOf(s.shapeTables(), own), innerRadiusOf(s.shapeTables(), its));
    if (approach(s, {i, other}, way, otherWay) <= thin) return kNeverMet;
    const double tolerance = static_cast<double>(kMeetingGap * pairLength(s.params[i], s.params[other]));
    double first = kNeverMet;
    for (int k = 0; k < ownParts; ++k)
      for (int j = 0; j < itsParts; ++j) {
        if (makePair(s, i, surfaceIsFirst(own.kind, its.kind) ? j : k, other, j, surface)) continue;
        const PlacedAny a = placedAny(s.shapeTables(), own, {0, 0, 0}, s.orientation[i], k);
        const PlacedAny b = placedAny(s.shapeTables(), its, s.position[other] - s.position[i],
                                      s.orientation[other], j);
        const TimeOfImpact m = meetingUnforeseen(a, way, b, otherWay, tolerance);
        if (m.fraction > 0) first = min(first, m.fraction);
      }
    return first;
  }
};

/// The motion of a body that has stopped at a body with which it has no pair.
struct StopLateBodies {
  static constexpr const char* kStage = "ccd";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (s.counters->anyFast == 0 || s.stopBits[i] == 0 || s.stopPair[i] != 0) return;
    atomicCount(&s.counters->stopped, 1);
    const Real done = Real(1) - fromFloatBits(s.stopBits[i]);
    s.ccdMotion[i] = {done * s.dx[i].dp, 0, done * s.dx[i].dw, 0};
  }
};

}  // namespace rubble::RUBBLE_CORE
