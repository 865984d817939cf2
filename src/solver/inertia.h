#pragma once
/// Inertia: where a body would go without constraints, and what it costs to go elsewhere.
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

/// c(a) = (1 - (a/2) cot(a/2)) / a^2 of the discrete momenta, and its derivative by a^2.
struct MomentumCurve {
  Real value, slope;
};
/// From a^2, by a series that converges as (a / 2 pi)^2: to 1e-6 at 2 rad.
RUBBLE_HD inline MomentumCurve momentumCurve(Real a2) {
  constexpr Real k[] = {Real(1. / 12),      Real(1. / 720),      Real(1. / 30240),
                        Real(1. / 1209600), Real(1. / 47900160), Real(691. / 1307674368000)};
  Real value = k[5], slope = 0;
  RUBBLE_UNROLL
  for (int i = 4; i >= 0; --i) slope = value + a2 * slope, value = k[i] + a2 * value;
  return {value, slope};
}

/// Angular momentum of a free body in its own frame, at the beginning (`side` = 1) or the end (-1) of a step
/// that it spends at spin w: the discrete Legendre maps of a rigid body, with x = dt w,
///
///   Pi+-(w) = I w +- x cross (I w) / 2 + c(|x|) x cross (x cross (I w))
///
/// so that R(t + dt) Pi-(w) = R(t) Pi+(w): what a free body has in the world stays as it is. [kg m2/s]
/// `inertia` principal moments [kg m2].
struct SpinMomentum {
  Vec3 inertia;
  Real dt, side;

  RUBBLE_HD Vec3 operator()(const Vec3& w) const {
    const Vec3 x = dt * w, h = mul(inertia, w), turn = cross(x, h);
    return h + (side / 2) * turn + momentumCurve(dot(x, x)).value * cross(x, turn);
  }
  /// One Newton step towards the spin of the momentum `wanted`.
  RUBBLE_HD Vec3 refine(const Vec3& w, const Vec3& wanted) const {
    const Vec3 x = dt * w, h = mul(inertia, w), turn = cross(x, h), twice = cross(x, turn);
    const MomentumCurve c = momentumCurve(dot(x, x));
    // products of three moments leave the range of a float
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
/// The spin of a momentum, from a first guess. Between 1 rad and 2 rad per step some slender bodies have no
/// such spin that a few Newton steps find: they get `otherwise`. Two steps are exact to round-off below 0.1
/// rad per step.
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

/// Spin after one step without constraints that keeps the angular momentum, Pi+(w1) = Pi-(w0) + dt T, in the
/// body's frame. [rad/s] `w0` spin, `torque` [N m], `inertia` principal moments [kg m2].
RUBBLE_HD inline Vec3 torqueFreeSpin(const Vec3& w0, const Vec3& torque, const Vec3& inertia, Real dt) {
  const Vec3 explicitSpin = w0 + dt * Vec3{torque.x / inertia.x, torque.y / inertia.y, torque.z / inertia.z};
  if (isSpherical(inertia) || dot(w0, w0) + dot(torque, torque) == Real(0)) return explicitSpin;
  const Vec3 wanted = SpinMomentum{inertia, dt, Real(-1)}(w0) + dt * torque;
  return spinOf({inertia, dt, Real(1)}, wanted, w0, explicitSpin);
}

/// Spin at orientation `here` of a body that has the angular momentum with which spin w takes it to
/// orientation `there`. World axes. [rad/s]
RUBBLE_HD RUBBLE_APART inline Vec3 spinAt(Quat here, Quat there, Vec3 w, Vec3 inertia, Real dt) {
  if (isSpherical(inertia)) return w;
  const SpinMomentum end{inertia, dt, Real(-1)};
  const Vec3 guess = rotateInverse(there, w);
  return rotate(here, spinOf(end, rotateInverse(here, rotate(there, end(guess))), guess, guess));
}

/// Angular momentum of a body at orientation q that ends, or begins, a step with spin w; world axes. [kg
/// m2/s]
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

/// What is added to a spin when its angular momentum is changed by `given`, in the frame of the body. [rad/s]
/// `near`: to first order in the rotation of a step; along no principal axis is the result further than
/// `most` from it. `given` [kg m2/s].
RUBBLE_HD inline Vec3 spinChange(const Vec3& w, const Vec3& given, const Vec3& near, Real most,
                                 const Vec3& inertia, Real dt) {
  if (isSpherical(inertia)) return given / inertia.x;
  const SpinMomentum end{inertia, dt, Real(-1)};
  const Vec3 first = w + near, off = spinOf(end, end(w) + given, first, first) - first;
  const auto cut = [&](Real a) { return clamp(a, -most, most); };
  return near + Vec3{cut(off.x), cut(off.y), cut(off.z)};
}

/// Rotations in a step below which Pi+- are I w for all that rows give, squared [rad2]: no spinAfterRows is
/// asked for.
inline constexpr Real kNoTurn2 = Real(1e-8);

/// Moments of inertia that differ by less than this share are the same [1].
inline constexpr Real kSameMoment = Real(1e-4);

/// Spin at the end of a step that has turned a body by x = exp(turn) since x^t, where it would have turned by
/// y without rows: that of the momentum Pi+(log(y) / dt) + I (x - y) / dt, of which rows have given the
/// second part (their torques balance it in the local problem [S 5]). log(x) / dt has that momentum to first
/// order alone: with it, torques would turn the momentum of a body that spins in a direction that is off by
/// half of its rotation in a step. Along a principal axis the two differ by no more than |log(x)| |x - y| /
/// dt: what rows of frozen levers seem to give a slender body about its long axis, which has turned since, is
/// left out. About an axis of symmetry torques about it alone change a spin, and log(x) / dt has that:
/// torques of a bearing that turns in a step are those of its end, and their momentum would brake the wheel.
/// World axes. [rad/s] `start` orientation at x^t, `inertia` principal moments [kg m2].
RUBBLE_HD RUBBLE_APART inline Vec3 spinAfterRows(Quat start, Quat x, Vec3 turn, Quat y, Vec3 inertia,
                                                 Real dt) {
  const Real inverseDt = Real(1) / dt;
  const Vec3 rows = Real(2) * shortArc(x * conjugate(y)).v;
  const bool spherical = isSpherical(inertia);
  const Vec3 free = logRotation(y);
  if (spherical) return inverseDt * (free + rows);
  const SpinMomentum begin{inertia, dt, Real(1)};
  // about its axis a rotation changes nothing: w is the same in the frames of the body at both ends
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

/// \eq{S1} The inertial part of the objective whose minimum is the implicit Euler step: |x - y|_M^2 / (2
/// dt^2); the potentials of all
/// forces are added to it. [J]
RUBBLE_HD inline Real inertialEnergy(const MassMatrix& m, const Pose& x, const Pose& y, Real dt) {
  const Vec6 d = difference(x, y);
  return (m.mass * dot(d.lin, d.lin) + dot(d.ang, m.inertia * d.ang)) / (2 * dt * dt);
}

/// Share of the external acceleration that a body followed in the last step, for the initial guess x^t + dt v
/// + c dt^2 a (adaptive rule of vertex block descent): 0 for a body at rest, 1 for a falling one. `v`,
/// `previous` velocities [m/s], `acceleration` [m/s2].
RUBBLE_HD inline Real followedShare(const Vec3& v, const Vec3& previous, const Vec3& acceleration, Real dt) {
  const Real a2 = dot(acceleration, acceleration);
  if (!(a2 > Real(0))) return 0;
  const Real c = dot(v - previous, acceleration) / (dt * a2);
  return isFinite(c) ? clamp(c, Real(0), Real(1)) : Real(0);
}

}  // namespace rubble::RUBBLE_CORE
