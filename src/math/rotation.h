#pragma once
/// Rotation vectors: exact exponential and logarithm of unit quaternions, for the rotation of a whole step.
#include "math/lanes.h"
#include "math/trig.h"

namespace rubble::RUBBLE_CORE {

/// The same rotation with s >= 0 (short arc).
template <class L> RUBBLE_HD RUBBLE_NEAR QuatT<L> shortArc(const QuatT<L>& q) {
  const auto far = q.s < LaneAccess<L>::splat(0);
  return {select(far, -q.s, q.s), select(far, -q.v, q.v)};
}

/// (cos(|a|/2), sin(|a|/2) a/|a|): rotation by the vector a [rad].
RUBBLE_HD inline Quat expRotation(const Vec3& a) {
  const Real angle2 = dot(a, a);
  if (angle2 < Real(1e-4)) {
    // series of sin(t/2)/t and cos(t/2), exact to round-off here
    return {Real(1) - angle2 * (Real(1) / 8 - angle2 / 384),
            a * (Real(.5) - angle2 * (Real(1) / 48 - angle2 / 3840))};
  }
  const Real angle = std::sqrt(angle2);
  const SinCos half = sinCos(angle / 2);
  return {half.cos, a * (half.sin / angle)};
}

/// Bound of |v|^2 of a unit quaternion (s, v) below which its logarithm is a series (a rotation of 0.1 rad).
inline constexpr Real kSmallTurn2 = Real(.0025);
/// logRotation of a short-arc quaternion with u2 = |v|^2 < kSmallTurn2: series of 2 asin(u)/u, relative error
/// below 1e-9.
template <class L> RUBBLE_HD RUBBLE_NEAR Vec3T<L> logOfSmall(const QuatT<L>& q, L u2) {
  return q.v * (Real(2) * (Real(1) + u2 * (Real(1) / 6 + u2 * (Real(3) / 40 + u2 * (Real(15) / 336)))));
}

/// The rotation vector a, |a| <= pi, with expRotation(a) = q up to sign [rad].
RUBBLE_HD inline Vec3 logRotation(const Quat& rotation) {
  const Quat q = shortArc(rotation);
  const Real u2 = dot(q.v, q.v);
  if (u2 < kSmallTurn2) return logOfSmall(q, u2);
  const Real u = std::sqrt(u2);
  return q.v * (Real(2) * angleOf(u, q.s) / u);
}

/// Two unit vectors that complete the unit vector n to a right-handed basis; continuous in n except at one
/// point (Duff et al. 2017).
template <class L> RUBBLE_HD RUBBLE_NEAR void tangentBasis(const Vec3T<L>& n, Vec3T<L>& t1, Vec3T<L>& t2) {
  using A = LaneAccess<L>;
  const L sign = select(n.z < A::splat(0), A::splat(-1), A::splat(1));
  const L a = A::splat(-1) / (sign + n.z);
  const L b = n.x * n.y * a;
  t1 = {A::splat(1) + sign * n.x * n.x * a, sign * b, -sign * n.x};
  t2 = {b, sign + n.y * n.y * a, -n.y};
}

}  // namespace rubble::RUBBLE_CORE
