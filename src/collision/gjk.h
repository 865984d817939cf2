#pragma once
/// The separating direction of two convex cores with the largest separation, and the closest points along it.
///
/// Distance: Gilbert, Johnson and Keerthi 1988, with the sub-simplices of Ericson 2005 (section 9.5).
///
/// Overlap: let s(n) be the separation along n (negative: overlap). B is translated along the best n found so
/// far until the gap is tau. Let the closest points of this configuration be d apart along n'. If d > tau,
/// then s(n') >= d - tau + s(n) > s(n), so n' is better and is tried next. A fixed point is a local maximum
/// of s, the least penetration. Distances are thus only computed for separated cores, where they are well
/// conditioned.
#include <limits>

#include "collision/distance.h"

namespace rubble::RUBBLE_CORE {

/// Gap to which overlapping cores are separated, over L [1].
inline constexpr Real kPushedGap = Real(.03);
/// Cores further apart than this share of L take the direction between their closest points.
inline constexpr Real kLeastGap = Real(1e-3);
/// The search stops once a direction gains less than this share of L.
inline constexpr Real kLeastGain = Real(1e-4);
/// Most translations per pair, and most GJK steps per distance. Few pairs reach them.
inline constexpr int kMaxPushes = 4;
inline constexpr int kMaxGjkSteps = 24;
/// Squared relative error of a distance.
inline constexpr Real kGjkTolerance = sizeof(Real) == 8 ? Real(1e-11) : Real(2e-6);

/// Two cores in the frame of A. B has rotation `q` (matrix `turn`) and center `at`.
struct ConvexPair {
  const Convex& a;
  const Convex& b;
  Quat q;
  Mat3 turn;
  Vec3 at;
  Real length;      ///< L [m]
  Weight weight{};  ///< in the frame of A, relative to the center of A
};

RUBBLE_HD inline Vec3 supportOfB(const ConvexPair& p, const Vec3& d) {
  return p.at + p.turn * support(p.b, mulTransposed(p.turn, d));
}

/// Separation of the cores along the unit vector n from A to B.
RUBBLE_HD inline Real separationAlong(const ConvexPair& p, const Vec3& n) {
  return dot(n, supportOfB(p, -n) - support(p.a, n));
}

struct Nearest {
  Vec3 n;         ///< unit, from A to B
  Real distance;  ///< 0: overlap
  Vec3 onA, onB;
  Real proven;  ///< separation along n by support functions: equals `distance` up to round-off
};

namespace simplices {

/// Simplex of the Minkowski difference B - A: its vertices, their points on A, and the barycentric weights of
/// the point closest to the origin.
struct Simplex {
  Vec3 w[4], a[4];
  Real weight[4];
  int count = 0;
};

RUBBLE_HD inline void keep(Simplex& s, int i, int j, int k, Real wi, Real wj, Real wk) {
  const Simplex old = s;
  const int from[3] = {i, j, k};
  const Real weight[3] = {wi, wj, wk};
  s.count = 0;
  for (int m = 0; m < 3; ++m) {
    if (from[m] < 0 || !(weight[m] > Real(0))) continue;
    s.w[s.count] = old.w[from[m]], s.a[s.count] = old.a[from[m]], s.weight[s.count++] = weight[m];
  }
}

/// Barycentric weights of the point of a triangle closest to the origin.
RUBBLE_HD inline Vec3 triangleWeights(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a;
  const Real d1 = -dot(ab, a), d2 = -dot(ac, a);
  if (d1 <= Real(0) && d2 <= Real(0)) return {1, 0, 0};
  const Real d3 = -dot(ab, b), d4 = -dot(ac, b);
  if (d3 >= Real(0) && d4 <= d3) return {0, 1, 0};
  const Real vc = d1 * d4 - d3 * d2;
  if (vc <= Real(0) && d1 >= Real(0) && d3 <= Real(0)) {
    const Real v = d1 / (d1 - d3);
    return {1 - v, v, 0};
  }
  const Real d5 = -dot(ab, c), d6 = -dot(ac, c);
  if (d6 >= Real(0) && d5 <= d6) return {0, 0, 1};
  const Real vb = d5 * d2 - d1 * d6;
  if (vb <= Real(0) && d2 >= Real(0) && d6 <= Real(0)) {
    const Real w = d2 / (d2 - d6);
    return {1 - w, 0, w};
  }
  const Real va = d3 * d6 - d5 * d4;
  if (va <= Real(0) && d4 - d3 >= Real(0) && d5 - d6 >= Real(0)) {
    const Real w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {0, 1 - w, w};
  }
  const Real inverse = Real(1) / (va + vb + vc);
  return {va * inverse, vb * inverse, vc * inverse};
}

/// Reduces a simplex to the feature closest to the origin. Returns false if the simplex contains the origin.
RUBBLE_HD inline bool reduce(Simplex& s) {
  if (s.count == 1) {
    s.weight[0] = 1;
    return true;
  }
  if (s.count == 2) {
    const Vec3 ab = s.w[1] - s.w[0];
    const Real l2 = dot(ab, ab), t = l2 > Real(0) ? clamp(-dot(s.w[0], ab) / l2, Real(0), Real(1)) : Real(0);
    keep(s, 0, 1, -1, 1 - t, t, 0);
    return true;
  }
  if (s.count == 3) {
    const Vec3 w = triangleWeights(s.w[0], s.w[1], s.w[2]);
    keep(s, 0, 1, 2, w.x, w.y, w.z);
    return true;
  }
  // the faces that have the origin on their outer side
  Real best = -1;
  int face = -1;
  Vec3 bestWeights{0, 0, 0};
  for (int f = 0; f < 4; ++f) {
    const int i = f == 0 ? 1 : 0, j = f <= 1 ? 2 : 1, k = f <= 2 ? 3 : 2;
    const Vec3 n = cross(s.w[j] - s.w[i], s.w[k] - s.w[i]);
    const Real origin = -dot(n, s.w[i]), inner = dot(n, s.w[f] - s.w[i]);
    if (inner != Real(0) && (origin > Real(0)) == (inner > Real(0))) continue;
    const Vec3 weights = triangleWeights(s.w[i], s.w[j], s.w[k]);
    const Vec3 v = s.w[i] * weights.x + s.w[j] * weights.y + s.w[k] * weights.z;
    const Real d2 = dot(v, v);
    if (face < 0 || d2 < best) best = d2, face = f, bestWeights = weights;
  }
  if (face < 0) return false;
  keep(s, face == 0 ? 1 : 0, face <= 1 ? 2 : 1, face <= 2 ? 3 : 2, bestWeights.x, bestWeights.y,
       bestWeights.z);
  return true;
}

}  // namespace simplices

/// Closest points of the cores, scaled by `size` about their centers, with B translated by `shift`. `guess`:
/// first search direction.
RUBBLE_HD inline Nearest nearestPoints(const ConvexPair& p, const Vec3& shift, const Vec3& guess,
                                       Real size = 1) {
  simplices::Simplex s;
  Vec3 v = guess;
  Real v2 = std::numeric_limits<Real>::infinity();
  Real reach = 0;  // support of the last search direction, times |v|
  Nearest out{guess, 0, {0, 0, 0}, {0, 0, 0}, 0};
  for (int step = 0; step < kMaxGjkSteps; ++step) {
    const Vec3 a = support(p.a, v) * size, w = p.at + (supportOfB(p, -v) - p.at) * size + shift - a;
    reach = dot(v, w);
    // no point is closer to the origin
    if (s.count > 0 && v2 - reach <= kGjkTolerance * v2) break;
    bool known = false;
    for (int k = 0; k < s.count; ++k) known |= s.w[k] == w;
    if (known) break;
    s.w[s.count] = w, s.a[s.count++] = a;
    const simplices::Simplex before = s;
    if (!simplices::reduce(s)) return out;
    Vec3 next{0, 0, 0};
    for (int k = 0; k < s.count; ++k) next += s.w[k] * s.weight[k];
    const Real next2 = dot(next, next);
    if (!(next2 >= kLeastSquare<Real>)) return out;
    if (next2 >= v2) {
      // no progress because of round-off, or a first point too far away for a square
      if (step == 0) return out;
      s = before;
      --s.count;
      break;
    }
    v = next, v2 = next2, reach = 0;
  }
  out.distance = std::sqrt(v2);
  out.n = v / out.distance;
  out.proven = reach / out.distance;
  out.onA = {0, 0, 0};
  for (int k = 0; k < s.count; ++k) out.onA += s.a[k] * s.weight[k];
  out.onB = out.onA + v - shift;
  return out;
}

/// A direction, the separation of the cores along it, and its closest points (onB - onA = separation n).
struct SeparatingDirection {
  Vec3 n;
  Real s;
  Vec3 onA, onB;
};

/// Least ratio of `proven` to `distance` of a result in single precision; below it GJK runs in double [1].
inline constexpr Real kProven = Real(.9);

/// GJK in double precision. In single precision, round-off of the simplex loses a small body beside one a
/// thousand times its size, and overlapping cores seem separated.
RUBBLE_HD RUBBLE_OUT_OF_LINE inline Nearest preciseNearest(Convex a, Convex b, Quat turn, Vec3 at) {
  const Separation x = gjk::cores({a, {0, 0, 0}, {}}, {b, Vec3d(at), Quatd(turn)});
  const Real distance = static_cast<Real>(x.distance);
  return {Vec3(x.n), distance, Vec3(x.onA), Vec3(x.onB), distance};
}

/// Closest points of the cores with proven >= kProven distance. `guess`: first search direction.
RUBBLE_HD inline Nearest provenNearest(const ConvexPair& p, const Vec3& guess) {
  const Nearest near = nearestPoints(p, {0, 0, 0}, guess);
  return near.proven >= kProven * near.distance ? near : preciseNearest(p.a, p.b, p.q, p.at);
}

/// The direction of largest separation. For separated cores it is the direction between the closest points.
/// For overlapping cores it is a local maximum. The search starts from n, or from the direction between the
/// cores shrunk about their centers if that separates more.
RUBBLE_HD inline SeparatingDirection mostSeparating(const ConvexPair& p, Vec3 n) {
  const Real gap = kPushedGap * p.length;
  const Nearest whole = provenNearest(p, n);
  if (whole.distance > kLeastGap * p.length) return {whole.n, whole.distance, whole.onA, whole.onB};
  Real most = separationAlong(p, n);
  for (Real size = Real(.9); size > Real(.1); size -= Real(.3)) {
    const Nearest smaller = nearestPoints(p, {0, 0, 0}, n, size);
    if (!(smaller.distance > Real(0))) continue;
    const Real s = separationAlong(p, smaller.n);
    if (s > most) most = s, n = smaller.n;
    break;
  }
  const Vec3 tips = (support(p.a, n) + supportOfB(p, -n)) * Real(.5);
  SeparatingDirection best{n, separationAlong(p, n), tips, tips};
  for (int push = 0; push < kMaxPushes; ++push) {
    const Vec3 shift = best.n * (gap - best.s);
    const Nearest near = nearestPoints(p, shift, best.n);
    if (!(near.distance > Real(0))) break;
    const Real s = separationAlong(p, near.n);
    const bool better = s >= best.s;
    if (better || push == 0) {
      // both points on a common line along n, the separation apart
      const Vec3 middle = (near.onA + near.onB) * Real(.5);
      const Vec3 dir = better ? near.n : best.n;
      const Real size = better ? s : best.s;
      const Real gain = s - best.s;
      best = {dir, size, middle - dir * (size / 2), middle + dir * (size / 2)};
      if (!(gain > kLeastGain * p.length)) break;
    } else {
      break;
    }
  }
  return best;
}

}  // namespace rubble::RUBBLE_CORE
