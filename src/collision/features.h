#pragma once
/// Closest points of surface features (vertex and triangle, or two edges), and their time of impact.
///
///   corners x_0 to x_3: side A first (one vertex, or two ends of an edge), then side B (a triangle, or an
///   edge)
///   closest points: sum c_i x_i = p_A - p_B, with c_i >= 0 that add up to 1 on side A and c_i <= 0 that add
///   up to -1 on side B
///
/// Coordinates are relative to a nearby origin, so that floats resolve 1e-7 of the size of the features.
#include "math/hd.h"

namespace rubble::RUBBLE_CORE {

/// Barycentric weights of the point of segment ab closest to p.
RUBBLE_HD inline void nearestOnSegment(const Vec3& p, const Vec3& a, const Vec3& b, Real (&w)[2]) {
  const Vec3 e = b - a;
  const Real size2 = dot(e, e),
             t = size2 > Real(0) ? clamp(dot(p - a, e) / size2, Real(0), Real(1)) : Real(0);
  w[0] = Real(1) - t, w[1] = t;
}

/// Barycentric weights of the point of triangle abc closest to p, by Voronoi region.
RUBBLE_HD inline void nearestOnTriangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c,
                                        Real (&w)[3]) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  w[0] = w[1] = w[2] = Real(0);
  const Real d1 = dot(ab, ap), d2 = dot(ac, ap), d3 = dot(ab, bp), d4 = dot(ac, bp), d5 = dot(ab, cp),
             d6 = dot(ac, cp);
  if (d1 <= Real(0) && d2 <= Real(0)) return void(w[0] = 1);
  if (d3 >= Real(0) && d4 <= d3) return void(w[1] = 1);
  if (d6 >= Real(0) && d5 <= d6) return void(w[2] = 1);
  const Real va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2, sum = va + vb + vc;
  if (vc <= Real(0) && d1 >= Real(0) && d3 <= Real(0)) {
    w[1] = d1 > d3 ? d1 / (d1 - d3) : Real(0);
    w[0] = Real(1) - w[1];
  } else if (vb <= Real(0) && d2 >= Real(0) && d6 <= Real(0)) {
    w[2] = d2 > d6 ? d2 / (d2 - d6) : Real(0);
    w[0] = Real(1) - w[2];
  } else if (va <= Real(0) && d4 - d3 >= Real(0) && d5 - d6 >= Real(0)) {
    const Real along = (d4 - d3) + (d5 - d6);
    w[2] = along > Real(0) ? (d4 - d3) / along : Real(0);
    w[1] = Real(1) - w[2];
  } else if (sum > Real(0)) {
    w[1] = vb / sum, w[2] = vc / sum;
    w[0] = Real(1) - w[1] - w[2];
  } else {
    // degenerate triangle: the closest of its three sides
    const Vec3* const corner[3] = {&a, &b, &c};
    Real best = -1;
    for (int k = 0; k < 3; ++k) {
      const int j = k == 2 ? 0 : k + 1;
      Real s[2];
      nearestOnSegment(p, *corner[k], *corner[j], s);
      const Vec3 d = p - s[0] * *corner[k] - s[1] * *corner[j];
      if (best >= Real(0) && dot(d, d) >= best) continue;
      best = dot(d, d);
      w[0] = w[1] = w[2] = Real(0);
      w[k] = s[0], w[j] = s[1];
    }
  }
}

/// Weights of the closest points of segments x0 x1 (c_0, c_1) and x2 x3 (c_2, c_3, negative).
RUBBLE_HD inline void nearestOfSegments(const Vec3 (&x)[4], Real (&c)[4]) {
  const Vec3 u = x[1] - x[0], v = x[3] - x[2], r = x[0] - x[2];
  const Real a = dot(u, u), e = dot(v, v), b = dot(u, v), f = dot(v, r), g = dot(u, r), det = a * e - b * b;
  // below this squared sine of the angle between them, round-off determines the closest points of the lines
  constexpr Real kParallel = sizeof(Real) == 8 ? Real(1e-12) : Real(1e-5);
  if (det > kParallel * a * e) {
    const Real s0 = clamp((b * f - g * e) / det, Real(0), Real(1)), t0 = (b * s0 + f) / e;
    const Real t = clamp(t0, Real(0), Real(1)), s = t == t0 ? s0 : clamp((b * t - g) / a, Real(0), Real(1));
    c[0] = Real(1) - s, c[1] = s, c[2] = t - Real(1), c[3] = -t;
    return;
  }
  Real best = -1;
  for (int end = 0; end < 4; ++end) {
    const int other = end < 2 ? 2 : 0;
    Real w[2];
    nearestOnSegment(x[end], x[other], x[other + 1], w);
    const Vec3 d = x[end] - w[0] * x[other] - w[1] * x[other + 1];
    if (best >= Real(0) && dot(d, d) >= best) continue;
    best = dot(d, d);
    const Real sign = end < 2 ? Real(1) : Real(-1);
    c[0] = c[1] = c[2] = c[3] = Real(0);
    c[end] = sign, c[other] = -sign * w[0], c[other + 1] = -sign * w[1];
  }
}

/// p_A - p_B of a vertex and a triangle (`sideA` 1) or of two edges (2), and the weights of the closest
/// points.
RUBBLE_HD inline Vec3 nearestOfFeatures(const Vec3 (&x)[4], int sideA, Real (&c)[4]) {
  if (sideA == 2) {
    nearestOfSegments(x, c);
    // relative to one corner, because sums of products of coordinates lose digits
    return (x[0] - x[2]) + c[1] * (x[1] - x[0]) + c[3] * (x[3] - x[2]);
  }
  Real w[3];
  nearestOnTriangle(x[0], x[1], x[2], x[3], w);
  c[0] = Real(1), c[1] = -w[0], c[2] = -w[1], c[3] = -w[2];
  return (x[0] - x[1]) + c[2] * (x[2] - x[1]) + c[3] * (x[3] - x[1]);
}

/// Result of a time-of-impact query of two moving features.
struct FeatureImpact {
  bool meets;
  Real time;  ///< time in [0, 1]; before it they are further apart than `keep`
  Vec3 n;     ///< unit, from B to A
  Real c[4];
};

/// Most steps of conservative advancement; an undecided query counts as an impact.
inline constexpr int kMostAdvances = 128;
/// The features count as in contact once their distance above `keep` has fallen to this share [1].
inline constexpr Real kMetShare = Real(.1);

/// Do features whose corners move linearly from x to x + move come as close as `keep`? `keep` is less than
/// their distance at the start. Conservative advancement: the distance above `keep` divided by the greatest
/// relative speed of their corners is a safe time step (Li, Kaufman, Jiang: Codimensional incremental
/// potential contact, 2021, section 5). Never misses an impact.
RUBBLE_HD inline FeatureImpact firstImpact(const Vec3 (&x)[4], const Vec3 (&move)[4], int sideA, Real keep) {
  FeatureImpact m;
  m.meets = false, m.time = Real(1);
  const Vec3 mean = Real(.25) * (move[0] + move[1] + move[2] + move[3]);
  Real side[2] = {0, 0};
  Vec3 own[4];
  for (int k = 0; k < 4; ++k) {
    own[k] = move[k] - mean;
    Real& most = side[k < sideA ? 0 : 1];
    most = max(most, dot(own[k], own[k]));
  }
  const Real reach = std::sqrt(side[0]) + std::sqrt(side[1]);
  Vec3 gap = nearestOfFeatures(x, sideA, m.c);
  Real distance = length(gap);
  if (distance - keep > reach) return m;
  // a plane that separates them at the start and at the end separates them all the time
  m.n = gap / distance;
  Real lowest = 0, highest = 0;
  for (int k = 0; k < 4; ++k) {
    const Real h = dot(m.n, (x[k] - x[0]) + own[k]);
    if (k < sideA)
      lowest = k == 0 ? h : min(lowest, h);
    else
      highest = k == sideA ? h : max(highest, h);
  }
  if (lowest - highest >= keep) return m;
  const Real near = kMetShare * (distance - keep);
  Real time = 0;
  for (int k = 0; k < kMostAdvances; ++k) {
    constexpr Real kCareful = Real(.9);
    const Real next = time + kCareful * (distance - keep) / reach;
    if (next >= Real(1)) return m;
    time = next;
    Vec3 at[4];
    for (int j = 0; j < 4; ++j) at[j] = x[j] + time * own[j];
    gap = nearestOfFeatures(at, sideA, m.c);
    distance = length(gap);
    if (!(distance - keep > near)) break;
  }
  m.meets = true, m.time = time;
  m.n = distance > Real(0) ? gap / distance : m.n;
  return m;
}

}  // namespace rubble::RUBBLE_CORE
