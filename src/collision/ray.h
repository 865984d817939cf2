#pragma once
/// Ray against a primitive shape or a triangle, in closed form.
#include "collision/distance.h"

namespace rubble::RUBBLE_CORE {

/// Fraction of the ray at the hit (above 1: no hit), and the outward normal there.
struct RayImpact {
  double fraction;
  Vec3d n;
  int triangle = -1;  ///< of a mesh or height field: SurfaceTriangle::index
};

namespace rays {

inline constexpr double kNever = 2;

/// Ray x + t d against a sphere about the origin.
RUBBLE_HD inline RayImpact sphere(const Vec3d& x, const Vec3d& d, double radius) {
  const double b = dot(x, d), c = dot(x, x) - radius * radius, dd = dot(d, d);
  if (c <= 0) return {0, {0, 0, 0}};
  const double q = b * b - c * dd;
  if (b >= 0 || q < 0) return {kNever, {}};
  const double t = c / (std::sqrt(q) - b);  // this form avoids cancellation
  return {t, (x + d * t) / radius};
}

RUBBLE_HD inline RayImpact box(const Vec3d& x, const Vec3d& d, const Vec3d& half) {
  double in = 0, out = 1;
  int axis = -1;
  for (int k = 0; k < 3; ++k) {
    if (d[k] == 0) {
      if (std::fabs(x[k]) > half[k]) return {kNever, {}};
      continue;
    }
    const double sign = d[k] > 0 ? 1 : -1, enter = (-sign * half[k] - x[k]) / d[k],
                 leave = (sign * half[k] - x[k]) / d[k];
    if (enter > in) in = enter, axis = k;
    out = min(out, leave);
  }
  if (in > out) return {kNever, {}};
  Vec3d n;
  if (axis >= 0) n[axis] = d[axis] > 0 ? -1 : 1;
  return {in, n};
}

/// Capsule along z, with cap centers at z = +- half.
RUBBLE_HD inline RayImpact capsule(const Vec3d& x, const Vec3d& d, double half, double radius) {
  const Vec3d side{x.x, x.y, 0}, along{d.x, d.y, 0};
  RayImpact m = dot(along, along) > 0 || dot(side, side) <= radius * radius ? sphere(side, along, radius)
                                                                            : RayImpact{kNever, {}};
  if (m.fraction <= 1 && std::fabs(x.z + m.fraction * d.z) <= half) return m;
  const RayImpact a = sphere(x - Vec3d{0, 0, half}, d, radius), b = sphere(x + Vec3d{0, 0, half}, d, radius);
  return a.fraction < b.fraction ? a : b;
}

/// Ray against a triangle, from the front or, if twoSided, from either side.
RUBBLE_HD inline RayImpact triangle(const Vec3d& x, const Vec3d& d, const Vec3d& a, const Vec3d& b,
                                    const Vec3d& c, bool twoSided) {
  Vec3d n = cross(b - a, c - a);
  double over = dot(n, x - a), down = -dot(n, d);
  if (down < 0 && twoSided) n = -n, over = -over, down = -down;
  if (!(down > 0) || over < 0 || over > down) return {kNever, {}};
  // the edge terms of neighbors have exactly opposite signs, so no ray passes between them
  const double u = dot(d, cross(b - x, a - x)), v = dot(d, cross(c - x, b - x)),
               w = dot(d, cross(a - x, c - x));
  if (!((u >= 0 && v >= 0 && w >= 0) || (u <= 0 && v <= 0 && w <= 0))) return {kNever, {}};
  return {over / down, normalize(n)};
}

}  // namespace rays

/// Casts a ray from `origin` along `move` against a primitive shape.
RUBBLE_HD inline RayImpact castRay(const Placed& shape, const Vec3d& origin, const Vec3d& move) {
  const Vec3d x = rotateInverse(shape.q, origin - shape.p), d = rotateInverse(shape.q, move);
  RayImpact m{rays::kNever, {}};
  if (shape.isPlane()) {
    if (x.z <= 0)
      m = {0, {0, 0, 0}};
    else if (d.z < 0)
      m = {x.z / -d.z, {0, 0, 1}};
  } else if (shape.shape.kind == ShapeKind::Box) {
    m = rays::box(x, d, Vec3d(shape.shape.half));
  } else {
    m = rays::capsule(x, d, static_cast<double>(shape.shape.half.z), shape.radius());
  }
  if (m.fraction > 1) return {rays::kNever, {}};
  m.n = m.n == Vec3d{} ? normalize(-move) : rotate(shape.q, m.n);
  return m;
}

}  // namespace rubble::RUBBLE_CORE
