#pragma once
/// Scene queries against a shape of any kind: rays, shape casts, overlaps and closest points. Coordinates are
/// relative to the origin of the query.
#include "collision/sweep.h"

namespace rubble::RUBBLE_CORE {

/// A ray hits at this distance from the surface: of convex shapes relative to their size, of distance fields
/// relative to their spacing [1].
inline constexpr double kRayGap = 1e-7, kFieldRayGap = 1e-4;

namespace probes {

/// A function, because device code cannot refer to a constant of the host.
RUBBLE_HD constexpr SweptMotion still() { return {}; }

RUBBLE_HD inline Convex point() {
  return {ShapeKind::Sphere, {0, 0, 0}, 0, nullptr, nullptr, nullptr, 0, 0, {}};
}

/// Sphere tracing. Interpolated distances are not exact, so an overshoot into the solid is bisected.
RUBBLE_HD inline RayImpact rayToField(const PlacedAny& field, const Vec3d& move) {
  constexpr int kMostSteps = 512, kHalvings = 30;
  constexpr double kSafe = .7;  // outside the lattice the distance is overestimated by up to sqrt(2)
  const DistanceLattice lattice = latticeOf(field.tables, field.shape);
  const Vec3d x = rotateInverse(field.q, -field.p), d = rotateInverse(field.q, move);
  const double speed = length(d), near = kFieldRayGap * static_cast<double>(lattice.spacing);
  Vec3 n;
  const auto distanceAt = [&](double fraction) {
    return static_cast<double>(latticeDistance(lattice, Vec3(x + d * fraction), n));
  };
  double before = 0, fraction = 0;
  for (int step = 0; step < kMostSteps && fraction <= 1; ++step) {
    const double gap = distanceAt(fraction);
    if (gap <= 0 && fraction == 0) return {0, {0, 0, 0}};
    if (gap > near) {
      before = fraction;
      fraction += kSafe * gap / speed;
      continue;
    }
    if (gap < 0) {
      double low = before;
      for (int k = 0; k < kHalvings; ++k) {
        const double middle = (low + fraction) / 2;
        (distanceAt(middle) > 0 ? low : fraction) = middle;
      }
      distanceAt(fraction);
    }
    return {fraction, rotate(field.q, Vec3d(n))};
  }
  return {rays::kNever, {}};
}

/// Closest surface point of a distance field: starts from the closest stored surface point and slides along
/// the surface.
RUBBLE_HD inline Separation nearestOfField(const PlacedAny& field) {
  constexpr int kSteps = 16;
  const DistanceLattice lattice = latticeOf(field.tables, field.shape);
  const Vec3 x(rotateInverse(field.q, -field.p));
  Vec3 n, y{0, 0, 0};
  if (latticeDistance(lattice, x, n) <= Real(0)) return {0, {}, {}, {}};
  Real least = Real(1e30);
  for (int k = 0; k < lattice.pointCount; ++k) {
    const Vec3 point = xyz(lattice.points[k]);
    const Real d2 = lengthSquared(point - x);
    if (d2 < least) least = d2, y = point;
  }
  for (int step = 0; step < kSteps; ++step) {
    latticeDistance(lattice, y, n);
    Vec3 along = (x - y) - n * dot(n, x - y);
    const Real way = length(along);
    if (way > lattice.spacing / 4) along *= lattice.spacing / 4 / way;
    Vec3 next = y + along;
    for (int k = 0; k < 2; ++k) {
      const Real gap = latticeDistance(lattice, next, n);
      next -= n * gap;
    }
    const Real d2 = lengthSquared(next - x);
    if (!(d2 < least)) break;
    least = d2, y = next;
  }
  const Vec3d at = field.p + rotate(field.q, Vec3d(y));
  return {length(at), {}, at, {}};
}

RUBBLE_HD inline Placed triangleOf(const PlacedAny& surface, const SurfaceTriangle& t) {
  return {{ShapeKind::Triangle,
           surface.shape.half,
           0,
           nullptr,
           nullptr,
           nullptr,
           0,
           0,
           {t.corner[0], t.corner[1], t.corner[2]}},
          surface.p,
          surface.q};
}

RUBBLE_HD inline Separation nearestOfTriangles(const PlacedAny& surface, double reach) {
  const Placed own{point(), {}, {}};
  const Vec3d x = rotateInverse(surface.q, -surface.p);
  Separation best{reach, {}, {}, {}};
  bool found = false;
  const auto visit = [&](const SurfaceTriangle& t) {
    const Separation s = separation(own, triangleOf(surface, t));
    if (s.distance < best.distance || (!found && s.distance <= best.distance)) best = s, found = true;
    return false;
  };
  const auto near = [&](const Vec3& low, const Vec3& high) {
    double d2 = 0;
    for (int k = 0; k < 3; ++k) {
      const double out = max(0.0,
                             max(static_cast<double>(low[k]) - x[k], x[k] - static_cast<double>(high[k])));
      d2 += out * out;
    }
    return d2 <= best.distance * best.distance;
  };
  if (surface.shape.kind == ShapeKind::Mesh) {
    surface::visitMesh(surface.tables, surface.shape, near, visit);
  } else {
    // the cell below or above bounds the search radius
    const surface::HeightGrid g = surface::heightGrid(surface.tables, surface.shape);
    const auto column = [&](double a) {
      return surface::cellAt((static_cast<Real>(a) - g.first.x) / g.grid.x, g.nx - 1);
    };
    const auto row = [&](double a) {
      return surface::cellAt((static_cast<Real>(a) - g.first.y) / g.grid.y, g.ny - 1);
    };
    g.visitCell(column(x.x), row(x.y), near, visit);
    const double r = best.distance;
    const int left = column(x.x - r), right = column(x.x + r), front = row(x.y - r), back = row(x.y + r);
    for (int j = front; j <= back; ++j)
      for (int i = left; i <= right; ++i) g.visitCell(i, j, near, visit);
  }
  if (!found) best.distance = kNoImpact * reach + 1;
  return best;
}

}  // namespace probes

/// As castRay() for a shape that is not primitive.
RUBBLE_HD RUBBLE_OUT_OF_LINE inline RayImpact castRayAtGeneral(const PlacedAny& target, const Vec3d& move) {
  RayImpact out{rays::kNever, {}};
  if (isConvex(target.shape.kind)) {
    const double gap = kRayGap * static_cast<double>(boundingRadius(target.shape));
    const TimeOfImpact m = timeOfImpact({probes::point(), {}, {}}, {move, {}}, asConvex(target),
                                        probes::still(), gap);
    out = {m.fraction, m.at.distance > 0 ? -m.at.n : Vec3d{}};
  } else if (target.shape.kind == ShapeKind::Distance) {
    out = probes::rayToField(target, move);
  } else {
    const Vec3d x = rotateInverse(target.q, -target.p), d = rotateInverse(target.q, move);
    const bool twoSided = isTwoSided(target.tables, target.shape);
    double limit = 1;
    visitTrianglesAlong(target.tables, target.shape, x, d, {}, limit, [&](const SurfaceTriangle& t) {
      const RayImpact m = rays::triangle(x, d, Vec3d(t.corner[0]), Vec3d(t.corner[1]), Vec3d(t.corner[2]),
                                         twoSided);
      if (m.fraction > limit || (m.fraction == limit && out.fraction <= 1)) return;
      out = {m.fraction, rotate(target.q, m.n), t.index};
      limit = m.fraction;
    });
  }
  if (out.fraction <= 1 && out.n == Vec3d{}) out.n = normalize(-move);
  return out;
}
/// Casts a ray from the origin along `move`. One-sided surfaces are hit from their front only.
RUBBLE_HD inline RayImpact castRay(const PlacedAny& target, const Vec3d& move) {
  return isPrimitive(target.shape.kind) ? castRay(asConvex(target), {}, move)
                                        : castRayAtGeneral(target, move);
}

/// Casts a convex shape along `move`; the result is within `tolerance` of the target. The normal points out
/// of the target.
RUBBLE_HD RUBBLE_OUT_OF_LINE inline TimeOfImpact castShape(const PlacedAny& own, const Vec3d& move,
                                                           const PlacedAny& target, double tolerance) {
  const auto all = [](const Vec3d&, const TimeOfImpact&) { return true; };
  const SweptMotion motion{move, {}};
  if (target.shape.kind == ShapeKind::Distance)
    return timeOfImpactWithField(target, probes::still(), own, motion, {tolerance}, all);
  if (isSurface(target.shape.kind)) {
    const Placed part = asConvex(own);
    const auto meet = [&](const Placed& triangle, const Vec3d&) {
      return timeOfImpact(triangle, probes::still(), part, motion, tolerance);
    };
    return timeOfImpactWithTriangles(target, probes::still(), part, motion, {tolerance}, meet);
  }
  return timeOfImpact(asConvex(target), probes::still(), asConvex(own), motion, tolerance);
}

/// Does a convex shape overlap another? For meshes and height fields only the surface counts.
RUBBLE_HD RUBBLE_OUT_OF_LINE inline bool overlaps(const PlacedAny& own, const PlacedAny& target) {
  const Placed part = asConvex(own);
  if (target.shape.kind == ShapeKind::Distance) return fieldSeparation(target, own).distance <= 0;
  if (!isSurface(target.shape.kind)) return separation(part, asConvex(target)).distance <= 0;
  const Vec3 x(rotateInverse(target.q, part.p - target.p)),
      half = boundingHalf(own.shape, Quat(conjugate(target.q) * part.q));
  return visitTriangles(target.tables, target.shape, x - half, x + half, [&](const SurfaceTriangle& t) {
    return separation(part, probes::triangleOf(target, t)).distance <= 0;
  });
}

/// From the origin to the closest point of a shape. If that is beyond `reach`, the distance is any value
/// above it.
RUBBLE_HD RUBBLE_OUT_OF_LINE inline Separation nearestPoint(const PlacedAny& target, double reach) {
  if (target.shape.kind == ShapeKind::Distance) return probes::nearestOfField(target);
  if (isSurface(target.shape.kind)) return probes::nearestOfTriangles(target, reach);
  return separation({probes::point(), {}, {}}, asConvex(target));
}

}  // namespace rubble::RUBBLE_CORE
