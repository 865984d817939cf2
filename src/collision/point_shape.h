#pragma once
/// A point against a shape: signed distance and direction. One function a shape and one dispatch.
#include "collision/shapes.h"

namespace rubble::RUBBLE_CORE {

/// Of a point x in the frame of the shape: the nearest point of the surface is x - distance n.
struct PointDistance {
  Vec3 n;         ///< outward, unit
  Real distance;  ///< negative inside [m]
};

RUBBLE_HD inline PointDistance pointToRound(const ShapeData& s, const Vec3& x) {
  // a capsule's axis lies along z; a sphere's has no length
  const Vec3 d{x.x, x.y, x.z - clamp(x.z, -s.half.z, s.half.z)};
  const Real l = length(d);
  return {l > Real(0) ? d / l : Vec3{1, 0, 0}, l - s.radius};
}

RUBBLE_HD inline PointDistance pointToBox(const ShapeData& s, const Vec3& x) {
  const Vec3& h = s.half;
  const Vec3 outside = x - Vec3{clamp(x.x, -h.x, h.x), clamp(x.y, -h.y, h.y), clamp(x.z, -h.z, h.z)};
  const Real l = length(outside);
  if (l > Real(1e-6) * length(h)) return {outside / l, l};
  // inside: out through the nearest face
  int axis = 0;
  for (int i = 1; i < 3; ++i)
    if (std::fabs(x[i]) - h[i] > std::fabs(x[axis]) - h[axis]) axis = i;
  Vec3 n{0, 0, 0};
  n[axis] = x[axis] < Real(0) ? Real(-1) : Real(1);
  return {n, std::fabs(x[axis]) - h[axis]};
}

RUBBLE_HD inline PointDistance pointToPlane(const Vec3& x) { return {{0, 0, 1}, x.z}; }

RUBBLE_HD inline PointDistance pointToShape(const ShapeData& s, const Vec3& x) {
  switch (s.kind) {
    case ShapeKind::Sphere:
    case ShapeKind::Capsule: return pointToRound(s, x);
    case ShapeKind::Box: return pointToBox(s, x);
    case ShapeKind::Plane: break;
  }
  return pointToPlane(x);
}

}  // namespace rubble::RUBBLE_CORE
