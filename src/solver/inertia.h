#pragma once
/// Mass matrix, inertial target and the angular momentum of free rotation.
#include "math/sym.h"
#include "solver/pose_algebra.h"

namespace rubble::RUBBLE_CORE {

/// \eq{S8} M = diag(m 1, I_w), I_w = R I_b R^T, frozen at x^t for the step. [kg, kg m2]
template <class L> struct MassMatrixT {
  L mass;
  Sym3T<L> inertia;
};
using MassMatrix = MassMatrixT<Real>;
RUBBLE_HD inline MassMatrix massMatrix(Real mass, const Vec3& principalInertia, const Quat& q) {
  return {mass, rotateDiagonal(q, principalInertia)};
}

/// \eq{S2} y - x^t = dt v + dt^2 a_ext, the linear part of the inertial target. [m]
RUBBLE_HD inline Vec3 inertialDisplacement(const Vec3& v, const Vec3& acceleration, Real dt) {
  return dt * (v + dt * acceleration);
}

/// c(a) = (1 - (a/2) cot(a/2)) / a^2 of the discrete momenta, and its derivative with respect to a^2.
struct MomentumCurve {
  Real value, slope;
};
/// Evaluated from a^2 by a series in (a / 2 pi)^2; error 1e-6 at 2 rad.
RUBBLE_HD inline MomentumCurve momentumCurve(Real a2) {
  constexpr Real k[] = {Real(1. / 12),      Real(1. / 720),      Real(1. / 30240),
                        Real(1. / 1209600), Real(1. / 47900160), Real(691. / 1307674368000)};
  Real value = k[5], slope = 0;
  RUBBLE_UNROLL
  for (int i = 4; i >= 0; --i) slope = value + a2 * slope, value = k[i] + a2 * value;
  return {value, slope};
}

/// Angular momentum of a free body in its own frame, at the start (`side` = 1) or the end (-1) of a step with
/// angular velocity w. These are the discrete Legendre maps of a rigid body, with x = dt w:
///
///   Pi+-(w) = I w +- x cross (I w) / 2 + c(|x|) x cross (x cross (I w))
///
/// R(t + dt) Pi-(w) = R(t) Pi+(w) holds, so the world-frame momentum of a free body is conserved. [kg m2/s]
/// `inertia`: principal moments [kg m2].
struct SpinMomentum {
  Vec3 inertia;
  Real dt, side;

  RUBBLE_HD Vec3 operator()(const Vec3& w) const {
    const Vec3 x = dt * w, h = mul(inertia, w), turn = cross(x, h);
    return h + (side / 2) * turn + momentumCurve(dot(x, x)).value * cross(x, turn);
  }
  /// One Newton step toward the angular velocity whose momentum is `wanted`.
  RUBBLE_HD Vec3 refine(const Vec3& w, const Vec3& wanted) const {
    const Vec3 x = dt * w, h = mul(inertia, w), turn = cross(x, h), twice = cross(x, turn);
    const MomentumCurve c = momentumCurve(dot(x, x));
    // scaled, because products of three moments overflow a float
    const Real unit = Real(1) / (inertia.x + inertia.y + inertia.z);
    const auto column = [&](const Vec3& axis, Real moment, Real along) {
      const Vec3 change = dt * cross(axis, h) + moment * cross(x, axis);
      return unit *
             (moment * axis + (side / 2) * change + c.value * (dt * cross(axis, turn) + cross(x, change)) +
              (2 * c.slope * dt * along) * twice);
    };
    const Vec3 c0 = column({1, 0, 0}, inertia.x, x.x), c1 = column({0, 1, 0}, inertia.y, x.y),
               c2 = column({0, 0, 1}, inertia.z, x.z);
    const Vec3 k0 = cross(c1, c2), k1 = cross(c2, c0), k2 = cross(c0, c1);
    const Vec3 missing = unit * (wanted - (h + (side / 2) * turn + c.value * twice));
    return w + Vec3{dot(k0, missing), dot(k1, missing), dot(k2, missing)} / dot(c0, k0);
  }
};
/// Angular velocity of a given momentum, from a first guess. Below 0.1 rad per step two Newton steps are
/// exact to round-off. Between 1 rad and 2 rad per step a few Newton steps fail for some slender bodies; the
/// result is then `otherwise`.
RUBBLE_HD inline Vec3 spinOf(const SpinMomentum& momentum, const Vec3& wanted, const Vec3& guess,
                             const Vec3& otherwise) {
  const Real turn2 = dot(guess, guess) * momentum.dt * momentum.dt;
  const int steps = turn2 < Real(0.01) ? 2 : turn2 < Real(1) ? 4 : 8;
  Vec3 w = guess;
  for (int i = 0; i < steps; ++i) w = momentum.refine(w, wanted);
  if (turn2 >= Real(0.25)) {
    const Vec3 left = momentum(w) - wanted;
    if (!(dot(left, left) <= Real(1e-6) * dot(wanted, wanted))) return otherwise;
  }
  return isFinite(w) ? w : otherwise;
}

RUBBLE_HD inline bool isSpherical(const Vec3& inertia) {
  return inertia.x == inertia.y && inertia.y == inertia.z;
}

/// Angular velocity after one step without constraints, in the body frame [rad/s]. Conserves angular
/// momentum: Pi+(w1) = Pi-(w0) + dt T. `torque`: T [N m]. `inertia`: principal moments [kg m2].
RUBBLE_HD inline Vec3 torqueFreeSpin(const Vec3& w0, const Vec3& torque, const Vec3& inertia, Real dt) {
  const Vec3 explicitSpin = w0 + dt * Vec3{torque.x / inertia.x, torque.y / inertia.y, torque.z / inertia.z};
  if (isSpherical(inertia) || dot(w0, w0) + dot(torque, torque) == Real(0)) return explicitSpin;
  const Vec3 wanted = SpinMomentum{inertia, dt, Real(-1)}(w0) + dt * torque;
  return spinOf({inertia, dt, Real(1)}, wanted, w0, explicitSpin);
}

/// Angular velocity at orientation `here` that keeps the angular momentum of a body that reaches orientation
/// `there` with angular velocity w. World axes. [rad/s]
RUBBLE_HD RUBBLE_OUT_OF_LINE inline Vec3 spinAt(Quat here, Quat there, Vec3 w, Vec3 inertia, Real dt) {
  if (isSpherical(inertia)) return w;
  const SpinMomentum end{inertia, dt, Real(-1)};
  const Vec3 guess = rotateInverse(there, w);
  return rotate(here, spinOf(end, rotateInverse(here, rotate(there, end(guess))), guess, guess));
}

/// World-frame angular momentum of a body at orientation q that ends (`side` = -1) or begins (1) a step with
/// angular velocity w. [kg m2/s]
RUBBLE_HD inline Vec3 momentumOf(const Quat& q, const Vec3& w, const Vec3& inertia, Real dt, Real side) {
  const Vec3 inBody = rotateInverse(q, w);
  return rotate(q, isSpherical(inertia) ? mul(inertia, inBody) : SpinMomentum{inertia, dt, side}(inBody));
}
RUBBLE_HD inline Vec3 angularMomentum(const Quat& q, const Vec3& w, const Vec3& inertia, Real dt) {
  return momentumOf(q, w, inertia, dt, Real(-1));
}
RUBBLE_HD inline Vec3 freeMomentum(const Quat& q, const Vec3& w, const Vec3& inertia, Real dt) {
  return momentumOf(q, w, inertia, dt, Real(1));
}

/// Change of the angular velocity w when the angular momentum changes by `given` [kg m2/s], in the body frame
/// [rad/s]. `near`: its first-order estimate. Along each principal axis the result differs from `near` by at
/// most `most`.
RUBBLE_HD inline Vec3 spinChange(const Vec3& w, const Vec3& given, const Vec3& near, Real most,
                                 const Vec3& inertia, Real dt) {
  if (isSpherical(inertia)) return given / inertia.x;
  const SpinMomentum end{inertia, dt, Real(-1)};
  const Vec3 first = w + near, off = spinOf(end, end(w) + given, first, first) - first;
  const auto cut = [&](Real a) { return clamp(a, -most, most); };
  return near + Vec3{cut(off.x), cut(off.y), cut(off.z)};
}

/// Squared rotation per step below which Pi+- equal I w to the accuracy of the rows [rad2]. spinAfterRows is
/// not called then.
inline constexpr Real kNoRotation2 = Real(1e-8);

/// Moments of inertia whose relative difference is smaller count as equal [1].
inline constexpr Real kSameMoment = Real(1e-4);

/// World-frame angular velocity at the end of a step [rad/s]. x = exp(turn) is the rotation since x^t, y the
/// rotation without rows. `start`: orientation at x^t; `inertia`: principal moments [kg m2].
///
/// The body has the angular momentum Pi+(log(y) / dt) + I (x - y) / dt. The second term is the contribution
/// of the rows, whose torques balance it in the local problem [S 5]. log(x) / dt has this momentum to first
/// order only: the torque on a spinning body would then act in a direction that is off by half its rotation
/// per step.
///
/// Two limits apply to the difference from log(x) / dt:
///   principal axis    at most |log(x)| |x - y| / dt. Rows with frozen levers seem to add more about the long
///                     axis of a slender body, which has rotated since x^t.
///   axis of symmetry  zero. Only torques about this axis change the spin, and log(x) / dt contains them. The
///                     torques of a bearing that rotates in the step belong to the end of the step; their
///                     momentum would brake the wheel.
RUBBLE_HD RUBBLE_OUT_OF_LINE inline Vec3 spinAfterRows(Quat start, Quat x, Vec3 turn, Quat y, Vec3 inertia,
                                                       Real dt) {
  const Real inverseDt = Real(1) / dt;
  const Vec3 rows = Real(2) * shortArc(x * conjugate(y)).v;
  const bool spherical = isSpherical(inertia);
  const Vec3 free = logRotation(y);
  if (spherical) return inverseDt * (free + rows);
  const SpinMomentum begin{inertia, dt, Real(1)};
  // invariant under rotation about its own axis: w is the same in the body frames at both ends
  const Vec3 w = inverseDt * rotateInverse(start, turn);
  const Vec3 change = mul(inertia, inverseDt * rotateInverse(start, rows));
  const Vec3 missing = change - (begin(w) - begin(inverseDt * rotateInverse(start, free)));
  const Quat now = x * start;
  const Vec3 given = rotateInverse(now, rotate(start, missing));
  const Real most = inverseDt * std::sqrt(dot(turn, turn) * dot(rows, rows));
  Vec3 added = spinChange(w, given, {0, 0, 0}, most, inertia, dt);
  const auto same = [](Real a, Real b) { return std::fabs(a - b) <= kSameMoment * a; };
  if (same(inertia.y, inertia.z)) added.x = 0;
  if (same(inertia.z, inertia.x)) added.y = 0;
  if (same(inertia.x, inertia.y)) added.z = 0;
  return inverseDt * turn + rotate(now, added);
}

/// \eq{S1} Inertial part of the implicit Euler objective, |x - y|_M^2 / (2 dt^2); the potentials of all
/// forces are added to it. [J]
RUBBLE_HD inline Real inertialEnergy(const MassMatrix& m, const Pose& x, const Pose& y, Real dt) {
  const Vec6 d = difference(x, y);
  return (m.mass * dot(d.lin, d.lin) + dot(d.ang, m.inertia * d.ang)) / (2 * dt * dt);
}

/// Share c of the external acceleration that a body followed in the last step: 0 at rest, 1 in free fall. The
/// initial guess of vertex block descent is x^t + dt v + c dt^2 a. `v`, `previous`: velocities of the last
/// two steps [m/s]; `acceleration` [m/s2].
RUBBLE_HD inline Real followedShare(const Vec3& v, const Vec3& previous, const Vec3& acceleration, Real dt) {
  const Real a2 = dot(acceleration, acceleration);
  if (!(a2 > Real(0))) return 0;
  const Real c = dot(v - previous, acceleration) / (dt * a2);
  return isFinite(c) ? clamp(c, Real(0), Real(1)) : Real(0);
}

}  // namespace rubble::RUBBLE_CORE
