#pragma once
/// Solids given by a signed distance field on a lattice. Contacts are its surface points against the other
/// shape, and corners of the other shape against the field.
///   vectors: (first sample, spacing) and the rotation lattice -> body (x, y, z, w), then samples, four per
///   vector, x fastest, then surface points
#include "collision/surface_contacts.h"

namespace rubble::RUBBLE_CORE {

/// Depth below a triangle surface up to which a point is still pushed out, over L [1].
inline constexpr Real kHeldFromBelow = Real(.1);

/// A signed distance field in the frame of its body.
struct DistanceLattice {
  Vec3 first;
  Real spacing;
  Quat turn;
  const Vec4* samples;
  const Vec4* points;
  int nx, ny, nz, pointCount;
};

RUBBLE_HD inline DistanceLattice latticeOf(const ShapeTables& tables, const ShapeData& s) {
  const int* const h = tables.index + s.data;
  const Vec4* const v = tables.vector + h[0];
  DistanceLattice l{xyz(v[0]), v[0].w, Quat{v[1].w, {v[1].x, v[1].y, v[1].z}}, v + 2, nullptr, h[2], h[3],
                    h[4],      h[5]};
  l.points = l.samples + (l.nx * l.ny * l.nz + 3) / 4;
  return l;
}

RUBBLE_HD inline Real sampleAt(const DistanceLattice& l, int i) {
  const Vec4 four = l.samples[i / 4];
  return (i & 3) == 0 ? four.x : (i & 3) == 1 ? four.y : (i & 3) == 2 ? four.z : four.w;
}

/// Distance and outward normal at x, body frame. Outside the lattice the distance to its boundary is added.
RUBBLE_HD inline Real latticeDistance(const DistanceLattice& l, const Vec3& x, Vec3& normal) {
  const Vec3 local = rotateInverse(l.turn, x - l.first) / l.spacing;
  const int counts[3] = {l.nx, l.ny, l.nz};
  int cell[3];
  Vec3 t, inside;
  for (int k = 0; k < 3; ++k) {
    inside[k] = clamp(local[k], Real(0), Real(counts[k] - 1));
    cell[k] = min(static_cast<int>(inside[k]), counts[k] - 2);
    t[k] = inside[k] - Real(cell[k]);
  }
  const int base = (cell[2] * l.ny + cell[1]) * l.nx + cell[0], dy = l.nx, dz = l.nx * l.ny;
  const Real c000 = sampleAt(l, base), c100 = sampleAt(l, base + 1), c010 = sampleAt(l, base + dy),
             c110 = sampleAt(l, base + dy + 1);
  const Real c001 = sampleAt(l, base + dz), c101 = sampleAt(l, base + dz + 1),
             c011 = sampleAt(l, base + dz + dy), c111 = sampleAt(l, base + dz + dy + 1);
  const auto mix = [](Real a, Real b, Real s) { return a + (b - a) * s; };
  const Real x00 = mix(c000, c100, t.x), x10 = mix(c010, c110, t.x), x01 = mix(c001, c101, t.x),
             x11 = mix(c011, c111, t.x);
  const Real y0 = mix(x00, x10, t.y), y1 = mix(x01, x11, t.y);
  Vec3 g;
  g.x = mix(mix(c100 - c000, c110 - c010, t.y), mix(c101 - c001, c111 - c011, t.y), t.z);
  g.y = mix(x10 - x00, x11 - x01, t.z);
  g.z = y1 - y0;
  const Vec3 beyond = local - inside;
  const Real away = length(beyond) * l.spacing;
  normal = rotate(l.turn, away > Real(0) ? normalize(beyond) : normalize(g));
  return mix(y0, y1, t.z) + away;
}

/// Signed distance of a point to a convex shape, in its frame. A lower bound for hulls and cones outside
/// edges.
RUBBLE_HD inline Real distanceTo(const Convex& c, const Vec3& x) {
  switch (c.kind) {
    case ShapeKind::Capsule:
      return length(x - Vec3{0, 0, clamp(x.z, -c.half.z, c.half.z)}) - c.radius;
    case ShapeKind::Box:
    case ShapeKind::RoundBox: {
      const Vec3 d = abs(x) - c.half;
      const Vec3 out{max(d.x, Real(0)), max(d.y, Real(0)), max(d.z, Real(0))};
      return length(out) + min(max(d.x, max(d.y, d.z)), Real(0)) - c.radius;
    }
    case ShapeKind::Cylinder: {
      const Real across = std::sqrt(x.x * x.x + x.y * x.y) - c.half.x, along = std::fabs(x.z) - c.half.z;
      const Real a = max(across, Real(0)), b = max(along, Real(0));
      return std::sqrt(a * a + b * b) + min(max(across, along), Real(0)) - c.radius;
    }
    case ShapeKind::Cone: {
      // the side is a line in the half plane (r, z)
      const Real r = std::sqrt(x.x * x.x + x.y * x.y), base = convex::coneBase(c), h = c.half.z - base;
      const Real side = (h * (r - c.half.x) + c.half.x * (x.z - base)) /
                        std::sqrt(h * h + c.half.x * c.half.x);
      return max(side, base - x.z) - c.radius;
    }
    case ShapeKind::Hull: {
      Real most = Real(-1e30);
      for (int f = 0; f < c.faceCount; ++f) most = max(most, dot(xyz(c.planes[f]), x) - c.planes[f].w);
      return most - c.radius;
    }
    default: {
      Real distance = length(x);
      [[maybe_unused]] Vec3 n;
      withAddedShape(c.kind, [&]<class A>() { distance = A::distance(c.half, x, n); });
      return distance - c.radius;
    }
  }
}

/// Unit gradient of the distance by central differences with step h.
RUBBLE_HD inline Vec3 normalTo(const Convex& c, const Vec3& x, Real h) {
  Vec3 g;
  for (int k = 0; k < 3; ++k) {
    Vec3 d{0, 0, 0};
    d[k] = h;
    g[k] = distanceTo(c, x + d) - distanceTo(c, x - d);
  }
  return normalize(g);
}

namespace distance {

/// Corners with which a convex core touches a concave surface.
template <class Visit> RUBBLE_HD void visitCorners(const Convex& c, Visit&& visit) {
  switch (c.kind) {
    case ShapeKind::Capsule:
      for (int k = -2; k <= 2; ++k) visit(Vec3{0, 0, c.half.z * Real(k) / 2}, 2 + k);
      return;
    case ShapeKind::Box:
    case ShapeKind::RoundBox:
      for (int k = 0; k < 8; ++k)
        visit(Vec3{(k & 1) ? c.half.x : -c.half.x, (k & 2) ? c.half.y : -c.half.y,
                   (k & 4) ? c.half.z : -c.half.z},
              k);
      return;
    case ShapeKind::Cylinder:
    case ShapeKind::Cone: {
      Feature f;
      faceFeature(c, 0, {0, 0, 1}, {0, 0, 0}, f);
      for (int k = 0; k < f.count; ++k) visit(f.corner[k], f.id[k]);
      if (c.kind == ShapeKind::Cone) {
        visit(Vec3{0, 0, c.half.z}, 32);
        return;
      }
      for (int k = 0; k < f.count; ++k)
        visit(Vec3{f.corner[k].x, f.corner[k].y, -f.corner[k].z}, 16 + f.id[k]);
      return;
    }
    case ShapeKind::Hull:
      for (int k = 0; k < c.vertexCount; ++k) visit(xyz(c.vertices[k]), k);
      return;
    default:
      if (!isAdded(c.kind)) return visit(Vec3{0, 0, 0}, 0);
      for (int k = 0; k < kAddedCorners; ++k) visit(support(c, addedDirection(k)), k);
  }
}

}  // namespace distance

/// Calls found(n, onSurface, gap, feature) wherever another shape is within `margin` of a distance field.
/// Frame of the field; the other shape has center `at` and rotation q. n points from the field to the other
/// shape; points are relative to the center of the field. The callback may lower `margin`.
template <class Found>
RUBBLE_HD void visitGaps(const ShapeTables& tables, const ShapeData& s, const ShapeTables& otherTables,
                         const ShapeData& other, const Vec3& at, const Quat& q, Real length,
                         const Real& margin, Found&& found) {
  const DistanceLattice lattice = latticeOf(tables, s);
  constexpr int kOfPoint = 0x4000;
  if (other.kind == ShapeKind::Plane) {
    const Vec3 up = rotate(q, Vec3{0, 0, 1});
    for (int k = 0; k < lattice.pointCount; ++k) {
      const Vec3 x = xyz(lattice.points[k]);
      const Real gap = dot(up, x - at);
      if (gap <= margin) found(-up, x, gap, kOfPoint + k);
    }
    return;
  }
  if (other.kind == ShapeKind::Distance) {
    const DistanceLattice second = latticeOf(otherTables, other);
    Vec3 n;
    for (int k = 0; k < lattice.pointCount; ++k) {
      const Vec3 x = xyz(lattice.points[k]);
      const Real gap = latticeDistance(second, rotateInverse(q, x - at), n);
      if (gap <= margin) found(-rotate(q, n), x, gap, kOfPoint + k);
    }
    for (int k = 0; k < second.pointCount; ++k) {
      const Vec3 x = at + rotate(q, xyz(second.points[k]));
      const Real gap = latticeDistance(lattice, x, n);
      if (gap <= margin) found(n, x - n * gap, gap, 2 * kOfPoint + k);
    }
    return;
  }
  if (other.kind == ShapeKind::Mesh || other.kind == ShapeKind::HeightField) {
    const Real depth = max(margin, kHeldFromBelow * length);
    const Vec3 reach{depth, depth, depth};
    const bool twoSided = isTwoSided(otherTables, other);
    for (int k = 0; k < lattice.pointCount; ++k) {
      const Vec3 x = xyz(lattice.points[k]), inOther = rotateInverse(q, x - at),
                 center = rotateInverse(q, -at);
      visitTriangles(otherTables, other, inOther - reach, inOther + reach, [&](const SurfaceTriangle& t) {
        Vec3 n = normalize(cross(t.corner[1] - t.corner[0], t.corner[2] - t.corner[0]));
        // only if the point projects into the triangle
        for (int e = 0; e < 3; ++e)
          if (dot(cross(n, t.corner[(e + 1) % 3] - t.corner[e]), inOther - t.corner[e]) < Real(0))
            return false;
        if (dot(n, center - t.corner[0]) < Real(0)) {
          if (!twoSided) return false;
          n = -n;
        }
        const Real gap = dot(n, inOther - t.corner[0]);
        if (gap <= margin && gap >= -depth) found(-rotate(q, n), x, gap, kOfPoint + k);
        return false;
      });
    }
    return;
  }
  const Convex convexOther = convexOf(otherTables, other);
  const Real h = Real(1e-3) * length;
  for (int k = 0; k < lattice.pointCount; ++k) {
    const Vec3 x = xyz(lattice.points[k]), local = rotateInverse(q, x - at);
    const Real gap = distanceTo(convexOther, local);
    if (gap <= margin) found(-rotate(q, normalTo(convexOther, local, h)), x, gap, kOfPoint + k);
  }
  distance::visitCorners(convexOther, [&](const Vec3& corner, int id) {
    const Vec3 x = at + rotate(q, corner);
    Vec3 n;
    const Real toCore = latticeDistance(lattice, x, n), gap = toCore - convexOther.radius;
    if (gap <= margin) found(n, x - n * toCore, gap, id);
  });
}

/// Contacts of a distance field and another shape.
RUBBLE_HD inline void collideDistance(const ShapeTables& tables, const ShapeData& s, const ShapeData& other,
                                      const Vec3& at, const Quat& q, Real margin, SurfaceContacts& out) {
  visitGaps(tables, s, tables, other, at, q, out.length, margin,
            [&](const Vec3& n, const Vec3& onSurface, Real gap, int feature) {
              addSurfacePoint(out, n, onSurface, gap, feature);
            });
}

}  // namespace rubble::RUBBLE_CORE
