#pragma once
/// A tendon around a sphere or a cylinder, by the rules of MuJoCo: it lies on the surface where the straight
/// segment would cut it, or, with a guide, on the side of the guide; a guide inside makes it touch the
/// surface from within.
///
/// In the plane of the center, with ends d_i, |d_i| > R, and the normal n of the plane, it leaves the circle
/// at
///
///   w_i = (R^2 d_i -+ R sqrt(|d_i|^2 - R^2) n x d_i) / |d_i|^2
///
/// On a cylinder it rises evenly along the axis over its three pieces. It is a geodesic, so dL/dx is that of
/// the two straight pieces with w_i fixed to the wrapped body.
#include "math/rotation.h"
#include "math/trig.h"

namespace rubble {

/// What a segment of a tendon wraps, in the precision R.
template <class R, class V> struct TendonWrap {
  V center;    ///< in the frame of its body [m]
  V axis;      ///< of a cylinder, of length 1; zeros: a sphere
  V guide;     ///< a point, from the center [m]
  R radius;    ///< [m]
  int point;   ///< the segment begins at this point of the path
  int side;    ///< of its body
  int guided;  ///< 0, 1
};

}  // namespace rubble

namespace rubble::RUBBLE_CORE {

/// Where a tendon meets the surface and leaves it, from the center [m].
struct WrappedArc {
  bool touches;  ///< if not, the segment is straight
  Vec3 begin, end;
  Real length;  ///< on the surface [m]
};

/// Do the segments a b and c d of a plane with normal n cross?
RUBBLE_HD inline bool segmentsCross(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d,
                                    const Vec3& n) {
  const Vec3 ab = b - a, cd = d - c, ca = a - c;
  const Real size = dot(n, cross(ab, cd));
  if (!(std::fabs(size) > Real(1e-15))) return false;
  const Real s = dot(n, cross(cd, ca)) / size, t = dot(n, cross(ab, ca)) / size;
  return s >= Real(0) && s <= Real(1) && t >= Real(0) && t <= Real(1);
}

/// Around a circle on the side of `guide`, or the shorter way without one.
RUBBLE_HD inline WrappedArc wrapOutside(const Vec3& d0, const Vec3& d1, const Vec3& n, Real radius,
                                        const Vec3* guide) {
  WrappedArc out{};
  const Real r2 = radius * radius;
  const Vec3 d[2] = {d0, d1};
  Vec3 along[2], across[2];
  for (int i = 0; i < 2; ++i) {
    const Real size = lengthSquared(d[i]);
    if (!(size > r2)) return out;
    along[i] = d[i] * (r2 / size);
    across[i] = cross(n, d[i]) * (radius * std::sqrt(size - r2) / size);
  }
  Real best = 0;
  for (int k = 0; k < 2; ++k) {
    const Real sign = k == 0 ? Real(1) : Real(-1);
    const Vec3 from = along[0] - sign * across[0], to = along[1] + sign * across[1];
    if (segmentsCross(d0, from, d1, to, n)) continue;
    const Real worth = guide ? dot(normalize(from + to), *guide) : -lengthSquared(from - to);
    if (out.touches && !(worth > best)) continue;
    out.touches = true, best = worth;
    // the angle between them, against the sense of n for the first solution
    constexpr Real kTurn = Real(6.28318530717958647693), kNone = Real(-.05);
    Real angle = signedAngleOf(-sign * dot(n, cross(from, to)), dot(from, to));
    if (angle < kNone && guide) angle += kTurn;
    out.begin = from, out.end = to, out.length = radius * max(angle, Real(0));
  }
  return out;
}

/// Through the point of a circle that makes the way shortest. Between the directions of the ends the slope of
/// the length changes its sign once.
RUBBLE_HD inline WrappedArc wrapInside(const Vec3& d0, const Vec3& d1, const Vec3& n, Real radius) {
  const Vec3 u0 = normalize(d0), u1 = normalize(d1);
  const auto at = [&](Real s) { return radius * normalize(u0 + s * (u1 - u0)); };
  const auto slope = [&](const Vec3& w) { return dot(cross(n, w), normalize(d0 - w) + normalize(d1 - w)); };
  const Real sense = dot(n, cross(u0, u1)) < Real(0) ? Real(-1) : Real(1);
  // the rule of false position, with the value of an end that stays halved
  Real low = 0, high = 1, f0 = sense * slope(at(low)), f1 = sense * slope(at(high)), s = Real(0.5);
  int kept = 0;
  for (int k = 0; k < 24 && f0 > f1; ++k) {
    s = clamp((low * f1 - high * f0) / (f1 - f0), low, high);
    const Real f = sense * slope(at(s));
    if (f > Real(0)) {
      low = s, f0 = f;
      if (kept == 1) f1 /= 2;
      kept = 1;
    } else {
      high = s, f1 = f;
      if (kept == -1) f0 /= 2;
      kept = -1;
    }
  }
  const Vec3 w = at(s);
  return {true, w, w, 0};
}

/// `from`, `to`: the ends, from the center of what is wrapped; `axis`, `guide`: in the same axes [m].
RUBBLE_OUT_OF_LINE RUBBLE_HD inline WrappedArc wrapAround(const Vec3& from, const Vec3& to, const Vec3& axis,
                                                          Real radius, const Vec3* guide) {
  const bool isCylinder = lengthSquared(axis) > Real(0.5);
  Vec3 n = axis;
  if (!isCylinder) {
    n = cross(from, to);
    const Real size = lengthSquared(from) * lengthSquared(to);
    constexpr Real kAligned = Real(1e-14);
    Vec3 other;
    if (lengthSquared(n) > kAligned * size)
      n = normalize(n);
    else
      tangentBasis(normalize(from), n, other);
  }
  const auto flat = [&](const Vec3& v) { return v - dot(n, v) * n; };
  const Vec3 d0 = flat(from), d1 = flat(to), way = d1 - d0;
  const Real way2 = lengthSquared(way), r2 = radius * radius;
  if (!(way2 > Real(0))) return {};
  // the point of the segment that is nearest to the center
  const Vec3 nearest = d0 + clamp(-dot(way, d0) / way2, Real(0), Real(1)) * way;
  const bool cuts = !(lengthSquared(nearest) > r2);
  WrappedArc out{};
  if (guide && lengthSquared(*guide) < r2) {
    if (cuts || !(lengthSquared(d0) > r2) || !(lengthSquared(d1) > r2)) return {};
    out = wrapInside(d0, d1, n, radius);
  } else {
    Vec3 beside{};
    if (guide) beside = flat(*guide);
    if (!cuts && !(guide && dot(beside, nearest) < Real(0))) return {};
    out = wrapOutside(d0, d1, n, radius, guide ? &beside : nullptr);
  }
  if (!isCylinder || !out.touches) return out;
  const Real before = length(d0 - out.begin), after = length(d1 - out.end), all = before + out.length + after;
  const Real bottom = dot(n, from), rise = dot(n, to) - bottom;
  if (!(all > Real(0))) return {};
  out.begin += (bottom + rise * before / all) * n;
  out.end += (bottom + rise * (before + out.length) / all) * n;
  const Real up = rise * out.length / all;
  out.length = std::sqrt(out.length * out.length + up * up);
  return out;
}

}  // namespace rubble::RUBBLE_CORE
