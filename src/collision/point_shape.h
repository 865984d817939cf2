#pragma once
/// Signed distance and normal of a point against a shape: one function per shape kind, and a dispatch.
#include "collision/gjk.h"
#include "collision/lattice.h"

namespace rubble::RUBBLE_CORE {

/// Signed distance of a point x in the frame of the shape. The closest surface point is x - distance n.
struct PointDistance {
  Vec3 n{0, 0, 1};             ///< outward, unit
  Real distance = Real(1e18);  ///< negative inside [m]
  int part = 0;                ///< part of a compound
};

/// Search range of a point query against a triangle surface, which has no inside.
struct PointReach {
  Real front, behind;  ///< search radius in front and behind [m]
  Vec3 side;           ///< normal with which the surface last held the point, or zero
};

RUBBLE_HD inline PointDistance pointToRound(const ShapeData& s, const Vec3& x) {
  // the axis of a capsule is along z; that of a sphere has length zero
  const Vec3 d{x.x, x.y, x.z - clamp(x.z, -s.half.z, s.half.z)};
  const Real l = length(d);
  return {l > Real(0) ? d / l : Vec3{1, 0, 0}, l - s.radius};
}

/// A box with or without rounding.
RUBBLE_HD inline PointDistance pointToBox(const ShapeData& s, const Vec3& x) {
  const Vec3& h = s.half;
  const Vec3 outside = x - Vec3{clamp(x.x, -h.x, h.x), clamp(x.y, -h.y, h.y), clamp(x.z, -h.z, h.z)};
  const Real l = length(outside);
  if (l > Real(1e-6) * length(h)) return {outside / l, l - s.radius};
  // inside: exit through the nearest face
  int axis = 0;
  for (int i = 1; i < 3; ++i)
    if (std::fabs(x[i]) - h[i] > std::fabs(x[axis]) - h[axis]) axis = i;
  Vec3 n{0, 0, 0};
  n[axis] = x[axis] < Real(0) ? Real(-1) : Real(1);
  return {n, std::fabs(x[axis]) - h[axis] - s.radius};
}

RUBBLE_HD inline PointDistance pointToPlane(const Vec3& x) { return {{0, 0, 1}, x.z}; }

RUBBLE_HD inline PointDistance pointToPrimitive(const ShapeData& s, const Vec3& x) {
  switch (s.kind) {
    case ShapeKind::Sphere:
    case ShapeKind::Capsule:
      return pointToRound(s, x);
    case ShapeKind::Box:
      return pointToBox(s, x);
    default:
      return pointToPlane(x);
  }
}

/// Distance and normal of a solid of revolution in the half plane (radial, axial).
struct FlatDistance {
  Real nAcross, nAlong, distance;
};
/// Distance from the closest point, which is (dAcross, dAlong) away; `line` on or inside the surface.
RUBBLE_HD inline FlatDistance fromFlat(Real dAcross, Real dAlong, const FlatDistance& line, Real size) {
  const Real l = std::sqrt(dAcross * dAcross + dAlong * dAlong);
  if (l > Real(1e-6) * size) return {dAcross / l, dAlong / l, l};
  return line;
}

RUBBLE_HD inline FlatDistance flatToCylinder(const ShapeData& s, Real r, Real z) {
  const Real across = r - s.half.x, along = std::fabs(z) - s.half.z, up = z < Real(0) ? Real(-1) : Real(1);
  const FlatDistance line = across > along ? FlatDistance{1, 0, across} : FlatDistance{0, up, along};
  return fromFlat(max(across, Real(0)), up * max(along, Real(0)), line, s.half.x + s.half.z);
}

RUBBLE_HD inline FlatDistance flatToCone(const ShapeData& s, Real r, Real z) {
  const Real base = -s.half.z / 3, h = s.half.z - base, rim = s.half.x, slant2 = h * h + rim * rim,
             slant = std::sqrt(slant2);
  const Real side = (h * (r - rim) + rim * (z - base)) / slant, below = base - z;
  const FlatDistance line = side > below ? FlatDistance{h / slant, rim / slant, side}
                                         : FlatDistance{0, -1, below};
  if (side <= Real(0) && below <= Real(0)) return line;
  const Real t = clamp((h * (z - base) - rim * (r - rim)) / slant2, Real(0), Real(1));
  const Real baseR = r - min(r, rim), baseZ = z - base, sideR = r - rim * (1 - t), sideZ = z - base - t * h;
  const bool nearBase = baseR * baseR + baseZ * baseZ < sideR * sideR + sideZ * sideZ;
  return fromFlat(nearBase ? baseR : sideR, nearBase ? baseZ : sideZ, line, slant);
}

RUBBLE_HD inline PointDistance pointToRevolved(const ShapeData& s, const Vec3& x) {
  const Real r = std::sqrt(x.x * x.x + x.y * x.y);
  const FlatDistance d = s.kind == ShapeKind::Cone ? flatToCone(s, r, x.z) : flatToCylinder(s, r, x.z);
  const Vec3 out = r > Real(0) ? Vec3{x.x / r, x.y / r, 0} : Vec3{1, 0, 0};
  return {out * d.nAcross + Vec3{0, 0, d.nAlong}, d.distance - s.radius};
}

RUBBLE_HD inline PointDistance pointToHull(const ShapeTables& tables, const ShapeData& s, const Vec3& x) {
  const Convex c = convexOf(tables, s);
  int best = 0;
  Real most = Real(-1e30);
  for (int f = 0; f < c.faceCount; ++f) {
    const Real h = dot(xyz(c.planes[f]), x) - c.planes[f].w;
    if (h > most) most = h, best = f;
  }
  const Vec3 n = xyz(c.planes[best]);
  const PointDistance toFace{n, most - c.radius};
  if (most <= Real(0)) return toFace;
  // outside: does the point project into that face?
  const int begin = c.faces[best], count = c.faces[best + 1] - begin;
  const int* const corners = c.faces + c.faceCount + 1 + begin;
  bool over = true;
  for (int k = 0; k < count && over; ++k) {
    const Vec3 from = xyz(c.vertices[corners[k]]), to = xyz(c.vertices[corners[(k + 1) % count]]);
    over = dot(cross(n, to - from), x - from) >= Real(0);
  }
  const Real size = length(c.half);
  if (over || most < kLeastGap * size) return toFace;
  const Convex point{ShapeKind::Sphere, {0, 0, 0}, 0, nullptr, nullptr, nullptr, 0, 0, {}};
  const Nearest near = provenNearest({c, point, {}, rotationMatrix(Quat{}), x, size}, n);
  return near.distance > Real(0) ? PointDistance{near.n, near.distance - c.radius} : toFace;
}

namespace surface {

/// The point of a triangle closest to the query point.
struct NearTriangle {
  Vec3 at;      ///< closest point relative to the query point
  Vec3 n;       ///< normal of the triangle
  Real height;  ///< height of the query point over its plane [m]
  bool inside;  ///< closest point is not on an edge
  bool rim;     ///< closest point is on a boundary edge
};

RUBBLE_HD inline NearTriangle nearTriangle(const SurfaceTriangle& t, const Vec3& x) {
  const Vec3 a = t.corner[0] - x, b = t.corner[1] - x, c = t.corner[2] - x;
  const Vec3 w = simplices::triangleWeights(a, b, c), n = normalize(cross(b - a, c - a));
  NearTriangle out{a * w.x + b * w.y + c * w.z, n, -dot(n, a),
                   w.x > Real(0) && w.y > Real(0) && w.z > Real(0), false};
  for (int e = 0; e < 3; ++e) {
    const bool onEdge = !(w[(e + 2) % 3] > Real(0));
    if (onEdge && (t.beyond[e] == t.corner[e] || t.beyond[e] == t.corner[(e + 1) % 3])) out.rim = true;
  }
  return out;
}

}  // namespace surface

/// Closest points of two triangles within this share of the reach coincide on a common edge. The triangle
/// that faces the query point most then decides the side.
inline constexpr Real kCommonPoint = Real(1e-4);
/// A triangle whose normal deviates from the last holding normal by more than this cosine is ignored.
inline constexpr Real kFacingAway = Real(-.5);

/// Distance to the closest triangle of a mesh or height field.
RUBBLE_HD inline PointDistance pointToTriangles(const ShapeTables& tables, const ShapeData& s, const Vec3& x,
                                                const PointReach& reach) {
  const bool twoSided = isTwoSided(tables, s), held = reach.side != Vec3{0, 0, 0};
  const Real far = max(reach.front, reach.behind);
  PointDistance best;
  const Real common2 = kCommonPoint * kCommonPoint * far * far;
  Real best2 = far * far, bestHeight = -1;
  Vec3 bestAt{2 * far, 2 * far, 2 * far};
  visitTriangles(tables, s, x - Vec3{far, far, far}, x + Vec3{far, far, far}, [&](const SurfaceTriangle& t) {
    const surface::NearTriangle near = surface::nearTriangle(t, x);
    const Real d2 = dot(near.at, near.at), height = std::fabs(near.height);
    if (!(lengthSquared(near.at - bestAt) <= common2 ? height > bestHeight : d2 < best2)) return false;
    const Real facing = held ? dot(near.n, reach.side) : Real(0);
    const bool turned = twoSided && (held ? facing < Real(0) : near.height < Real(0));
    const Vec3 n = turned ? -near.n : near.n;
    const Real over = turned ? -near.height : near.height, d = std::sqrt(d2);
    if (held && !twoSided && facing < kFacingAway) return false;
    // beyond a boundary edge there is no back side
    if (over < Real(0) && (d > reach.behind || near.rim)) return false;
    best2 = d2, bestHeight = height, bestAt = near.at;
    if (near.inside || !(d > Real(1e-3) * far))
      best = {n, over};
    else
      best = over < Real(0) ? PointDistance{near.at / d, -d} : PointDistance{-near.at / d, d};
    return false;
  });
  return best;
}

/// Any convex shape except a plane.
RUBBLE_HD inline PointDistance pointToConvex(const ShapeTables& tables, const ShapeData& s, const Vec3& x) {
  switch (s.kind) {
    case ShapeKind::RoundBox:
      return pointToBox(s, x);
    case ShapeKind::Cylinder:
    case ShapeKind::Cone:
      return pointToRevolved(s, x);
    case ShapeKind::Hull:
      return pointToHull(tables, s, x);
    default: {
      if (!isAdded(s.kind)) return pointToPrimitive(s, x);
      PointDistance at;
      withAddedShape(s.kind, [&]<class A>() { at.distance = A::distance(s.half, x, at.n) - s.radius; });
      return at;
    }
  }
}

/// Non-primitive shapes. For a compound the part with the smallest signed distance.
RUBBLE_HD RUBBLE_OUT_OF_LINE inline PointDistance pointToGeneralShape(const ShapeTables& tables,
                                                                      const ShapeData& s, const Vec3& x,
                                                                      const PointReach& reach) {
  switch (s.kind) {
    case ShapeKind::Mesh:
    case ShapeKind::HeightField:
      return pointToTriangles(tables, s, x, reach);
    case ShapeKind::Distance: {
      PointDistance at;
      at.distance = latticeDistance(latticeOf(tables, s), x, at.n);
      return at;
    }
    case ShapeKind::Compound:
      break;
    default:
      return pointToConvex(tables, s, x);
  }
  const int* const header = tables.index + s.data;
  PointDistance best;
  for (int k = 0; k < header[3]; ++k) {
    const ShapePart& part = tables.part[header[2] + k];
    if (length(x - part.position) - part.radius > max(best.distance, Real(0))) continue;
    PointDistance at = pointToConvex(tables, part.shape, rotateInverse(part.rotation, x - part.position));
    if (at.distance >= best.distance) continue;
    at.n = rotate(part.rotation, at.n);
    at.part = k;
    best = at;
  }
  return best;
}

}  // namespace rubble::RUBBLE_CORE
