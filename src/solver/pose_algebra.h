#pragma once
/// Differences and updates of poses. A pose in a step is x^t plus a displacement; orientations are kept relative to q^t.
#include "math/rotation.h"

namespace rubble::RUBBLE_CORE {

/// A position and an orientation.
struct Pose {
  Vec3 p;
  Quat q;
};

/// A 6-vector: linear part first; angular part in world axes.
struct Vec6 {
  Vec3 lin, ang;
  RUBBLE_HD friend Vec6 operator-(const Vec6& a) { return {-a.lin, -a.ang}; }
  RUBBLE_HD friend Vec6 operator*(Real s, const Vec6& a) { return {s * a.lin, s * a.ang}; }
};
RUBBLE_HD inline Real dot(const Vec6& a, const Vec6& b) { return dot(a.lin, b.lin) + dot(a.ang, b.ang); }

/// \eq{S7} a - b = (p_a - p_b, 2 (q_a q_b^-1)_v), along the short arc. [m, rad for small angles]
RUBBLE_HD inline Vec6 difference(const Pose& a, const Pose& b) {
  return {a.p - b.p, Real(2) * shortArc(a.q * conjugate(b.q)).v};
}

/// \eq{S9} x + dx = (p + dp, normalize(q + (0, dw) q / 2)). For the small updates of the solver.
RUBBLE_HD inline Pose retract(const Pose& x, const Vec6& dx) {
  const Quat dq = Quat{Real(0), dx.ang} * x.q;
  return {x.p + dx.lin, normalize(Quat{x.q.s + dq.s / 2, x.q.v + dq.v / 2})};
}

}  // namespace rubble::RUBBLE_CORE
