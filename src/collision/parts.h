#pragma once
/// Narrow phase of two convex parts of any kind.
#include "collision/collide.h"
#include "collision/convex_plane.h"

namespace rubble::RUBBLE_CORE {

/// A part of a body, in world axes.
struct PlacedPart {
  ShapeData shape;
  Quat q;
  Vec3 at;  ///< its center relative to that of its body, world axes [m]
};

/// Part `part` of a body; a shape that is not a compound is its only part.
RUBBLE_HD inline PlacedPart placedPart(const ShapeTables& tables, const ShapeData& shape, const Quat& q,
                                       int part) {
  if (shape.kind != ShapeKind::Compound) return {shape, q, {0, 0, 0}};
  const ShapePart& p = tables.part[tables.index[shape.data + 2] + part];
  return {p.shape, q * p.rotation, rotate(q, p.position)};
}

/// Contact points of two parts, relative to the center of A's body. `t` = p_B - p_A of the bodies; `down`:
/// unit, along gravity, or zero.
RUBBLE_HD inline RawManifold collideParts(const ShapeTables& tables, const PlacedPart& a, const PlacedPart& b,
                                          const Vec3& t, Real margin, Real length,
                                          const Vec3& down = {0, 0, 0}) {
  const Vec3 between = t + b.at - a.at;
  const Weight weight{-a.at, t - a.at, down};
  RawManifold m;
  if (isPrimitive(a.shape.kind) && isPrimitive(b.shape.kind)) {
    m = collide(a.shape, a.q, b.shape, b.q, between, margin, length);
  } else if (b.shape.kind == ShapeKind::Plane) {
    m = collideConvexPlane(convexOf(tables, a.shape), a.q, b.q, between, margin, length, weight);
  } else if (a.shape.kind == ShapeKind::Plane) {
    m = flipped(collideConvexPlane(convexOf(tables, b.shape), b.q, a.q, -between, margin, length,
                                   {-b.at, -t - b.at, down}),
                between);
  } else {
    m = collideConvex(convexOf(tables, a.shape), a.q, convexOf(tables, b.shape), b.q, between, margin, length,
                      weight);
  }
  for (int k = 0; k < m.count; ++k) m.points[k].onA += a.at, m.points[k].onB += a.at;
  return m;
}

}  // namespace rubble::RUBBLE_CORE
