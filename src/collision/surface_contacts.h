#pragma once
/// A convex part against a triangle surface: the contacts of all triangles, clustered by normal.
#include "collision/parts.h"
#include "collision/triangles.h"

namespace rubble::RUBBLE_CORE {

/// Manifolds per pair with a surface, one per contact normal.
inline constexpr int kSurfaceSlots = 4;
/// Contacts whose normals differ by less belong to one manifold (cosine of 5 degrees).
inline constexpr Real kSameFacing = Real(.9962);
/// Points of a cluster closer than this share of L are merged.
inline constexpr Real kSameSpot = Real(.01);

/// Contact points with a common normal.
struct SurfaceCluster {
  Vec3 n;                   ///< unit, from the surface to the part
  convex::CutOf<8> points;  ///< x: on the surface, w: gap along n, from: feature
};

struct SurfaceContacts {
  SurfaceCluster cluster[kSurfaceSlots];
  int count = 0;
  Real length;    ///< L [m]
  Weight weight;  ///< in the frame of the surface, relative to the center of the part
};

/// Same rule as touchesNow() of manifold.h.
RUBBLE_HD inline bool touches(const SurfaceContacts& found, Real gap) {
  for (int i = 0; i < found.count; ++i)
    for (int k = 0; k < found.cluster[i].points.count; ++k)
      if (found.cluster[i].points.v[k].w <= gap) return true;
  return false;
}

/// Adds a point to the cluster with the closest normal. The normal of a cluster is that of its deepest point.
RUBBLE_HD inline void addSurfacePoint(SurfaceContacts& out, const Vec3& n, const Vec3& onSurface, Real gap,
                                      int feature) {
  int best = -1;
  Real alike = Real(-2);
  for (int i = 0; i < out.count; ++i) {
    const Real c = dot(out.cluster[i].n, n);
    if (c > alike) alike = c, best = i;
  }
  if (alike < kSameFacing && out.count < kSurfaceSlots) {
    best = out.count++;
    out.cluster[best].n = n;
    out.cluster[best].points.count = 0;
  }
  SurfaceCluster& cluster = out.cluster[best];
  auto& points = cluster.points;
  bool deepest = true;
  for (int k = 0; k < points.count; ++k) deepest &= gap < points.v[k].w;
  if (deepest) cluster.n = n;
  const Real near2 = kSameSpot * kSameSpot * out.length * out.length;
  for (int k = 0; k < points.count; ++k) {
    if (lengthSquared(points.v[k].x - onSurface) > near2) continue;
    // of two equally deep points the one further along the load direction stays
    const bool asDeep = std::fabs(gap - points.v[k].w) < kSameHeight * out.length;
    const Real outward = dot(convex::loadedSide(points, cluster.n, out.weight).along,
                             onSurface - points.v[k].x);
    if (asDeep && outward != Real(0) ? outward > Real(0) : gap < points.v[k].w)
      points.v[k] = {onSurface, gap, feature, feature};
    return;
  }
  if (points.count == 8)
    convex::pickFour(points, cluster.n, convex::loadedSide(points, cluster.n, out.weight), Real(1e30),
                     out.length);
  points.v[points.count++] = {onSurface, gap, feature, feature};
}

namespace surface {

/// Adds the contacts of one triangle. The corners are in the frame of the surface, relative to the center of
/// the part; q and `turn` rotate the part.
RUBBLE_HD inline void addTriangle(const SurfaceTriangle& t, bool twoSided, const Convex& part, const Quat& q,
                                  const Mat3& turn, Real margin, SurfaceContacts& out) {
  Convex triangle{ShapeKind::Triangle,
                  {0, 0, 0},
                  0,
                  nullptr,
                  nullptr,
                  nullptr,
                  0,
                  0,
                  {t.corner[0], t.corner[1], t.corner[2]}};
  Vec3 n = xyz(facePlane(triangle, 0));
  bool turned = false;
  if (dot(n, triangle.corner[0]) > Real(0)) {
    // back face
    if (!twoSided) return;
    triangle.corner[1] = t.corner[2], triangle.corner[2] = t.corner[1];
    n = -n;
    turned = true;
  }
  const Real length = out.length;
  const ConvexPair p{triangle, part, q, turn, {0, 0, 0}, length, out.weight};
  convex::BestFace face{0, false, dot(n, supportOfB(p, -n) - triangle.corner[0])};
  if (face.s - part.radius > margin) return;
  RawManifold raw;
  Real lowest;
  convex::faceContact(p, face, margin, raw, lowest);
  const bool exact = raw.count > 0 && lowest <= face.s + kSameHeight * length;
  if (!exact || face.s < -kEdgeMargin * length) {
    const convex::BestFace start = convex::bestFace(p, margin + part.radius);
    if (start.s - part.radius > margin) return;
    const Vec3 plane = xyz(facePlane(start.onB ? part : triangle, start.face < 0 ? 0 : start.face));
    const SeparatingDirection x = mostSeparating(p, start.onB ? -(turn * plane) : n);
    if (x.s - part.radius > margin) return;
    // corner or edge of the triangle furthest out along the direction
    Real height[3];
    for (int k = 0; k < 3; ++k) height[k] = dot(triangle.corner[k], x.n);
    const int low = height[0] <= height[1] && height[0] <= height[2] ? 0 : height[1] <= height[2] ? 1 : 2;
    const int i = (low + 1) % 3, j = (low + 2) % 3;
    const auto original = [&](int k) { return turned && k > 0 ? 3 - k : k; };
    // on the back side concave edges are convex
    const int flags = turned ? t.flags >> 6 : t.flags;
    // the triangle beyond an edge must not rise above the contact plane; otherwise the contact belongs to its
    // face
    const auto clear = [&](int edge, int corner) {
      return dot(x.n, t.beyond[edge] - triangle.corner[corner]) <= kSameHeight * length;
    };
    // edge e starts at corner e; on the back side edges 0 and 2 are exchanged
    const auto edgeFrom = [&](int k) { return turned ? 2 - k : k; };
    bool touchable;
    if (std::fabs(height[i] - height[j]) < kSameHeight * length) {
      touchable = (flags >> edgeFrom(i) & 1) && clear(edgeFrom(i), i);
    } else {
      const int top = height[i] > height[j] ? i : j;
      touchable = (flags >> (3 + original(top)) & 1) && clear(edgeFrom(top), top) &&
                  clear(edgeFrom((top + 2) % 3), top);
    }
    const bool preferred = raw.count == 0 || x.s > kEdgePreference * face.s + kEdgeMargin * length;
    if (!touchable && raw.count == 0) return;
    if (touchable && preferred) convex::edgeContact(p, x, margin, raw);
  }
  for (int k = 0; k < raw.count; ++k) {
    const RawPoint& q = raw.points[k];
    const bool ofPart = q.feature < 0x800 || q.feature >= 0x2000;
    addSurfacePoint(out, raw.n, q.onA, dot(raw.n, q.onB - q.onA),
                    ofPart ? q.feature : q.feature | (t.index & 0xff) << 16);
  }
}

}  // namespace surface

/// Contacts of a part with a mesh or height field, in the frame of the surface. Points are relative to the
/// center of the part; the part has center `at` and rotation q.
RUBBLE_HD inline void collideTriangles(const ShapeTables& tables, const ShapeData& s, const ShapeData& part,
                                       const Vec3& at, const Quat& q, Real margin, SurfaceContacts& out) {
  const Convex convexPart = convexOf(tables, part);
  const Mat3 turn = rotationMatrix(q);
  const Vec3 half = boundingHalf(part, q) + Vec3{margin, margin, margin};
  const bool twoSided = isTwoSided(tables, s);
  visitTriangles(tables, s, at - half, at + half, [&](const SurfaceTriangle& t) {
    const SurfaceTriangle near{{t.corner[0] - at, t.corner[1] - at, t.corner[2] - at},
                               t.flags,
                               t.index,
                               {t.beyond[0] - at, t.beyond[1] - at, t.beyond[2] - at}};
    surface::addTriangle(near, twoSided, convexPart, q, turn, margin, out);
    return false;
  });
}

}  // namespace rubble::RUBBLE_CORE
