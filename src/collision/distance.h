#pragma once
/// Distance of convex shapes by GJK (Gilbert, Johnson, Keerthi 1988; Ericson 2005, chapter 9), and their time
/// of impact by conservative advancement (Mirtich 1996). In double precision, because a bullet is small
/// compared with its displacement per step.
#include "collision/convex.h"
#include "math/trig.h"

namespace rubble::RUBBLE_CORE {

using Quatd = QuatT<double>;

/// A convex shape or a half space, at a pose.
struct Placed {
  Convex shape;
  Vec3d p;  ///< its center [m]
  Quatd q;
  Vec3d arm{};  ///< its center relative to that of the rotating body [m]

  RUBBLE_HD bool isPlane() const { return shape.kind == ShapeKind::Plane; }
  RUBBLE_HD double radius() const { return static_cast<double>(shape.radius); }
};
/// Primitive shapes need no tables.
RUBBLE_HD inline Placed placed(const ShapeData& shape, const Vec3d& p, const Quatd& q) {
  return {{shape.kind, shape.half, shape.radius, nullptr, nullptr, nullptr, 0, 0, {}}, p, q};
}

/// Distance and closest points of A and B.
struct Separation {
  double distance;  ///< [m]; if the cores overlap: minus both radii, with n and the points undefined
  Vec3d onA, onB;   ///< on the two surfaces
  Vec3d n;          ///< unit, from A to B
};

namespace gjk {

struct Vertex {
  Vec3d a, b, w;  ///< support points of A and B, and a - b
};

/// Up to four vertices whose hull contains the point closest to the origin, with its barycentric weights.
struct Simplex {
  Vertex v[4];
  double weight[3];
  int count;
};

/// A feature of a simplex by vertex numbers, with the weights of the point closest to the origin. count 0:
/// the simplex contains the origin.
struct Part {
  int count, vertex[3];
  double weight[3];
};

RUBBLE_HD RUBBLE_OUT_OF_LINE inline Vec3d generalSupport(const Convex& c, const Vec3d& d) {
  return RUBBLE_CORE::support(c, d);
}

RUBBLE_HD inline Vec3d support(const Placed& s, const Vec3d& direction) {
  const Vec3d d = rotateInverse(s.q, direction);
  if (s.shape.kind > ShapeKind::RoundBox) return s.p + rotate(s.q, generalSupport(s.shape, d));
  // the core of a sphere is a box of size zero, that of a capsule a segment
  const Vec3d half(s.shape.half);
  return s.p + rotate(s.q, Vec3d{d.x < 0 ? -half.x : half.x, d.y < 0 ? -half.y : half.y,
                                 d.z < 0 ? -half.z : half.z});
}

RUBBLE_HD inline Vec3d nearest(const Simplex& s, const Part& part) {
  Vec3d x;
  for (int k = 0; k < part.count; ++k) x += s.v[part.vertex[k]].w * part.weight[k];
  return x;
}

RUBBLE_HD inline Part onVertex(int a) { return {1, {a, 0, 0}, {1, 0, 0}}; }
RUBBLE_HD inline Part onEdge(int a, int b, double t) { return {2, {a, b, 0}, {1 - t, t, 0}}; }

RUBBLE_HD inline Part nearestPart(const Simplex& s, int i, int j) {
  const Vec3d &a = s.v[i].w, ab = s.v[j].w - a;
  const double t = -dot(a, ab), size = dot(ab, ab);
  if (t <= 0) return onVertex(i);
  if (t >= size) return onVertex(j);
  return onEdge(i, j, t / size);
}

RUBBLE_HD RUBBLE_OUT_OF_LINE inline Part nearestPart(const Simplex& s, int i, int j, int k) {
  const Vec3d &a = s.v[i].w, &b = s.v[j].w, &c = s.v[k].w, ab = b - a, ac = c - a;
  const double d1 = -dot(ab, a), d2 = -dot(ac, a);
  if (d1 <= 0 && d2 <= 0) return onVertex(i);
  const double d3 = -dot(ab, b), d4 = -dot(ac, b);
  if (d3 >= 0 && d4 <= d3) return onVertex(j);
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return onEdge(i, j, d1 / (d1 - d3));
  const double d5 = -dot(ab, c), d6 = -dot(ac, c);
  if (d6 >= 0 && d5 <= d6) return onVertex(k);
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return onEdge(i, k, d2 / (d2 - d6));
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 >= d3 && d5 >= d6) return onEdge(j, k, (d4 - d3) / ((d4 - d3) + (d5 - d6)));
  const double total = va + vb + vc;
  return {3, {i, j, k}, {va / total, vb / total, vc / total}};
}

/// Feature of the first `count` vertices that is closest to the origin.
RUBBLE_HD inline Part nearestPart(const Simplex& s, int count) {
  if (count == 1) return onVertex(0);
  if (count == 2) return nearestPart(s, 0, 1);
  if (count == 3) return nearestPart(s, 0, 1, 2);
  Part best{};
  double best2 = 0;
  for (int i = 0; i < 4; ++i) {
    const int j = (i + 1) % 4, k = (i + 2) % 4, l = (i + 3) % 4;
    const Vec3d &a = s.v[j].w, n = cross(s.v[k].w - a, s.v[l].w - a), edge = s.v[i].w - a;
    const double own = dot(n, edge), origin = -dot(n, a);
    // origin on the inner side of this face; a flat tetrahedron has no inside
    if (own * origin > 0 && own * own > 1e-24 * dot(n, n) * dot(edge, edge)) continue;
    const Part face = nearestPart(s, j, k, l);
    const Vec3d x = nearest(s, face);
    if (best.count == 0 || dot(x, x) < best2) best = face, best2 = dot(x, x);
  }
  return best;
}
/// Reduces the simplex to a feature, in its vertex order.
RUBBLE_HD inline void keep(Simplex& s, const Part& part) {
  const Vertex kept[3] = {s.v[part.vertex[0]], s.v[part.vertex[1]], s.v[part.vertex[2]]};
  for (int k = 0; k < part.count; ++k) s.v[k] = kept[k], s.weight[k] = part.weight[k];
  s.count = part.count;
}

/// Cores overlap if their squared distance is less than this share of their squared sizes, where double
/// precision ends.
inline constexpr double kTouching = 1e-22;
/// Segments are parallel if the squared sine of their angle is less than this.
inline constexpr double kParallel = 1e-12;
/// Squared distance below which cores overlap [m2]; positive even for two points.
RUBBLE_HD inline double touchingDistance2(const Placed& a, const Placed& b) {
  const Vec3d halfA(a.shape.half), halfB(b.shape.half);
  return kTouching * (dot(halfA, halfA) + dot(halfB, halfB) + 1e-30);
}

/// Closest points of the two cores.
RUBBLE_HD inline Separation cores(const Placed& a, const Placed& b) {
  constexpr int kMostSteps = 64;       // typically a few; more would be cycles of round-off
  constexpr double kRelative = 1e-12;  // of the squared distance
  Simplex s{};
  Vec3d d = b.p - a.p;
  if (!(dot(d, d) > 0)) d = {1, 0, 0};
  s.v[0].a = support(a, d), s.v[0].b = support(b, -d), s.v[0].w = s.v[0].a - s.v[0].b;
  s.count = 1, s.weight[0] = 1;
  Vec3d x = s.v[0].w;
  const double touching2 = touchingDistance2(a, b);
  bool apart = true;
  for (int step = 0; step < kMostSteps; ++step) {
    const double x2 = dot(x, x);
    if (x2 <= touching2) {
      apart = false;
      break;
    }
    Vertex v;
    v.a = support(a, -x), v.b = support(b, x), v.w = v.a - v.b;
    if (x2 - dot(x, v.w) <= kRelative * x2) break;
    bool known = false;
    for (int i = 0; i < s.count; ++i) known |= s.v[i].w == v.w;
    if (known) break;
    s.v[s.count] = v;
    const Part part = nearestPart(s, s.count + 1);
    if (part.count == 0) {
      apart = false;
      break;
    }
    const Vec3d y = nearest(s, part);
    if (dot(y, y) >= x2) break;
    keep(s, part);
    x = y;
  }
  Separation out{};
  if (!apart) return out;
  for (int i = 0; i < s.count; ++i) out.onA += s.v[i].a * s.weight[i], out.onB += s.v[i].b * s.weight[i];
  out.distance = length(x);
  out.n = x * (-1 / out.distance);
  return out;
}

/// Is the core a point or a segment (sphere or capsule)?
RUBBLE_HD inline bool isLine(const Placed& s) {
  return s.shape.kind == ShapeKind::Sphere || s.shape.kind == ShapeKind::Capsule;
}

/// Closest points of two segments p + s u and q + t v with s and t in [-1, 1], in closed form (Ericson 2005,
/// section 5.1.9).
RUBBLE_HD inline Separation lines(const Placed& a, const Placed& b) {
  const Vec3d u = rotate(a.q, Vec3d(a.shape.half)), v = rotate(b.q, Vec3d(b.shape.half)), r = b.p - a.p;
  const double uu = dot(u, u), vv = dot(v, v), uv = dot(u, v), ur = dot(u, r), vr = dot(v, r),
               det = uu * vv - uv * uv;
  const auto along = [](double way, double size) { return size > 0 ? clamp(way / size, -1.0, 1.0) : 0.0; };
  // any s will do for parallel segments
  double s = det > kParallel * uu * vv ? clamp((ur * vv - uv * vr) / det, -1.0, 1.0) : 0.0;
  const double t = along(s * uv - vr, vv);
  s = along(t * uv + ur, uu);
  Separation out{};
  const Vec3d onA = a.p + u * s, onB = b.p + v * t, x = onB - onA;
  const double x2 = dot(x, x);
  if (x2 <= touchingDistance2(a, b)) return out;
  out.onA = onA, out.onB = onB;
  out.distance = std::sqrt(x2);
  out.n = x / out.distance;
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

/// Distance of two shapes; two half spaces are infinitely far apart.
RUBBLE_HD RUBBLE_OUT_OF_LINE inline Separation separation(const Placed& a, const Placed& b) {
  if (a.isPlane() && b.isPlane()) return {1e300, a.p, b.p, {0, 0, 1}};
  if (a.isPlane()) return gjk::fromPlane(a, b);
  if (b.isPlane()) {
    const Separation s = gjk::fromPlane(b, a);
    return {s.distance, s.onB, s.onA, -s.n};
  }
  Separation s = gjk::isLine(a) && gjk::isLine(b) ? gjk::lines(a, b) : gjk::cores(a, b);
  s.onA += s.n * a.radius(), s.onB -= s.n * b.radius();
  s.distance -= a.radius() + b.radius();
  return s;
}

/// Rigid motion at constant velocity within a step, until `until`.
struct SweptMotion {
  Vec3d move;        ///< displacement of the center in a whole step [m]
  Vec3d turn;        ///< rotation vector, likewise [rad]
  double until = 1;  ///< fraction of the step after which it goes on as `after` says
  Vec3d after{};     ///< displacement in a whole step, without rotation [m]
};
/// The motion from `fraction` on, until it changes.
RUBBLE_HD inline SweptMotion motionFrom(const SweptMotion& motion, double fraction) {
  return fraction < motion.until ? motion : SweptMotion{motion.after, {}, motion.until};
}
/// Displacement of the center up to `fraction` [m].
RUBBLE_HD inline Vec3d wayUntil(const SweptMotion& motion, double fraction) {
  return motion.move * min(fraction, motion.until) + motion.after * max(0.0, fraction - motion.until);
}
/// The next fraction after `fraction` at which one of two motions ends, or 1.
RUBBLE_HD inline double nextEnd(const SweptMotion& a, const SweptMotion& b, double fraction) {
  const double endA = a.until > fraction ? a.until : 1, endB = b.until > fraction ? b.until : 1;
  return min(endA, endB);
}

RUBBLE_HD inline Quatd turnOf(const Vec3d& w) {
  const double angle = length(w);
  if (!(angle > 0)) return {};
  const SinCosOf<double> half = sinCos(angle / 2);
  return {half.cos, w / angle * half.sin};
}

RUBBLE_HD RUBBLE_OUT_OF_LINE inline Placed movedBy(const Placed& s, const SweptMotion& motion,
                                                   double fraction) {
  Placed m = s;
  m.p += wayUntil(motion, fraction);
  if (motion.turn == Vec3d{}) return m;
  const Quatd turn = turnOf(motion.turn * min(fraction, motion.until));
  m.q = turn * s.q;
  m.arm = rotate(turn, s.arm);
  m.p += m.arm - s.arm;
  return m;
}

/// Bound of the displacement of any point of the core along the unit vector n by the rotation [m]: (w x r) .
/// n = (n x w) . r at every orientation of r.
RUBBLE_HD inline double turnReach(const Placed& s, const SweptMotion& motion, const Vec3d& n) {
  return length(cross(n, motion.turn)) * (length(Vec3d(s.shape.half)) + length(s.arm));
}

/// Time of impact and the closest points then.
struct TimeOfImpact {
  double fraction;  ///< fraction of the step; above 1: no impact
  Separation at;
};
inline constexpr double kNoImpact = 2;
/// The motion of a shape as far as its surface moves: a sphere about the center of its body does not rotate.
RUBBLE_HD inline SweptMotion motionOfSurface(const Placed& s, const SweptMotion& motion) {
  const bool rotates = s.shape.kind != ShapeKind::Sphere || s.arm != Vec3d{};
  return rotates ? motion : SweptMotion{motion.move, {}, motion.until, motion.after};
}
/// Separation of two shapes along a unit vector from A to B [m]: at most their distance; negative: overlap
/// along n.
RUBBLE_HD RUBBLE_OUT_OF_LINE inline double gapAlong(const Placed& a, const Placed& b, const Vec3d& n) {
  if (a.isPlane()) return gjk::fromPlane(a, b).distance;
  if (b.isPlane()) return gjk::fromPlane(b, a).distance;
  return dot(n, gjk::support(b, -n) - gjk::support(a, n)) - a.radius() - b.radius();
}

/// Bound of the acceleration of any point of the core by the rotation, times the square of the step [m].
RUBBLE_HD inline double bend(const Placed& s, const SweptMotion& motion) {
  return dot(motion.turn, motion.turn) * (length(Vec3d(s.shape.half)) + length(s.arm));
}
/// Least t in [0, 1] with gap + change t - bend t (1 - t) = 0, for a positive gap and bend >= 0; above 1:
/// none.
RUBBLE_HD inline double leastRoot(double bend, double change, double gap) {
  const double slope = bend - change, inside = slope * slope - 4 * bend * gap;
  return slope > 0 && inside >= 0 ? 2 * gap / (slope + std::sqrt(inside)) : kNoImpact;
}

/// Conservative advancement. Two bounds say how long the shapes cannot meet. One is the speed at which points
/// approach along n, the other the gap along n at the end of their motions: in between, points deviate from a
/// steady motion along n by no more than their accelerations allow.
RUBBLE_HD RUBBLE_OUT_OF_LINE inline TimeOfImpact timeOfImpact(const Placed& a, const SweptMotion& bodyA,
                                                              const Placed& b, const SweptMotion& bodyB,
                                                              double tolerance) {
  const SweptMotion motionA = motionOfSurface(a, bodyA), motionB = motionOfSurface(b, bodyB);
  constexpr int kMostSteps = 128;  // longer searches stay within the tolerance for long: an impact
  TimeOfImpact m{};
  for (int step = 0;; ++step) {
    m.at = separation(movedBy(a, motionA, m.fraction), movedBy(b, motionB, m.fraction));
    if (step == kMostSteps || !(m.at.distance > tolerance)) return m;
    const SweptMotion nowA = motionFrom(motionA, m.fraction), nowB = motionFrom(motionB, m.fraction);
    const Vec3d& n = m.at.n;
    const double closing = dot(n, nowA.move - nowB.move) + turnReach(a, nowA, n) + turnReach(b, nowB, n);
    const double end = nextEnd(motionA, motionB, m.fraction), left = end - m.fraction,
                 safe = m.at.distance - tolerance / 2;
    double next = closing > 0 ? m.fraction + safe / closing : kNoImpact;
    if (next <= end) {
      const double last = gapAlong(movedBy(a, motionA, end), movedBy(b, motionB, end), n);
      next = max(next, m.fraction + left * leastRoot((bend(a, nowA) + bend(b, nowB)) * left * left / 2,
                                                     last - m.at.distance, safe));
    }
    if (next <= end)
      m.fraction = next;
    else if (end < 1)
      m.fraction = end;
    else
      return {kNoImpact, m.at};
  }
}

/// Time of impact of A and B, which are already in contact along n. An impact is a penetration deeper than
/// `allowed`. If they start deeper, they may still penetrate further by `more`, so that the step can proceed.
/// n rotates with one of the bodies. The cheap gap along n is tested first. Where it fails, the distance and
/// its direction replace it.
RUBBLE_HD RUBBLE_OUT_OF_LINE inline TimeOfImpact timeOfImpactBeyond(const Placed& a, const SweptMotion& bodyA,
                                                                    const Placed& b, const SweptMotion& bodyB,
                                                                    const Vec3d& n, bool turnsWithB,
                                                                    double allowed, double more) {
  const SweptMotion motionA = motionOfSurface(a, bodyA), motionB = motionOfSurface(b, bodyB);
  constexpr int kMostSteps = 128;
  constexpr double
      kLargestRotation = .1;       // rotation of n per search step [rad]: speed bounds hold at its start
  constexpr double kSameSide = 1;  // after a larger rotation [rad] a gap along n may lie on the other side
  const double start = gapAlong(a, b, n);
  allowed = max(allowed, more - start);
  const double reached = allowed - more / 4;
  const Placed& own = turnsWithB ? b : a;
  const Placed endA = movedBy(a, motionA, 1), endB = movedBy(b, motionB, 1);
  Vec3d local = rotateInverse(own.q, n);
  TimeOfImpact m{kNoImpact, {start, {}, {}, n}};
  const bool sameSide = length((turnsWithB ? motionB : motionA).turn) <= kSameSide;
  if (sameSide && gapAlong(endA, endB, rotate((turnsWithB ? endB : endA).q, local)) >= -allowed) return m;

  const double spin = max(length(motionA.turn), length(motionB.turn)),
               turnStep = spin > 0 ? kLargestRotation / spin : 1;
  m.fraction = 0;
  for (int step = 0; step < kMostSteps; ++step) {
    const Placed nowA = movedBy(a, motionA, m.fraction), nowB = movedBy(b, motionB, m.fraction);
    const Placed& nowOwn = turnsWithB ? nowB : nowA;
    m.at.n = rotate(nowOwn.q, local);
    m.at.distance = gapAlong(nowA, nowB, m.at.n);
    if (m.at.distance <= -reached) {
      const Separation s = separation(nowA, nowB);
      if (s.n == Vec3d{} || s.distance <= -reached) return m;
      m.at = s;
      local = rotateInverse(nowOwn.q, s.n);
    }
    const SweptMotion goA = motionFrom(motionA, m.fraction), goB = motionFrom(motionB, m.fraction);
    const auto velocity = [](const Placed& x, const SweptMotion& motion) {
      return motion.move + cross(motion.turn, x.arm);
    };
    const Placed& other = turnsWithB ? nowA : nowB;
    const Vec3d ownTurn = (turnsWithB ? goB : goA).turn, otherTurn = (turnsWithB ? goA : goB).turn,
                toOther = turnsWithB ? -m.at.n : m.at.n;
    const double closing = dot(m.at.n, velocity(nowA, goA) - velocity(nowB, goB)) +
                           dot(toOther, cross(ownTurn, other.p - nowOwn.p)) +
                           length(cross(m.at.n, otherTurn - ownTurn)) * length(Vec3d(other.shape.half));
    double next = min(m.fraction + turnStep, nextEnd(motionA, motionB, m.fraction));
    if (closing > 0) next = min(next, m.fraction + (m.at.distance + allowed) / closing);
    if (next >= 1 || m.fraction >= 1) return {kNoImpact, m.at};
    m.fraction = next;
  }
  return m;
}

/// Half of the smallest thickness of a primitive shape [m].
RUBBLE_HD inline Real innerRadius(const ShapeData& s) {
  // a plane has no far side, but deep penetration is corrected slowly
  if (s.kind == ShapeKind::Plane) return Real(0);
  if (s.kind != ShapeKind::Box) return s.radius;
  return min(s.half.x, min(s.half.y, s.half.z));
}

}  // namespace rubble::RUBBLE_CORE
