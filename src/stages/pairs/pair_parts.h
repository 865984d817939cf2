#pragma once
/// From pairs of bodies to pairs of parts. Two primitive shapes give one pair. A compound gives one pair for
/// each of its parts that comes near. A surface (mesh, height field, distance field) gives kSurfaceSlots
/// pairs, one for each direction in which it may support the other part.
#include <cstring>

#include "stages/pairs/filter.h"

namespace rubble::RUBBLE_CORE {

/// A pair with the lower id first.
struct OrderedPair {
  int a, b;
};
RUBBLE_HD inline OrderedPair ordered(const Pair& p) {
  return p.ownerIsA ? OrderedPair{p.owner, p.other} : OrderedPair{p.other, p.owner};
}
RUBBLE_HD inline Pair pairOf(const SolverData& s, int owner, int other, int first = 0, int second = 0) {
  const bool ownerIsA = s.ordered ? s.idOf[owner] < s.idOf[other] : owner < other;
  return {owner, other, ownerIsA, static_cast<std::uint32_t>(first) & 0x7fffffffu, second};
}

RUBBLE_HD inline Real pairLength(const BodyParams& a, const BodyParams& b) {
  // the smaller dynamic body; a fixed one says nothing about the scale of the contact
  const Real radiusA = loadUnchanging(a.radius), radiusB = loadUnchanging(b.radius);
  const Real ra = a.kind == BodyKind::Dynamic ? radiusA : Real(0),
             rb = b.kind == BodyKind::Dynamic ? radiusB : Real(0);
  return 2 * (ra > Real(0) && rb > Real(0) ? min(ra, rb) : max(ra, rb));
}

RUBBLE_HD inline Vec3 centerDistance(const SolverData& s, int a, int b) {
  return Vec3(s.position[b] - s.position[a]);
}

RUBBLE_HD inline bool isPrimitivePair(const SolverData& s, int a, int b) {
  return isPrimitive(s.params[a].shape.kind) && isPrimitive(s.params[b].shape.kind);
}

/// Bounds from the relative speed of a pair.
struct PairSpeed {
  Real closing;  ///< upper bound of the closing speed of any two points [m/s]
  bool bullet;   ///< the bodies may tunnel: no row built before the step can predict where they meet
                 ///< (stages/ccd/fast_bodies.h)
};
RUBBLE_HD inline PairSpeed pairSpeed(const SolverData& s, int a, int b, const BodyParams& pa,
                                     const BodyParams& pb) {
  const Vec3 relative = s.velocity[a] - s.velocity[b];
  const Real closing = length(relative) + length(s.angularVelocity[a]) * pa.radius +
                       length(s.angularVelocity[b]) * pb.radius;
  return {closing, s.step->dt * closing > pairLength(pa, pb)};
}

/// Share of the closing speed of an impact that body `own` may receive, by mass [1]. It is 1 if the other
/// body has at least a third of its mass.
RUBBLE_HD inline Real shareOfImpact(const BodyParams& own, const BodyParams& other) {
  if (other.kind != BodyKind::Dynamic) return 1;
  return min(Real(1), 4 * other.mass / (own.mass + other.mass));
}

/// Bits of a non-negative float, which are ordered as the numbers are.
RUBBLE_HD inline int floatBits(Real a) {
  const float f = static_cast<float>(a);
  int bits;
  memcpy(&bits, &f, sizeof bits);
  return bits;
}
RUBBLE_HD inline Real fromFloatBits(int bits) {
  float f;
  memcpy(&f, &bits, sizeof f);
  return static_cast<Real>(f);
}

RUBBLE_HD inline Real impactSpeedBoundOf(const SolverData& s, int a, int b) {
  return max(fromFloatBits(s.impactSpeedBound[a]), fromFloatBits(s.impactSpeedBound[b]));
}

/// Detection margin of a pair [m]: contactMargin of its size, or the possible approach in a step if larger.
/// For pairs that may tunnel it is at most their size.
RUBBLE_HD inline Real pairMargin(const SolverData& s, int a, int b, Real pairSize, const PairSpeed& speed) {
  const Real least = s.step->contactMargin * pairSize;
  if (!speed.bullet) return max(least, s.step->dt * max(speed.closing, impactSpeedBoundOf(s, a, b)));
  // exchanging momentum over four points takes more iterations than over the one point of first contact
  const bool bothMove = s.params[a].kind == BodyKind::Dynamic && s.params[b].kind == BodyKind::Dynamic;
  return bothMove ? least : pairSize;
}

/// Largest distance of two parts that need a test in this step [m].
RUBBLE_HD inline Real pairReach(const SolverData& s, int a, int b) {
  const BodyParams &pa = s.params[a], &pb = s.params[b];
  return max(s.step->contactMargin * pairLength(pa, pb), s.step->dt * pairSpeed(s, a, b, pa, pb).closing);
}

/// Of two bodies with a surface among them: does the first one have it? Against a distance field any other
/// surface counts as a part.
RUBBLE_HD inline bool surfaceIsFirst(ShapeKind a, ShapeKind b) {
  return a == ShapeKind::Distance || (isSurface(a) && b != ShapeKind::Distance);
}

/// Of a pair with a surface: is it on body A?
RUBBLE_HD inline bool surfaceIsOnA(const SolverData& s, const Pair& p, const OrderedPair& o) {
  const ShapeKind a = s.params[o.a].shape.kind, b = s.params[o.b].shape.kind;
  return p.owner == o.a ? surfaceIsFirst(a, b) : !surfaceIsFirst(b, a);
}

namespace parts {

RUBBLE_HD inline int count(const SolverData& s, const ShapeData& shape) {
  return shape.kind == ShapeKind::Compound ? s.shapeIndex[shape.data + 3] : 1;
}

/// Bounding sphere of a part: its center relative to that of its body, world axes. Returns the radius [m].
RUBBLE_HD inline Real sphere(const SolverData& s, int body, int part, Vec3& center) {
  const BodyParams& p = s.params[body];
  if (p.shape.kind != ShapeKind::Compound) {
    center = {0, 0, 0};
    return p.radius;
  }
  const ShapePart& incidence = s.shapePart[s.shapeIndex[p.shape.data + 2] + part];
  center = rotate(s.orientation[body], incidence.position);
  return incidence.radius;
}

/// Does a part come near the surface of another body?
RUBBLE_HD inline bool nearSurface(const SolverData& s, int surfaceBody, int body, int part, Real margin) {
  const ShapeData& surface = s.params[surfaceBody].shape;
  Vec3 center;
  const Real reach = sphere(s, body, part, center) + margin;
  const Vec3 at = rotateInverse(s.orientation[surfaceBody], centerDistance(s, surfaceBody, body) + center);
  if (s.params[body].shape.kind == ShapeKind::Plane) return true;
  const Vec3 box{reach, reach, reach};
  if (!boxesOverlap(at - box, at + box, -surface.half, surface.half)) return false;
  if (surface.kind == ShapeKind::Distance) return true;
  return visitTriangles(s.shapeTables(), surface, at - box, at + box,
                        [](const SurfaceTriangle&) { return true; });
}

}  // namespace parts

/// found(first, second) for every pair of parts of two bodies that may touch. Without a surface: part of the
/// owner, part of the other. With one: the part that meets it, and the slot.
template <class Found>
RUBBLE_HD void forEachPartPair(const SolverData& s, int owner, int other, Found&& found) {
  if (isPrimitivePair(s, owner, other)) {
    found(0, 0);
    return;
  }
  const ShapeData &shapeA = s.params[owner].shape, &shapeB = s.params[other].shape;
  const Real margin = pairReach(s, owner, other);
  if (isSurface(shapeA.kind) || isSurface(shapeB.kind)) {
    const bool first = surfaceIsFirst(shapeA.kind, shapeB.kind);
    const int surface = first ? owner : other, body = first ? other : owner;
    const int count = parts::count(s, s.params[body].shape);
    for (int k = 0; k < count; ++k) {
      if (!parts::nearSurface(s, surface, body, k, margin)) continue;
      for (int slot = 0; slot < kSurfaceSlots; ++slot) found(k, slot);
    }
    return;
  }
  const int ofA = parts::count(s, shapeA), ofB = parts::count(s, shapeB);
  const Vec3 between = centerDistance(s, owner, other);
  const bool plane = shapeB.kind == ShapeKind::Plane;
  const Vec3 up = plane ? rotate(s.orientation[other], Vec3{0, 0, 1}) : Vec3{0, 0, 0};
  for (int i = 0; i < ofA; ++i) {
    Vec3 a;
    const Real ra = parts::sphere(s, owner, i, a) + margin;
    for (int k = 0; k < ofB; ++k) {
      Vec3 b;
      const Real reach = ra + parts::sphere(s, other, k, b);
      if (plane ? dot(up, a - between) <= reach : lengthSquared(between + b - a) <= reach * reach)
        found(i, k);
    }
  }
}

}  // namespace rubble::RUBBLE_CORE
