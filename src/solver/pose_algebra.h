#pragma once
/// Differences and updates of poses. Within a step a pose is x^t plus a displacement, and orientations are
/// relative to q^t.
#include "math/rotation.h"

namespace rubble::RUBBLE_CORE {

/// A position and an orientation; L: Real or SIMD lanes (math/lanes.h).
template <class L> struct PoseT {
  Vec3T<L> p;
  QuatT<L> q;
};
using Pose = PoseT<Real>;

/// A 6-vector: linear part first, angular part in world axes.
template <class L> struct Vec6T {
  Vec3T<L> lin, ang;
  RUBBLE_HD friend Vec6T operator-(const Vec6T& a) { return {-a.lin, -a.ang}; }
  RUBBLE_HD friend Vec6T& operator+=(Vec6T& a, const Vec6T& b) {
    a.lin += b.lin, a.ang += b.ang;
    return a;
  }
  RUBBLE_HD friend Vec6T operator*(L s, const Vec6T& a) { return {s * a.lin, s * a.ang}; }
};
using Vec6 = Vec6T<Real>;
RUBBLE_HD inline Real dot(const Vec6& a, const Vec6& b) { return dot(a.lin, b.lin) + dot(a.ang, b.ang); }

/// \eq{S7} a - b = (p_a - p_b, 2 (q_a q_b^-1)_v), along the short arc. [m, rad for small angles]
template <class L> RUBBLE_HD RUBBLE_NEAR Vec6T<L> difference(const PoseT<L>& a, const PoseT<L>& b) {
  return {a.p - b.p, LaneAccess<L>::splat(2) * shortArc(a.q * conjugate(b.q)).v};
}

/// \eq{S9} x + dx = (p + dp, normalize(q + (0, dw) q / 2)). For small updates only.
template <class L = Real> RUBBLE_HD RUBBLE_NEAR PoseT<L> retract(const PoseT<L>& x, const Vec6T<L>& dx) {
  using A = LaneAccess<L>;
  const QuatT<L> dq = QuatT<L>{A::splat(0), dx.ang} * x.q;
  const L s = x.q.s + Real(.5) * dq.s;
  const Vec3T<L> v = x.q.v + A::splat(Real(.5)) * dq.v;
  const L inverse = A::splat(1) / sqrtOf(s * s + dot(v, v));
  return {x.p + dx.lin, {s * inverse, v * inverse}};
}

}  // namespace rubble::RUBBLE_CORE
