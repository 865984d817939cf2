#pragma once
/// Time of impact of moving shapes of any kind. Convex shapes: conservative advancement (distance.h). Meshes
/// and height fields: the triangles along the path. Distance fields: conservative advancement by the field.
#include "collision/distance.h"
#include "collision/lattice.h"
#include "collision/parts.h"
#include "collision/ray.h"

namespace rubble::RUBBLE_CORE {

/// A non-compound shape or a part of a compound, at a pose.
struct PlacedAny {
  ShapeTables tables;
  ShapeData shape;
  Vec3d p;  ///< its center [m]
  Quatd q;
  Vec3d arm{};  ///< its center relative to that of the rotating body [m]
};
/// Part `part` of a body whose center is p.
RUBBLE_HD inline PlacedAny placedAny(const ShapeTables& tables, const ShapeData& shape, const Vec3d& p,
                                     const Quat& q, int part) {
  const PlacedPart x = placedPart(tables, shape, q, part);
  return {tables, x.shape, p + Vec3d(x.at), Quatd(x.q), Vec3d(x.at)};
}
RUBBLE_HD inline Placed asConvex(const PlacedAny& s) {
  return {convexOf(s.tables, s.shape), s.p, s.q, s.arm};
}

/// When a contact with a surface counts as an impact: at a distance of `tolerance`. With `passing` the shape
/// must also penetrate deeper than `held`, or, for a distance field and a convex shape, one must contain the
/// center of the other.
struct ImpactRule {
  double tolerance;  ///< [m]
  bool passing = false;
  double held = 0;  ///< [m]
};

/// 1 / d by component; 0 where d is nothing.
RUBBLE_HD inline Vec3d inverseOf(const Vec3d& d) {
  constexpr double kNothing = 1e-290;  // its inverse is finite
  const auto of = [](double a) { return std::fabs(a) > kNothing ? 1 / a : 0.0; };
  return {of(d.x), of(d.y), of(d.z)};
}
/// Does a box of half extents `reach` about x + t d contain the origin for some t in [0, limit]? `inverse`:
/// that of d.
RUBBLE_HD inline bool passes(const Vec3d& x, const Vec3d& inverse, const Vec3d& reach, double limit) {
  double in = 0, out = limit;
  for (int k = 0; k < 3; ++k) {
    if (inverse[k] == 0) {
      if (std::fabs(x[k]) > reach[k]) return false;
      continue;
    }
    const double a = (-reach[k] - x[k]) * inverse[k], b = (reach[k] - x[k]) * inverse[k];
    in = max(in, min(a, b)), out = min(out, max(a, b));
  }
  return in <= out;
}

/// Calls visit(triangle) for the triangles of a mesh or height field that a box of half extents `half` may
/// touch on its path x + t d, t in [0, limit]. Frame of the surface. The visitor may lower `limit` after a
/// hit.
template <class Visit>
RUBBLE_HD void visitTrianglesAlong(const ShapeTables& tables, const ShapeData& s, const Vec3d& x,
                                   const Vec3d& d, const Vec3d& half, const double& limit, Visit&& visit) {
  const Vec3d inverse = inverseOf(d);
  const auto meets = [&](const Vec3& low, const Vec3& high) {
    const Vec3d l(low), h(high);
    return passes(x - (l + h) * .5, inverse, half + (h - l) * .5, limit);
  };
  const auto all = [&](const SurfaceTriangle& t) {
    visit(t);
    return false;
  };
  if (s.kind == ShapeKind::Mesh) {
    surface::visitMesh(tables, s, meets, all);
    return;
  }
  const surface::HeightGrid g = surface::heightGrid(tables, s);
  // row by row from the start of the path; within a row the cells that it crosses
  const auto cell = [](double a, double first, double spacing, int cells) {
    return static_cast<int>(clamp(std::floor((a - first) / spacing), 0.0, static_cast<double>(cells - 1)));
  };
  const double firstX = static_cast<double>(g.first.x), firstY = static_cast<double>(g.first.y);
  const double stepX = static_cast<double>(g.grid.x), stepY = static_cast<double>(g.grid.y);
  const double endY = x.y + limit * d.y;
  const int low = cell(min(x.y, endY) - half.y, firstY, stepY, g.ny - 1),
            high = cell(max(x.y, endY) + half.y, firstY, stepY, g.ny - 1);
  for (int n = 0; n <= high - low; ++n) {
    const int j = d.y >= 0 ? low + n : high - n;
    double t0 = 0, t1 = limit;
    if (d.y != 0) {
      const double a = (firstY + j * stepY - half.y - x.y) / d.y,
                   b = (firstY + (j + 1) * stepY + half.y - x.y) / d.y;
      t0 = max(t0, min(a, b)), t1 = min(t1, max(a, b));
      if (t0 > t1) continue;
    }
    const double x0 = x.x + t0 * d.x, x1 = x.x + t1 * d.x;
    const int from = cell(min(x0, x1) - half.x, firstX, stepX, g.nx - 1),
              to = cell(max(x0, x1) + half.x, firstX, stepX, g.nx - 1);
    for (int i = from; i <= to; ++i) g.visitCell(i, j, meets, all);
  }
}

/// Time of impact of a mesh or height field (A) with a convex part. Back faces of one-sided triangles are
/// ignored. meet(triangle, face normal toward the part) returns the time of impact with one triangle.
template <class Meet>
RUBBLE_HD TimeOfImpact timeOfImpactWithTriangles(const PlacedAny& surface, const SweptMotion& motionS,
                                                 const Placed& part, const SweptMotion& motionP,
                                                 const ImpactRule& rule, Meet&& meet) {
  const Vec3d move = wayUntil(motionP, 1) - wayUntil(motionS, 1);
  const Vec3d x = rotateInverse(surface.q, part.p - surface.p), d = rotateInverse(surface.q, move);
  const double turns = length(motionS.turn) *
                       (length(x) + length(d));  // bounds the path of the part by this rotation
  const double reach = length(Vec3d(part.shape.half)) + part.radius() + rule.tolerance + turns +
                       length(motionP.turn) * length(part.arm);
  const Placed end = movedBy(part, {move, motionP.turn * motionP.until}, 1);
  const bool twoSided = isTwoSided(surface.tables, surface.shape);
  Placed triangle{{ShapeKind::Triangle, surface.shape.half, 0, nullptr, nullptr, nullptr, 0, 0, {}},
                  surface.p,
                  surface.q};
  TimeOfImpact best{kNoImpact, {}};
  double limit = 1;
  visitTrianglesAlong(
      surface.tables, surface.shape, x, d, {reach, reach, reach}, limit, [&](const SurfaceTriangle& t) {
        const Vec3d a(t.corner[0]), b(t.corner[1]), c(t.corner[2]);
        Vec3d n = normalize(cross(b - a, c - a));
        if (dot(n, x - a) <= 0) {
          if (!twoSided) return;
          n = -n;
        }
        const Vec3d up = rotate(surface.q, n), corner = surface.p + rotate(surface.q, a);
        const double slack = turns + part.radius() + (rule.passing ? -rule.held : rule.tolerance);
        const bool above = dot(up, gjk::support(end, -up) - corner) > slack;
        if (above && (rule.passing || dot(up, gjk::support(part, -up) - corner) > slack)) return;
        for (int k = 0; k < 3; ++k) triangle.shape.corner[k] = t.corner[k];
        const TimeOfImpact m = meet(triangle, up);
        if (m.fraction > limit || (m.fraction == limit && best.fraction <= 1)) return;
        best = m;
        limit = m.fraction;
      });
  return best;
}

/// Time of impact of the surface points of a distance field (A) with a mesh or height field.
template <class Accepts>
RUBBLE_HD TimeOfImpact timeOfImpactWithFieldTriangles(const PlacedAny& field, const SweptMotion& motionF,
                                                      const PlacedAny& surface, const SweptMotion& motionS,
                                                      const ImpactRule& rule, Accepts&& accepts) {
  const DistanceLattice lattice = latticeOf(field.tables, field.shape);
  const bool twoSided = isTwoSided(surface.tables, surface.shape);
  const Quatd turnF = turnOf(motionF.turn * motionF.until), turnS = turnOf(motionS.turn * motionS.until);
  TimeOfImpact best{kNoImpact, {}};
  double limit = 1;
  for (int k = 0; k < lattice.pointCount; ++k) {
    const Vec3d lever = rotate(field.q, Vec3d(xyz(lattice.points[k])));
    const Vec3d from = rotateInverse(surface.q, field.p + lever - surface.p);
    const Vec3d end = field.p + wayUntil(motionF, 1) + rotate(turnF, lever);
    const Vec3d to = rotateInverse(turnS * surface.q, end - surface.p - wayUntil(motionS, 1));
    visitTrianglesAlong(surface.tables, surface.shape, from, to - from, {}, limit,
                        [&](const SurfaceTriangle& t) {
                          const Vec3d a(t.corner[0]);
                          const RayImpact r = rays::triangle(from, to - from, a, Vec3d(t.corner[1]),
                                                             Vec3d(t.corner[2]), twoSided);
                          if (r.fraction > limit || (r.fraction == limit && best.fraction <= 1)) return;
                          if (rule.passing && dot(r.n, to - a) > -rule.held) return;
                          const Vec3d n = -rotate(surface.q, r.n), at = field.p + lever;
                          const TimeOfImpact m{r.fraction, {0, at, at, n}};
                          if (!accepts(n, m)) return;
                          best = m;
                          limit = r.fraction;
                        });
  }
  return best;
}

/// Smallest distance of a distance field (A) to a convex shape, a plane or another field, and its closest
/// points.
RUBBLE_HD inline Separation fieldSeparation(const PlacedAny& field, const PlacedAny& other) {
  const Real sizeF = boundingRadius(field.shape), sizeO = boundingRadius(other.shape);
  const Vec3d between = other.p - field.p;
  Separation out{length(between) - static_cast<double>(sizeF + sizeO), field.p, other.p, normalize(between)};
  // far apart the distance of the bounding spheres suffices
  if (other.shape.kind != ShapeKind::Plane && out.distance > .25 * static_cast<double>(sizeF + sizeO))
    return out;
  const Vec3 at(rotateInverse(field.q, between));
  const Quat q(conjugate(field.q) * other.q);
  Real margin = Real(1e30);
  visitGaps(field.tables, field.shape, other.tables, other.shape, at, q,
            2 * (sizeO > Real(0) ? min(sizeF, sizeO) : sizeF), margin,
            [&](const Vec3& n, const Vec3& onSurface, Real gap, int) {
              if (gap >= margin) return;
              margin = gap;
              out.distance = static_cast<double>(gap);
              out.n = rotate(field.q, Vec3d(n));
              out.onA = field.p + rotate(field.q, Vec3d(onSurface));
              out.onB = out.onA + out.n * out.distance;
            });
  return out;
}

/// Time of impact of a distance field (A) with a shape of any kind. A contact that is not accepted as an
/// impact is stepped over by half a spacing.
template <class Accepts>
RUBBLE_HD TimeOfImpact timeOfImpactWithField(const PlacedAny& field, const SweptMotion& motionF,
                                             const PlacedAny& other, const SweptMotion& motionO,
                                             const ImpactRule& rule, Accepts&& accepts) {
  if (other.shape.kind == ShapeKind::Mesh || other.shape.kind == ShapeKind::HeightField)
    return timeOfImpactWithFieldTriangles(field, motionF, other, motionO, rule, accepts);
  constexpr int kMostSteps = 128;
  const double speed = max(length(motionF.move - motionO.move),
                           max(max(length(motionF.after - motionO.move),
                                   length(motionF.move - motionO.after)),
                               length(motionF.after - motionO.after)) *
                               (motionF.until < 1 || motionO.until < 1)) +
                       length(motionF.turn) * static_cast<double>(boundingRadius(field.shape)) +
                       length(motionO.turn) *
                           (static_cast<double>(boundingRadius(other.shape)) + length(other.arm));
  const DistanceLattice lattice = latticeOf(field.tables, field.shape);
  const double detail = static_cast<double>(lattice.spacing) / 2;
  const auto entered = [&](const PlacedAny& f, const PlacedAny& o, double distance) {
    if (!isConvex(o.shape.kind)) return distance < -rule.held;
    Vec3 n;
    return latticeDistance(lattice, Vec3(rotateInverse(f.q, o.p - f.p)), n) < Real(0) ||
           distanceTo(convexOf(o.tables, o.shape), Vec3(rotateInverse(o.q, f.p - o.p))) < Real(0);
  };
  const auto moved = [](const PlacedAny& s, const SweptMotion& motion, double fraction) {
    const Placed m = movedBy({{}, s.p, s.q, s.arm}, motion, fraction);
    return PlacedAny{s.tables, s.shape, m.p, m.q, m.arm};
  };
  TimeOfImpact m{0, {}}, first{kNoImpact, {}};
  for (int step = 0; step < kMostSteps; ++step) {
    const PlacedAny f = moved(field, motionF, m.fraction), o = moved(other, motionO, m.fraction);
    m.at = fieldSeparation(f, o);
    const bool touches = m.at.distance <= rule.tolerance;
    if (!touches)
      first.fraction = kNoImpact;
    else if (first.fraction > 1 && accepts(m.at.n, m))
      first = m;
    if (first.fraction <= 1 && (!rule.passing || entered(f, o, m.at.distance))) return first;
    if (!(speed > 0) || m.fraction >= 1) return {kNoImpact, m.at};
    m.fraction = min(1.0, m.fraction + (touches ? detail : m.at.distance - rule.tolerance / 2) / speed);
  }
  // step limit while in contact: counts as an impact, so that nothing passes through
  return rule.passing ? m : TimeOfImpact{kNoImpact, m.at};
}

namespace sweep {

RUBBLE_HD inline Real innerRadiusOfPart(const ShapeTables& tables, const ShapeData& s) {
  switch (s.kind) {
    case ShapeKind::RoundBox:
      return min(s.half.x, min(s.half.y, s.half.z)) + s.radius;
    case ShapeKind::Cylinder:
      return min(s.half.x, s.half.z) + s.radius;
    case ShapeKind::Cone: {
      // insphere, which touches base and side
      const Real r = s.half.x, h = s.half.z * 4 / 3;
      return r * h / (r + std::sqrt(r * r + h * h));
    }
    case ShapeKind::Hull: {
      const Convex c = convexOf(tables, s);
      Real least = Real(1e18);
      for (int f = 0; f < c.faceCount; ++f) least = min(least, c.planes[f].w);
      return least + s.radius;
    }
    case ShapeKind::Distance:
      return latticeOf(tables, s).spacing / 2;
    case ShapeKind::Mesh:
    case ShapeKind::HeightField:
      return 0;
    default: {
      Real radius = innerRadius(s);
      withAddedShape(s.kind, [&]<class A>() { radius = A::innerRadius(s.half) + s.radius; });
      return radius;
    }
  }
}

RUBBLE_HD RUBBLE_OUT_OF_LINE inline Real generalInnerRadius(const ShapeTables& tables, const ShapeData& s) {
  if (s.kind != ShapeKind::Compound) return innerRadiusOfPart(tables, s);
  const int first = tables.index[s.data + 2], count = tables.index[s.data + 3];
  Real least = Real(1e18);
  for (int k = first; k < first + count; ++k)
    least = min(least, innerRadiusOfPart(tables, tables.part[k].shape));
  return least;
}

}  // namespace sweep

/// Half of the smallest thickness of any shape; for a compound that of its thinnest part, for surfaces 0. [m]
RUBBLE_HD inline Real innerRadiusOf(const ShapeTables& tables, const ShapeData& s) {
  return isPrimitive(s.kind) ? innerRadius(s) : sweep::generalInnerRadius(tables, s);
}

/// The smaller inner radius of two shapes. Planes and surfaces have none and do not count. [m]
RUBBLE_HD inline Real thinner(Real a, Real b) { return a > Real(0) && b > Real(0) ? min(a, b) : max(a, b); }

}  // namespace rubble::RUBBLE_CORE
