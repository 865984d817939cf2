#pragma once
/// Distances to bodies that share no code with the engine: every shape as convex pieces, each by projection
/// in closed form or over all faces.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <vector>

#include "tests/support/random.h"
#include "tests/support/scenes.h"

namespace rubble::test {

/// A convex solid, a half space or a triangle in the world.
struct Piece {
  Shape shape;     ///< a mesh: the triangle of `corner`
  Vec3 corner[3];  ///< in the frame
  Vec3 position;
  Quat orientation;
  double reach;  ///< it lies within this distance of `position` [m]
};

/// A point of a piece, and how far it is; of a point inside the distance is not positive.
struct Near {
  Vec3 point;
  double distance;
};

inline Vec3 nearestOnSegment(const Vec3& a, const Vec3& b, const Vec3& y) {
  const double t = dot(y - a, b - a) / lengthSquared(b - a);
  return a + std::clamp(t, 0., 1.) * (b - a);
}

inline Vec3 nearestOnTriangle(const Vec3* c, const Vec3& y) {
  const Vec3 n = normalize(cross(c[1] - c[0], c[2] - c[0])), foot = y - dot(n, y - c[0]) * n;
  bool inside = true;
  for (int k = 0; k < 3; ++k) inside = inside && dot(cross(c[(k + 1) % 3] - c[k], foot - c[k]), n) >= 0;
  if (inside) return foot;
  Vec3 best = nearestOnSegment(c[0], c[1], y);
  for (int k = 1; k < 3; ++k) {
    const Vec3 other = nearestOnSegment(c[k], c[(k + 1) % 3], y);
    if (length(other - y) < length(best - y)) best = other;
  }
  return best;
}

/// Faces of a hull: the triples of points that all others lie on one side of.
struct HullFace {
  Vec3 corner[3], normal;
};
inline const std::vector<HullFace>& facesOf(const std::shared_ptr<const ShapeGeometry>& g) {
  static std::map<std::shared_ptr<const ShapeGeometry>, std::vector<HullFace>> known;
  const auto [incidence, isNew] = known.try_emplace(g);
  if (!isNew) return incidence->second;
  const auto& p = g->points;
  for (std::size_t i = 0; i < p.size(); ++i)
    for (std::size_t j = i + 1; j < p.size(); ++j)
      for (std::size_t k = j + 1; k < p.size(); ++k) {
        Vec3 n = cross(p[j] - p[i], p[k] - p[i]);
        if (length(n) < 1e-9) continue;
        n = normalize(n);
        double low = 0, high = 0;
        for (const Vec3& x : p)
          low = std::min(low, dot(n, x - p[i])), high = std::max(high, dot(n, x - p[i]));
        if (high < 1e-9)
          incidence->second.push_back({{p[i], p[j], p[k]}, n});
        else if (low > -1e-9)
          incidence->second.push_back({{p[i], p[j], p[k]}, -n});
      }
  return incidence->second;
}

/// Of a figure of revolution about z: the nearest point in the half plane (across, along).
inline Vec3 revolved(const Vec3& y, double across, double along) {
  const double r = std::hypot(y.x, y.y);
  return r > 0 ? Vec3{y.x / r * across, y.y / r * across, along} : Vec3{across, 0, along};
}

/// The nearest point of the core of a convex shape, and less than 0 inside of it.
inline Near nearestInCore(const Shape& s, const Vec3& y) {
  const double r = s.rounding, across = std::hypot(y.x, y.y);
  switch (s.type) {
    case ShapeType::Sphere:
      return {{}, length(y)};
    case ShapeType::Capsule: {
      const Vec3 x{0, 0, std::clamp(y.z, -s.halfLength, s.halfLength)};
      return {x, length(y - x)};
    }
    case ShapeType::Plane:
      return {{y.x, y.y, 0}, y.z};
    case ShapeType::Cylinder: {
      const double rc = s.radius - r, hc = s.halfLength - r;
      if (across <= rc && std::fabs(y.z) <= hc) return {y, std::max(across - rc, std::fabs(y.z) - hc)};
      const Vec3 x = revolved(y, std::min(across, rc), std::clamp(y.z, -hc, hc));
      return {x, length(y - x)};
    }
    case ShapeType::Cone: {
      const Vec3 rim{s.radius, 0, -s.halfLength}, tip{0, 0, s.halfLength}, flat{across, 0, y.z};
      const Vec3 out = normalize(Vec3{2 * s.halfLength, 0, s.radius});
      const double side = dot(out, flat - tip), under = -s.halfLength - y.z;
      if (side <= 0 && under <= 0) return {y, std::max(side, under)};
      const Vec3 a = nearestOnSegment(rim, tip, flat), b = nearestOnSegment({0, 0, -s.halfLength}, rim, flat);
      const Vec3 best = length(a - flat) < length(b - flat) ? a : b, x = revolved(y, best.x, best.z);
      return {x, length(y - x)};
    }
    case ShapeType::Hull: {
      double out = -1e30;
      for (const HullFace& f : facesOf(s.geometry)) out = std::max(out, dot(f.normal, y - f.corner[0]));
      if (out <= 0) return {y, out};
      Near best{{}, 1e30};
      for (const HullFace& f : facesOf(s.geometry)) {
        const Vec3 x = nearestOnTriangle(f.corner, y);
        if (length(x - y) < best.distance) best = {x, length(x - y)};
      }
      return best;
    }
    default:
      break;
  }
  const Vec3 half = s.halfExtents - Vec3{r, r, r}, out = abs(y) - half;
  if (std::max({out.x, out.y, out.z}) <= 0) return {y, std::max({out.x, out.y, out.z})};
  Vec3 x;
  for (int k = 0; k < 3; ++k) x[k] = std::clamp(y[k], -half[k], half[k]);
  return {x, length(y - x)};
}

inline Near nearestOf(const Piece& p, const Vec3& x) {
  const Vec3 y = rotateInverse(p.orientation, x - p.position);
  Near near;
  if (p.shape.type == ShapeType::Mesh) {
    near.point = nearestOnTriangle(p.corner, y);
    near.distance = length(near.point - y);
  } else {
    near = nearestInCore(p.shape, y);
    const bool round = p.shape.type == ShapeType::Sphere || p.shape.type == ShapeType::Capsule;
    const double r = round ? p.shape.radius : p.shape.rounding, fromCore = near.distance;
    near.distance -= r;
    if (near.distance <= 0)
      near.point = y;
    else
      near.point += (y - near.point) * (r / fromCore);
  }
  return {p.position + rotate(p.orientation, near.point), near.distance};
}

inline double reachOf(const Shape& s) {
  switch (s.type) {
    case ShapeType::Plane:
      return 1e30;
    case ShapeType::Hull: {
      double reach = 0;
      for (const Vec3& p : s.geometry->points) reach = std::max(reach, length(p));
      return reach + s.rounding;
    }
    case ShapeType::Box:
      return length(s.halfExtents);
    case ShapeType::Sphere:
      return s.radius;
    default:
      return s.radius + s.halfLength;
  }
}

inline std::vector<Piece> piecesOf(const BodyDef& b) {
  if (b.shape.type == ShapeType::Compound) {
    std::vector<Piece> out;
    for (const ShapePartDef& part : b.shape.geometry->parts)
      out.push_back({part.shape,
                     {},
                     b.position + rotate(b.orientation, part.position),
                     normalize(b.orientation * part.orientation),
                     reachOf(part.shape)});
    return out;
  }
  if (b.shape.type != ShapeType::Mesh) return {{b.shape, {}, b.position, b.orientation, reachOf(b.shape)}};
  std::vector<Piece> out;
  const ShapeGeometry& g = *b.shape.geometry;
  for (const auto& t : g.triangles) {
    Piece p{b.shape, {}, b.position, b.orientation, 0};
    for (std::size_t k = 0; k < 3; ++k) {
      p.corner[k] = g.points[static_cast<std::size_t>(t[k])];
      p.reach = std::max(p.reach, length(p.corner[k]));
    }
    out.push_back(p);
  }
  return out;
}

/// Distance of x from some pieces, if it is below `limit`; inside not above 0.
inline double distanceTo(const std::vector<Piece>& pieces, const Vec3& x,
                         double limit = std::numeric_limits<double>::infinity()) {
  double least = limit;
  for (const Piece& p : pieces)
    if (length(x - p.position) - p.reach < least) least = std::min(least, nearestOf(p, x).distance);
  return least;
}
inline double distanceTo(const BodyDef& b, const Vec3& x) { return distanceTo(piecesOf(b), x); }

/// Nearest points of two convex pieces, of which at most one is a half space.
struct NearestPair {
  Vec3 a, b;
  double distance;  ///< of a half space: along its normal, below 0 under its surface
};

/// By projecting from one on the other in turn, which converges for convex sets.
inline NearestPair nearestPair(const Piece& a, const Piece& b) {
  if (a.shape.type == ShapeType::Plane) {
    const NearestPair other = nearestPair(b, a);
    return {other.b, other.a, other.distance};
  }
  if (b.shape.type == ShapeType::Plane) {
    // the lowest point: the one nearest to a far point below
    const Vec3 up = rotate(b.orientation, Vec3{0, 0, 1});
    const Vec3 lowest = nearestOf(a, a.position - 1e6 * up).point;
    const double height = dot(up, lowest - b.position);
    return {lowest, lowest - height * up, height};
  }
  Vec3 x = a.position;
  for (int i = 0; i < 3000; ++i) {
    const Vec3 next = nearestOf(a, nearestOf(b, x).point).point;
    if (length(next - x) < 1e-12) break;
    x = next;
  }
  const Vec3 y = nearestOf(b, x).point;
  return {x, y, length(y - x)};
}
inline double distanceBetween(const Piece& a, const Piece& b) { return nearestPair(a, b).distance; }
inline double distanceBetween(const BodyDef& a, const BodyDef& b) {
  double least = 1e30;
  for (const Piece& p : piecesOf(a))
    for (const Piece& q : piecesOf(b))
      if (length(p.position - q.position) - p.reach - q.reach < least)
        least = std::min(least, distanceBetween(p, q));
  return least;
}

inline Shape randomHull(Random& random, int corners, double size, double rounding = 0) {
  std::vector<Vec3> points;
  const Vec3 away = random.vector(.3 * size);
  for (int i = 0; i < corners; ++i) {
    const Vec3 way = random.direction();
    points.push_back(away + size * random.uniform(.6, 1) * way);
  }
  return Shape::hull(points, rounding);
}

/// A convex solid that reaches no further than `most` from its frame, at least a twentieth as thick.
inline Shape randomConvex(Random& random, double most) {
  const auto size = [&] { return random.logUniform(most / 20, most / 2); };
  // a radius and half a length
  const auto round = [&](auto&& make) {
    const double length = size();
    return make(size(), length);
  };
  switch (random.below(9)) {
    case 0:
      return Shape::sphere(size());
    case 1:
      return round(Shape::capsule);
    case 2:
      return Shape::box({size(), size(), size()});
    case 3:
      return Shape::box({size(), size(), size()}, most / 40);
    case 4:
      return round([](double r, double h) { return Shape::cylinder(r, h); });
    case 5:
      return round([&](double r, double h) { return Shape::cylinder(r, h, most / 40); });
    case 6:
      return round(Shape::cone);
    case 7:
      return randomHull(random, 4 + random.below(6), .7 * most);
    default:
      return randomHull(random, 4 + random.below(6), .6 * most, most / 40);
  }
}

inline Shape randomSolid(Random& random, double most) {
  if (random.below(5) > 0) return randomConvex(random, most);
  std::vector<ShapePartDef> parts;
  for (int k = 0; k <= 1 + random.below(2); ++k)
    parts.push_back({randomConvex(random, most / 2), random.vector(most / 4), random.rotation()});
  return Shape::compound(parts);
}

/// A strip of triangles, two-sided.
inline Shape randomMesh(Random& random, double most) {
  std::vector<Vec3> points;
  std::vector<std::array<int, 3>> triangles;
  for (int i = 0; i < 8; ++i)
    points.push_back(Vec3{most * (.2 * i - .7), most * (i % 2 ? .3 : -.3), 0} + random.vector(.15 * most));
  for (int i = 0; i < 6; ++i) triangles.push_back({i, i + 1 + i % 2, i + 2 - i % 2});
  return Shape::mesh(points, triangles, true);
}

}  // namespace rubble::test
