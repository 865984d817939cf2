#pragma once
/// Distances between convex shapes by GJK (Gilbert, Johnson, Keerthi 1988; Ericson 2005, chapter 9), the time at which moving ones meet by
/// conservative advancement (Mirtich 1996), and rays. In double precision: a bullet is small beside the way it goes in a step.
#include "collision/convex.h"

namespace rubble::RUBBLE_CORE {

using Quatd = QuatT<double>;

/// A convex shape, or a half space, at a pose.
struct Placed {
  Convex shape;
  Vec3d p;      ///< its centre [m]
  Quatd q;
  Vec3d arm{};  ///< its centre less that of the body that it turns with [m]

  RUBBLE_HD bool isPlane() const { return shape.kind == ShapeKind::Plane; }
  RUBBLE_HD double radius() const { return static_cast<double>(shape.radius); }
};
/// Plain shapes need no tables.
RUBBLE_HD inline Placed placed(const ShapeData& shape, const Vec3d& p, const Quatd& q) {
  return {{shape.kind, shape.half, shape.radius, nullptr, nullptr, nullptr, 0, 0, {}}, p, q};
}

/// Shortest way from A to B.
struct Separation {
  double distance;  ///< [m]; of overlapping cores: 0 less both radii, and n and the points are not defined
  Vec3d onA, onB;   ///< on the two surfaces
  Vec3d n;          ///< from A to B, unit
};

namespace gjk {

struct Vertex {
  Vec3d a, b, w;  ///< on A, on B, a - b
};

/// Up to four vertices whose hull has the point nearest to the origin inside, and its barycentric coordinates.
struct Simplex {
  Vertex v[4];
  double weight[4];
  int count;
};

RUBBLE_HD RUBBLE_APART inline Vec3d rareSupport(const Convex& c, const Vec3d& d) { return RUBBLE_CORE::support(c, d); }

RUBBLE_HD inline Vec3d support(const Placed& s, const Vec3d& direction) {
  const Vec3d d = rotateInverse(s.q, direction);
  if (s.shape.kind > ShapeKind::RoundBox) return s.p + rotate(s.q, rareSupport(s.shape, d));
  // the core of a sphere is a box of no size, that of a capsule a line
  const Vec3d half(s.shape.half);
  return s.p + rotate(s.q, Vec3d{d.x < 0 ? -half.x : half.x, d.y < 0 ? -half.y : half.y, d.z < 0 ? -half.z : half.z});
}

RUBBLE_HD inline Vec3d nearest(const Simplex& s) {
  Vec3d x;
  for (int i = 0; i < s.count; ++i) x += s.v[i].w * s.weight[i];
  return x;
}

RUBBLE_HD inline Simplex part(const Vertex& a) { return {{a, {}, {}, {}}, {1, 0, 0, 0}, 1}; }
RUBBLE_HD inline Simplex part(const Vertex& a, const Vertex& b, double t) { return {{a, b, {}, {}}, {1 - t, t, 0, 0}, 2}; }

RUBBLE_HD inline Simplex nearestPart(const Vertex& a, const Vertex& b) {
  const Vec3d ab = b.w - a.w;
  const double t = -dot(a.w, ab), size = dot(ab, ab);
  if (t <= 0) return part(a);
  if (t >= size) return part(b);
  return part(a, b, t / size);
}

RUBBLE_HD inline Simplex nearestPart(const Vertex& a, const Vertex& b, const Vertex& c) {
  const Vec3d ab = b.w - a.w, ac = c.w - a.w;
  const double d1 = -dot(ab, a.w), d2 = -dot(ac, a.w);
  if (d1 <= 0 && d2 <= 0) return part(a);
  const double d3 = -dot(ab, b.w), d4 = -dot(ac, b.w);
  if (d3 >= 0 && d4 <= d3) return part(b);
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return part(a, b, d1 / (d1 - d3));
  const double d5 = -dot(ab, c.w), d6 = -dot(ac, c.w);
  if (d6 >= 0 && d5 <= d6) return part(c);
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return part(a, c, d2 / (d2 - d6));
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 >= d3 && d5 >= d6) return part(b, c, (d4 - d3) / ((d4 - d3) + (d5 - d6)));
  const double total = va + vb + vc;
  return {{a, b, c, {}}, {va / total, vb / total, vc / total, 0}, 3};
}

/// Keeps the part of the simplex that is nearest to the origin. Returns false if the origin is inside a tetrahedron.
RUBBLE_HD inline bool reduce(Simplex& s) {
  if (s.count == 1) {
    s.weight[0] = 1;
  } else if (s.count == 2) {
    s = nearestPart(s.v[0], s.v[1]);
  } else if (s.count == 3) {
    s = nearestPart(s.v[0], s.v[1], s.v[2]);
  } else {
    bool inside = true, found = false;
    Simplex best = s;
    double best2 = 0;
    for (int i = 0; i < 4; ++i) {
      const Vertex &a = s.v[(i + 1) % 4], &b = s.v[(i + 2) % 4], &c = s.v[(i + 3) % 4], &other = s.v[i];
      const Vec3d n = cross(b.w - a.w, c.w - a.w);
      const double own = dot(n, other.w - a.w), origin = -dot(n, a.w);
      // on the same side of this face as the fourth vertex; a flat tetrahedron has no inside
      if (own * origin > 0 && own * own > 1e-24 * dot(n, n) * dot(other.w - a.w, other.w - a.w)) continue;
      inside = false;
      const Simplex face = nearestPart(a, b, c);
      const Vec3d x = nearest(face);
      if (!found || dot(x, x) < best2) best = face, best2 = dot(x, x), found = true;
    }
    if (inside) return false;
    s = best;
  }
  return true;
}

/// Points of the two cores that are nearest to one another.
RUBBLE_HD inline Separation cores(const Placed& a, const Placed& b) {
  constexpr int kMostSteps = 64;           // it ends after a few; more would be round-off going in circles
  constexpr double kRelative = 1e-12;      // of the squared distance
  Simplex s{};
  Vec3d d = b.p - a.p;
  if (!(dot(d, d) > 0)) d = {1, 0, 0};
  s.v[0].a = support(a, d), s.v[0].b = support(b, -d), s.v[0].w = s.v[0].a - s.v[0].b;
  s.count = 1, s.weight[0] = 1;
  Vec3d x = s.v[0].w;
  const Vec3d halfA(a.shape.half), halfB(b.shape.half);
  const double scale2 = dot(halfA, halfA) + dot(halfB, halfB) + 1e-30;
  bool apart = true;
  for (int step = 0; step < kMostSteps; ++step) {
    const double x2 = dot(x, x);
    if (x2 <= 1e-22 * scale2) {
      apart = false;
      break;
    }
    Vertex v;
    v.a = support(a, -x), v.b = support(b, x), v.w = v.a - v.b;
    if (x2 - dot(x, v.w) <= kRelative * x2) break;
    bool known = false;
    for (int i = 0; i < s.count; ++i) known |= s.v[i].w == v.w;
    if (known) break;
    Simplex next = s;
    next.v[next.count++] = v;
    if (!reduce(next)) {
      apart = false;
      break;
    }
    const Vec3d y = nearest(next);
    if (dot(y, y) >= x2) break;
    s = next, x = y;
  }
  Separation out{};
  if (!apart) return out;
  for (int i = 0; i < s.count; ++i) out.onA += s.v[i].a * s.weight[i], out.onB += s.v[i].b * s.weight[i];
  out.distance = length(x);
  out.n = x * (-1 / out.distance);
  return out;
}

RUBBLE_HD inline Separation fromPlane(const Placed& plane, const Placed& b) {
  const Vec3d up = rotate(plane.q, Vec3d{0, 0, 1});
  Separation out;
  out.onB = support(b, -up) - up * b.radius();
  out.distance = dot(up, out.onB - plane.p);
  out.onA = out.onB - up * out.distance;
  out.n = up;
  return out;
}

}  // namespace gjk

/// Distance of two shapes; two half spaces are never near.
RUBBLE_HD inline Separation separation(const Placed& a, const Placed& b) {
  if (a.isPlane() && b.isPlane()) return {1e300, a.p, b.p, {0, 0, 1}};
  if (a.isPlane()) return gjk::fromPlane(a, b);
  if (b.isPlane()) {
    const Separation s = gjk::fromPlane(b, a);
    return {s.distance, s.onB, s.onA, -s.n};
  }
  Separation s = gjk::cores(a, b);
  s.onA += s.n * a.radius(), s.onB -= s.n * b.radius();
  s.distance -= a.radius() + b.radius();
  return s;
}

/// A way that a shape goes at constant speed.
struct Way {
  Vec3d move;  ///< of its centre [m]
  Vec3d turn;  ///< rotation vector [rad]
};

RUBBLE_HD inline Quatd turnOf(const Vec3d& w) {
  const double angle = length(w);
  return angle > 0 ? fromAxisAngle(w / angle, angle) : Quatd{};
}

RUBBLE_HD inline Placed movedBy(const Placed& s, const Way& way, double fraction) {
  Placed m = s;
  m.p += way.move * fraction;
  if (way.turn == Vec3d{}) return m;
  const Quatd turn = turnOf(way.turn * fraction);
  m.q = turn * s.q;
  m.arm = rotate(turn, s.arm);
  m.p += m.arm - s.arm;
  return m;
}

/// No point of the core goes further by a turn of its body than this [m].
RUBBLE_HD inline double turnReach(const Placed& s, const Way& way) { return length(way.turn) * (length(Vec3d(s.shape.half)) + length(s.arm)); }

/// Where and when A and B come within `tolerance` of one another.
struct Meeting {
  double fraction;  ///< of the way, above 1: never
  Separation at;
};
RUBBLE_HD inline Meeting meeting(const Placed& a, const Way& wayA, const Placed& b, const Way& wayB, double tolerance) {
  constexpr int kMostSteps = 128;  // whoever needs more stays within the tolerance for long: then that is where they meet
  const Vec3d relative = wayA.move - wayB.move;
  const double turning = turnReach(a, wayA) + turnReach(b, wayB);
  Meeting m{0, separation(a, b)};
  for (int step = 0; step < kMostSteps && m.at.distance > tolerance; ++step) {
    const double closing = dot(m.at.n, relative) + turning;
    if (!(closing > 0)) return {2, m.at};
    m.fraction += (m.at.distance - tolerance / 2) / closing;
    if (m.fraction > 1) return {2, m.at};
    m.at = separation(movedBy(a, wayA, m.fraction), movedBy(b, wayB, m.fraction));
  }
  return m;
}

/// Half of the smallest thickness of a plain shape [m].
RUBBLE_HD inline Real innerRadius(const ShapeData& s) {
  // nothing passes a plane, but what goes into it deeply comes back slowly
  if (s.kind == ShapeKind::Plane) return Real(0);
  if (s.kind != ShapeKind::Box) return s.radius;
  return min(s.half.x, min(s.half.y, s.half.z));
}

}  // namespace rubble::RUBBLE_CORE
