#pragma once
/// Spheres and capsules against primitive shapes, and boxes against planes. Contact points are recomputed in
/// every step and lie on the two surfaces.
#include "collision/shapes.h"

namespace rubble::RUBBLE_CORE {

/// A capsule counts as parallel to a face or to another capsule up to this sine of the angle.
inline constexpr Real kParallelCapsule = Real(.05);

namespace rounds {

/// Core of a round shape: a segment (of length zero for a sphere) and a radius.
struct Core {
  Vec3 center, half;  ///< relative to the center of A; end points are center +- half
  Real radius;
};
RUBBLE_HD inline Core coreOf(const ShapeData& s, const Quat& q, const Vec3& center) {
  return {center, rotate(q, s.half), s.radius};
}

/// Adds the contact of point `a` on the core of A with point `b` on the core of B, along n.
RUBBLE_HD inline void addPoint(RawManifold& out, const Vec3& a, Real radiusA, const Vec3& b, Real radiusB,
                               Real margin, int feature) {
  const Real gap = dot(b - a, out.n) - radiusA - radiusB;
  if (gap > margin || out.count >= kLanes) return;
  out.points[out.count++] = {a + out.n * radiusA, b - out.n * radiusB, feature};
}

/// Parameter in [-1, 1] of the point of the core segment closest to x.
RUBBLE_HD inline Real nearestOnSegment(const Core& c, const Vec3& x) {
  const Real h2 = dot(c.half, c.half);
  return h2 > Real(0) ? clamp(dot(x - c.center, c.half) / h2, Real(-1), Real(1)) : Real(0);
}

/// Parameters of the closest points of two segments (Ericson 2005, 5.1.9, for centered segments).
RUBBLE_HD inline void nearestOfSegments(const Core& a, const Core& b, Real& s, Real& t) {
  const Real aa = dot(a.half, a.half), bb = dot(b.half, b.half), ab = dot(a.half, b.half);
  const Vec3 d = b.center - a.center;
  const Real denominator = aa * bb - ab * ab;
  s = denominator > Real(1e-6) * aa * bb
          ? clamp((dot(d, a.half) * bb - dot(d, b.half) * ab) / denominator, Real(-1), Real(1))
          : Real(0);
  t = nearestOnSegment(b, a.center + a.half * s);
  s = nearestOnSegment(a, b.center + b.half * t);
}

}  // namespace rounds

/// Sphere or capsule against sphere or capsule.
RUBBLE_HD inline RawManifold collideRounds(const ShapeData& sa, const Quat& qa, const ShapeData& sb,
                                           const Quat& qb, const Vec3& t, Real margin) {
  using namespace rounds;
  const Core a = coreOf(sa, qa, {0, 0, 0}), b = coreOf(sb, qb, t);
  RawManifold out;
  Real s, u;
  nearestOfSegments(a, b, s, u);
  const Vec3 pa = a.center + a.half * s, pb = b.center + b.half * u;
  const Vec3 d = pb - pa;
  // coincident points: any direction separates spheres; the common normal of both axes is the shortest way
  // out for capsules
  const Vec3 across = cross(a.half, b.half);
  out.n = normalize(d, dot(across, across) > Real(0) ? normalize(across) : normalize(t, Vec3{0, 0, 1}));
  out.separation = length(d) - a.radius - b.radius;
  if (out.separation > margin) return out;

  const Vec3 cross2 = cross(a.half, b.half);
  const Real sizes = dot(a.half, a.half) * dot(b.half, b.half);
  if (sizes > Real(0) && dot(cross2, cross2) < kParallelCapsule * kParallelCapsule * sizes) {
    // parallel: two points at the ends of the common part, if it has a length
    const Real reach = std::sqrt(dot(b.half, b.half) / dot(a.half, a.half));
    const Real middle = dot(b.center - a.center, a.half) / dot(a.half, a.half);
    const Real lo = max(Real(-1), middle - reach), hi = min(Real(1), middle + reach);
    if (hi - lo > Real(.1)) {
      const Vec3 lowA = a.center + a.half * lo, highA = a.center + a.half * hi;
      addPoint(out, lowA, a.radius, b.center + b.half * nearestOnSegment(b, lowA), b.radius, margin, 1);
      addPoint(out, highA, a.radius, b.center + b.half * nearestOnSegment(b, highA), b.radius, margin, 2);
      if (out.count > 0) return out;
    }
  }
  addPoint(out, pa, a.radius, pb, b.radius, margin, 0);
  return out;
}

/// Sphere or capsule (A) against box (B).
RUBBLE_HD inline RawManifold collideRoundBox(const ShapeData& sa, const Quat& qa, const ShapeData& sb,
                                             const Quat& qb, const Vec3& t, Real margin) {
  using namespace rounds;
  RawManifold out;
  // in the frame of the box
  const Vec3 center = rotateInverse(qb, -t), half = rotateInverse(qb, rotate(qa, sa.half)), h = sb.half;
  const auto clampToBox = [&](const Vec3& x) {
    return Vec3{clamp(x.x, -h.x, h.x), clamp(x.y, -h.y, h.y), clamp(x.z, -h.z, h.z)};
  };
  // The squared distance of center + s half to the box is convex in s, so its derivative is bisected.
  Real lo = -1, hi = 1, s = 0;
  if (dot(half, half) > Real(0)) {
    constexpr int kBisections = 24;
    for (int i = 0; i < kBisections; ++i) {
      s = (lo + hi) / 2;
      const Vec3 x = center + half * s;
      const Real slope = dot(x - clampToBox(x), half);
      if (slope == Real(0)) break;
      (slope > Real(0) ? hi : lo) = s;
    }
  }
  const Vec3 x = center + half * s, onBox = clampToBox(x), d = onBox - x;
  const Real distance = length(d);
  out.normalOnB = true;
  Vec3 n;  // from the round shape to the box, box frame
  int faceAxis = -1;
  Real faceSide = 1;
  if (distance > Real(1e-6) * (sa.radius + length(h))) {
    n = d / distance;
    out.separation = distance - sa.radius;
    if (out.separation > margin) return out;
    for (int i = 0; i < 3; ++i)
      if (std::fabs(n[i]) > Real(1) - Real(1e-4))
        faceAxis = i, faceSide = n[i] > Real(0) ? Real(-1) : Real(1);
  } else {
    // the axis intersects the box: exit through the face with the shortest way for the whole segment
    Real best = 0;
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k < 2; ++k) {
        const Real sign = k == 0 ? Real(1) : Real(-1);
        const Real separation = sign * center[i] - std::fabs(half[i]) - h[i];
        if (faceAxis < 0 || separation > best) best = separation, faceAxis = i, faceSide = sign;
      }
    }
    n = Vec3{0, 0, 0};
    n[faceAxis] = -faceSide;
    out.separation = best - sa.radius;
  }
  out.n = rotate(qb, n);

  if (faceAxis >= 0) {
    // face contact: both ends of the part of the axis above the face
    Real from = -1, to = 1;
    for (int i = 0; i < 3; ++i) {
      if (i == faceAxis || half[i] == Real(0)) continue;
      const Real a = (-h[i] - center[i]) / half[i], b = (h[i] - center[i]) / half[i];
      from = max(from, min(a, b));
      to = min(to, max(a, b));
    }
    const bool single = dot(half, half) == Real(0) || !(to - from > Real(.1));
    for (int k = 0; k < (single ? 1 : 2); ++k) {
      const Vec3 end = center + half * (single ? s : k == 0 ? from : to);
      Vec3 foot = end;
      foot[faceAxis] = faceSide * h[faceAxis];
      const Real gap = dot(foot - end, n) - sa.radius;
      if (gap <= margin)
        out.points[out.count++] = {t + rotate(qb, end + n * sa.radius), t + rotate(qb, foot), 1 + k};
    }
    if (out.count > 0) return out;
  }
  out.count = 1;
  out.points[0] = {t + rotate(qb, x + n * sa.radius), t + rotate(qb, onBox), 0};
  return out;
}

/// Sphere, capsule or box (A) against the half space z < 0 of the plane (B).
RUBBLE_HD inline RawManifold collidePlane(const ShapeData& sa, const Quat& qa, const Quat& qb, const Vec3& t,
                                          Real margin) {
  RawManifold out;
  const Vec3 up = rotate(qb, Vec3{0, 0, 1});
  out.n = -up;
  out.normalOnB = true;
  const Real planeHeight = dot(up, t);
  const auto add = [&](const Vec3& x, int feature) {
    const Real gap = dot(up, x) - planeHeight;
    if (out.count == 0 || gap < out.separation) out.separation = gap;
    if (gap <= margin && out.count < kLanes) out.points[out.count++] = {x, x - up * gap, feature};
  };
  if (sa.kind == ShapeKind::Box) {
    // the four corners of the lowest face
    const Vec3 down = rotateInverse(qa, -up);
    int axis = 0;
    for (int i = 1; i < 3; ++i)
      if (std::fabs(down[i]) > std::fabs(down[axis])) axis = i;
    const int iu = (axis + 1) % 3, iv = (axis + 2) % 3;
    for (int k = 0; k < 4; ++k) {
      Vec3 corner;
      corner[axis] = down[axis] < Real(0) ? -sa.half[axis] : sa.half[axis];
      corner[iu] = (k == 1 || k == 2) ? sa.half[iu] : -sa.half[iu];
      corner[iv] = k >= 2 ? sa.half[iv] : -sa.half[iv];
      const int feature = (corner.x > Real(0)) + 2 * (corner.y > Real(0)) + 4 * (corner.z > Real(0));
      add(rotate(qa, corner), feature);
    }
    return out;
  }
  const Vec3 half = rotate(qa, sa.half);
  const Vec3 foot = up * -sa.radius;
  if (sa.kind == ShapeKind::Sphere) {
    add(foot, 0);
  } else {
    add(half + foot, 1);
    add(-half + foot, 2);
  }
  return out;
}

}  // namespace rubble::RUBBLE_CORE
