#pragma once
/// From pairs of bodies to pairs of parts. A pair of plain shapes is one pair. A compound has one for each of its parts that comes near; a
/// surface (mesh, height field, distance field) has kSurfaceSlots, one for each direction in which it may hold the other part.
#include "state/view.h"

namespace rubble::RUBBLE_CORE {

/// A pair with the lower index first.
struct OrderedPair {
  int a, b;
};
RUBBLE_HD inline OrderedPair ordered(const Pair& p) { return p.owner < p.other ? OrderedPair{p.owner, p.other} : OrderedPair{p.other, p.owner}; }

RUBBLE_HD inline Real pairLength(const BodyParams& a, const BodyParams& b) {
  // the smaller dynamic body; a fixed one says nothing about the scale of the contact
  const Real ra = a.kind == BodyKind::Dynamic ? a.radius : Real(0), rb = b.kind == BodyKind::Dynamic ? b.radius : Real(0);
  return 2 * (ra > Real(0) && rb > Real(0) ? min(ra, rb) : max(ra, rb));
}

RUBBLE_HD inline Vec3 centreDistance(const View& s, int a, int b) { return Vec3(s.position[b] - s.position[a]); }

/// Detection margin of a pair: what it may approach in a step, and not less than contactMargin of its size. [m]
RUBBLE_HD inline Real pairMargin(const View& s, int a, int b, Real pairSize) {
  const Vec3 relative = s.velocity[a] - s.velocity[b];
  const Real approach = length(relative) + length(s.spin[a]) * s.params[a].radius + length(s.spin[b]) * s.params[b].radius;
  return max(s.step.contactMargin * pairSize, s.step.dt * approach);
}

RUBBLE_HD inline bool isPlainPair(const View& s, int a, int b) { return isPlain(s.params[a].shape.kind) && isPlain(s.params[b].shape.kind); }

/// Of two bodies with a surface among them: is it the first one's? A distance field takes any other surface as a part.
RUBBLE_HD inline bool surfaceIsFirst(ShapeKind a, ShapeKind b) { return a == ShapeKind::Distance || (isSurface(a) && b != ShapeKind::Distance); }

namespace parts {

RUBBLE_HD inline int count(const View& s, const ShapeData& shape) { return shape.kind == ShapeKind::Compound ? s.shapeIndex[shape.data + 3] : 1; }

/// Bounding sphere of a part: its centre less that of its body, world axes.
RUBBLE_HD inline Real sphere(const View& s, int body, int part, Vec3& centre) {
  const BodyParams& p = s.params[body];
  if (p.shape.kind != ShapeKind::Compound) {
    centre = {0, 0, 0};
    return p.radius;
  }
  const ShapePart& entry = s.shapePart[s.shapeIndex[p.shape.data + 2] + part];
  centre = rotate(s.orientation[body], entry.position);
  return entry.radius;
}

/// Does a part come near the surface of another body?
RUBBLE_HD inline bool nearSurface(const View& s, int surfaceBody, int body, int part, Real margin) {
  const ShapeData& surface = s.params[surfaceBody].shape;
  Vec3 centre;
  const Real reach = sphere(s, body, part, centre) + margin;
  const Vec3 at = rotateInverse(s.orientation[surfaceBody], centreDistance(s, surfaceBody, body) + centre);
  if (s.params[body].shape.kind == ShapeKind::Plane) return true;
  const Vec3 box{reach, reach, reach};
  if (!boxesMeet(at - box, at + box, -surface.half, surface.half)) return false;
  if (surface.kind == ShapeKind::Distance) return true;
  return visitTriangles(s.shapeTables(), surface, at - box, at + box, [](const SurfaceTriangle&) { return true; });
}

}  // namespace parts

/// found(first, second) for every pair of parts of two bodies that may touch. Without a surface: part of the owner, part of the other. With one:
/// the part that meets it, and the slot.
template <class Found>
RUBBLE_HD void forEachPartPair(const View& s, int owner, int other, Found&& found) {
  if (isPlainPair(s, owner, other)) {
    found(0, 0);
    return;
  }
  const ShapeData &shapeA = s.params[owner].shape, &shapeB = s.params[other].shape;
  const Real margin = pairMargin(s, owner, other, pairLength(s.params[owner], s.params[other]));
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
  const Vec3 between = centreDistance(s, owner, other);
  const bool plane = shapeB.kind == ShapeKind::Plane;
  const Vec3 up = plane ? rotate(s.orientation[other], Vec3{0, 0, 1}) : Vec3{0, 0, 0};
  for (int i = 0; i < ofA; ++i) {
    Vec3 a;
    const Real ra = parts::sphere(s, owner, i, a) + margin;
    for (int k = 0; k < ofB; ++k) {
      Vec3 b;
      const Real reach = ra + parts::sphere(s, other, k, b);
      if (plane ? dot(up, a - between) <= reach : lengthSquared(between + b - a) <= reach * reach) found(i, k);
    }
  }
}

}  // namespace rubble::RUBBLE_CORE
